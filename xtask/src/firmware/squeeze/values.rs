//! Which registers hold the same value.
//!
//! The compiler's moves are its register allocator's, which knew of no function but the one. What is in a register already is not
//! put there again; what reads a copy reads the original, so that the copy is often for nobody; and what is for nobody is left out.

use super::assembly::{Flow, Function, Instruction, Line};
use super::effects::{Memory, Set, any_pointer, pair, pointer, register};
use super::frames::Frame;
use super::liveness::{Known, Whole};
use super::stack_arguments::access;

/// What a register holds: what that register held that has it since the longest time, or a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Value {
    Of(u8),
    Number(u8),
}

/// What all registers hold.
#[derive(Clone, Debug, PartialEq)]
struct State([Value; 32]);

impl State {
    fn unknown() -> Self {
        Self(std::array::from_fn(|number| Value::Of(number as u8)))
    }

    fn of(&self, number: u8) -> Value {
        self.0[usize::from(number & 31)]
    }

    fn set(&mut self, number: u8, value: Value) {
        self.0[usize::from(number & 31)] = value;
    }

    /// A register holds something new.
    fn forget(&mut self, number: u8) {
        let heirs: Vec<u8> = (0..32)
            .filter(|&it| it != number && self.of(it) == Value::Of(number))
            .collect();
        for &heir in &heirs {
            self.set(heir, Value::Of(heirs[0]));
        }
        self.set(number, Value::Of(number));
    }

    /// What is so on both ways.
    fn meet(&mut self, other: &Self) {
        for number in 0..32 {
            if self.of(number) != other.of(number) {
                self.set(number, Value::Of(number));
            }
        }
    }

    fn step(&mut self, it: &Instruction, writes: Set) {
        let copies = copies(it);
        let values: Vec<(u8, Value)> = match (it.name.as_str(), register(it.operand(0))) {
            ("ldi", Some(to)) => it
                .operand(1)
                .parse::<i32>()
                .map(|number| vec![(to, Value::Number(number as u8))])
                .unwrap_or_default(),
            ("clr", Some(to)) => vec![(to, Value::Number(0))],
            ("eor", Some(to)) if it.operand(0) == it.operand(1) => vec![(to, Value::Number(0))],
            _ => copies
                .iter()
                .map(|&(to, from)| (to, self.of(from)))
                .collect(),
        };
        let same = |state: &Self| values.iter().all(|&(to, value)| state.of(to) == value);
        if !values.is_empty() && same(self) {
            return;
        }
        for number in (0..32).filter(|&number| writes.has(Set::register(number))) {
            self.forget(number);
        }
        for (to, value) in values {
            // A value whose register was just overwritten has gone.
            let gone = matches!(value, Value::Of(from) if writes.has(Set::register(from)));
            if !gone {
                self.set(to, value);
            }
        }
    }

    /// The register that held it first.
    fn original(&self, number: u8) -> Option<u8> {
        match self.of(number) {
            Value::Of(first) => Some(first),
            Value::Number(0) if self.of(1) == Value::Number(0) => Some(1),
            Value::Number(_) => None,
        }
    }

    /// Two registers that held what two hold, the lower of each.
    fn original_pair(&self, low: u8) -> Option<u8> {
        match (self.of(low), self.of(low + 1)) {
            (Value::Of(first), Value::Of(second)) if first % 2 == 0 && second == first + 1 => {
                Some(first)
            }
            _ => None,
        }
    }
}

/// Registers to which an instruction copies, and from which.
fn copies(it: &Instruction) -> Vec<(u8, u8)> {
    match (
        it.name.as_str(),
        register(it.operand(0)),
        register(it.operand(1)),
    ) {
        ("mov", Some(to), Some(from)) => vec![(to, from)],
        ("movw", Some(to), Some(from)) => vec![(to, from), (to + 1, from + 1)],
        _ => Vec::new(),
    }
}

/// Rounds at most.
const ROUNDS: usize = 16;

/// Simplifies a function until nothing is left to do.
pub(super) fn simplify(function: &mut Function, whole: &Whole) -> Result<(), String> {
    for _ in 0..ROUNDS {
        let known = whole.about(function)?;
        let before = function.clone();
        use_originals(function, &known);
        let known = whole.about(function)?;
        leave_out(function, &known);
        if *function == before {
            break;
        }
    }
    Ok(())
}

/// What registers hold before each line; nothing where it is never reached.
fn states(function: &Function, known: &Known) -> Vec<Option<State>> {
    let lines = &function.lines;
    let labels = function.places();
    let mut states: Vec<Option<State>> = vec![None; lines.len() + 1];
    let mut entry = State::unknown();
    entry.set(1, Value::Number(0));
    states[0] = Some(entry);
    let mut open = vec![0];
    while let Some(at) = open.pop() {
        let (Some(mut state), Some(line)) = (states[at].clone(), lines.get(at)) else {
            continue;
        };
        let mut next = vec![at + 1];
        if let Line::Do(it) = line {
            state.step(it, known.effects[at].writes);
            if it.ends() {
                next.clear();
            }
            next.extend(it.target().and_then(|target| labels.get(target)));
        }
        for place in next {
            let new = match &states[place] {
                None => state.clone(),
                Some(old) => {
                    let mut new = old.clone();
                    new.meet(&state);
                    new
                }
            };
            if states[place].as_ref() != Some(&new) {
                states[place] = Some(new);
                open.push(place);
            }
        }
    }
    states
}

