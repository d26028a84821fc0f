//! What is written more than once, written once.
//!
//! Instructions that occur in several places, with no label between them but for those of their own jumps, become a function of their own, and each place
//! calls it; where they end in a return or a jump, each place jumps there. The call costs nine cycles, so where cycles count only long
//! ones are taken out ([`heat`](super::heat)), and none where the hardware is touched: a time may be prescribed between two instructions.
//!
//! A call puts three bytes on the stack. What works on the stack may therefore only be reached by a jump: pushes and pops, moves
//! of the stack pointer, calls that leave arguments there. And the stack pointer's two halves are written without a break.
//!
//! Each round sorts all that follows any instruction, so that equal beginnings lie side by side; takes what saves most,
//! then the next that is still whole; until a round finds nothing.

use std::collections::{HashMap, HashSet};

use super::assembly::{Flow, Function, Instruction, Line};
use super::{frames, tails};

/// Longest sequence that is looked for, in instructions.
const LONGEST: usize = 64;
/// Rounds at most.
const ROUNDS: usize = 40;

/// Writes once what is written more than once. `least` says how many words may be taken out of a function at least, `None` that it stays
/// as it is; calls of those with arguments on the stack stay.
pub(super) fn share(
    functions: &mut Vec<Function>,
    least: impl Fn(&Function) -> Option<usize>,
    stack_arguments: &HashSet<String>,
) {
    let mut made = 0;
    for _ in 0..ROUNDS {
        for function in functions.iter_mut() {
            tails::jump(function, stack_arguments);
        }
        let text = Text::read(functions, &least, stack_arguments);
        let mut taken = vec![false; text.words.len()];
        let before = made;
        for candidate in text.candidates() {
            let places = text.free_places(&candidate, &taken);
            if text.saving(&candidate, places.len()) < 1 {
                continue;
            }
            for &place in &places {
                taken[place..place + candidate.length].fill(true);
            }
            text.replace(
                functions,
                &candidate,
                &places,
                &format!("rumbo_shared_{made}"),
            );
            made += 1;
        }
        if made == before {
            break;
        }
        for function in functions.iter_mut() {
            function
                .lines
                .retain(|line| line.instruction().is_none_or(|it| !it.name.is_empty()));
        }
    }
}

/// Whether a function works on the hardware's registers or on interrupts.
pub(super) fn touches_hardware(function: &Function) -> bool {
    let stack = |operand: &str| ["61", "62", "63"].contains(&operand);
    // The stack pointer's own moves.
    let releases = |at: usize| {
        let next = function.instructions().nth(at + 1);
        next.is_some_and(|next| next.name == "out" && next.operand(0) == "62")
    };
    function
        .instructions()
        .enumerate()
        .any(|(at, it)| match it.name.as_str() {
            "in" => !stack(it.operand(1)),
            "out" => !stack(it.operand(0)),
            "lds" => it.operand(1).parse::<u32>().is_ok(),
            "sts" => it.operand(0).parse::<u32>().is_ok(),
            "cli" => !releases(at),
            "sei" | "sleep" | "wdr" | "sbi" | "cbi" => true,
            _ => false,
        })
}

/// What an instruction means for those around it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// May be anywhere.
    Free,
    /// On the stack as it is.
    Stack,
    /// The same, and with what comes before it.
    Within,
    /// Ends a sequence.
    End,
    /// A jump and the label that only it goes to: both are in a sequence or none.
    Paired,
    /// In none.
    Apart,
}

/// Instructions of the whole program, one after the other, as numbers: equal ones are equal.
struct Text {
    words: Vec<u32>,
    place: Vec<Place>,
    size: Vec<usize>,
    is_call: Vec<bool>,
    /// The other of a pair.
    partner: Vec<usize>,
    /// Fewest words that may be taken out there.
    least: Vec<usize>,
    /// Function and line.
    from: Vec<(usize, usize)>,
}

/// A sequence: where one stands, its length, and where it stands in the sorted list.
#[derive(Clone, Debug)]
struct Candidate {
    length: usize,
    places: Vec<usize>,
    saving: i64,
}

