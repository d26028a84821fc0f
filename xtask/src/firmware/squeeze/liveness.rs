//! Which registers and flags matter where.
//!
//! All calls are direct, so this is known of the whole program: what a function reads of what it is called with, what it may
//! change, and what of it anybody reads when it returns. What others call, or is known by its address, keeps to the convention.

use std::collections::{HashMap, HashSet};

use super::assembly::{Flow, Function, Line, Program};
use super::effects::{Effect, Set, pair};
use super::frames::Frame;

/// What a call reads and may change.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Call {
    pub(super) reads: Set,
    pub(super) writes: Set,
}

/// The arithmetic that the program is linked with, by the lowest register of its arguments, which end in r25.
const ARITHMETIC: [(u8, &[&str]); 3] = [
    (
        18,
        &[
            "__mulsf3",
            "__addsf3",
            "__subsf3",
            "__divsf3",
            "__ltsf2",
            "__lesf2",
            "__gtsf2",
            "__gesf2",
            "__eqsf2",
            "__nesf2",
            "__unordsf2",
            "__mulsi3",
            "__udivmodsi4",
            "__divmodsi4",
        ],
    ),
    (20, &["memcpy", "memmove", "memset", "memcmp"]),
    (
        22,
        &[
            "__floatunsisf",
            "__floatsisf",
            "__fixunssfsi",
            "__fixsfsi",
            "sqrtf",
        ],
    ),
];

impl Call {
    /// Of a function that is not in the assembly.
    fn foreign(name: &str) -> Self {
        let known = ARITHMETIC.iter().find(|(_, names)| names.contains(&name));
        Self {
            reads: known.map_or(Set::ARGUMENTS, |(first, _)| Set::registers(*first, 25))
                | Set::register(1),
            writes: Set::FREE,
        }
    }
}

/// What is known of all functions.
pub(super) struct Whole {
    calls: HashMap<String, Call>,
    /// What is read of a function's registers when it has returned.
    wanted: HashMap<String, Set>,
}

/// A function with what each line does, calls and returns included.
pub(super) struct Known {
    pub(super) effects: Vec<Effect>,
    /// What matters behind each line.
    pub(super) live: Vec<Set>,
}

impl Whole {
    /// Finds out.
    pub(super) fn of(program: &Program) -> Result<Self, String> {
        let mut whole = Self {
            calls: HashMap::new(),
            wanted: HashMap::new(),
        };
        let convention = Set::KEPT | Set::RESULTS | Set::register(1);
        let known_elsewhere = known_elsewhere(program);
        for function in &program.functions {
            let is_elsewhere = function
                .names
                .iter()
                .any(|name| known_elsewhere.contains(name.as_str()));
            let wanted = if is_elsewhere {
                convention
            } else {
                Set::register(1)
            };
            for name in &function.names {
                whole.calls.insert(name.clone(), Call::default());
                whole.wanted.insert(name.clone(), wanted);
            }
        }
        let own: Vec<Vec<Effect>> = program
            .functions
            .iter()
            .map(own_effects)
            .collect::<Result<_, String>>()?;
        loop {
            let mut changed = false;
            for (function, own) in program.functions.iter().zip(&own) {
                changed |= whole.update(function, own);
            }
            if !changed {
                return Ok(whole);
            }
        }
    }

    /// What is known of a function.
    pub(super) fn about(&self, function: &Function) -> Result<Known, String> {
        self.about_where(function, |_| {})
    }

    /// The same, where some lines do something else.
    pub(super) fn about_where(
        &self,
        function: &Function,
        edit: impl Fn(&mut [Effect]),
    ) -> Result<Known, String> {
        let mut own = own_effects(function)?;
        edit(&mut own);
        Ok(self.complete(function, &own, self.wanted(function)))
    }

    /// What a call does.
    pub(super) fn call(&self, name: &str) -> Call {
        self.calls
            .get(name)
            .copied()
            .unwrap_or_else(|| Call::foreign(name))
    }

    /// What is read of a function when it has returned.
    pub(super) fn wanted(&self, function: &Function) -> Set {
        self.wanted
            .get(function.name())
            .copied()
            .unwrap_or(Set::ALL)
    }

    fn complete(&self, function: &Function, own: &[Effect], wanted: Set) -> Known {
        let places = function.places();
        let mut effects = own.to_vec();
        for (line, effect) in function.lines.iter().zip(&mut effects) {
            let Line::Do(it) = line else { continue };
            let call = it
                .target()
                .filter(|target| !places.contains_key(target))
                .map(|target| self.call(target));
            match (it.flow(), call) {
                (Flow::Call, Some(call)) => {
                    effect.reads |= call.reads;
                    effect.writes |= call.writes;
                }
                (Flow::Jump | Flow::Branch, Some(call)) => {
                    effect.reads |= call.reads | wanted.without(call.writes);
                }
                (Flow::Return, _) => {
                    effect.reads |= if it.name == "ret" { wanted } else { Set::ALL };
                }
                _ => {}
            }
        }
        let live = live(function, &effects, &places);
        Known { effects, live }
    }

