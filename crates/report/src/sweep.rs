//! The page of a sweep: each metric over each parameter, heat maps, parallel coordinates, the best and the worst points.

mod plots;

use crate::judge;
use crate::metric_names::{Shown, bare};
use crate::summary::{heading, shell};
use crate::table::{Cell, Tone, table};
use crate::text::{Language, Text, escape, put, with_unit, word};
use rumbo_experiment::compare::median;
use rumbo_experiment::files::ScenarioFile;
use rumbo_experiment::metrics;
use rumbo_experiment::sweep::{Axis, RunRow, SweepOutcome};
use std::collections::BTreeMap;

const RESULT: Text = word("sweep-result");
const UNFINISHED: Text = word("sweep-unfinished");
const BEST: Text = word("best-points");
const WORST: Text = word("worst-points");
const PASS: Text = word("runs-that-pass");
const BEST_RUN: Text = word("best-run");
const WORST_RUN: Text = word("worst-run");
const RANKED: Text = word("ranked-by");
const REPLAY: Text = word("how-to-replay");
const MISSED: Text = word("missed-limits");

/// Points in the tables of the best and of the worst.
pub const SHOWN: usize = 5;

/// What the page is made of.
#[derive(Clone, Copy, Debug)]
pub struct Page<'a> {
    /// The sweep.
    pub sweep: &'a SweepOutcome,
    /// Its scenario.
    pub scenario: &'a ScenarioFile,
    /// The metric that ranks.
    pub by: &'a str,
    /// Addresses of the logs of runs that were kept, by point and seed.
    pub logs: &'a BTreeMap<(usize, u64), String>,
}

