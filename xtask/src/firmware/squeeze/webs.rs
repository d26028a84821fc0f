//! Values and the registers that they are in.
//!
//! A *web* is all writes and reads of a register that have to be of the same one: each write with every read that it reaches. Where calls,
//! pointers or the convention ask for a register, it is fixed. All others may change places with what else is in a register, if that holds
//! together with what is tied to it: the halves of a pair. Two webs that are alive at the same time meet, and must be apart, unless
//! one is a copy of the other (Chaitin 1982). What changes places is a chain (Kempe 1879): all that is in one of two registers and meets what
//! is in the other.

use std::collections::HashMap;

use super::assembly::{Function, Instruction, Line};
use super::effects::{Set, any_pointer};
use super::liveness::Known;
use super::operands::{self, Operand};

/// What stays where it is.
const BOUND: [u8; 4] = [0, 1, 28, 29];
/// The first webs are what is fixed in each register.
const FIXED: usize = 32;

/// An operand and the web that it is of; of a pair the lower one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Named {
    pub(super) line: usize,
    pub(super) place: usize,
    pub(super) web: usize,
}

/// A copy, by the webs that it writes and reads, lower halves first.
pub(super) type Copy = Vec<(usize, usize)>;

/// All webs of a function.
#[derive(Debug)]
pub(super) struct Webs {
    /// Where each is.
    pub(super) register: Vec<u8>,
    /// Where each may be, for its instructions and for what is fixed.
    may: Vec<Set>,
    meets: Vec<Vec<usize>>,
    /// What goes where it goes.
    tied: Vec<Vec<usize>>,
    pub(super) named: Vec<Named>,
    pub(super) copies: Vec<Copy>,
}

fn numbers(set: Set) -> impl Iterator<Item = u8> {
    (0..32).filter(move |&number| set.has(Set::register(number)))
}

/// Registers before and behind lines, and which of them have to be of one web.
struct Joined(Vec<usize>);

/// A register before a line.
fn before(line: usize, number: u8) -> usize {
    FIXED + line * 64 + usize::from(number)
}

/// A register behind a line.
fn behind(line: usize, number: u8) -> usize {
    before(line, number) + 32
}

impl Joined {
    fn find(&mut self, mut it: usize) -> usize {
        while self.0[it] != it {
            self.0[it] = self.0[self.0[it]];
            it = self.0[it];
        }
        it
    }

    /// What is fixed has the lowest numbers and stays first.
    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.find(one), self.find(other));
        self.0[one.max(other)] = one.min(other);
    }

    fn of(function: &Function, known: &Known, operands: &[Vec<Operand>]) -> Self {
        let lines = &function.lines;
        let mut joined = Self((0..FIXED + lines.len() * 64).collect());
        let alive =
            |at: usize| known.live[at].without(known.effects[at].writes) | known.effects[at].reads;
        let bound = BOUND.map(Set::register);
        let bound = bound.into_iter().fold(Set::NONE, |all, it| all | it);
        let places = function.places();
        numbers(alive(0)).for_each(|it| joined.join(usize::from(it), before(0, it)));
        for (at, line) in lines.iter().enumerate() {
            let it = line.instruction();
            let (mut reads, mut writes) = (known.effects[at].reads, known.effects[at].writes);
            for number in numbers(known.live[at].without(writes)) {
                joined.join(before(at, number), behind(at, number));
            }
            for operand in &operands[at] {
                let named = it.map_or(Set::NONE, |it| operand.names(it));
                if operand.reads {
                    reads = reads.without(named);
                }
                if operand.writes {
                    writes = writes.without(named);
                }
                if operand.reads && operand.writes {
                    numbers(named).for_each(|it| joined.join(before(at, it), behind(at, it)));
                }
            }
            // What no operand names is asked for by the instruction.
            for number in numbers(reads | bound) {
                joined.join(usize::from(number), before(at, number));
            }
            for number in numbers(writes | bound) {
                joined.join(usize::from(number), behind(at, number));
            }
            let falls = it.is_none_or(|it| !it.ends());
            if falls && at + 1 == lines.len() {
                numbers(known.live[at]).for_each(|it| joined.join(usize::from(it), behind(at, it)));
            }
            let follows = (falls && at + 1 < lines.len()).then_some(at + 1);
            let target = it.and_then(Instruction::target);
            for next in follows
                .into_iter()
                .chain(target.and_then(|it| places.get(it)).copied())
            {
                numbers(alive(next)).for_each(|it| joined.join(behind(at, it), before(next, it)));
            }
        }
        joined
    }
}

/// What is found line by line.
struct Reader {
    webs: Webs,
    joined: Joined,
    /// The webs found so far.
    of: HashMap<usize, usize>,
    /// Where a web may be that nothing says more of.
    may: Set,
}

impl Reader {
    fn web(&mut self, place: usize) -> usize {
        let root = self.joined.find(place);
        if root < FIXED {
            return root;
        }
        let next = self.webs.register.len();
        let web = *self.of.entry(root).or_insert(next);
        if web == next {
            self.webs.register.push(((root - FIXED) % 32) as u8);
            self.webs.may.push(self.may);
            self.webs.meets.push(Vec::new());
            self.webs.tied.push(Vec::new());
        }
        web
    }