/// Reads what came first, and puts nothing where it is.
fn use_originals(function: &mut Function, known: &Known) {
    let states = states(function, known);
    for (at, line) in function.lines.iter_mut().enumerate() {
        let (Line::Do(it), Some(state)) = (&mut *line, &states[at]) else {
            continue;
        };
        if it.flow() != Flow::Next {
            continue;
        }
        let mut after = state.clone();
        after.step(it, known.effects[at].writes);
        let sets_flags = known.effects[at].writes.meets(Set::FLAGS);
        let sets = matches!(it.name.as_str(), "mov" | "movw" | "ldi" | "clr");
        let needed = sets_flags && known.live[at].meets(Set::FLAGS);
        if sets && !needed && after == *state && is_known(it, state) {
            it.name.clear();
            continue;
        }
        rename(it, state);
    }
    function
        .lines
        .retain(|line| line.instruction().is_none_or(|it| !it.name.is_empty()));
}

/// Whether what it writes is there already.
fn is_known(it: &Instruction, state: &State) -> bool {
    let copies = copies(it);
    if copies.is_empty() {
        let to = register(it.operand(0));
        return to.is_some_and(|to| matches!(state.of(to), Value::Number(_)));
    }
    copies
        .iter()
        .all(|&(to, from)| state.of(to) == state.of(from))
}

/// Names the originals of what it reads.
fn rename(it: &mut Instruction, state: &State) {
    let name = it.name.clone();
    let read: &[usize] = match name.as_str() {
        "mov" | "add" | "adc" | "sub" | "sbc" | "and" | "or" | "eor" | "std" | "st" => &[1],
        "cp" | "cpc" | "mul" => &[0, 1],
        "push" | "tst" => &[0],
        "movw" => {
            if let Some(first) = register(it.operand(1)).and_then(|from| state.original_pair(from))
            {
                it.operands[1] = format!("r{first}");
            }
            return;
        }
        _ => &[],
    };
    // What is cleared by itself reads nothing; and a pointer that moves is not stored meanwhile.
    if it.operand(0) == it.operand(1) || any_pointer(it.operand(0)).is_some_and(|(_, moves)| moves)
    {
        return;
    }
    for &place in read {
        if let Some(first) = register(it.operand(place)).and_then(|from| state.original(from)) {
            it.operands[place] = format!("r{first}");
        }
    }
    rebase(it, state);
}

/// Goes by the pointer that was first.
fn rebase(it: &mut Instruction, state: &State) {
    let place = match it.name.as_str() {
        "ld" | "ldd" => 1,
        "st" | "std" => 0,
        _ => return,
    };
    let Some((base, distance)) = pointer(it.operand(place)) else {
        return;
    };
    let letters = [(28, "Y"), (30, "Z"), (26, "X")];
    let first = letters.into_iter().find(|&(other, letter)| {
        // X reaches no farther than itself.
        let reaches = letter != "X" || it.name.len() == 2;
        let same = |by: u8| state.of(base + by) == state.of(other + by);
        reaches && same(0) && same(1)
    });
    let Some((_, letter)) = first else {
        return;
    };
    it.operands[place] = if it.name.len() == 3 {
        format!("{letter}+{distance}")
    } else {
        letter.to_owned()
    };
}

/// Leaves out what is for nobody.
fn leave_out(function: &mut Function, known: &Known) {
    let has_frame = Frame::read(function).is_some_and(|frame| frame.has_variables());
    let kept = Frame::read(function).map_or(0, |frame| frame.beginning());
    let mut at = 0;
    let flags = vain_comparisons(function, known);
    function.lines.retain(|line| {
        let here = at;
        at += 1;
        let Line::Do(it) = line else { return true };
        if it.flow() != Flow::Next || here < kept {
            return true;
        }
        let effect = known.effects[here];
        let removable = match effect.memory {
            Memory::None => true,
            Memory::Load => has_frame && access(it).is_some(),
            Memory::Store | Memory::Fixed => false,
        };
        let moves_y = effect.writes.meets(pair(28));
        let dead = removable
            && !moves_y
            && !effect.writes.is_empty()
            && !effect.writes.meets(known.live[here]);
        !dead && !flags.contains(&here)
    });
}

/// Comparisons with zero of what has just been calculated.
fn vain_comparisons(function: &Function, known: &Known) -> Vec<usize> {
    const SETS_ZERO: [&str; 9] = [
        "andi", "ori", "and", "or", "eor", "inc", "dec", "subi", "lsr",
    ];
    let mut vain = Vec::new();
    let mut last: Option<String> = None;
    for (at, line) in function.lines.iter().enumerate() {
        let Line::Do(it) = line else {
            last = None;
            continue;
        };
        let compares = it.name == "cpi" && it.operand(1) == "0" || it.name == "tst";
        let only_zero = !known.live[at].meets(Set::CARRY | Set::SIGN);
        if compares && only_zero && last.as_deref() == Some(it.operand(0)) {
            vain.push(at);
            continue;
        }
        if SETS_ZERO.contains(&it.name.as_str()) {
            last = Some(it.operand(0).to_owned());
            continue;
        }
        let writes = known.effects[at].writes;
        let lost = writes.meets(Set::FLAGS)
            || it.flow() != Flow::Next
            || last
                .as_deref()
                .and_then(register)
                .is_some_and(|it| writes.has(Set::register(it)));
        if lost {
            last = None;
        }
    }
    vain
}
