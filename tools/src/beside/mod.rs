//! Mode 8 beside planners of the literature that know all ranges around them exactly, in the same random worlds.
//!
//! `cargo xtask campaign --only beside` builds and starts it. Arguments: `--seeds N` (1,000), `--write` (the table of
//! docs/theory/mission.md).

mod bugs;
mod disc;
mod histogram;

use crate::arguments::Arguments;
use crate::pages;
use bugs::{Bug2, DistBug, TangentBug};
use disc::{Outcome, Planner, TOP_M_S, drive};
use histogram::Histogram;
use rayon::prelude::*;
use rumbo_experiment::files::{FileError, Library, Overrides, Setup};
use rumbo_experiment::random_world::Journey;
use rumbo_experiment::run::{self, RunResult};
use std::process::ExitCode;

/// Who drives.
const NAMES: [&str; 5] = ["mode 8", "Bug2", "DistBug", "TangentBug", "VFH+"];

/// A planner that has just been started; none for mode 8.
fn planner(name: &str) -> Option<Box<dyn Planner>> {
    match name {
        "Bug2" => Some(Box::<Bug2>::default()),
        "DistBug" => Some(Box::<DistBug>::default()),
        "TangentBug" => Some(Box::<TangentBug>::default()),
        "VFH+" => Some(Box::<Histogram>::default()),
        _ => None,
    }
}

pub(crate) fn main() -> ExitCode {
    crate::ended("beside", compare().map(|()| true))
}

/// The runs in a seed's world, in order of [`NAMES`].
struct Runs {
    seed: u64,
    journey: Journey,
    outcomes: [Outcome; NAMES.len()],
}

fn compare() -> Result<(), FileError> {
    let args = Arguments::read(&["--seeds"], &["--write"], &[])?;
    let setup = Library::new().setup("mode8-random", &Overrides::default())?;
    let runs: Vec<Runs> = (1..1 + args.number("--seeds", 1_000))
        .into_par_iter()
        .map(|seed| runs_of(&setup, seed))
        .collect::<Result<_, _>>()?;
    let table = table(&runs);
    println!("{table}");
    if args.has("--write") {
        pages::write("docs/theory/mission.md", "beside", &table)?;
    }
    Ok(())
}

fn runs_of(setup: &Setup, seed: u64) -> Result<Runs, FileError> {
    let own = setup.of_seed(seed)?;
    let world = own.world.world();
    let world = world.map_err(|error| FileError::Setting(format!("mode8-random: {error}")))?;
    let start_m = [own.scenario.start.x_m, own.scenario.start.y_m];
    let journey = own.world.journey.clone().ok_or_else(|| {
        FileError::Setting("mode8-random: its world has no goal of its own".to_owned())
    })?;
    let mut outcomes = [Outcome::default(); NAMES.len()];
    for (outcome, name) in outcomes.iter_mut().zip(NAMES) {
        *outcome = match planner(name) {
            Some(mut planner) => drive(planner.as_mut(), &world, start_m, journey.goal_m),
            None => mode_8(&run::run(setup, seed)?),
        };
    }
    Ok(Runs {
        seed,
        journey,
        outcomes,
    })
}

fn mode_8(result: &RunResult) -> Outcome {
    let value = |name: &str| result.metrics.get(name).copied().unwrap_or(f64::NAN);
    Outcome {
        reached: value("reached") == 1.0,
        unreachable: value("unreachable_reported") == 1.0,
        touched: value("contacts") > 0.0,
        time_s: value("time_s"),
        way_m: value("path_m"),
    }
}

