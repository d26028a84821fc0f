//! Tables of the modes, and of their states and transitions, from their descriptions.

use super::{Made, RPM};
use rumbo_control::mode::{ModeId, Reference, ReferenceKind};
use rumbo_control::rig::Rig;

/// The modes, one a row.
pub(crate) fn modes() -> Result<Option<Made>, String> {
    let mut words = String::from(
        "| mode | does | setpoint | rigs | parameters first |\n|---|---|---|---|---|\n",
    );
    for mode in ModeId::ALL {
        let about = mode.description();
        let rigs: Vec<_> = about.rigs.iter().map(Rig::name).collect();
        let rigs = match rigs.len() {
            all if all == Rig::ALL.len() => "any".into(),
            _ => format!("`{}`", rigs.join("`, `")),
        };
        let first = about.parameters.first().into_iter();
        let first: Vec<_> = first
            .flat_map(|group| group.parameters)
            .map(|id| format!("`{}`", id.name()))
            .collect();
        words += &format!(
            "| {} `{}` | {} | {} | {rigs} | {} |\n",
            about.number,
            about.name,
            about.about,
            about.reference.as_ref().map(reference).unwrap_or_default(),
            first.join(", ")
        );
    }
    Ok(Some(Made {
        figures: Vec::new(),
        words,
    }))
}

/// A reference with its range, in the units that people use.
fn reference(reference: &Reference) -> String {
    if !reference.commanded {
        return "found by the mode".into();
    }
    let (what, factor, unit) = match reference.kind {
        ReferenceKind::Distance => ("distance", 100.0, "cm"),
        ReferenceKind::WheelSpeed => ("speed of each wheel", RPM, "rpm"),
        ReferenceKind::Speed => ("speed", RPM, "rpm"),
        ReferenceKind::Goal => ("x and y", 1.0, "m"),
    };
    let shown = |value: f32| (f64::from(value) * factor).round();
    let (min, max) = (shown(reference.min), shown(reference.max));
    format!("{what}, {min} to {max} {unit}")
}

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