impl Page<'_> {
    /// The page.
    #[must_use]
    pub fn html(&self, language: Language) -> String {
        let mut body = self.facts(language);
        let ranked = self.sweep.ranked(self.by);
        let best = &ranked[..SHOWN.min(ranked.len())];
        let rest = &ranked[best.len()..];
        let worst: Vec<usize> = rest.iter().rev().take(SHOWN).copied().collect();
        body += &heading(BEST.of(language));
        let name = self.name(language, self.by);
        put(
            &mut body,
            format_args!(
                "<p>{}</p>\n",
                escape(&RANKED.with(language, &[("metric", &name)]))
            ),
        );
        body += &self.points(language, best);
        if !worst.is_empty() {
            body += &heading(WORST.of(language));
            body += &self.points(language, &worst);
        }
        put(
            &mut body,
            format_args!("<p>{}</p>\n", crate::text::quoted(REPLAY.of(language))),
        );
        body += &self.curves(language);
        body += &self.heats(language);
        body += &self.parallel(language, &ranked);
        let title = self.scenario.title.replace("->", "→");
        shell(language, &title, &self.subtitle(), &body)
    }

    fn subtitle(&self) -> String {
        let names = self.sweep.plan.axes.iter().map(|axis| axis.name.as_str());
        let names: Vec<&str> = names.collect();
        format!("{}: {}", self.scenario.name, names.join(", "))
    }

    fn facts(&self, language: Language) -> String {
        let (sweep, plan) = (self.sweep, &self.sweep.plan);
        let passed = sweep.rows.iter().filter(|row| row.pass).count();
        let values = [
            ("points", plan.points.len().to_string()),
            ("runs", sweep.rows.len().to_string()),
            ("each", plan.runs.to_string()),
            ("seed", plan.seed.to_string()),
            ("pass", passed.to_string()),
        ];
        let mut body = format!("<p>{}</p>\n", escape(&RESULT.with(language, &values)));
        if sweep.rows.len() < plan.len() {
            let [done, all] = [sweep.rows.len(), plan.len()].map(|count| count.to_string());
            let text = UNFINISHED.with(language, &[("done", &done), ("all", &all)]);
            put(
                &mut body,
                format_args!("<div class=\"note\"><p>{}</p></div>\n", escape(&text)),
            );
        }
        body
    }

    /// Whether some runs pass and some do not.
    fn pass_varies(&self) -> bool {
        let mut rows = self.sweep.rows.iter();
        let first = rows.next().map(|row| row.pass);
        rows.any(|row| Some(row.pass) != first)
    }

    /// Whether a metric is not the same in all runs.
    fn varies(&self, metric: &str) -> bool {
        let rows = self.sweep.rows.iter();
        let mut values = rows.map(|row| metrics::worst(&row.metrics, metric).map(f64::to_bits));
        let first = values.next();
        values.any(|value| Some(value) != first)
    }

    /// Names of metrics with a limit that vary.
    fn limited(&self) -> Vec<&str> {
        let has_limit = |name: &&str| {
            let mut limits = self.scenario.limits.keys();
            limits.any(|limit| metrics::bare(limit) == *name)
        };
        let all = self.sweep.metrics(self.scenario);
        let shown = all.into_iter().filter(has_limit);
        let mut limited: Vec<&str> = shown.filter(|metric| self.varies(metric)).collect();
        if !limited.contains(&self.by) {
            limited.insert(0, self.by);
        }
        limited
    }

    fn shown(&self, language: Language, metric: &str) -> Shown {
        bare(language, metrics::bare(metric)).unwrap_or_else(|| Shown {
            name: metric.to_owned(),
            ..judge::plain("")
        })
    }

    /// With its unit.
    fn name(&self, language: Language, metric: &str) -> String {
        let shown = self.shown(language, metric);
        match shown.unit {
            "" => shown.name,
            unit => format!("{}, {unit}", shown.name),
        }
    }

    /// A table of points with their values, metrics and runs.
    fn points(&self, language: Language, points: &[usize]) -> String {
        let limited = self.limited();
        let names: Vec<String> = limited
            .iter()
            .map(|metric| self.shown(language, metric).name)
            .collect();
        let axes = &self.sweep.plan.axes;
        let mut header: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
        header.extend([PASS, MISSED].map(|text| text.of(language)));
        header.extend(names.iter().map(String::as_str));
        header.extend([BEST_RUN.of(language), WORST_RUN.of(language)]);
        let row = |point: &usize| {
            let values = self.sweep.plan.points[*point].iter().zip(axes);
            let mut row: Vec<Cell> = values
                .map(|(value, axis)| Cell::text(&value_of(language, axis, *value)))
                .collect();
            let share = self.sweep.pass_share(*point);
            let tone = if share >= 1.0 { Tone::Good } else { Tone::Bad };
            let percent = with_unit(language.number(100.0 * share, 0), "%");
            row.push(Cell::text(&percent).tone(tone));
            row.push(Cell::text(&self.missed(language, *point)));
            for metric in &limited {
                let shown = self.shown(language, metric);
                let spread = self.sweep.spread(*point, metric);
                let median = spread.map_or(f64::NAN, |spread| spread.median);
                row.push(Cell::text(&judge::value(language, &shown, median)));
            }
            for worst in [false, true] {
                let run = self.sweep.extreme(*point, self.by, worst);
                row.push(run.map_or_else(|| Cell::text("–"), |run| self.run(run)));
            }
            row
        };
        table(&header, &points.iter().map(row).collect::<Vec<_>>())
    }

    /// The limits that runs of a point miss, each with the share of them and the median of what they had.
    fn missed(&self, language: Language, point: usize) -> String {
        let runs = || self.sweep.rows.iter().filter(|row| row.point == point);
        let missed = self.scenario.limits.iter().filter_map(|(key, limit)| {
            let values = runs().map(|run| run.metrics.get(key).copied().unwrap_or(f64::NAN));
            let beyond: Vec<f64> = values.filter(|value| !limit.admit(*value)).collect();
            if beyond.is_empty() {
                return None;
            }
            let shown = self.shown(language, key);
            Some(format!(
                "{}{}: {}, {} ({}/{})",
                key.strip_suffix(metrics::bare(key))
                    .unwrap_or_default()
                    .replace('.', ": "),
                shown.name,
                judge::value(language, &shown, median(&beyond)),
                judge::bounds(language, &shown, *limit),
                beyond.len(),
                runs().count()
            ))
        });
        missed.collect::<Vec<_>>().join("; ")
    }

    /// A run, linked to its log.
    fn run(&self, row: &RunRow) -> Cell {
        match self.logs.get(&(row.point, row.seed)) {
            Some(log) => Cell::html(format!("<a href=\"{}\">{}</a>", escape(log), row.seed)),
            None => Cell::text(&row.seed.to_string()),
        }
    }
}

/// The value of a parameter: of a switch or a choice its name.
fn value_of(language: Language, axis: &Axis, value: f64) -> String {
    match axis.name_of(value) {
        Some(name) => name.to_owned(),
        None => language.significant(value, 4),
    }
}
