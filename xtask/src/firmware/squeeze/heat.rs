//! How often functions run, and so how much a call may cost in them.
//!
//! To take a sequence out of a function costs the nine cycles of a call and its return, and gives back a word for each of its words but
//! one. Where cycles count only long sequences are worth that. A few functions are known to be hot; what they call, by whatever way, is
//! warm, since it runs when they do, and some others are known to be; the rest is cold.

use std::collections::{HashMap, HashSet};

use super::assembly::{Function, Instruction};

/// Fewest words of a sequence that is taken out of a hot, a warm, and a cold function.
const HOT: usize = 6;
const WARM: usize = 4;
const COLD: usize = 2;

/// Names of the functions that are not cold.
pub(super) struct Heat {
    hot: HashSet<String>,
    warm: HashSet<String>,
}

impl Heat {
    /// Finds out from those that are known to be hot, and parts of the names of those that are warm in any case.
    pub(super) fn of(
        functions: &[Function],
        is_hot: impl Fn(&Function) -> bool,
        known: &[String],
    ) -> Self {
        let names = |function: &Function| function.names.clone();
        let hot: HashSet<String> = functions
            .iter()
            .filter(|it| is_hot(it))
            .flat_map(names)
            .collect();
        let by_name: HashMap<&str, &Function> = functions
            .iter()
            .flat_map(|function| {
                function
                    .names
                    .iter()
                    .map(move |name| (name.as_str(), function))
            })
            .collect();
        let is_warm = |it: &&Function| known.iter().any(|part| it.name().contains(part.as_str()));
        let mut warm: HashSet<String> = functions.iter().filter(is_warm).flat_map(names).collect();
        let mut open: Vec<&str> = hot.iter().map(String::as_str).collect();
        while let Some(name) = open.pop() {
            let Some(function) = by_name.get(name) else {
                continue;
            };
            for target in function.instructions().filter_map(Instruction::target) {
                if by_name.contains_key(target) && warm.insert(target.to_owned()) {
                    open.push(target);
                }
            }
        }
        Self { hot, warm }
    }

    /// Fewest words of a sequence that is taken out of a function. What is made of sequences is warm.
    pub(super) fn least_words(&self, function: &Function) -> usize {
        let is_in = |set: &HashSet<String>| function.names.iter().any(|name| set.contains(name));
        if is_in(&self.hot) {
            HOT
        } else if is_in(&self.warm) || function.name().starts_with("rumbo_") {
            WARM
        } else {
            COLD
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::firmware::squeeze::assembly::Line;

    fn function(name: &str, lines: &[&str]) -> Function {
        let lines = lines
            .iter()
            .map(|line| Line::Do(Instruction::parse(line).unwrap()));
        Function::new(name.to_owned(), lines.collect())
    }

    #[test]
    fn what_hot_functions_call_is_warm_however_far_down() {
        let functions = [
            function("hot", &["call one", "jmp two"]),
            function("one", &["call three", "ret"]),
            function("two", &["ret"]),
            function("three", &["call hot", "ret"]),
            function("cold", &["call one", "ret"]),
            function("lukewarm", &["ret"]),
            function("rumbo_shared_1", &["ret"]),
        ];
        let heat = Heat::of(&functions, |it| it.name() == "hot", &["luke".to_owned()]);
        let words = functions.each_ref().map(|it| heat.least_words(it));
        assert_eq!(words, [HOT, WARM, WARM, WARM, COLD, WARM, WARM]);
    }
}