impl Text {
    fn read(
        functions: &[Function],
        least: &impl Fn(&Function) -> Option<usize>,
        stack_arguments: &HashSet<String>,
    ) -> Self {
        let mut text = Self {
            words: Vec::new(),
            place: Vec::new(),
            size: Vec::new(),
            is_call: Vec::new(),
            partner: Vec::new(),
            least: Vec::new(),
            from: Vec::new(),
        };
        let mut known: HashMap<Word, u32> = HashMap::new();
        // Numbers of what is like nothing else count down.
        let mut unlike = u32::MAX;
        for (number, function) in functions.iter().enumerate() {
            let Some(least) = least(function) else {
                continue;
            };
            let pairs = pairs(function);
            let start = text.words.len();
            for (at, line) in function.lines.iter().enumerate() {
                let next = known.len() as u32;
                let partner = pairs.get(&at).copied();
                let (word, place) = match (line, partner) {
                    (line, Some(partner)) => {
                        let name = line.instruction().map_or("", |it| &it.name);
                        let word = Word::Paired(name, partner as i64 - at as i64);
                        (*known.entry(word).or_insert(next), Place::Paired)
                    }
                    (Line::Do(it), None) => (
                        *known.entry(Word::Plain(it)).or_insert(next),
                        Place::of(it, stack_arguments),
                    ),
                    (Line::Label(_), None) => (0, Place::Apart),
                };
                text.partner.push(start + partner.unwrap_or(at));
                text.least.push(least);
                unlike -= 1;
                text.words
                    .push(if place == Place::Apart { unlike } else { word });
                text.place.push(place);
                let instruction = line.instruction();
                text.size.push(instruction.map_or(0, |it| {
                    if matches!(it.flow(), Flow::Call | Flow::Jump) {
                        1
                    } else {
                        it.words()
                    }
                }));
                text.is_call
                    .push(instruction.is_some_and(|it| it.flow() == Flow::Call));
                text.from.push((number, at));
            }
            // Nothing goes on from one function to the next.
            unlike -= 1;
            text.words.push(unlike);
            text.place.push(Place::Apart);
            text.size.push(0);
            text.is_call.push(false);
            text.partner.push(text.partner.len());
            text.least.push(least);
            text.from.push((number, usize::MAX));
        }
        text
    }

    /// All sequences that save something, the best first.
    fn candidates(&self) -> Vec<Candidate> {
        let tail = |at: usize| &self.words[at..(at + LONGEST).min(self.words.len())];
        let mut sorted: Vec<usize> = (0..self.words.len())
            .filter(|&at| self.place[at] != Place::Apart)
            .collect();
        sorted.sort_unstable_by(|&one, &other| tail(one).cmp(tail(other)).then(one.cmp(&other)));
        let shared: Vec<usize> = sorted
            .windows(2)
            .map(|two| {
                tail(two[0])
                    .iter()
                    .zip(tail(two[1]))
                    .take_while(|(one, other)| one == other)
                    .count()
            })
            .collect();
        let mut candidates = Vec::new();
        for length in 1..=LONGEST {
            let mut at = 0;
            while at < shared.len() {
                let run = shared[at..]
                    .iter()
                    .take_while(|shared| **shared >= length)
                    .count();
                if run > 0 {
                    let mut places = sorted[at..=at + run].to_vec();
                    places.sort_unstable();
                    let mut candidate = Candidate {
                        length,
                        places,
                        saving: 0,
                    };
                    if self.is_whole(candidate.places[0], length) {
                        let free = self.free_places(&candidate, &[]);
                        candidate.saving = self.saving(&candidate, free.len());
                        if candidate.saving > 0 {
                            candidates.push(candidate);
                        }
                    }
                }
                at += run + 1;
            }
        }
        candidates.sort_by_key(|candidate| {
            (
                std::cmp::Reverse(candidate.saving),
                std::cmp::Reverse(candidate.length),
                candidate.places[0],
            )
        });
        candidates
    }

    /// Whether a sequence can be taken out of its place.
    fn is_whole(&self, at: usize, length: usize) -> bool {
        let places = &self.place[at..at + length];
        let jumped_to = places[length - 1] == Place::End;
        // Nor may what is called return in place of its caller.
        let only_by_jump = places
            .iter()
            .any(|place| matches!(place, Place::Stack | Place::Within | Place::End));
        let mut pairs = self.partner[at..at + length].iter();
        let is_inside = |partner: &usize| (at..at + length).contains(partner);
        places[0] != Place::Within && (jumped_to || !only_by_jump) && pairs.all(is_inside)
    }

    /// Words that are saved where it stands so many times.
    fn saving(&self, candidate: &Candidate, times: usize) -> i64 {
        let first = candidate.places[0];
        let last = first + candidate.length - 1;
        let size = self.words_of(candidate);
        // A call at its end becomes a jump, and the return is somebody else's.
        let returns = usize::from(self.place[last] != Place::End && !self.is_call[last]);
        (times * size) as i64 - (times + size + returns) as i64
    }

    /// Words that it takes.
    fn words_of(&self, candidate: &Candidate) -> usize {
        let first = candidate.places[0];
        self.size[first..first + candidate.length].iter().sum()
    }

