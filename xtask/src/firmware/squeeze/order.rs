//! The order of the functions in which most calls are short.
//!
//! A short call takes a word and reaches 2,048. All calls of the same that come from farther away, but within the reach of one island,
//! cost that island, two words; one alone costs a word more. What an order costs is therefore the sum over all that is called, and
//! the order sought is the one in which it is least.
//!
//! The search draws a function, or a few that lie side by side, and a place near to one that it calls or that calls it, and moves
//! it there if that costs less, and at first now and then also if it costs more (simulated annealing). The numbers come from a
//! generator with a fixed start: the same program always has the same order.

use std::ops::Range;

use super::assembly::Function;
use super::graph::{Graph, Place, Target};

/// Words that a short call surely reaches: 2,048 without what islands in between take.
const REACH: i64 = 1_950;
/// Words from the first to the last call of the same that one island serves: it lies between two functions, not always in the middle.
const SERVED: i64 = 3_700;
/// Moves that are tried for each unit.
const TRIED: usize = 350;
/// Functions side by side that move together, at most.
const TOGETHER: usize = 12;
/// Words more that a move may cost at first.
const WARMTH: f64 = 2.0;

/// Puts functions into the order in which calls cost least.
pub(super) fn order(functions: &mut Vec<Function>, direct: impl Fn(&Function) -> bool) {
    let graph = Graph::read(functions, direct);
    let order = Search::new(&graph).run();
    let mut old: Vec<Option<Function>> = std::mem::take(functions).into_iter().map(Some).collect();
    for unit in order {
        functions.extend(graph.units[unit].clone().filter_map(|at| old[at].take()));
    }
}

/// Numbers that look like chance: Marsaglia's generator.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % limit.max(1)
    }

    /// Whether a move that costs so many words is made.
    fn takes(&mut self, cost: i64, warmth: f64) -> bool {
        cost <= 0 || (self.below(1_000_000) as f64) < 1e6 * (-(cost as f64) / warmth).exp()
    }
}

/// A move: units by their places in the order, where they go in it, and by how many words.
struct Move {
    from: Range<usize>,
    to: usize,
    words: i64,
}

/// An order, and what it takes to change it.
struct Search<'a> {
    graph: &'a Graph,
    /// Calls of each unit, in its own order, and of what.
    calls: Vec<Vec<(i64, usize)>>,
    /// Targets of which a unit has the place or a call.
    touched: Vec<Vec<usize>>,
    /// Units that a unit calls or is called by.
    partners: Vec<Vec<usize>>,
    order: Vec<usize>,
    /// Of each unit, its place in the order, and the word at which it begins.
    rank: Vec<usize>,
    begin: Vec<i64>,
    chance: Chance,
}

impl<'a> Search<'a> {
    fn new(graph: &'a Graph) -> Self {
        let count = graph.units.len();
        let mut search = Self {
            graph,
            calls: vec![Vec::new(); count],
            touched: vec![Vec::new(); count],
            partners: vec![Vec::new(); count],
            order: (0..count).collect(),
            rank: (0..count).collect(),
            begin: begins(graph, &(0..count).collect::<Vec<_>>()),
            chance: Chance(0x9E37_79B9_7F4A_7C15),
        };
        for (number, target) in graph.targets.iter().enumerate() {
            for (at, call) in target.calls.iter().enumerate() {
                search.calls[call.unit].push((call.words, number));
                search.touched[call.unit].push(number);
                // Calls of what lies behind the program draw each other.
                let other = target.place.or(target.calls.get(at + 1).copied());
                if let Some(other) = other.filter(|other| other.unit != call.unit) {
                    search.partners[call.unit].push(other.unit);
                    search.partners[other.unit].push(call.unit);
                }
            }
            if let Some(place) = target.place {
                search.touched[place.unit].push(number);
            }
        }
        for (calls, touched) in search.calls.iter_mut().zip(&mut search.touched) {
            calls.sort_unstable();
            touched.sort_unstable();
            touched.dedup();
        }
        search
    }

    fn run(mut self) -> Vec<usize> {
        let mut cost = self.cost();
        let moves = TRIED * self.order.len();
        for tried in 0..moves {
            let warmth = WARMTH * (1.0 - tried as f64 / moves as f64) + 1e-6;
            let Some(it) = self.draw() else { continue };
            // What moves, as if the rest stayed where it is: that is quick, and most moves are none.
            let estimate = self.estimate(&it);
            if !self.chance.takes(estimate, warmth) {
                continue;
            }
            let back = self.go(&it);
            let new = self.cost();
            if self.chance.takes(new - cost, warmth) {
                cost = new;
            } else {
                self.go(&back);
            }
        }
        self.order
    }

    /// Draws a move.
    fn draw(&mut self) -> Option<Move> {
        let count = self.order.len();
        let unit = self.chance.below(count);
        let several = self.chance.below(3) == 0;
        let length = if several {
            1 + self.chance.below(TOGETHER)
        } else {
            1
        };
        let first = self.rank[unit];
        let from = first..(first + length).min(count);
        let partner = self.chance.below(self.partners[unit].len());
        let partner = *self.partners[unit].get(partner)?;
        let near = self.chance.below(2 * REACH as usize) as i64 - REACH;
        let word = self.begin[partner] + near;
        let to = self
            .order
            .partition_point(|&other| self.begin[other] < word);
        if (from.start..=from.end).contains(&to) {
            return None;
        }
        let between = if to < from.start {
            &self.order[to..from.start]
        } else {
            &self.order[from.end..to]
        };
        let words: i64 = between.iter().map(|&unit| self.graph.words[unit]).sum();
        Some(if to < from.start {
            Move {
                from,
                to,
                words: -words,
            }
        } else {
            Move {
                to: to - from.len(),
                from,
                words,
            }
        })
    }

