//! web/src/row.js: the signals of a frame as the page plots them, from the one table of `rumbo_log`.

use super::File;
use rumbo_log::{SIGNALS, Signal};

/// For `--only`.
pub(super) const NAME: &str = "signals";

const HEAD: &str = "// @ts-check
/** The signals of a frame that are plotted. Written by `cargo xtask figures` from the table in crates/log/src/signals.rs. */

/** @type {(import('./signals.js').Signal & {column: string})[]} */
export const ROW = [
";

/// The file as it should be.
pub(super) fn file() -> File {
    let plotted = SIGNALS.iter().filter(|signal| !signal.about.is_empty());
    let lines: String = plotted.map(line).collect();
    File {
        path: "web/src/row.js".into(),
        text: format!("{HEAD}{lines}];\n"),
    }
}

fn line(signal: &Signal) -> String {
    let Signal {
        name: column,
        label,
        about,
        shown: (unit, _),
        ..
    } = signal;
    let name = match *unit {
        "rpm" => column.replace("_rad_s", "_rpm"),
        "°" => column.replace("_rad", "_deg"),
        "cm" => column.replace("_m", "_cm"),
        _ => (*column).to_owned(),
    };
    let kind = match column {
        _ if column.starts_with("true_") || column.starts_with("ghost_") => "true",
        _ if column.contains("_ref_") => "reference",
        _ => "measured",
    };
    let colour = colour(column);
    format!(
        "  {{ name: '{name}', column: '{column}', label: '{label}', about: '{about}', unit: '{unit}', colour: '{colour}', kind: '{kind}' }},\n"
    )
}

/// One colour for each side; the ghost's and the setpoint's are others.
fn colour(column: &str) -> &'static str {
    let (whose, part) = match column.strip_prefix("ghost_") {
        Some(part) => ("ghost", part),
        None => ("", column.trim_start_matches("true_")),
    };
    let side = part.trim_start_matches("range_");
    let is_first = side.starts_with("left") || side.starts_with("x_");
    let is_second =
        side.starts_with("right") || side.starts_with("y_") || side.starts_with("servo");
    match (whose, part) {
        ("ghost", _) if is_second => "reference",
        ("ghost", _) => "goal",
        (_, "heading_ref_rad") => "reference",
        _ if is_first => "left",
        _ if is_second => "right",
        _ => "front",
    }
}