    /// Where it stands, without overlaps, in what is not taken.
    fn free_places(&self, candidate: &Candidate, taken: &[bool]) -> Vec<usize> {
        let mut end = 0;
        let is_free =
            |&at: &usize| taken.is_empty() || !taken[at..at + candidate.length].contains(&true);
        let mut places = candidate.places.clone();
        let words = self.words_of(candidate);
        places.retain(|at| {
            let free = *at >= end && is_free(at) && words >= self.least[*at];
            if free {
                end = at + candidate.length;
            }
            free
        });
        places
    }

    /// Makes it a function, and calls of what it was. Lines that are no more lose their name, so that those after them keep their places.
    fn replace(
        &self,
        functions: &mut Vec<Function>,
        candidate: &Candidate,
        places: &[usize],
        name: &str,
    ) {
        let Some(&first) = places.first() else {
            return;
        };
        let (function, line) = self.from[first];
        let last = first + candidate.length - 1;
        let mut lines = functions[function].lines[line..line + candidate.length].to_vec();
        let jumped_to = self.place[last] == Place::End;
        if !jumped_to {
            match lines.last_mut() {
                Some(Line::Do(it)) if it.flow() == Flow::Call => "jmp".clone_into(&mut it.name),
                _ => lines.push(Line::Do(Instruction::new("ret", &[]))),
            }
        }
        rename_labels(&mut lines, name);
        for &place in places {
            let (function, line) = self.from[place];
            let old = &mut functions[function].lines[line..line + candidate.length];
            old.fill(Line::Do(Instruction::new("", &[])));
            old[0] = Line::Do(Instruction::new(
                if jumped_to { "jmp" } else { "call" },
                &[name],
            ));
        }
        functions.push(Function::new(name.to_owned(), lines));
    }
}

/// What equal lines have in common.
#[derive(PartialEq, Eq, Hash)]
enum Word<'a> {
    Plain(&'a Instruction),
    /// The name of a jump, none of a label, and how far away the other is.
    Paired(&'a str, i64),
}

/// Jumps of a function with the labels that only they go to, by their lines, both ways.
fn pairs(function: &Function) -> HashMap<usize, usize> {
    let mut users: HashMap<&str, Vec<usize>> = HashMap::new();
    for (at, line) in function.lines.iter().enumerate() {
        for operand in line.instruction().into_iter().flat_map(|it| &it.operands) {
            let start = operand.find(".L").unwrap_or(operand.len());
            let label = operand[start..].trim_end_matches(')');
            users.entry(label).or_default().push(at);
        }
    }
    let mut pairs = HashMap::new();
    for (at, line) in function.lines.iter().enumerate() {
        let users = match line {
            Line::Label(label) => users.get(label.as_str()).map_or(&[][..], Vec::as_slice),
            Line::Do(_) => continue,
        };
        if let [user] = users
            && at.abs_diff(*user) < LONGEST
            && function.lines[*user]
                .instruction()
                .is_some_and(|it| it.target().is_some())
        {
            pairs.extend([(at, *user), (*user, at)]);
        }
    }
    pairs
}

/// Names labels after the function in which they are.
fn rename_labels(lines: &mut [Line], function: &str) {
    let mut new: HashMap<String, String> = HashMap::new();
    for line in lines.iter_mut() {
        if let Line::Label(label) = line {
            let name = format!(".L{function}_{}", new.len());
            new.insert(std::mem::replace(label, name.clone()), name);
        }
    }
    for line in lines.iter_mut() {
        if let Line::Do(it) = line
            && let Some(name) = it.target().and_then(|target| new.get(target))
        {
            it.operands[0].clone_from(name);
        }
    }
}

impl Place {
    fn of(instruction: &Instruction, stack_arguments: &HashSet<String>) -> Self {
        let is_stack = |operand: &str| ["61", "62", "63"].contains(&operand);
        match (instruction.flow(), instruction.name.as_str()) {
            (Flow::Branch, _) | (_, "ijmp" | "reti") => Place::Apart,
            (Flow::Jump | Flow::Return, _) if instruction.operand(0).starts_with(".L") => {
                Place::Apart
            }
            (Flow::Jump | Flow::Return, _) => Place::End,
            (Flow::Call, _) if instruction.operand(0).starts_with(frames::ENTER) => Place::Apart,
            (Flow::Call, _) if stack_arguments.contains(instruction.operand(0)) => Place::Stack,
            (_, "push" | "pop" | "cli") => Place::Stack,
            (_, "in") if is_stack(instruction.operand(1)) => Place::Stack,
            (_, "out") if is_stack(instruction.operand(0)) => Place::Within,
            _ => Place::Free,
        }
    }
}
