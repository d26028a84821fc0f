//! Islands: where calls go that do not reach what they call.
//!
//! Calls of the same that come from farther away than a short call reaches go to a `jmp` among them, which lies between two functions.
//! An island lies as far behind the first call that it serves as that reaches, and so serves as many others as can be.

use std::collections::HashMap;

use super::assembly::{Function, Instruction, Line};
use super::graph::{Graph, Place};

/// Words that a short call reaches, 2,048 but for the few jumps that will be longer than they are taken for.
const REACH: i64 = 2_030;
/// Words that an island takes.
const WORDS: i64 = 2;
/// Calls that make an island worth its words.
const WORTH: usize = 3;
/// Times that islands are placed: they move what lies behind them.
const ROUNDS: usize = 4;

/// Labels of islands by where they lead.
pub(super) type Islands = HashMap<String, Vec<String>>;

/// Puts islands between the functions. Those of `direct` functions make no way round.
pub(super) fn make(functions: &mut Vec<Function>, direct: impl Fn(&Function) -> bool) -> Islands {
    let graph = Graph::read(functions, direct);
    // Of each unit, the targets of the islands before it.
    let mut before: Vec<Vec<usize>> = vec![Vec::new(); graph.units.len()];
    for _ in 0..ROUNDS {
        before = place(&graph, &before);
    }
    let mut old = std::mem::take(functions).into_iter();
    let mut islands = Islands::new();
    for (number, (unit, targets)) in graph.units.iter().zip(&before).enumerate() {
        let mut island = Function::new(format!("rumbo_island_{number}"), Vec::new());
        for (place, &target) in targets.iter().enumerate() {
            let name = &graph.targets[target].name;
            let label = format!(".Lisland_{number}_{place}");
            island.lines.push(Line::Label(label.clone()));
            island
                .lines
                .push(Line::Do(Instruction::new("jmp", &[name])));
            islands.entry(name.clone()).or_default().push(label);
        }
        if !targets.is_empty() {
            functions.push(island);
        }
        functions.extend(old.by_ref().take(unit.len()));
    }
    islands
}

/// Places islands, where so many lie already.
fn place(graph: &Graph, before: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut begin = Vec::new();
    let mut border = Vec::new();
    let mut word = 0;
    for (words, islands) in graph.words.iter().zip(before) {
        border.push(word);
        word += WORDS * islands.len() as i64;
        begin.push(word);
        word += words;
    }
    let word = |place: Place| begin[place.unit] + place.words;
    let mut new = vec![Vec::new(); before.len()];
    for (number, target) in graph.targets.iter().enumerate() {
        let place = target.place.map(word);
        let calls = target.calls.iter().map(|call| word(*call));
        let mut far: Vec<i64> = calls
            .filter(|call| place.is_none_or(|place| (call - place).abs() > REACH))
            .collect();
        far.sort_unstable();
        let mut rest = far.as_slice();
        while let Some(first) = rest.first() {
            let unit = border.partition_point(|border| border - first <= REACH) - 1;
            let served = rest.partition_point(|call| call - border[unit] <= REACH);
            if served >= WORTH {
                new[unit].push(number);
            }
            rest = &rest[served.max(1)..];
        }
    }
    new
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `far`, what fills so many words, and functions of 100 words that jump to it.
    fn program(filler: usize, calls: usize) -> Vec<Function> {
        let function = |name: &str, words: usize, last: &str| {
            let lines = std::iter::repeat_n("nop", words - 1).chain([last]);
            let lines = lines.map(|line| Line::Do(Instruction::parse(line).unwrap()));
            Function::new(name.to_owned(), lines.collect())
        };
        let calls = (0..calls).map(|at| function(&format!("call{at}"), 100, "jmp far"));
        let before = [function("far", 1, "ret"), function("filler", filler, "ret")];
        before.into_iter().chain(calls).collect()
    }

    #[test]
    fn an_island_lies_as_far_as_the_first_call_reaches() {
        let mut functions = program(3_000, 30);
        let islands = make(&mut functions, |_| false);
        assert_eq!(islands["far"].len(), 1);
        let at = functions
            .iter()
            .position(|it| it.name().starts_with("rumbo_island"));
        // The first jump is the last word of `call0`.
        assert_eq!(functions[at.unwrap() - 1].name(), "call20");
        assert_eq!(make(&mut program(3_000, 60), |_| false)["far"].len(), 2);
    }

    #[test]
    fn what_reaches_needs_none_nor_do_two_calls_nor_those_that_go_no_way_round() {
        assert!(make(&mut program(1_000, 9), |_| false).is_empty());
        assert!(make(&mut program(3_000, 2), |_| false).is_empty());
        assert!(make(&mut program(3_000, 30), |it| it.name().starts_with("call")).is_empty());
    }
}
