//! The table of a mode's states and transitions, from its description.

use super::Made;
use rumbo_control::mode::ModeId;

/// A way out that leaves this many states has one row, below them.
const SHARED: usize = 4;

/// The states of the mode with this number.
pub(crate) fn states<const NUMBER: u8>() -> Result<Option<Made>, String> {
    let mode = ModeId::from_number(NUMBER).ok_or_else(|| format!("no mode {NUMBER}"))?;
    let states = mode.description().states;
    let name = |number: usize| format!("{number} {}", states[number].name);
    // The numbers of the states that each way out leaves, in the order in which they come.
    let mut ways: Vec<((&str, u8), Vec<String>)> = Vec::new();
    for (number, state) in states.iter().enumerate() {
        for way in state.ways {
            let out = (way.when, way.to);
            match ways.iter_mut().find(|(known, _)| *known == out) {
                Some((_, from)) => from.push(number.to_string()),
                None => ways.push((out, vec![number.to_string()])),
            }
        }
    }
    ways.retain(|(_, from)| from.len() >= SHARED);
    let row =
        |first: &str, when: &str, to: u8| format!("{first} {when} | {} |\n", name(usize::from(to)));
    let mut words = String::from("| state | does | leaves when | to |\n|---|---|---|---|\n");
    for (number, state) in states.iter().enumerate() {
        let mut first = format!("| {} | {} |", name(number), state.does);
        for way in state.ways {
            if ways.iter().all(|(shared, _)| *shared != (way.when, way.to)) {
                words += &row(&first, way.when, way.to);
                first = "| | |".into();
            }
        }
        if first != "| | |" {
            words += &format!("{first} | |\n");
        }
    }
    for ((when, to), from) in &ways {
        words += &row(&format!("| {} | |", from.join(", ")), when, *to);
    }
    Ok(Some(Made {
        figures: Vec::new(),
        words,
    }))
}
