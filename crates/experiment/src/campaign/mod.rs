//! Large sets of runs and their joint requirements: every scenario over many seeds, and mode 8 over many random worlds.
//!
//! A run of a scenario passes or fails by the limits in its file. Required of many runs are the share that passes, that
//! nothing is touched, and for random worlds the share of goals reached and the length of the paths relative to the
//! shortest ones. `cargo xtask campaign` prints this for thousands of seeds; a test judges a sample in the same way.

mod failure;
pub mod faults;
pub mod moving;

use crate::files::{FileError, Kind, Library, Overrides, Setup};
use crate::metrics::Metrics;
use crate::run::{self, RunResult};
use rumbo_control::mode::ModeId;
use rumbo_sim::trace::Trace;

/// Share of the seeds that must pass a scenario's limits.
const PASS: f64 = 0.99;
/// Share of the reachable goals that must be reached.
const REACHED: f64 = 0.98;
/// Share of the goals that a policy must reach: 85 % by floats, of which integers may lose 3 points.
const POLICY: f64 = 0.82;
/// Largest median of path over shortest path, in worlds that block the straight line.
const RATIO_MEDIAN: f64 = 1.3;
/// The same for the 95th percentile.
const RATIO_95: f64 = 2.2;
/// Share of the random worlds in which something may be touched.
const CONTACTS: f64 = 0.005;
/// Fastest touch allowed there [m/s].
const CONTACT_M_S: f64 = 0.1;
/// Time within which a goal that cannot be reached must be called so [s].
const UNREACHABLE_S: f64 = 180.0;
/// Share of the random worlds that must block the straight line, so that the other figures are meaningful.
const BLOCKED: f64 = 0.7;

/// A requirement on many runs, and its result.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// What is measured.
    pub what: String,
    /// The requirement; empty for figures that are only reported.
    pub required: String,
    /// The result of the runs.
    pub measured: String,
    /// The requirement is met.
    pub met: bool,
}

impl Requirement {
    fn new(
        what: impl Into<String>,
        required: impl Into<String>,
        measured: impl Into<String>,
        met: bool,
    ) -> Self {
        Self {
            what: what.into(),
            required: required.into(),
            measured: measured.into(),
            met,
        }
    }
}

/// Runs built-in scenarios with seeds from 1 to `seeds` and judges them, one after the other; all scenarios where `only` is empty.
///
/// # Errors
/// A name in `only` that is none, or a setup that does not fit together.
pub fn campaign(
    seeds: u64,
    only: &[String],
    mut found: impl FnMut(Requirement),
) -> Result<(), FileError> {
    let library = Library::new();
    let names = if only.is_empty() {
        library.list(Kind::Scenario)
    } else {
        only.to_vec()
    };
    let setups: Vec<Setup> = names
        .iter()
        .map(|name| library.setup(name, &Overrides::default()))
        .collect::<Result<_, _>>()?;
    for setup in &setups {
        let jobs: Vec<_> = (1..=seeds).map(|seed| (setup, seed)).collect();
        let mut results = Vec::new();
        run::run_all(&jobs, |_, mut result| {
            // A thousand traces would fill the memory.
            result.trace = Trace::default();
            results.push(result);
            Ok::<(), FileError>(())
        })?;
        judge(setup, &results).into_iter().for_each(&mut found);
    }
    Ok(())
}

/// Summary of the runs of a scenario.
#[must_use]
pub fn judge(setup: &Setup, results: &[RunResult]) -> Vec<Requirement> {
    if setup.scenario.mode == ModeId::Policy {
        vec![judge_policy(setup, results)]
    } else if setup.world.random.is_some() {
        let mut findings = vec![judge_limits(setup, results)];
        let metrics: Vec<&Metrics> = results.iter().map(|result| &result.metrics).collect();
        findings.extend(
            judge_worlds(&metrics)
                .into_iter()
                .map(|finding| Requirement {
                    what: format!("{}: {}", setup.scenario.name, finding.what),
                    ..finding
                }),
        );
        findings
    } else {
        vec![judge_limits(setup, results)]
    }
}

