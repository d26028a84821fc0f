//! What becomes of a run's results: those of several robots together, and the verdict by the limits of its scenario.

use super::RunResult;
use crate::files::{Setup, did_you_mean, near};
use crate::metrics::{self, Metrics};
use crate::note::Note;
use rumbo_sim::Sim;
use rumbo_sim::fleet::Fleet;

/// A sketch that misses more limits than this was made for something else.
const MANY: usize = 2;

/// The result, judged by the limits of its scenario.
pub(super) fn judged(setup: &Setup, mut whole: RunResult) -> RunResult {
    let scenario = &setup.scenario;
    whole.scenario.clone_from(&scenario.name);
    whole.path.clone_from(&scenario.path);
    // What its program could no longer do is not judged: the verdict suffices.
    if whole.ended.is_none() {
        whole.failures.extend(missed(setup, &whole));
    }
    let own = scenario.has_mode && setup.firmware.is_some() && !setup.takes_parameters();
    if own && whole.failures.len() > MANY {
        let text = format!(
            "scenario {} judges mode {}; a sketch that does something else runs in a scenario without mode and limits, \
             for instance `rumbo run free`",
            scenario.name,
            scenario.mode.name()
        );
        whole.notes.push(text.into());
    }
    whole.pass = whole.failures.is_empty();
    whole
}

/// The result of several robots: with the metrics of each and of each pair after their names, and of all.
pub(super) fn together(fleet: &Fleet, sims: &[Sim], robots: Vec<RunResult>) -> RunResult {
    let all = |what: fn(&RunResult) -> &[Note]| -> Vec<Note> {
        let named = robots.iter().flat_map(|robot| {
            what(robot).iter().map(|note| Note::Robot {
                name: robot.scenario.clone(),
                note: Box::new(note.clone()),
            })
        });
        named.collect()
    };
    let own = robots.iter();
    let own: Vec<_> = own
        .map(|robot| (robot.scenario.as_str(), &robot.metrics))
        .collect();
    RunResult {
        seed: robots.first().map_or(0, |first| first.seed),
        metrics: metrics::of_fleet(fleet, sims, &own),
        failures: all(|robot| &robot.failures),
        notes: all(|robot| &robot.notes),
        ended: robots.iter().find_map(|robot| robot.ended.clone()),
        robots,
        ..RunResult::default()
    }
}

/// The limits that a result misses.
fn missed(setup: &Setup, result: &RunResult) -> Vec<Note> {
    let metrics = &result.metrics;
    let mut failures = Vec::new();
    for (name, bounds) in &setup.scenario.limits {
        let why = match metrics.get(name) {
            Some(value) if bounds.admit(*value) => continue,
            Some(value) if value.is_finite() => format!(" = {value:.4}: limit {bounds}"),
            // The measured event did not happen.
            Some(_) => format!(" = never: limit {bounds}"),
            None if !result.drove() => format!(
                " = never: limit {bounds}; the robot was not armed, or its program drove no wheel"
            ),
            None => format!(
                ": this scenario has no such metric; {}",
                instead(name, metrics)
            ),
        };
        failures.push(Note::Limit {
            metric: name.clone(),
            why,
        });
    }
    failures
}

fn instead(name: &str, metrics: &Metrics) -> String {
    let known = || metrics.keys().map(String::as_str);
    match &near::near(name, known())[..] {
        [] => format!("it has {}", known().collect::<Vec<_>>().join(", ")),
        near => did_you_mean(&near.iter().map(ToString::to_string).collect::<Vec<_>>()),
    }
}
