//! The stack as a person sees it: a frame for each function, also for those that were inlined, with what is in scope.

use crate::expression::{Item, Names, member, register};
use crate::location::{Context, Place};
use crate::symbols::{Scope, ScopeKind, Symbols, Variable};
use crate::unwind::Frame;
use crate::value::{Memory, Value};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::space::DATA;
use std::rc::Rc;

/// A function that runs.
#[derive(Clone)]
pub(crate) struct CallFrame<'a> {
    /// Its name with classes and namespaces; of what has no debugging information, that of the linker.
    pub(crate) name: String,
    /// The file, in [`crate::symbols::Lines::files`].
    pub(crate) file: Option<usize>,
    /// From 1; 0: unknown.
    pub(crate) line: u32,
    /// From 1; 0: unknown.
    pub(crate) column: u32,
    /// Its next instruction [bytes].
    pub(crate) address: u32,
    pub(crate) memory: Memory<'a>,
    frames: Rc<Vec<Frame>>,
    index: usize,
    /// The function that it is inlined in, or it itself.
    function: Option<&'a Scope>,
    /// Its blocks around the instruction, innermost first.
    scopes: Vec<&'a Scope>,
}

impl Symbols {
    /// The frames of the chip, up to that of `main`.
    pub(crate) fn frames(&self, chip: &Chip) -> Vec<Frame> {
        let named = |address, is: fn(&str) -> bool| {
            self.function(address)
                .is_some_and(|function| is(&function.name))
        };
        self.unwinder.frames(
            chip,
            |address| named(address, |name| name == "main"),
            |address| named(address, |name| name.starts_with("__vector_")),
        )
    }

    /// The CFA of the innermost frame.
    pub(crate) fn cfa(&self, chip: &Chip) -> Option<u16> {
        let cpu = chip.cpu();
        let y = u16::from_le_bytes([cpu.registers()[28], cpu.registers()[29]]);
        self.unwinder
            .cfa(2 * cpu.program_counter(), cpu.stack_pointer(), y)
    }
}

/// The frames, innermost first.
pub(crate) fn stack(memory: Memory<'_>) -> Vec<CallFrame<'_>> {
    let symbols = memory.symbols;
    let frames = Rc::new(symbols.frames(memory.chip));
    let mut stack = Vec::new();
    for (index, frame) in frames.iter().enumerate() {
        let at = frame.address_in_code();
        let row = symbols.lines.row(at);
        let mut whole = CallFrame {
            name: String::new(),
            file: row.map(|row| row.file),
            line: row.map_or(0, |row| row.line),
            column: row.map_or(0, |row| row.column),
            address: frame.program_counter,
            memory,
            frames: frames.clone(),
            index,
            function: symbols.function(at),
            scopes: Vec::new(),
        };
        let Some(function) = whole.function else {
            whole.name = symbols.image.function(at / 2).unwrap_or("?").to_owned();
            stack.push(whole);
            continue;
        };
        for scope in function.chain(at).into_iter().rev() {
            whole.scopes.push(scope);
            match scope.kind {
                ScopeKind::Block => continue,
                ScopeKind::Function | ScopeKind::Inlined { .. } => stack.push(CallFrame {
                    name: scope.name.clone(),
                    ..whole.clone()
                }),
            }
            if let ScopeKind::Inlined { file, line } = scope.kind {
                (whole.file, whole.line, whole.column) = (file, line, 0);
                whole.scopes.clear();
            }
        }
    }
    stack
}

impl<'a> CallFrame<'a> {
    /// Parameters and variables, those of inner blocks first.
    pub(crate) fn locals_in_scope(&self) -> impl Iterator<Item = &'a Variable> {
        self.scopes.iter().flat_map(|scope| &scope.variables)
    }

    /// The value of a variable.
    pub(crate) fn value(&self, variable: &Variable) -> Value {
        let bytes = self.memory.symbols.types.bytes(variable.of);
        let base = self.function.map(|function| &function.frame_base);
        let context = Context {
            chip: self.memory.chip,
            frame: &self.frames[self.index],
            frame_base: base.unwrap_or(&Place::None),
            passed: &|register| self.passed(register),
        };
        Value::new(variable.of, context.spot(&variable.place, bytes))
    }

    /// What the caller passed in a register, where its call says so.
    fn passed(&self, register: u8) -> Option<u64> {
        let caller = self.frames.get(self.index + 1)?;
        let function = self.memory.symbols.function(caller.address_in_code())?;
        let mut passed = function.call(caller.program_counter)?.iter();
        let (_, code) = passed.find(|(own, _)| *own == register)?;
        let context = Context {
            chip: self.memory.chip,
            frame: caller,
            frame_base: &function.frame_base,
            passed: &|_| None,
        };
        context.value(code)
    }

    /// The registers r0 to r31 as they are for this frame; `None`: not known.
    pub(crate) fn registers(&self) -> [Option<u8>; 32] {
        let frame = &self.frames[self.index];
        std::array::from_fn(|number| frame.register(number).read(self.memory.chip))
    }
}

impl Names for CallFrame<'_> {
    fn memory(&self) -> Memory<'_> {
        self.memory
    }

    fn find(&self, name: &str) -> Option<Item> {
        let symbols = self.memory.symbols;
        let frame = &self.frames[self.index];
        if name.starts_with('$') {
            return register(name, self.memory, |number| frame.register(number));
        }
        let locals = || self.locals_in_scope();
        if let Some(local) = locals().find(|variable| variable.name == name) {
            return Some(Item::Value(self.value(local)));
        }
        if let Some(this) = locals().find(|variable| variable.name == "this")
            && let Some((address, of)) = self.memory.target(&self.value(this))
            && let Some(found) = member(self.memory, &Value::at(address, of), name)
        {
            return Some(Item::Value(found));
        }
        // Those of the same file come before others of this name.
        let unit = locals().next().map(|variable| variable.unit);
        let globals = symbols.globals.iter().chain(&symbols.registers);
        let mut named: Vec<&Variable> = globals.filter(|variable| variable.name == name).collect();
        named.sort_by_key(|variable| Some(variable.unit) != unit);
        if let Some(global) = named.first() {
            return Some(Item::Value(self.value(global)));
        }
        if let Some(value) = symbols.types.enumerator(name) {
            return Some(Item::Number(crate::value::Number::Integer(value)));
        }
        let function = symbols.functions_named(name).next()?;
        Some(Item::Pointer(function.entry, None))
    }

    fn all(&self) -> Vec<String> {
        let globals = self.memory.symbols.listed();
        let mut names: Vec<String> = Vec::new();
        for variable in self.locals_in_scope().chain(globals) {
            if !names.contains(&variable.name) {
                names.push(variable.name.clone());
            }
        }
        names
    }
}

impl Symbols {
    /// The symbol that an address is in, and how far.
    pub(crate) fn named(&self, address: u32) -> Option<(&str, u32)> {
        let (symbols, at) = match address.checked_sub(DATA) {
            Some(at) => (self.image.variables(), at),
            None => (self.image.functions(), address / 2),
        };
        let after = symbols.partition_point(|symbol| symbol.address <= at);
        let symbol = symbols.get(after.checked_sub(1)?)?;
        let offset = at - symbol.address;
        (offset < symbol.size.max(1))
            .then_some((&symbol.name, offset * if address < DATA { 2 } else { 1 }))
    }
}