/// Share of the goals reached in time, without a hard contact or a fault.
fn judge_policy(setup: &Setup, results: &[RunResult]) -> Requirement {
    let value = |result: &RunResult, name: &str| result.metrics.get(name).copied();
    let arrives = |result: &&RunResult| {
        value(result, "reached") == Some(1.0)
            && value(result, "contact_speed_m_s").is_some_and(|fastest| fastest <= CONTACT_M_S)
    };
    let arrived = results.iter().filter(arrives).count();
    Requirement::new(
        setup.scenario.name.clone(),
        format!(
            "{} reach the goal, no contact above {CONTACT_M_S} m/s",
            percent(POLICY)
        ),
        share_of(arrived, results.len()),
        arrived as f64 >= POLICY * results.len() as f64,
    )
}

/// Limits of the file, and no touch in modes that have no obstacles to look for.
fn judge_limits(setup: &Setup, results: &[RunResult]) -> Requirement {
    let passed = results.iter().filter(|result| result.pass).count();
    let touched = results
        .iter()
        .filter(|result| {
            result
                .metrics
                .get("contacts")
                .is_some_and(|count| *count > 0.0)
        })
        .count();
    let untouched = setup.scenario.mode != ModeId::Mission;
    let mut required = format!("{} pass", percent(PASS));
    let mut measured = share_of(passed, results.len());
    if untouched {
        required += ", none touches";
        if touched > 0 {
            measured += &format!(", {touched} touch something");
        }
    }
    if let Some(failed) = results.iter().find(|result| !result.pass) {
        measured += &format!("; first failure seed {}: ", failed.seed);
        measured.extend(failed.failures.first().map(ToString::to_string));
    }
    let met = passed as f64 >= PASS * results.len() as f64 && !(untouched && touched > 0);
    Requirement::new(setup.scenario.name.clone(), required, measured, met)
}

/// Summary of runs in random worlds, by their metrics.
#[must_use]
pub fn judge_worlds(runs: &[&Metrics]) -> Vec<Requirement> {
    let value = |run: &Metrics, name: &str| run.get(name).copied().unwrap_or(f64::NAN);
    let is = |run: &Metrics, name: &str| value(run, name) == 1.0;
    let part = |of: &[&Metrics], name: &str| of.iter().filter(|run| is(run, name)).count();
    let (reachable, walled_in): (Vec<&Metrics>, Vec<&Metrics>) =
        runs.iter().partition(|run| is(run, "reachable"));
    let reached = part(&reachable, "reached");
    let given_up = part(&reachable, "given_up_wrongly");
    let blocked = part(runs, "blocked");
    let touched: Vec<_> = runs
        .iter()
        .filter(|run| value(run, "contacts") > 0.0)
        .collect();
    let fastest_m_s = touched
        .iter()
        .map(|run| value(run, "contact_speed_m_s"))
        .fold(0.0, f64::max);
    let in_time = walled_in
        .iter()
        .filter(|run| is(run, "unreachable_reported") || is(run, "gave_up"))
        .filter(|run| value(run, "time_s") <= UNREACHABLE_S)
        .count();
    let at_least = |share: f64| format!("at least {}", percent(share));
    let [median, high] = ways(&reachable);
    vec![
        Requirement::new(
            "worlds that block the straight line",
            at_least(BLOCKED),
            share_of(blocked, runs.len()),
            blocked as f64 >= BLOCKED * runs.len() as f64,
        ),
        Requirement::new(
            "goals reached of those that can be",
            at_least(REACHED),
            share_of(reached, reachable.len()),
            reached as f64 >= REACHED * reachable.len() as f64,
        ),
        Requirement::new("of the others: given up", "", given_up.to_string(), true),
        median,
        high,
        Requirement::new(
            "runs that touch something",
            format!("at most {}", percent(CONTACTS)),
            share_of(touched.len(), runs.len()),
            touched.len() as f64 <= CONTACTS * runs.len() as f64,
        ),
        Requirement::new(
            "fastest touch",
            format!("below {CONTACT_M_S} m/s"),
            format!("{fastest_m_s:.3} m/s"),
            fastest_m_s < CONTACT_M_S,
        ),
        Requirement::new(
            "unreachable goals given up within 180 s",
            "all",
            format!("{in_time} of {}", walled_in.len()),
            in_time == walled_in.len(),
        ),
    ]
}