    /// What a move costs, as if nothing else moved.
    fn estimate(&self, it: &Move) -> i64 {
        let moved = &self.order[it.from.clone()];
        let mut targets: Vec<usize> = moved
            .iter()
            .flat_map(|&unit| self.touched[unit].iter().copied())
            .collect();
        if moved.len() > 1 {
            targets.sort_unstable();
            targets.dedup();
        }
        let before = |place: Place| self.begin[place.unit] + place.words;
        let after = |place: Place| {
            let moves = it.from.contains(&self.rank[place.unit]);
            before(place) + if moves { it.words } else { 0 }
        };
        let mut far = Vec::new();
        targets
            .into_iter()
            .map(|target| {
                let target = &self.graph.targets[target];
                cost(target, after, &mut far) - cost(target, before, &mut far)
            })
            .sum()
    }

    /// Makes a move; says how to take it back.
    fn go(&mut self, it: &Move) -> Move {
        let length = it.from.len();
        let moved: Vec<usize> = self.order.drain(it.from.clone()).collect();
        self.order.splice(it.to..it.to, moved);
        let first = it.from.start.min(it.to);
        let last = it.from.end.max(it.to + length);
        let mut word = first.checked_sub(1).map_or(0, |before| {
            let unit = self.order[before];
            self.begin[unit] + self.graph.words[unit]
        });
        for place in first..last {
            let unit = self.order[place];
            self.rank[unit] = place;
            self.begin[unit] = word;
            word += self.graph.words[unit];
        }
        Move {
            from: it.to..it.to + length,
            to: it.from.start,
            words: -it.words,
        }
    }

    /// What the order costs.
    fn cost(&self) -> i64 {
        let targets = &self.graph.targets;
        let place = |place: Place| self.begin[place.unit] + place.words;
        let places: Vec<Option<i64>> = targets.iter().map(|it| it.place.map(place)).collect();
        // Of each target, where the last island's calls begin, and whether there are several.
        let mut islands = vec![(i64::MIN / 2, true); targets.len()];
        let mut cost = 0;
        for &unit in &self.order {
            for &(words, target) in &self.calls[unit] {
                let word = self.begin[unit] + words;
                if places[target].is_some_and(|place| (word - place).abs() <= REACH) {
                    continue;
                }
                let island = &mut islands[target];
                if word - island.0 >= SERVED {
                    *island = (word, false);
                    cost += 1;
                } else if !island.1 {
                    island.1 = true;
                    cost += 1;
                }
            }
        }
        cost
    }
}

/// What all calls of a target cost.
fn cost(target: &Target, word: impl Fn(Place) -> i64, far: &mut Vec<i64>) -> i64 {
    let place = target.place.map(&word);
    let calls = target.calls.iter().map(|call| word(*call));
    far.clear();
    far.extend(calls.filter(|call| place.is_none_or(|place| (call - place).abs() > REACH)));
    far.sort_unstable();
    let mut cost = 0;
    let mut rest = far.as_slice();
    while let Some(first) = rest.first() {
        let served = rest.partition_point(|call| call - first < SERVED);
        cost += if served > 1 { 2 } else { 1 };
        rest = &rest[served..];
    }
    cost
}

/// The word at which each unit begins.
fn begins(graph: &Graph, order: &[usize]) -> Vec<i64> {
    let mut begin = vec![0; order.len()];
    let mut word = 0;
    for &unit in order {
        begin[unit] = word;
        word += graph.words[unit];
    }
    begin
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::firmware::squeeze::assembly::{Instruction, Line};

    fn function(name: &str, words: usize, last: &str) -> Function {
        let lines = std::iter::repeat_n("nop", words - 1).chain([last]);
        let lines = lines.map(|line| Line::Do(Instruction::parse(line).unwrap()));
        Function::new(name.to_owned(), lines.collect())
    }

    /// Twenty functions of 400 words, each of which jumps to the one ten behind it.
    fn crossed() -> Vec<Function> {
        let jumps = |at: usize| format!("jmp f{}", at + 10);
        let first = (0..10).map(|at| function(&format!("f{at}"), 400, &jumps(at)));
        let second = (10..20).map(|at| function(&format!("f{at}"), 400, "ret"));
        first.chain(second).collect()
    }

    #[test]
    fn what_is_called_comes_within_reach() {
        let mut functions = crossed();
        assert_eq!(Search::new(&Graph::read(&functions, |_| false)).cost(), 10);
        order(&mut functions, |_| false);
        assert_eq!(Search::new(&Graph::read(&functions, |_| false)).cost(), 0);
        let mut names: Vec<_> = functions.iter().map(Function::name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 20);
    }

    #[test]
    fn what_goes_on_in_the_next_stays_before_it() {
        let mut functions = crossed();
        let goes_on = |number: usize| function(&format!("before_f{number}"), 30, "nop");
        functions.insert(15, goes_on(15));
        functions.insert(3, goes_on(3));
        order(&mut functions, |_| false);
        for two in functions.windows(2) {
            if let Some(next) = two[0].name().strip_prefix("before_") {
                assert_eq!(next, two[1].name());
            }
        }
    }

    #[test]
    fn several_calls_from_far_away_cost_one_island() {
        let filled = |calls: usize| {
            let mut functions = vec![function("far", 1, "ret"), function("filler", 3_000, "ret")];
            let calls = (0..calls).map(|at| function(&format!("call{at}"), 100, "jmp far"));
            functions.extend(calls);
            Search::new(&Graph::read(&functions, |_| false)).cost()
        };
        assert_eq!([filled(0), filled(1), filled(2), filled(9)], [0, 1, 2, 2]);
        // From 5,000 words one more.
        assert_eq!(filled(50), 4);
    }
}
