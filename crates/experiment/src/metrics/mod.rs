//! Metrics of a run: from ground truth and the signals at the pins, never from the robot's own estimates.
//!
//! Some are given for every run, some by the mode's description; each step of a reference has its own group, numbered
//! in the order of the scenario: `step1.settling_s`. Names end in their unit; docs/scenarios.md lists them all.

mod align;
mod curve;
mod fleet;
pub(crate) mod floor;
mod journey;
mod lane;
mod light;
mod mission;
mod path;
mod route;
mod start;
mod step;
mod straight;
mod wall;

pub(crate) use fleet::of_fleet;

use crate::files::Setup;
use rumbo_control::mode::MetricGroup;
use rumbo_sim::Sim;
use rumbo_sim::trace::Trace;
use rumbo_wire::FromRobot;
use std::collections::BTreeMap;

/// Metrics by name.
pub type Metrics = BTreeMap<String, f64>;

/// Metrics of which more is better; of all others less is.
const MORE_IS_BETTER: [&str; 8] = [
    "clearance_m",
    "contact_clearance_m",
    "cruise_m_s",
    "forward_m",
    "line_way_m",
    "reached",
    "straights",
    "telemetry_hz",
];

/// A metric's name without the step, goal or instant that it is of: `settling_s` of `step1.settling_s`.
#[must_use]
pub fn bare(name: &str) -> &str {
    name.split_once('.').map_or(name, |(_, bare)| bare)
}

/// Whether more of a metric is better.
#[must_use]
pub fn more_is_better(name: &str) -> bool {
    MORE_IS_BETTER.contains(&bare(name))
}

/// The metric of this name, or the worst of those with this bare name; not a number where one never happened, `None`
/// where a run has none.
#[must_use]
pub fn worst(metrics: &Metrics, name: &str) -> Option<f64> {
    if let Some(value) = metrics.get(name) {
        return Some(*value);
    }
    let more = more_is_better(name);
    let values = metrics.iter().filter(|(full, _)| bare(full) == name);
    values
        .map(|(_, value)| *value)
        .reduce(|worst, value| match worst.is_nan() || value.is_nan() {
            true => f64::NAN,
            false if more => worst.min(value),
            false => worst.max(value),
        })
}

/// All metrics of a run. Not a number where what is measured did not happen; of a robot that was never driven, those of
/// its mode are missing.
pub fn compute(setup: &Setup, sim: &Sim, trace: &Trace) -> Metrics {
    let mut metrics = Metrics::new();
    let duration_s = setup.scenario.duration_s;
    metrics.insert("contacts".into(), f64::from(sim.truth().contacts));
    metrics.insert("reverse_drive_rad_s".into(), sim.worst_reverse_rad_s());
    let frames = trace
        .messages
        .iter()
        .filter(|message| matches!(message.what, FromRobot::Telemetry(_)));
    metrics.insert("telemetry_hz".into(), frames.count() as f64 / duration_s);
    metrics.insert("control_period_s".into(), sim.control_period_s());
    floor::following(setup, trace, &mut metrics);
    light::seeking(setup, trace, &mut metrics);
    if trace.drove() {
        of_mode(setup, sim, trace, &mut metrics);
    }
    for value in metrics.values_mut() {
        *value = match value.is_finite() {
            // A billionth of any unit is rounding, not behaviour.
            true => (*value * 1e9).round() / 1e9 + 0.0,
            // Nothing to measure: no wall ahead, for instance.
            false => f64::NAN,
        };
    }
    metrics
}

fn of_mode(setup: &Setup, sim: &Sim, trace: &Trace, metrics: &mut Metrics) {
    let contact_m_s = sim.worst_contact_m_s();
    for group in setup.scenario.mode.description().metrics {
        match group {
            MetricGroup::DistanceSteps => step::distance_steps(setup, sim, trace, metrics),
            MetricGroup::SpeedSteps => step::speed_steps(setup, trace, metrics),
            MetricGroup::Alignment => align::aligning(setup, sim, trace, metrics),
            MetricGroup::Wall => wall::following(setup, sim, trace, metrics),
            MetricGroup::Movement => path::movement(setup, trace, metrics),
            MetricGroup::DeadZones => start::dead_zones(trace, metrics),
            MetricGroup::StaticCurve => curve::curve(setup, trace, metrics),
            MetricGroup::Drift => straight::drift(trace, metrics),
            MetricGroup::Route => route::route(setup, trace, metrics),
            MetricGroup::Goals => mission::mission(setup, contact_m_s, trace, metrics),
            MetricGroup::Journey => journey::journey(setup, contact_m_s, trace, metrics),
            MetricGroup::Lane => lane::lane(setup, trace, metrics),
        }
    }
}
