//! What a client sees of a program that stands: frames, scopes, variables, expressions.

use super::message::{Levels, Place};
use super::{Adapter, LaunchHost};
use crate::expression::{Item, assignment};
use crate::spot::{Piece, Spot};
use crate::stack::CallFrame;
use crate::symbols::{SourceFile, Variable};
use crate::value::Value as Shown;
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
/// Before what is typed for the program, not the debugger.
const TO_PROGRAM: char = '>';

/// A file as clients know it.
pub(super) fn source(file: &SourceFile) -> Value {
    let name = file.name.rsplit('/').next().unwrap_or_default();
    match &file.path {
        Some(path) => json!({"name": name, "path": path}),
        None => json!({"name": name}),
    }
}

impl<H: LaunchHost> Adapter<H> {
    pub(super) fn stack_trace(&mut self, levels: &Levels) -> Result<Value, String> {
        let first = self.lines_start_at;
        let debugger = self.debugger()?;
        let files = &debugger.symbols.lines.files;
        let stack = debugger.stack();
        let count = if levels.levels == 0 {
            stack.len()
        } else {
            levels.levels
        };
        let frames = stack
            .iter()
            .enumerate()
            .skip(levels.start_frame)
            .take(count)
            .map(|(number, frame)| {
                let mut shown = json!({
                    "id": number, "name": frame.name, "line": 0, "column": frame.column.max(1),
                    "instructionPointerReference": format!("0x{:x}", frame.address),
                });
                match frame
                    .file
                    .and_then(|file| files.get(file))
                    .filter(|_| frame.line > 0)
                {
                    Some(file) => {
                        shown["line"] = json!(i64::from(frame.line) - 1 + first);
                        shown["source"] = source(file);
                        if file.path.is_none() {
                            shown["presentationHint"] = json!("subtle");
                        }
                    }
                    None => shown["presentationHint"] = json!("subtle"),
                }
                shown
            });
        Ok(json!({"stackFrames": frames.collect::<Vec<_>>(), "totalFrames": stack.len()}))
    }

    pub(super) fn scopes(&mut self, place: &Place) -> Result<Value, String> {
        let frame = place.frame_id;
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
        let reference = number
            .checked_sub(1)
            .and_then(|index| self.references.get(index));
        reference
            .cloned()
            .ok_or_else(|| "the program has gone on since".into())
    }

    pub(super) fn variables(&mut self, place: &Place) -> Result<Value, String> {
        let reference = self.referred(place.variables_reference)?;
        let most = if place.count == 0 {
            MOST_PARTS
        } else {
            place.count
        };
        let debugger = self.debugger.as_ref().ok_or("nothing is being debugged")?;
        let memory = debugger.memory();
        let stack = debugger.stack();
        let named = |variables: Vec<&Variable>| -> Vec<(String, String, Shown)> {
            let frame = stack.first();
            let values = variables
                .into_iter()
                .filter_map(|variable| Some((variable, frame?.value(variable))));
            values
                .map(|(variable, value)| (variable.name.clone(), variable.name.clone(), value))
                .collect()
        };
        let (frame, mut values) = match &reference {
            Reference::Locals(frame) => (*frame, locals(stack.get(*frame))),
            Reference::Globals | Reference::Libraries => {
                let own = matches!(reference, Reference::Globals);
                let listed = debugger.symbols.listed();
                (0, named(listed.filter(|each| each.is_own == own).collect()))
            }
            Reference::Peripherals => (0, named(debugger.symbols.registers.iter().collect())),
            Reference::Parts(frame, name, value) => {
                let parts = memory.parts(value).into_iter();
                (
                    *frame,
                    parts
                        .map(|(part, value)| (part.clone(), joined(name, &part), value))
                        .collect(),
                )
            }
            Reference::Registers(frame) => {
                return Ok(json!({"variables": registers(stack.get(*frame))}));
            }
            Reference::Pins => {
                let pins = debugger.world().pins().into_iter();
                let pins = pins.map(|(name, level)| json!({"name": name, "value": if level { "HIGH" } else { "LOW" }, "variablesReference": 0}));
                return Ok(json!({"variables": pins.collect::<Vec<_>>()}));
            }
        };
        if let Reference::Globals | Reference::Libraries = reference {
            values.sort_by(|a, b| a.0.cmp(&b.0));
        }
        let hex = matches!(reference, Reference::Peripherals);
        let shown: Vec<_> = values
            .into_iter()
            .skip(place.start)
            .take(most)
            .map(|(name, expression, value)| {
                let text = match memory.number(&value) {
                    Some(crate::value::Number::Integer(number)) if hex => format!("0x{number:02x}"),
                    _ => memory.text(&value),
                };
                (
                    name,
                    expression,
                    text,
                    memory.symbols.types.name(value.of),
                    value,
                )
            })
            .collect();
        let variables = shown.into_iter().map(|(name, expression, text, of, value)| {
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

    pub(super) fn evaluate(&mut self, place: &Place) -> Result<Value, String> {
        let text = place.expression.trim();
        if let (Some(typed), true) = (text.strip_prefix(TO_PROGRAM), place.context == "repl") {
            let line = format!("{typed}\n");
            self.debugger()?
                .change(|world| world.type_in(line.as_bytes()));
            return Ok(json!({"result": "", "variablesReference": 0}));
        }
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

    pub(super) fn set_expression(&mut self, place: &Place) -> Result<Value, String> {
        self.debugger()?
            .assign(place.frame_id, &place.expression, &place.value)?;
        self.shown(place.frame_id, &place.expression, "value")
    }

    pub(super) fn set_variable(&mut self, place: &Place) -> Result<Value, String> {
        if let Reference::Registers(0) = self.referred(place.variables_reference)? {
            return self.set_register(place);
        }
        let (frame, expression) = self.named(place)?;
        self.debugger()?.assign(frame, &expression, &place.value)?;
        self.shown(frame, &expression, "value")
    }

    /// The frame and the expression of a variable of a reference, or of none.
    pub(super) fn named(&self, place: &Place) -> Result<(usize, String), String> {
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

    fn set_register(&mut self, place: &Place) -> Result<Value, String> {
        let number = place
            .name
            .strip_prefix('r')
            .and_then(|number| number.parse::<u8>().ok());
        let Some(number) = number.filter(|number| *number < 32) else {
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

/// Parameters, then variables; of one name the inner.
fn locals(frame: Option<&CallFrame<'_>>) -> Vec<(String, String, Shown)> {
    let mut seen: Vec<(String, String, Shown)> = Vec::new();
    let mut variables = frame.map(CallFrame::variables).unwrap_or_default();
    variables.sort_by_key(|(variable, _)| !variable.is_parameter);
    for (variable, value) in variables {
        if !seen.iter().any(|(name, ..)| *name == variable.name) {
            seen.push((variable.name.clone(), variable.name.clone(), value));
        }
    }
    seen
}

fn byte(value: Option<u8>) -> String {
    value.map_or_else(
        || crate::OPTIMISED_OUT.into(),
        |value| format!("0x{value:02x}"),
    )
}

fn registers(frame: Option<&CallFrame<'_>>) -> Vec<Value> {
    let Some(frame) = frame else {
        return Vec::new();
    };
    let cpu = frame.memory.chip.cpu();
    let single =
        |name: &str, value: String| json!({"name": name, "value": value, "variablesReference": 0});
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
