//! What a tuning is for: `settling_s, overshoot_m < 0.01`.

use crate::files::{MetricBounds, ScenarioFile};
use crate::metrics::{self, Metrics, more_is_better};
use std::collections::BTreeMap;
use thiserror::Error;

/// Cost of what never happened, in units of what is to be made small.
const NEVER: f64 = 5.0;
/// Within this share of a limit a value costs as if it came near missing it: other robots may.
const MARGIN: f64 = 0.1;
/// Weight of a limit that is missed by all of its value.
const WEIGHT: f64 = 10.0;
/// Cost of every miss, however small.
const MISS: f64 = 5.0;

/// What is to be made small (or large, where more is better), and what must hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objective {
    /// Metrics; of a bare name the worst step or goal.
    pub aims: Vec<String>,
    /// Limits besides those of the scenario.
    pub limits: BTreeMap<String, MetricBounds>,
}

/// A text that is no objective.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ObjectiveError {
    /// A part is neither a metric nor a limit.
    #[error(
        "`{0}`: write metrics and limits with commas between them, e.g. \"settling_s, overshoot_m < 0.01\""
    )]
    Part(String),
    /// A limit has no number.
    #[error("`{0}`: its limit is not a number")]
    Number(String),
}

impl std::str::FromStr for Objective {
    type Err = ObjectiveError;

    fn from_str(text: &str) -> Result<Self, ObjectiveError> {
        let mut objective = Self::default();
        for part in text.split(',').map(str::trim) {
            let is_name = |name: &str| {
                let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.');
                !name.is_empty() && name.chars().all(is_part)
            };
            let Some(at) = part.find(['<', '>']) else {
                // Of `settling_s < 1,5` the comma made it a part.
                if !is_name(part) || part.parse::<f64>().is_ok() {
                    return Err(ObjectiveError::Part(part.to_owned()));
                }
                objective.aims.push(part.to_owned());
                continue;
            };
            let (name, limit) = part.split_at(at);
            let limit = limit[1..].trim_start_matches('=').trim();
            if !is_name(name.trim()) {
                return Err(ObjectiveError::Part(part.to_owned()));
            }
            let value = limit.parse::<f64>().ok().filter(|value| value.is_finite());
            let value = value.ok_or_else(|| ObjectiveError::Number(part.to_owned()))?;
            let bounds = objective.limits.entry(name.trim().to_owned()).or_default();
            match part.as_bytes()[at] {
                b'<' => bounds.max = Some(value),
                _ => bounds.min = Some(value),
            }
        }
        Ok(objective)
    }
}

impl Objective {
    /// The names of metrics that it needs.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let limits = self.limits.keys();
        self.aims.iter().chain(limits).map(String::as_str)
    }

    /// Whether a run keeps its own limits.
    #[must_use]
    pub fn admits(&self, run: &Metrics) -> bool {
        self.limits.iter().all(|(name, bounds)| {
            metrics::worst(run, name).is_some_and(|value| bounds.admit(value))
        })
    }

    /// The cost of a run: its aims, each as a multiple of `unit`, and what it misses of all limits.
    pub(super) fn cost(
        &self,
        scenario: &ScenarioFile,
        units: &[f64],
        run: &Metrics,
        pass: bool,
    ) -> f64 {
        let mut cost = 0.0;
        for (name, unit) in self.aims.iter().zip(units) {
            let value = metrics::worst(run, name).unwrap_or(f64::NAN);
            cost += match (value.is_finite(), more_is_better(name)) {
                (false, _) => NEVER,
                (true, false) => value / unit,
                (true, true) => -value / unit,
            };
        }
        let (mut missed, mut fullest) = (false, 0.0f64);
        for (name, bounds) in scenario.limits.iter().chain(&self.limits) {
            let value = metrics::worst(run, name).unwrap_or(f64::NAN);
            missed |= !bounds.admit(value);
            let used = use_of(bounds, value);
            fullest = fullest.max(used);
            cost += WEIGHT * (used - (1.0 - MARGIN)).max(0.0);
        }
        // Without an aim: as far from every limit as can be.
        if self.aims.is_empty() {
            cost += fullest;
        }
        // A fault, or a refusal, misses no limit.
        if missed || !pass {
            cost += MISS;
        }
        cost
    }
}

/// How much of what a limit allows a value uses: 1 at the limit, at most [`NEVER`].
fn use_of(bounds: &MetricBounds, value: f64) -> f64 {
    if value.is_nan() {
        return NEVER;
    }
    let above = bounds.max.map_or(0.0, |max| match max {
        max if max > 0.0 => value / max,
        max => 1.0 - MARGIN + (value - max).max(0.0),
    });
    let below = bounds.min.map_or(0.0, |min| match value {
        value if value > 0.0 && min > 0.0 => min / value,
        value => 1.0 - MARGIN + (min - value).max(0.0),
    });
    // A count that must be exactly reached is not near its limit.
    let whole =
        |limit: Option<f64>| limit.is_some_and(|limit| limit == value && limit.fract() == 0.0);
    match whole(bounds.max) || whole(bounds.min) {
        true => 0.0,
        false => above.max(below).clamp(0.0, NEVER),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Library;

    #[test]
    fn aims_and_limits_are_read_and_what_is_neither_is_named() {
        let objective: Objective = "settling_s, overshoot_m<= 0.01,clearance_m > 0.05"
            .parse()
            .unwrap();
        assert_eq!(objective.aims, ["settling_s"]);
        assert_eq!(objective.limits["overshoot_m"].max, Some(0.01));
        assert_eq!(objective.limits["clearance_m"].min, Some(0.05));
        for wrong in ["", "settling s", "settling_s,", "a < b", "< 3", "a < nan"] {
            assert!(wrong.parse::<Objective>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_worse_run_costs_more_and_what_never_happened_most() {
        let scenario = Library::new().scenario("mode1").unwrap();
        let objective: Objective = "settling_s, overshoot_m < 0.01".parse().unwrap();
        let run = |settling_s: f64, overshoot_m: f64| {
            let metric = |name: &str, value| (name.to_owned(), value);
            let of = |step: &str| {
                [
                    metric(&format!("{step}.settling_s"), settling_s),
                    metric(&format!("{step}.overshoot_m"), overshoot_m),
                    metric(&format!("{step}.steady_error_m"), 0.001),
                ]
            };
            let all = [of("step1"), of("step2")].concat();
            Metrics::from_iter([vec![metric("contacts", 0.0)], all].concat())
        };
        let cost = |settling_s, overshoot_m| {
            objective.cost(&scenario, &[1.0], &run(settling_s, overshoot_m), true)
        };
        let costs = [
            cost(0.8, 0.001),
            cost(0.9, 0.001),
            cost(0.9, 0.0079),
            cost(0.9, 0.009),
            cost(0.9, 0.02),
            cost(f64::NAN, 0.02),
        ];
        assert!(costs.is_sorted(), "{costs:?}");
        assert!(!objective.admits(&run(0.9, 0.02)) && objective.admits(&run(0.9, 0.009)));
    }
}
