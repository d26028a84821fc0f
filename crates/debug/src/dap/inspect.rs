//! What a client sees of a program that stands: frames, scopes, variables, expressions.

use super::message::Arguments;
use super::{Adapter, LaunchHost};
use crate::expression::{Item, assignment};
use crate::spot::{Piece, Spot};
use crate::stack::CallFrame;
use crate::symbols::{SourceFile, Variable};
use crate::value::{Number, OPTIMISED_OUT, Value as Shown};
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_emulator::status::Status;
use serde_json::{Value, json};

/// What a number of variables stands for.
#[derive(Clone, Debug)]
pub(super) enum Reference {
    Locals(usize),
    Globals,
    Libraries,
    Registers(usize),
    Peripherals,
    Pins,
    /// The parts of a value: the frame, and how an expression names it.
    Parts(usize, String, Shown),
}

/// Most parts that are listed at once, if a client does not page.
const MOST_PARTS: usize = 1_000;
/// A file as clients know it.
pub(super) fn source(file: &SourceFile) -> Value {
    let name = file.name.rsplit('/').next().unwrap_or_default();
    match &file.path {
        Some(path) => json!({"name": name, "path": path}),
        None => json!({"name": name}),
    }
}

impl<H: LaunchHost> Adapter<H> {
    pub(super) fn stack_trace(&mut self, asked: &Arguments) -> Result<Value, String> {
        let first = self.lines_start_at;
        let debugger = self.debugger()?;
        let files = &debugger.symbols.lines.files;
        let stack = debugger.stack();
        let shown = |(number, frame): (usize, &CallFrame<'_>)| {
            let mut shown = json!({
                "id": number, "name": frame.name, "line": 0, "column": frame.column.max(1),
                "instructionPointerReference": format!("0x{:x}", frame.address),
            });
            let file = frame.file.and_then(|file| files.get(file));
            let file = file.filter(|_| frame.line > 0);
            if let Some(file) = file {
                shown["line"] = json!(i64::from(frame.line) - 1 + first);
                shown["source"] = source(file);
            }
            if file.is_none_or(|file| file.path.is_none()) {
                shown["presentationHint"] = json!("subtle");
            }
            shown
        };
        let frames = stack.iter().enumerate().skip(asked.start_frame).map(shown);
        let frames: Vec<Value> = match asked.levels {
            0 => frames.collect(),
            levels => frames.take(levels).collect(),
        };
        Ok(json!({"stackFrames": frames, "totalFrames": stack.len()}))
    }

    pub(super) fn scopes(&mut self, frame: usize) -> Result<Value, String> {
        let has_registers = !self.debugger()?.symbols.registers.is_empty();
        let mut scopes = Vec::new();
        for (name, reference, is_wanted) in [
            ("Locals", Reference::Locals(frame), true),
            ("Globals", Reference::Globals, true),
            ("Core and libraries", Reference::Libraries, true),
            ("Pins", Reference::Pins, true),
            ("I/O registers", Reference::Peripherals, has_registers),
            ("CPU", Reference::Registers(frame), true),
        ] {
            if is_wanted {
                let number = self.reference(reference);
                scopes.push(json!({"name": name, "variablesReference": number, "expensive": name != "Locals"}));
            }
        }
        Ok(json!({"scopes": scopes}))
    }

    /// A number for something, from 1.
    fn reference(&mut self, reference: Reference) -> usize {
        self.references.push(reference);
        self.references.len()
    }

    fn referred(&self, number: usize) -> Result<Reference, String> {
        let index = number.checked_sub(1);
        let reference = index.and_then(|index| self.references.get(index));
        let gone = || "the program has gone on since".into();
        reference.cloned().ok_or_else(gone)
    }

