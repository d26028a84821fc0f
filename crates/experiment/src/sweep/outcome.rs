//! What the runs of a sweep were like.

use super::SweepPlan;
use crate::compare::median;
use crate::files::ScenarioFile;
use crate::metrics::{self, Metrics, bare, more_is_better};
use crate::run::RunResult;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunRow {
    /// Index of its point.
    pub point: usize,
    /// Its seed.
    pub seed: u64,
    /// No limit was missed, and the robot refused nothing and reported no fault.
    #[serde(rename = "passed")]
    pub pass: bool,
    /// All metrics; not a number where what is measured never happened.
    #[serde(deserialize_with = "with_never")]
    pub metrics: Metrics,
}

/// JSON has no NaN: it is written as null.
fn with_never<'de, D: Deserializer<'de>>(from: D) -> Result<Metrics, D::Error> {
    let metrics = BTreeMap::<String, Option<f64>>::deserialize(from)?;
    let value = |(name, value): (String, Option<f64>)| (name, value.unwrap_or(f64::NAN));
    Ok(metrics.into_iter().map(value).collect())
}

impl RunRow {
    pub(super) fn of(point: usize, result: &RunResult) -> Self {
        Self {
            point,
            seed: result.seed,
            pass: result.pass,
            metrics: result.metrics.clone(),
        }
    }
}

/// The values of a metric at one point, over the seeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricSpread {
    /// The middle value; not a number where the measured event never happened in half of the runs.
    pub median: f64,
    /// One run in twenty is below.
    pub low: f64,
    /// One run in twenty is above.
    pub high: f64,
}

impl MetricSpread {
    /// Of these values; one that never happened is worse than all others. `None` of none.
    fn of(mut values: Vec<f64>, more_is_better: bool) -> Option<Self> {
        let never = match more_is_better {
            true => f64::NEG_INFINITY,
            false => f64::INFINITY,
        };
        for value in &mut values {
            if value.is_nan() {
                *value = never;
            }
        }
        values.sort_by(f64::total_cmp);
        let last = values.len().checked_sub(1)?;
        let known = |value: f64| if value.is_finite() { value } else { f64::NAN };
        let at = |share: f64| known(values[(share * last as f64).round() as usize]);
        Some(Self {
            median: known(median(&values)),
            low: at(0.05),
            high: at(0.95),
        })
    }
}

/// A value of a metric such that less is better; what never happened is worst.
fn badness(metric: &str, value: f64) -> f64 {
    match (value.is_nan(), more_is_better(metric)) {
        (true, _) => f64::INFINITY,
        (false, true) => -value,
        (false, false) => value,
    }
}

/// A sweep, or what is done of it.
#[derive(Clone, Debug)]
pub struct SweepOutcome {
    /// What was to be run.
    pub plan: SweepPlan,
    /// What was run: from the first on, without gaps.
    pub rows: Vec<RunRow>,
}

impl SweepOutcome {
    /// Names of the metrics, without their step or goal: those with a limit first.
    #[must_use]
    pub fn metrics(&self, scenario: &ScenarioFile) -> Vec<&str> {
        let all: BTreeSet<&str> = self
            .rows
            .iter()
            .flat_map(|row| row.metrics.keys())
            .map(|name| bare(name))
            .collect();
        let limits: BTreeSet<&str> = scenario.limits.keys().map(|name| bare(name)).collect();
        let (mut with, without): (Vec<&str>, Vec<&str>) =
            all.into_iter().partition(|name| limits.contains(name));
        with.extend(without);
        with
    }

    /// The runs of a point that are done.
    pub fn of_point(&self, point: usize) -> &[RunRow] {
        let runs = self.plan.runs as usize;
        let from = (point * runs).min(self.rows.len());
        &self.rows[from..(from + runs).min(self.rows.len())]
    }

    /// Points of which at least one run is done.
    #[must_use]
    pub fn points_done(&self) -> usize {
        self.rows.len().div_ceil(self.plan.runs as usize)
    }

    /// A metric over the runs of a point; of a bare name the worst step or goal of each run.
    #[must_use]
    pub fn spread(&self, point: usize, metric: &str) -> Option<MetricSpread> {
        self.spread_over(&[point], metric)
    }

    /// The same over the runs of several points.
    #[must_use]
    pub fn spread_over(&self, points: &[usize], metric: &str) -> Option<MetricSpread> {
        let rows = points.iter().flat_map(|point| self.of_point(*point));
        let values = rows.filter_map(|row| metrics::worst(&row.metrics, metric));
        MetricSpread::of(values.collect(), more_is_better(metric))
    }

    /// The share of a point's runs that pass.
    #[must_use]
    pub fn pass_share(&self, point: usize) -> f64 {
        let rows = self.of_point(point);
        let passed = rows.iter().filter(|row| row.pass).count();
        passed as f64 / rows.len().max(1) as f64
    }

    /// The points that were run, the best first: those with most runs that pass, among them by the median of a metric.
    #[must_use]
    pub fn ranked(&self, metric: &str) -> Vec<usize> {
        let key = |point: usize| {
            let median = self.spread(point, metric).map_or(f64::NAN, |s| s.median);
            (-self.pass_share(point), badness(metric, median))
        };
        let mut points: Vec<(usize, (f64, f64))> = (0..self.points_done())
            .map(|point| (point, key(point)))
            .collect();
        points.sort_by(|(_, one), (_, other)| {
            one.0.total_cmp(&other.0).then(one.1.total_cmp(&other.1))
        });
        points.into_iter().map(|(point, _)| point).collect()
    }

    /// The run of a point that is best or worst by a metric: one that does not pass is worse than one that does.
    #[must_use]
    pub fn extreme(&self, point: usize, metric: &str, worst: bool) -> Option<&RunRow> {
        let key = |row: &RunRow| {
            let value = metrics::worst(&row.metrics, metric).unwrap_or(f64::NAN);
            (!row.pass, badness(metric, value))
        };
        let order = |one: &&RunRow, other: &&RunRow| {
            let (one, other) = (key(one), key(other));
            one.0.cmp(&other.0).then(one.1.total_cmp(&other.1))
        };
        let rows = self.of_point(point).iter();
        match worst {
            true => rows.max_by(order),
            false => rows.min_by(order),
        }
    }
}