/// The way driven over the shortest one, of goals that can be reached but not straight on: median and 95th percentile.
fn ways(reachable: &[&Metrics]) -> [Requirement; 2] {
    let blocked = reachable
        .iter()
        .filter(|run| run.get("blocked") == Some(&1.0));
    // A goal that was not reached counts as an infinite path.
    let mut ratios: Vec<f64> = blocked
        .map(|run| run.get("path_ratio").copied().unwrap_or(f64::INFINITY))
        .collect();
    ratios.sort_by(f64::total_cmp);
    [
        (
            "path over shortest path where blocked, median",
            0.5,
            RATIO_MEDIAN,
        ),
        ("the same, 95th percentile", 0.95, RATIO_95),
    ]
    .map(|(what, share, most)| {
        let ratio = quantile(&ratios, share);
        let required = format!("at most {most}");
        Requirement::new(what, required, format!("{ratio:.3}"), ratio <= most)
    })
}

/// The smallest value that at least this share of the sorted values does not exceed.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let rank = (share * sorted.len() as f64).ceil().max(1.0) as usize;
    sorted.get(rank - 1).copied().unwrap_or(f64::NAN)
}

fn percent(share: f64) -> String {
    format!("{} %", (1000.0 * share).round() / 10.0)
}

fn share_of(count: usize, all: usize) -> String {
    format!(
        "{} ({count} of {all})",
        percent(count as f64 / all.max(1) as f64)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run in a random world that blocks the straight line.
    fn run(values: &[(&str, f64)]) -> Metrics {
        let usual = [
            ("blocked", 1.0),
            ("contacts", 0.0),
            ("contact_speed_m_s", 0.0),
            ("reachable", 1.0),
            ("reached", 1.0),
            ("path_ratio", 1.1),
            ("unreachable_reported", 0.0),
            ("time_s", 30.0),
        ];
        let all = usual.iter().chain(values);
        all.map(|(name, value)| ((*name).to_owned(), *value))
            .collect()
    }

    /// Which requirements a hundred good runs and these miss.
    fn missed(others: &[Metrics]) -> Vec<String> {
        let good = run(&[]);
        let runs: Vec<&Metrics> = std::iter::repeat_n(&good, 100).chain(others).collect();
        let findings = judge_worlds(&runs).into_iter();
        findings
            .filter(|finding| !finding.met)
            .map(|finding| finding.what)
            .collect()
    }

    #[test]
    fn good_runs_miss_nothing() {
        assert_eq!(missed(&[]), [""; 0]);
    }

    #[test]
    fn a_goal_not_reached_counts_as_a_way_without_end() {
        let mut lost = run(&[("reached", 0.0)]);
        lost.remove("path_ratio");
        assert_eq!(missed(&[lost.clone()]), [""; 0], "one of a hundred");
        let tenth = vec![lost; 10];
        assert_eq!(
            missed(&tenth),
            [
                "goals reached of those that can be",
                "the same, 95th percentile"
            ]
        );
    }

    #[test]
    fn one_fast_touch_and_one_goal_driven_at_for_ever_are_too_many() {
        let touch = run(&[("contacts", 1.0), ("contact_speed_m_s", 0.2)]);
        assert_eq!(
            missed(&[touch]),
            ["runs that touch something", "fastest touch"]
        );
        let never = run(&[("reachable", 0.0), ("reached", 0.0), ("time_s", f64::NAN)]);
        assert_eq!(
            missed(&[never]),
            ["unreachable goals given up within 180 s"]
        );
        let late = run(&[
            ("reachable", 0.0),
            ("unreachable_reported", 1.0),
            ("time_s", 181.0),
        ]);
        assert_eq!(missed(&[late]), ["unreachable goals given up within 180 s"]);
    }

    #[test]
    fn quantiles_are_values_that_occurred() {
        let values: Vec<f64> = (1..=20).map(f64::from).collect();
        assert_eq!(quantile(&values, 0.5), 10.0);
        assert_eq!(quantile(&values, 0.95), 19.0);
        assert!(quantile(&[], 0.5).is_nan());
    }
}