    pub(super) fn variables(&mut self, asked: &Arguments) -> Result<Value, String> {
        let reference = self.referred(asked.variables_reference)?;
        let most = match asked.count {
            0 => MOST_PARTS,
            count => count,
        };
        let debugger = self.debugger.as_ref().ok_or("nothing is being debugged")?;
        let (memory, stack) = (debugger.memory(), debugger.stack());
        let (frame, values) = match &reference {
            Reference::Registers(frame) => {
                return Ok(json!({"variables": registers(stack.get(*frame))}));
            }
            Reference::Pins => {
                let level = |level| if level { "HIGH" } else { "LOW" };
                let pins = debugger.world().pins().into_iter();
                let pins = pins.map(|(name, is_high)| single(&name, level(is_high).into()));
                return Ok(json!({"variables": pins.collect::<Vec<_>>()}));
            }
            Reference::Locals(frame) => (*frame, stack.get(*frame).map(locals)),
            Reference::Globals | Reference::Libraries => {
                let own = matches!(reference, Reference::Globals);
                let listed = debugger.symbols.listed().filter(|each| each.is_own == own);
                let mut listed: Vec<&Variable> = listed.collect();
                listed.sort_by_key(|variable| &variable.name);
                (0, stack.first().map(|frame| values(frame, listed)))
            }
            Reference::Peripherals => {
                let registers = debugger.symbols.registers.iter();
                (0, stack.first().map(|frame| values(frame, registers)))
            }
            Reference::Parts(frame, whole, value) => {
                let parts = memory.parts(value).into_iter();
                let parts = parts.map(|(part, value)| (joined(whole, &part), part, value));
                (*frame, Some(parts.collect()))
            }
        };
        let is_hex = matches!(reference, Reference::Peripherals);
        let values = values.unwrap_or_default().into_iter();
        let texts = values.skip(asked.start).take(most).map(|named| {
            let text = match memory.number(&named.2) {
                Some(Number::Integer(number)) if is_hex => format!("0x{number:02x}"),
                _ => memory.text(&named.2),
            };
            let of = memory.symbols.types.name(named.2.of);
            (named, text, of)
        });
        let texts: Vec<_> = texts.collect();
        let variables = texts.into_iter().map(|((expression, name, value), text, of)| {
            let number = self.number_of_parts(frame, &expression, Some(value));
            json!({"name": name, "value": text, "type": of, "evaluateName": expression, "variablesReference": number})
        });
        Ok(json!({"variables": variables.collect::<Vec<_>>()}))
    }

    /// The number of a value's parts; 0: it has none.
    fn number_of_parts(&mut self, frame: usize, name: &str, value: Option<Shown>) -> usize {
        let (Some(debugger), Some(value)) = (&self.debugger, value) else {
            return 0;
        };
        match debugger.memory().has_parts(&value) {
            true => self.reference(Reference::Parts(frame, name.to_owned(), value)),
            false => 0,
        }
    }

    /// Types a line for the program, not the debugger.
    pub(super) fn type_in(&mut self, line: &str) -> Result<Value, String> {
        let line = format!("{line}\n");
        let type_in = |world: &mut H::World| world.type_in(line.as_bytes());
        self.debugger()?.change(type_in);
        Ok(json!({"result": "", "variablesReference": 0}))
    }

    pub(super) fn evaluate(&mut self, place: &Arguments) -> Result<Value, String> {
        if let Some(typed) = place.typed() {
            return self.type_in(typed);
        }
        let text = place.expression.trim();
        let text = match assignment(text) {
            Some((target, value)) => {
                self.debugger()?.assign(place.frame_id, target, value)?;
                target
            }
            None => text,
        };
        self.shown(place.frame_id, text, "result")
    }

    /// An expression's value, with what a client needs to open it.
    fn shown(&mut self, frame: usize, expression: &str, key: &str) -> Result<Value, String> {
        let debugger = self.debugger()?;
        let item = debugger.evaluate(expression, frame)?;
        let (text, of, value) = item.shown(debugger.memory());
        let number = match item {
            Item::Pointer(..) => self.number_of_parts(frame, &format!("*({expression})"), value),
            _ => self.number_of_parts(frame, expression, value),
        };
        Ok(json!({key: text, "type": of, "variablesReference": number}))
    }

    pub(super) fn set_expression(&mut self, place: &Arguments) -> Result<Value, String> {
        self.debugger()?
            .assign(place.frame_id, &place.expression, &place.value)?;
        self.shown(place.frame_id, &place.expression, "value")
    }

