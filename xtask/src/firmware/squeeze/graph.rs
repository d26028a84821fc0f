//! The program as lengths and calls, for what looks for places ([`order`](super::order), [`islands`](super::islands)).

use std::collections::HashMap;
use std::ops::Range;

use super::assembly::{Flow, Function, Instruction, Line};

/// A place in the program: which unit, and how many words from where it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) unit: usize,
    pub(super) words: i64,
}

/// What is called or jumped to from elsewhere.
pub(super) struct Target {
    pub(super) name: String,
    /// `None`: it is linked behind the program.
    pub(super) place: Option<Place>,
    /// Calls and jumps that may go by an island.
    pub(super) calls: Vec<Place>,
}

/// The program as lengths and calls.
pub(super) struct Graph {
    /// Functions that lie behind each other in any case: each but the last goes on in the next.
    pub(super) units: Vec<Range<usize>>,
    pub(super) words: Vec<i64>,
    pub(super) targets: Vec<Target>,
}

/// Words that an instruction takes where jumps and calls are short.
fn short(it: &Instruction) -> i64 {
    if it.target().is_some() {
        1
    } else {
        it.words() as i64
    }
}

impl Graph {
    /// Reads a program. Calls of `direct` functions may not go by an island.
    pub(super) fn read(functions: &[Function], direct: impl Fn(&Function) -> bool) -> Self {
        let mut graph = Self {
            units: Vec::new(),
            words: Vec::new(),
            targets: Vec::new(),
        };
        let mut places: HashMap<&str, (usize, Place)> = HashMap::new();
        let mut calls: Vec<(usize, &str, Place)> = Vec::new();
        let mut goes_on = false;
        for (number, function) in functions.iter().enumerate() {
            if !goes_on {
                graph.units.push(number..number);
                graph.words.push(0);
            }
            let unit = graph.units.len() - 1;
            graph.units[unit].end = number + 1;
            let words = &mut graph.words[unit];
            let place = |words: &i64| Place {
                unit,
                words: *words,
            };
            let names = function.names.iter();
            places.extend(names.map(|name| (name.as_str(), (number, place(words)))));
            for line in &function.lines {
                match line {
                    Line::Label(label) => {
                        places.insert(label, (number, place(words)));
                    }
                    Line::Do(it) => {
                        let target = it
                            .target()
                            .filter(|_| it.flow() != Flow::Branch && !direct(function));
                        calls.extend(target.map(|target| (number, target, place(words))));
                        *words += short(it);
                    }
                }
            }
            let last = function.lines.last().and_then(Line::instruction);
            goes_on = last.is_none_or(|it| !it.ends());
        }
        let mut numbers: HashMap<&str, usize> = HashMap::new();
        for (function, name, place) in calls {
            let at = places.get(name);
            if at.is_some_and(|(other, _)| *other == function) {
                continue;
            }
            let number = *numbers.entry(name).or_insert_with(|| {
                graph.targets.push(Target {
                    name: name.to_owned(),
                    place: at.map(|(_, place)| *place),
                    calls: Vec::new(),
                });
                graph.targets.len() - 1
            });
            graph.targets[number].calls.push(place);
        }
        graph
    }
}
