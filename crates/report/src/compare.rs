//! The page of a comparison: variants of a scenario, pair by pair, with box plots.

use crate::metric_names::shown;
use crate::summary::{figure, heading, shell};
use crate::table::{Cell, Tone, table};
use crate::text::{Language, Text, escape, put, word};
use rumbo_experiment::compare::{Difference, Variant, differences};
use rumbo_experiment::files::ScenarioFile;
use rumbo_plot::Boxes;

const FACTS: Text = word("compare-facts");
const HOW: Text = word("compare-how");
const PASS: Text = word("runs-that-pass");
const VARIANT: Text = word("variant");
const METRIC: Text = word("metric");
const MEAN: Text = word("mean-difference");
const INTERVAL: Text = word("interval");
const EFFECT: Text = word("effect");
const BETTER: Text = word("better-in");
const NONE: Text = word("no-difference");
const NEVER_IN: Text = word("never-in-runs");
const AGAINST: Text = word("against-first");

/// The page of variants that were run with these seeds.
#[must_use]
pub fn page(
    scenario: &ScenarioFile,
    variants: &[Variant],
    seeds: &[u64],
    language: Language,
) -> String {
    let [first, others @ ..] = variants else {
        return String::new();
    };
    let values = [
        ("count", seeds.len().to_string()),
        (
            "seed",
            seeds.first().map(ToString::to_string).unwrap_or_default(),
        ),
    ];
    let mut body = format!("<p>{}</p>\n", escape(&FACTS.with(language, &values)));
    let rows: Vec<_> = variants
        .iter()
        .map(|one| passes(one, seeds.len()))
        .collect();
    body += &table(&[VARIANT.of(language), PASS.of(language)], &rows);
    put(
        &mut body,
        format_args!("<p>{}</p>\n", escape(HOW.of(language))),
    );
    let mut metrics: Vec<String> = Vec::new();
    for other in others {
        let values = [
            ("first", first.name.as_str()),
            ("other", other.name.as_str()),
        ];
        body += &heading(&AGAINST.with(language, &values));
        let all = differences(first, other);
        let found: Vec<&Difference> = all.iter().filter(|one| !one.is_none()).collect();
        if found.is_empty() {
            put(
                &mut body,
                format_args!("<p>{}</p>\n", escape(NONE.of(language))),
            );
        } else {
            body += &table_of(language, scenario, &found, [&first.name, &other.name]);
        }
        for one in found {
            if !metrics.contains(&one.metric) {
                metrics.push(one.metric.clone());
            }
        }
    }
    for metric in &metrics {
        let (name, factor) = named(language, scenario, metric);
        let groups = variants.iter().map(|variant| {
            let values = variant.metrics.iter().filter_map(|run| run.get(metric));
            let values = values.map(|value| factor * value).collect();
            (variant.name.clone(), values)
        });
        let boxes = Boxes {
            x: name.clone(),
            groups: groups.collect(),
        };
        body += &figure(&boxes.svg(language), &name);
    }
    shell(language, &scenario.title, &scenario.name, &body)
}

/// How many of these runs of a variant passed.
fn passes(variant: &Variant, runs: usize) -> Vec<Cell> {
    let pass = variant.passes.iter().filter(|pass| **pass).count();
    let tone = match pass == runs {
        true => Tone::Good,
        false => Tone::Bad,
    };
    let count = Cell::text(&format!("{pass} / {runs}")).tone(tone);
    vec![Cell::text(&variant.name), count]
}

/// The metric's name with its step and unit, and the factor to that unit.
fn named(language: Language, scenario: &ScenarioFile, metric: &str) -> (String, f64) {
    match shown(language, scenario, metric) {
        None => (metric.to_owned(), 1.0),
        Some(known) if known.unit.is_empty() => (known.name, known.factor),
        Some(known) => (format!("{}, {}", known.name, known.unit), known.factor),
    }
}

fn table_of(
    language: Language,
    scenario: &ScenarioFile,
    found: &[&Difference],
    names: [&str; 2],
) -> String {
    let header = [
        METRIC.of(language),
        names[0],
        names[1],
        MEAN.of(language),
        INTERVAL.of(language),
        EFFECT.of(language),
        BETTER.of(language),
    ];
    let rows: Vec<Vec<Cell>> = found
        .iter()
        .map(|one| row(language, scenario, one))
        .collect();
    table(&header, &rows)
}

fn row(language: Language, scenario: &ScenarioFile, one: &Difference) -> Vec<Cell> {
    let (name, factor) = named(language, scenario, &one.metric);
    let figure = |value: f64| language.significant(factor * value, 3);
    let [low, high] = one.interval;
    let tone = match (one.is_clear(), one.better >= one.worse) {
        (false, _) => Tone::Plain,
        (true, true) => Tone::Good,
        (true, false) => Tone::Bad,
    };
    let name = match one.never {
        [0, 0] => name,
        [first, other] => {
            let [first, other] = [first, other].map(|count| count.to_string());
            let values = [("first", first.as_str()), ("other", other.as_str())];
            format!("{name} ({})", NEVER_IN.with(language, &values))
        }
    };
    vec![
        Cell::text(&name),
        Cell::text(&figure(one.medians[0])),
        Cell::text(&figure(one.medians[1])),
        Cell::text(&figure(one.mean)).tone(tone),
        Cell::text(&format!("{} … {}", figure(low), figure(high))),
        Cell::text(&language.number(one.effect, 2)),
        Cell::text(&format!("{} %", language.number(100.0 * one.better, 0))),
    ]
}