    pub(super) fn set_variable(&mut self, place: &Arguments) -> Result<Value, String> {
        if let Reference::Registers(0) = self.referred(place.variables_reference)? {
            return self.set_register(place);
        }
        let (frame, expression) = self.named(place)?;
        self.debugger()?.assign(frame, &expression, &place.value)?;
        self.shown(frame, &expression, "value")
    }

    /// The frame and the expression of a variable of a reference, or of none.
    pub(super) fn named(&self, place: &Arguments) -> Result<(usize, String), String> {
        if place.variables_reference == 0 {
            return Ok((place.frame_id, place.name.clone()));
        }
        match self.referred(place.variables_reference)? {
            Reference::Locals(frame) => Ok((frame, place.name.clone())),
            Reference::Globals | Reference::Libraries | Reference::Peripherals => {
                Ok((0, place.name.clone()))
            }
            Reference::Parts(frame, name, _) => Ok((frame, joined(&name, &place.name))),
            Reference::Registers(_) => {
                Err("registers can be set in the innermost frame only".into())
            }
            Reference::Pins => Err("a pin is set by the program, or by what is wired to it".into()),
        }
    }

    fn set_register(&mut self, place: &Arguments) -> Result<Value, String> {
        let number = place.name.strip_prefix('r');
        let number = number.and_then(|number| number.parse().ok());
        let Some(number) = number.filter(|number: &u8| *number < 32) else {
            return Err(format!("{} cannot be set; r0 to r31 can", place.name));
        };
        let debugger = self.debugger()?;
        let item = debugger.evaluate(&place.value, 0)?;
        let value = item.integer(debugger.memory())?;
        debugger.write(&Spot::Pieces(vec![Piece::Register(number)]), &[value as u8]);
        Ok(json!({"value": byte(Some(value as u8)), "variablesReference": 0}))
    }
}

/// How an expression names a part of what another names.
fn joined(whole: &str, part: &str) -> String {
    match part {
        "*" => format!("*({whole})"),
        _ if part.starts_with('[') => format!("{whole}{part}"),
        // Behind a `*` a member binds more tightly.
        _ if whole.starts_with('*') => format!("({whole}).{part}"),
        _ => format!("{whole}.{part}"),
    }
}

/// An expression, what it is called, and its value.
type Named = (String, String, Shown);

/// Variables as a frame has them.
fn values<'v>(
    frame: &CallFrame<'_>,
    variables: impl IntoIterator<Item = &'v Variable>,
) -> Vec<Named> {
    let variables = variables.into_iter();
    let of = |each: &Variable| (each.name.clone(), each.name.clone(), frame.value(each));
    variables.map(of).collect()
}

/// Parameters, then variables; of one name the inner.
fn locals(frame: &CallFrame<'_>) -> Vec<Named> {
    let mut seen: Vec<&Variable> = Vec::new();
    let mut variables: Vec<&Variable> = frame.locals_in_scope().collect();
    variables.sort_by_key(|variable| !variable.is_parameter);
    for variable in variables {
        if !seen.iter().any(|inner| inner.name == variable.name) {
            seen.push(variable);
        }
    }
    values(frame, seen)
}

fn byte(value: Option<u8>) -> String {
    value.map_or(OPTIMISED_OUT.into(), |value| format!("0x{value:02x}"))
}

/// A variable without parts or type.
fn single(name: &str, value: String) -> Value {
    json!({"name": name, "value": value, "variablesReference": 0})
}

fn registers(frame: Option<&CallFrame<'_>>) -> Vec<Value> {
    let Some(frame) = frame else {
        return Vec::new();
    };
    let cpu = frame.memory.chip.cpu();
    let mut all = vec![
        single("pc", format!("0x{:05x}", frame.address)),
        single("sp", format!("0x{:04x}", cpu.stack_pointer())),
        single("sreg", Status::letters(cpu.status().bits())),
        single("cycle", frame.memory.chip.cycle().to_string()),
    ];
    let registers = frame.registers().into_iter().enumerate();
    all.extend(registers.map(|(number, value)| single(&format!("r{number}"), byte(value))));
    all
}