    /// Takes in the operands of a line; says what copy it is.
    fn operands(&mut self, line: usize, it: &Instruction, operands: &[Operand]) -> Copy {
        let mut sides = [Vec::new(), Vec::new()];
        for operand in operands {
            let place = if operand.writes { behind } else { before };
            let halves: Vec<usize> = numbers(operand.names(it))
                .map(|number| self.web(place(line, number)))
                .collect();
            self.webs.may[halves[0]] = self.webs.may[halves[0]] & operand.may;
            if let [low, high] = halves[..] {
                self.webs.tie(low, high);
            }
            self.webs.named.push(Named {
                line,
                place: operand.place,
                web: halves[0],
            });
            sides[operand.place] = halves;
        }
        let [to, from] = sides;
        if it.name.starts_with("mov") {
            to.into_iter().zip(from).collect()
        } else {
            Copy::new()
        }
    }

    /// What a line writes meets all that is alive behind it.
    fn meetings(&mut self, at: usize, it: Option<&Instruction>, known: &Known, copy: &Copy) {
        let effect = known.effects[at];
        let moves = |operand: &String| any_pointer(operand).is_some_and(|(_, moves)| moves);
        let moves = it.is_some_and(|it| it.operands.iter().any(moves));
        for one in numbers(effect.writes) {
            let one = self.web(behind(at, one));
            for other in numbers(known.live[at] | effect.writes) {
                let other = self.web(behind(at, other));
                if !copy.contains(&(one, other)) {
                    self.webs.meet(one, other);
                }
            }
            // Nor may a pointer move that is stored itself.
            for other in numbers(if moves { effect.reads } else { Set::NONE }) {
                let other = self.web(before(at, other));
                self.webs.meet(one, other);
            }
        }
    }
}

impl Webs {
    /// Reads them; what is not fixed may be in those registers only.
    pub(super) fn read(function: &Function, known: &Known, may: Set) -> Self {
        let both = function.lines.iter().zip(&known.effects);
        let operands: Vec<Vec<Operand>> = both
            .map(|(line, effect)| {
                let it = line.instruction();
                it.map_or_else(Vec::new, |it| operands::of(it, effect))
            })
            .collect();
        let mut reader = Reader {
            webs: Self {
                register: (0..32).collect(),
                may: vec![Set::NONE; FIXED],
                meets: vec![Vec::new(); FIXED],
                tied: vec![Vec::new(); FIXED],
                named: Vec::new(),
                copies: Vec::new(),
            },
            joined: Joined::of(function, known, &operands),
            of: HashMap::new(),
            may,
        };
        for (at, line) in function.lines.iter().enumerate() {
            let it = line.instruction();
            let copy = it.map_or_else(Copy::new, |it| reader.operands(at, it, &operands[at]));
            reader.meetings(at, it, known, &copy);
            if !copy.is_empty() {
                reader.webs.copies.push(copy);
            }
        }
        let mut webs = reader.webs;
        for (others, may) in webs.meets.iter_mut().zip(&mut webs.may) {
            others.sort_unstable();
            others.dedup();
            for &other in others.iter().filter(|other| **other < FIXED) {
                *may = may.without(Set::register(other as u8));
            }
        }
        webs
    }

    fn meet(&mut self, one: usize, other: usize) {
        if one != other {
            self.meets[one].push(other);
            self.meets[other].push(one);
        }
    }

    /// From now on one goes where the other goes.
    pub(super) fn tie(&mut self, one: usize, other: usize) {
        if one != other && !self.tied[one].contains(&other) {
            self.tied[one].push(other);
            self.tied[other].push(one);
        }
    }

    /// Whether two are alive at the same time.
    pub(super) fn meets(&self, one: usize, other: usize) -> bool {
        self.meets[one].binary_search(&other).is_ok()
    }

    /// Lets a web go to another register, and the halves of a pair to the halves of another, together with all that has to change places with
    /// it; what was where before. `None` where one of them cannot.
    pub(super) fn go(&mut self, web: usize, to: u8) -> Option<Vec<(usize, u8)>> {
        // By pairs: whoever is no half of one goes all the same.
        let width = if self.register[web] % 2 == to % 2 {
            2
        } else {
            1
        };
        let (from, to) = (self.register[web] / width, to / width);
        if from == to {
            return None;
        }
        let mut chain = vec![(web, self.register[web])];
        let mut at = 0;
        while let Some(&(web, old)) = chain.get(at) {
            at += 1;
            let new = match old / width {
                it if it == from => old - from * width + to * width,
                it if it == to => old - to * width + from * width,
                // Tied to something elsewhere.
                _ => return None,
            };
            if !self.may[web].has(Set::register(new)) {
                return None;
            }
            let meets = self.meets[web].iter();
            let in_the_way = meets.filter(|it| **it >= FIXED && self.register[**it] == new);
            for &next in in_the_way.chain(&self.tied[web]) {
                if !chain.iter().any(|(it, _)| *it == next) {
                    chain.push((next, self.register[next]));
                }
            }
        }
        for &(web, old) in &chain {
            let (one, other) = (from * width, to * width);
            self.register[web] = if old / width == from {
                old - one + other
            } else {
                old - other + one
            };
        }
        Some(chain)
    }

    /// Puts back what went.
    pub(super) fn back(&mut self, chain: &[(usize, u8)]) {
        for &(web, register) in chain {
            self.register[web] = register;
        }
    }

    /// Writes the registers into the function, and leaves out copies of what is there.
    pub(super) fn write(&self, function: &mut Function) {
        for named in &self.named {
            if let Line::Do(it) = &mut function.lines[named.line] {
                it.operands[named.place] = format!("r{}", self.register[named.web]);
            }
        }
        let is_none = |it: &Instruction| {
            ["mov", "movw"].contains(&it.name.as_str()) && it.operand(0) == it.operand(1)
        };
        let lines = &mut function.lines;
        lines.retain(|line| !line.instruction().is_some_and(is_none));
    }
}