    /// Takes in what a function says of itself and of those that it calls.
    fn update(&mut self, function: &Function, own: &[Effect]) -> bool {
        let wanted = self.wanted(function);
        let known = self.complete(function, own, wanted);
        let places = function.places();
        let saved = saved(function);
        let mut writes = function.lost;
        let mut changed = false;
        for (at, line) in function.lines.iter().enumerate() {
            let Line::Do(it) = line else { continue };
            writes |= own[at].writes.without(Set::KEPT);
            let Some(target) = it.target().filter(|target| !places.contains_key(target)) else {
                continue;
            };
            let call = self.call(target);
            writes |= call.writes.without(saved.unwrap_or(Set::NONE));
            let after = match (it.flow(), saved) {
                // What it saves is not known: those that it calls keep all.
                (_, None) => known.live[at] | wanted | Set::KEPT,
                (Flow::Call, _) => known.live[at],
                _ => wanted,
            };
            if let Some(wanted) = self.wanted.get_mut(target) {
                let before = *wanted;
                *wanted |= after.without(Set::FLAGS | Set::register(0));
                changed |= before != *wanted;
            }
        }
        if saved.is_some_and(|saved| !saved.is_empty()) {
            // The common beginning takes them.
            writes |= pair(26) | pair(30);
        }
        // What passes through is not read.
        let known = self.complete(function, own, wanted & writes);
        let entry = known.effects[0].reads | known.live[0].without(known.effects[0].writes);
        let call = Call {
            reads: entry.without(Set::FLAGS | Set::register(0)) | Set::register(1),
            // Nobody keeps these across a call, by the convention.
            writes: (writes | Set::FLAGS | Set::register(0)).without(Set::register(1)),
        };
        for name in &function.names {
            if let Some(old) = self.calls.get_mut(name) {
                changed |= *old != call;
                *old = call;
            }
        }
        changed
    }
}

/// Registers that a function saves as it begins and gives back where it ends; `None` where it begins or ends in another way.
fn saved(function: &Function) -> Option<Set> {
    let frame = Frame::read(function)?;
    let y = if frame.y { pair(28) } else { Set::NONE };
    let pushed = frame.pushed.iter().map(|number| Set::register(*number));
    Some(pushed.fold(y, |set, register| set | register))
}

fn own_effects(function: &Function) -> Result<Vec<Effect>, String> {
    let of = |line: &Line| line.instruction().map_or(Ok(Effect::default()), Effect::of);
    let mut effects = function
        .lines
        .iter()
        .map(of)
        .collect::<Result<Vec<_>, String>>()
        .map_err(|error| format!("{}: {error}", function.name()))?;
    // Around a move of the stack pointer flags are kept, whoever asks for them.
    let is = |at: usize, name: &str, operands: [&str; 2]| {
        let it = function.lines.get(at).and_then(Line::instruction);
        it.is_some_and(|it| {
            it.name == name && it.operand(0) == operands[0] && it.operand(1) == operands[1]
        })
    };
    // To save is not to read.
    let saves = Frame::read(function).map_or(0, |frame| frame.pushes());
    for effect in &mut effects[..saves] {
        effect.reads = Set::NONE;
    }
    for at in 0..effects.len() {
        if is(at, "in", ["r0", "63"])
            && is(at + 1, "cli", ["", ""])
            && is(at + 3, "out", ["63", "r0"])
        {
            effects[at].reads = Set::NONE;
            effects[at + 3].writes = Set::NONE;
        }
    }
    Ok(effects)
}

/// What matters behind each line.
fn live(function: &Function, effects: &[Effect], places: &HashMap<&str, usize>) -> Vec<Set> {
    let lines = &function.lines;
    let mut before = vec![Set::NONE; lines.len()];
    let mut after = vec![Set::NONE; lines.len()];
    loop {
        let mut changed = false;
        for at in (0..lines.len()).rev() {
            let it = lines[at].instruction();
            let falls = it.is_none_or(|it| !it.ends());
            let mut live = Set::NONE;
            if falls {
                // What lies behind the last line is not known.
                live |= before.get(at + 1).copied().unwrap_or(Set::ALL);
            }
            let target = it.and_then(|it| it.target()).and_then(|it| places.get(it));
            if let Some(target) = target {
                live |= before[*target];
            }
            after[at] = live;
            let new = live.without(effects[at].writes) | effects[at].reads;
            changed |= new != before[at];
            before[at] = new;
        }
        if !changed {
            return after;
        }
    }
}

/// Names that something other than a call or a jump of the program knows.
fn known_elsewhere<'a>(program: &'a Program) -> HashSet<&'a str> {
    let words = |text: &'a str| {
        text.split(|letter: char| !letter.is_ascii_alphanumeric() && !"._$".contains(letter))
    };
    let mut known: HashSet<&str> = program.global.iter().map(String::as_str).collect();
    for text in &program.rest {
        known.extend(words(text));
    }
    for function in &program.functions {
        for it in function.instructions().filter(|it| it.target().is_none()) {
            for text in &it.operands {
                known.extend(words(text));
            }
        }
    }
    known
}