/// The score of the BARN challenge (Perille and others 2020): the time of the shortest way at top speed over that of the
/// run, of which no less than twice and no more than eight times the former counts; 0 where the goal was not reached.
fn score(outcome: &Outcome, shortest_m: f64) -> f64 {
    if !outcome.reached || outcome.touched {
        return 0.0;
    }
    let least_s = shortest_m / TOP_M_S;
    least_s / outcome.time_s.clamp(2.0 * least_s, 8.0 * least_s)
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn table(runs: &[Runs]) -> String {
    let mut table = String::from(
        "| | goals reached | unreachable: said, wrongly said | time | way over shortest | touches | score | mode 8 takes |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    let shortest_m = |runs: &Runs| runs.journey.shortest.as_ref().map(|path| path.length_m);
    let reachable: Vec<(&Runs, f64)> = runs
        .iter()
        .filter_map(|runs| Some((runs, shortest_m(runs)?)))
        .collect();
    let walled_in = runs.len() - reachable.len();
    for (index, name) in NAMES.iter().enumerate() {
        let of = |runs: &Runs| runs.outcomes[index];
        let reached = reachable.iter().filter(|(runs, _)| of(runs).reached);
        let both = reached.clone().filter(|(runs, _)| runs.outcomes[0].reached);
        let said = |reachable: bool| {
            let those = runs
                .iter()
                .filter(|runs| shortest_m(runs).is_some() == reachable);
            those.filter(|runs| of(runs).unreachable).count()
        };
        let scores: f64 = reachable
            .iter()
            .map(|(runs, shortest_m)| score(&of(runs), *shortest_m))
            .sum();
        let blocked = reached.clone().filter(|(runs, _)| runs.journey.blocked);
        let ratio = |one: fn(&Outcome) -> f64| {
            median(
                both.clone()
                    .map(|(runs, _)| one(&runs.outcomes[0]) / one(&of(runs))),
            )
        };
        table += &format!(
            "| {name} | {} of {} | {} of {walled_in}, {} | {:.1} s | {:.2} | {} | {:.3} | {:.2} x time, {:.2} x way |\n",
            reached.clone().count(),
            reachable.len(),
            said(false),
            said(true),
            median(reached.clone().map(|(runs, _)| of(runs).time_s)),
            median(blocked.map(|(runs, shortest_m)| of(runs).way_m / shortest_m)),
            runs.iter().filter(|runs| of(runs).touched).count(),
            scores / reachable.len() as f64,
            ratio(|outcome| outcome.time_s),
            ratio(|outcome| outcome.way_m),
        );
    }
    let lost: Vec<String> = reachable
        .iter()
        .filter(|(runs, _)| runs.outcomes.iter().all(|outcome| !outcome.reached))
        .map(|(runs, _)| runs.seed.to_string())
        .collect();
    if !lost.is_empty() {
        table += &format!("\nReached by none: {}.\n", lost.join(", "));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_plant::world::{Block, Wall, World};

    const START: [f64; 2] = [0.0, 0.0];
    const GOAL: [f64; 2] = [3.0, 0.0];

    fn planners() -> impl Iterator<Item = (&'static str, Box<dyn Planner>)> {
        NAMES
            .into_iter()
            .filter_map(|name| Some((name, planner(name)?)))
    }

    fn block(center_m: [f64; 2], size_m: [f64; 2]) -> Block {
        Block {
            center_m,
            size_m,
            heading_rad: 0.3,
        }
    }

    #[test]
    fn on_an_empty_floor_each_goes_straight_at_top_speed() {
        for (name, mut planner) in planners() {
            let outcome = drive(planner.as_mut(), &World::empty(), START, GOAL);
            assert!(
                outcome.reached && outcome.way_m < 3.001,
                "{name} {outcome:?}"
            );
            let score = score(&outcome, 3.0);
            assert!(score == 0.5, "{name} {score}");
        }
    }

    #[test]
    fn each_gets_around_a_box_without_a_touch() {
        let world = World::new(&[], &[block([1.5, 0.1], [0.4, 0.8])]).expect("a world");
        for (name, mut planner) in planners() {
            let outcome = drive(planner.as_mut(), &world, START, GOAL);
            assert!(outcome.reached && !outcome.touched, "{name} {outcome:?}");
            assert!(
                outcome.way_m > 3.02 && outcome.way_m < 4.4,
                "{name} {outcome:?}"
            );
        }
    }

    #[test]
    fn only_the_bugs_say_that_a_goal_inside_a_box_has_no_way() {
        let world = World::new(&[], &[block(GOAL, [0.8, 0.8])]).expect("a world");
        for (name, mut planner) in planners() {
            let outcome = drive(planner.as_mut(), &world, START, GOAL);
            assert!(!outcome.reached, "{name} {outcome:?}");
            assert_eq!(outcome.unreachable, name != "VFH+", "{name} {outcome:?}");
        }
    }

    #[test]
    fn a_pocket_keeps_the_histogram_and_lets_the_bugs_out() {
        let wall = |from_m: [f64; 2], to_m: [f64; 2]| Wall {
            from_m,
            to_m,
            thickness_m: 0.05,
        };
        let walls = [
            wall([2.0, -0.6], [2.0, 0.6]),
            wall([1.0, 0.6], [2.0, 0.6]),
            wall([1.0, -0.6], [2.0, -0.6]),
        ];
        let world = World::new(&walls, &[]).expect("a world");
        for (name, mut planner) in planners() {
            let outcome = drive(planner.as_mut(), &world, START, GOAL);
            assert_eq!(outcome.reached, name != "VFH+", "{name} {outcome:?}");
        }
    }

    #[test]
    fn the_score_is_zero_with_a_touch_and_counts_no_more_than_eight_times_the_least_time() {
        let outcome = Outcome {
            reached: true,
            time_s: 1_000.0,
            ..Outcome::default()
        };
        assert_eq!(score(&outcome, 2.0), 0.125);
        let touched = Outcome {
            touched: true,
            ..outcome
        };
        assert_eq!(score(&touched, 2.0), 0.0);
    }
}
