//! Metrics against their limits, as people read them.

use crate::complaints;
use crate::metric_names::{Shown, shown};
use crate::signals::ReportedRun;
use crate::table::{Cell, Tone, table};
use crate::text::{Language, Text, escape, with, with_unit, word};
use rumbo_experiment::files::MetricBounds;
use rumbo_experiment::note::Note;

/// A value that is no metric, already in its unit.
pub(crate) const fn plain(unit: &'static str) -> Shown {
    Shown {
        name: String::new(),
        bare: "",
        factor: 1.0,
        unit,
    }
}

const NEVER: Text = word("never");

/// A metric's value as it is shown.
pub(crate) fn value(language: Language, shown: &Shown, value: f64) -> String {
    if value.is_nan() {
        // Such as the settling of what does not settle.
        return NEVER.of(language).to_owned();
    }
    let value = value * shown.factor;
    let text = match shown.unit {
        "m/s" | "m" => language.short(value, 3),
        // Times are known to a tenth at least.
        "s" if value < 100.0 => {
            let short = language.short(value, 2);
            if short.contains(['.', ',']) {
                short
            } else {
                language.number(value, 1)
            }
        }
        _ => language.figure(value),
    };
    with_unit(text, shown.unit)
}

pub(crate) fn bounds(language: Language, shown: &Shown, bounds: MetricBounds) -> String {
    // A limit in rad was a round number of degrees before it was converted and rounded.
    let number = |value: f64| {
        let value = value * shown.factor;
        let decimals = if value.abs() >= 100.0 {
            0
        } else if value.abs() >= 10.0 {
            1
        } else {
            2
        };
        language.short(value, decimals)
    };
    let text = match (bounds.min, bounds.max) {
        (Some(min), Some(max)) => format!("{}\u{a0}…\u{a0}{}", number(min), number(max)),
        (Some(min), None) => format!("≥\u{a0}{}", number(min)),
        (None, Some(max)) => format!("≤\u{a0}{}", number(max)),
        (None, None) => return String::new(),
    };
    with_unit(text, shown.unit)
}

const METRIC: Text = word("metric");
const VALUE: Text = word("value");
const LIMIT: Text = word("limit");
const RESULT: Text = word("result");
pub(crate) const KEPT: Text = word("met");
pub(crate) const MISSED: Text = word("missed");
const MESSAGE: Text = word("message-of-the-program");

/// The metrics of runs against their limits, a table for each run.
pub(crate) fn limits(language: Language, outcomes: &[&ReportedRun]) -> String {
    let header = [METRIC, VALUE, LIMIT, RESULT].map(|text| text.of(language));
    let mut html = String::new();
    for outcome in outcomes {
        let rows = rows(language, outcome);
        if !rows.is_empty() {
            let name = name_of(&outcome.result.scenario);
            html += &format!("<h4>{name}</h4>\n");
            html += &table(&header, &rows);
        }
        html += &complaints(language, outcome);
    }
    html
}

/// A name of the program.
pub(crate) fn name_of(name: &str) -> String {
    format!("<code translate=\"no\">{}</code>", escape(name))
}

const SCENARIO: Text = word("scenario");

/// The same of many runs in one table.
pub(crate) fn limits_together(language: Language, outcomes: &[&ReportedRun]) -> String {
    let mut all = Vec::new();
    for outcome in outcomes {
        for (index, mut row) in rows(language, outcome).into_iter().enumerate() {
            // Said once, where the table's rows are many.
            let name = match index {
                0 => name_of(&outcome.result.scenario),
                _ => String::new(),
            };
            row.insert(0, Cell::html(name));
            all.push(row);
        }
    }
    let header = [SCENARIO, METRIC, VALUE, LIMIT, RESULT].map(|text| text.of(language));
    let complaints = outcomes.iter().map(|outcome| complaints(language, outcome));
    table(&header, &all) + &complaints.collect::<String>()
}

/// A run's metrics that have a limit.
fn rows(language: Language, outcome: &ReportedRun) -> Vec<Vec<Cell>> {
    let row = |(key, limit): (&String, &MetricBounds)| {
        let shown = shown(language, &outcome.setup.scenario, key)?;
        let found = outcome.metric(key).unwrap_or(f64::NAN);
        let (verdict, tone) = if limit.admit(found) {
            (KEPT, Tone::Good)
        } else {
            (MISSED, Tone::Bad)
        };
        Some(vec![
            Cell::text(&shown.name),
            Cell::text(&value(language, &shown, found)),
            Cell::text(&bounds(language, &shown, *limit)),
            Cell::text(verdict.of(language)).tone(tone),
        ])
    };
    outcome
        .setup
        .scenario
        .limits
        .iter()
        .filter_map(row)
        .collect()
}

/// Failures of the robot or the program besides missed limits.
fn complaints(language: Language, outcome: &ReportedRun) -> String {
    let complaint = |note: &Note| {
        let said = complaints::complaint(language, note).html();
        let name = name_of(&outcome.result.scenario);
        let message = with(
            &escape(MESSAGE.of(language)),
            &[("scenario", &name), ("message", &said)],
        );
        format!("<p class=\"verdict bad\">{message}</p>\n")
    };
    let failures = outcome.result.failures.iter();
    failures
        .filter(|note| !matches!(note, Note::Limit { .. }))
        .map(complaint)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signals::DEG;
    use rumbo_experiment::files::{Library, Overrides};
    use rumbo_experiment::run::run;

    #[test]
    fn every_metric_that_has_a_limit_has_a_name_in_both_languages() {
        let library = Library::new();
        for experiment in crate::EXPERIMENTS {
            for name in experiment.scenarios {
                let mut setup = library.setup(name, &Overrides::default()).unwrap();
                // Names depend on the commands, not on their outcome.
                setup.scenario.calibrated = false;
                setup.scenario.duration_s = 0.1;
                let limits: Vec<String> = setup.scenario.limits.keys().cloned().collect();
                let result = run(&setup, 1).unwrap();
                let outcome = ReportedRun { setup, result };
                for key in limits {
                    for language in [Language::English, Language::Spanish] {
                        assert!(
                            shown(language, &outcome.setup.scenario, &key).is_some(),
                            "{name}: {key}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn values_and_bounds_are_shown_in_the_unit_of_a_reader() {
        let shown = Shown {
            factor: DEG,
            ..plain("°")
        };
        assert_eq!(value(Language::Spanish, &shown, 0.0349), "2°");
        let both = MetricBounds {
            min: Some(-1.75),
            max: Some(-1.4),
        };
        assert_eq!(
            bounds(Language::English, &shown, both),
            "\u{2212}100\u{a0}…\u{a0}\u{2212}80.2°"
        );
        assert_eq!(value(Language::English, &shown, f64::NAN), "never");
    }
}
