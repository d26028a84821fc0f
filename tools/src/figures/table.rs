//! Tables of metrics, a column per program.

use crate::factor;
use crate::figures::runs::Runs;

/// One metric.
#[derive(Clone)]
pub(crate) struct Row {
    pub(crate) what: &'static str,
    pub(crate) metric: &'static str,
    pub(crate) unit: &'static str,
    /// The report's robot, from its report or its recorded run.
    pub(crate) real: &'static str,
    /// Less is worse.
    pub(crate) least_is_worst: bool,
}

/// A row where more is worse.
pub(crate) const fn row(
    what: &'static str,
    metric: &'static str,
    unit: &'static str,
    real: &'static str,
) -> Row {
    Row {
        what,
        metric,
        unit,
        real,
        least_is_worst: false,
    }
}

/// The table: median and, in parentheses, the worst of the seeds.
pub(crate) fn table(columns: &[(&str, &Runs)], rows: &[Row]) -> String {
    let mut text = String::from("| median (worst) |");
    for (title, _) in columns {
        text += &format!(" {title} |");
    }
    text += " the report's robot | limit |\n|---|---|---|";
    text += &"---|".repeat(columns.len());
    text += "\n";
    for row in rows {
        text += &format!("| {} |", row.what);
        for (_, runs) in columns {
            text += &format!(" {} |", cell(row, runs));
        }
        let limits = columns.last().map(|(_, ours)| &ours.setup.scenario.limits);
        let bounds = limits.and_then(|limits| limits.get(row.metric));
        let limit = bounds
            .and_then(|bounds| bounds.max.or(bounds.min))
            .map(|limit| with_unit(limit, row))
            .unwrap_or_default();
        text += &format!(" {} | {limit} |\n", row.real);
    }
    text
}

/// Median, and in parentheses min and max.
pub(crate) fn spread(row: &Row, runs: &Runs) -> String {
    let Some([median, most]) = runs.median_and_worst(row.metric, false) else {
        return "-".into();
    };
    let least = runs
        .median_and_worst(row.metric, true)
        .map_or(f64::NAN, |[_, least]| least);
    let [median, least, most] = [median, least, most].map(|value| in_words(value, row));
    let numbers = format!("{median} ({least} to {most})");
    if median == "never" {
        numbers
    } else {
        format!("{numbers} {}", row.unit).trim_end().to_owned()
    }
}

fn in_words(value: f64, row: &Row) -> String {
    if value.is_finite() {
        number(value * factor(row.metric, row.unit))
    } else {
        "never".into()
    }
}

fn cell(row: &Row, runs: &Runs) -> String {
    match runs.median_and_worst(row.metric, row.least_is_worst) {
        None => "-".into(),
        Some([median, worst]) => {
            let (median, worst) = (in_words(median, row), in_words(worst, row));
            let numbers = format!("{median} ({worst})");
            if median == "never" {
                numbers
            } else {
                format!("{numbers} {}", row.unit).trim_end().to_owned()
            }
        }
    }
}

fn with_unit(value: f64, row: &Row) -> String {
    format!(
        "{} {}",
        number(value * factor(row.metric, row.unit)),
        row.unit
    )
    .trim_end()
    .to_owned()
}

/// Two significant digits, three from 10 on.
fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        "0".into()
    } else if size >= 9.95 {
        format!("{value:.1}")
    } else if size >= 0.095 {
        format!("{value:.2}")
    } else if size >= 0.0005 {
        format!("{value:.3}")
    } else {
        "0.000".into()
    }
}
