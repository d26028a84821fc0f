//! Robots among what moves: movers of a world, and other robots.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use rumbo_control::Wheels;
use rumbo_experiment::files::{Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run, run_all_on};
use rumbo_plant::contact::{Footprint, Pose};
use rumbo_plant::world::Obstacle;
use rumbo_sim::Sim;
use rumbo_sim::fleet::{Encounter, Fleet, FleetError, Met};
use rumbo_sim::trace::Trace;
use rumbo_wire::Command;

/// Two who cross the way, and a goal behind them.
const CROSSING: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../examples/crossing/mode8-crossing.toml"
);

fn setup(scenario: &str, program: NativeProgram) -> Setup {
    let overrides = Overrides {
        program,
        ..Overrides::default()
    };
    Library::new().setup(scenario, &overrides).unwrap()
}

fn runs_on(threads: usize, setup: &Setup, seeds: std::ops::Range<u64>) -> Vec<RunResult> {
    let jobs: Vec<_> = seeds.map(|seed| (setup, seed)).collect();
    let mut results = Vec::new();
    run_all_on::<rumbo_experiment::files::FileError>(
        threads,
        &jobs,
        || Ok(()),
        |_, result| {
            results.push(result);
            Ok(())
        },
    )
    .unwrap();
    results
}

#[test]
fn movers_are_met_alike_on_any_number_of_threads_and_by_a_repetition() {
    let mut setup = setup(CROSSING, NativeProgram::Rumbo);
    setup.scenario.duration_s = 15.0;
    let one = runs_on(1, &setup, 1..4);
    // Metrics may be no numbers, which are not equal.
    let same = |one: &RunResult, other: &RunResult| one.trace == other.trace;
    let three = runs_on(3, &setup, 1..4);
    assert!(std::iter::zip(&one, &three).all(|(one, other)| same(one, other)));
    assert!(same(&one[2], &run(&setup, 3).unwrap()));
    // The world is empty but for them: what a sonar sees is one of the two.
    let sees = |run: &RunResult| {
        let mut samples = run.trace.samples.iter();
        samples.any(|sample| run.trace.range_m(sample, 2) < 1.0)
    };
    assert!(one.iter().all(sees));
    // Also while it stands itself.
    let trace = &one[0].trace;
    let each = trace.samples.iter().map(|sample| trace.range_m(sample, 2));
    assert!(each.eq(trace.samples.iter().map(trace.ranges_m(2))));
}

/// Ranges are measured when somebody asks for them, in the world as it was.
#[test]
fn what_a_sonar_saw_stays_so_when_a_hand_moves_the_wall() {
    let mut sim = setup("mode1", NativeProgram::Rumbo).sim(1).unwrap();
    let (mut trace, mut seen_m) = (Trace::default(), Vec::new());
    for tick in 1..=4_u64 {
        if tick == 3 {
            assert!(sim.shift(0, [0.3, 0.0]));
        }
        sim.advance(tick * 10_000);
        trace.sample(&sim);
        seen_m.push(sim.truth().range_m[2].unwrap());
    }
    let asked = trace.samples.iter().map(|sample| trace.range_m(sample, 2));
    assert_eq!(asked.collect::<Vec<_>>(), seen_m);
    let in_order = trace.samples.iter().map(trace.ranges_m(2));
    assert_eq!(in_order.collect::<Vec<_>>(), seen_m);
    assert!(seen_m[2] > seen_m[1] + 0.2, "{seen_m:?}");
}

/// The report's robot on its way ahead, from a pose.
fn ahead(seed: u64, x_m: f64, heading_rad: f64) -> Sim {
    let setup = setup("mode5", NativeProgram::Baseline);
    let mut config = setup.config(seed).unwrap();
    config.start = Pose {
        x_m,
        y_m: 0.0,
        heading_rad,
    };
    Sim::new(config).unwrap()
}

fn drive(robot: &mut Sim) {
    for command in [
        Command::WheelReference(Wheels {
            left: 6.0,
            right: 6.0,
        }),
        Command::Arm,
    ] {
        assert!(robot.order(command));
    }
}

/// Robots with what they are to each other.
#[derive(Clone)]
struct Together {
    fleet: Fleet,
    robots: Vec<Sim>,
}

impl Together {
    fn new(mut robots: Vec<Sim>) -> Result<Self, FleetError> {
        let fleet = Fleet::new(&mut robots)?;
        Ok(Self { fleet, robots })
    }

    fn advance(&mut self, until_us: u64) {
        self.fleet.advance(&mut self.robots, until_us);
    }

    fn encounters(&self, robot: usize) -> Vec<Encounter> {
        self.fleet.encounters(robot, &self.robots[robot])
    }
}

#[test]
fn a_fleet_of_one_is_the_single_run() {
    let mut single = ahead(3, 0.0, 0.0);
    let mut fleet = Together::new(vec![ahead(3, 0.0, 0.0)]).unwrap();
    drive(&mut single);
    drive(&mut fleet.robots[0]);
    for tick in 1..=500 {
        single.advance(tick * 10_000);
        fleet.advance(tick * 10_000);
        assert_eq!(single.truth(), fleet.robots[0].truth());
    }
    assert!(single.truth().pose.x_m > 0.5, "{:?}", single.truth());
}

#[test]
fn two_that_meet_head_on_touch_each_other_and_do_not_overlap() {
    let pi = std::f64::consts::PI;
    let mut fleet = Together::new(vec![ahead(1, 0.0, 0.0), ahead(2, 1.0, pi)]).unwrap();
    for robot in 0..2 {
        drive(&mut fleet.robots[robot]);
    }
    let front_m = |fleet: &Together| fleet.robots[0].truth().range_m[2];
    let before_m = front_m(&fleet);
    fleet.advance(6_000_000);
    for robot in 0..2 {
        let encounters = fleet.encounters(robot);
        let first = encounters.first().unwrap();
        assert_eq!(first.met, Met::Robot(1 - robot));
        assert!(first.speed_m_s > 0.1, "both drive: {encounters:?}");
    }
    assert!(fleet.fleet.closest_m(0, 1) < 1e-3);
    let [one, other] = &fleet.robots[..] else {
        panic!()
    };
    let apart_m = other.truth().pose.x_m - one.truth().pose.x_m;
    assert!(
        apart_m > 0.255,
        "each is 0.13 m long ahead of its axis: {apart_m}"
    );
    assert!(before_m.is_none_or(|before_m| before_m < 1.0));
}

#[test]
fn the_closest_approach_is_the_least_distance_at_any_millisecond() {
    // They pass each other, and meet nobody.
    let pi = std::f64::consts::PI;
    let mut other = setup("mode5", NativeProgram::Baseline).config(2).unwrap();
    other.start = Pose {
        x_m: 1.0,
        y_m: 0.4,
        heading_rad: 0.98 * pi,
    };
    let mut fleet = Together::new(vec![ahead(1, 0.0, 0.0), Sim::new(other).unwrap()]).unwrap();
    for robot in 0..2 {
        drive(&mut fleet.robots[robot]);
    }
    let outline = |robot: &Sim| {
        let params = robot.params();
        let footprint = Footprint::new(&params.body, &params.wheels);
        Obstacle::convex(&footprint.corners(&robot.truth().pose)).unwrap()
    };
    let mut least_m = f64::INFINITY;
    for ms in 1..=6_000 {
        fleet.advance(ms * 1_000);
        let [one, other] = &fleet.robots[..] else {
            panic!()
        };
        least_m = least_m.min(outline(one).apart_m(&outline(other)));
        let known_m = fleet.fleet.closest_m(0, 1);
        assert!(
            (known_m - least_m).abs() < 1e-12,
            "{ms} ms: {known_m} {least_m}"
        );
    }
    let [one, other] = &fleet.robots[..] else {
        panic!()
    };
    let last_m = outline(one).apart_m(&outline(other));
    assert!(least_m > 0.05 && least_m < 0.3, "{least_m}");
    assert!(last_m > least_m + 0.2, "{last_m}");
}

/// A program for a Mega in the final wiring: both motors forward, for good.
const AHEAD: &str = ":1400000008E100930101009302016B9A739A9D9AA59AFFCF82\n:00000001FF\n";

#[test]
fn two_emulated_megas_meet_the_same_way_each_time_and_from_a_snapshot() {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("ahead.hex");
    std::fs::write(&path, AHEAD).unwrap();
    let overrides = Overrides {
        rig: Some("final".into()),
        wiring: Some("final".into()),
        firmware: Some(path),
        ..Overrides::default()
    };
    let setup = Library::new().setup("free", &overrides).unwrap();
    let robot = |seed: u64, x_m: f64, heading_rad: f64| {
        let mut config = setup.config(seed).unwrap();
        config.start = Pose {
            x_m,
            heading_rad,
            ..Pose::default()
        };
        Sim::new(config).unwrap()
    };
    let pi = std::f64::consts::PI;
    let fleet = || Together::new(vec![robot(1, 0.0, 0.0), robot(2, 1.0, pi)]).unwrap();
    let (mut first, mut second) = (fleet(), fleet());
    first.advance(500_000);
    let mut snapshot = first.clone();
    for fleet in [&mut first, &mut second, &mut snapshot] {
        fleet.advance(3_000_000);
        assert_eq!(fleet.encounters(0)[0].met, Met::Robot(1));
        assert_eq!(fleet.encounters(1)[0].met, Met::Robot(0));
    }
    let truths = |fleet: &Together| [0, 1].map(|robot| fleet.robots[robot].truth());
    assert_eq!(truths(&first), truths(&second));
    assert_eq!(truths(&first), truths(&snapshot));
}

#[test]
fn the_order_of_the_robots_makes_no_difference() {
    let pi = std::f64::consts::PI;
    let places = [(1, 0.0, 0.0), (2, 0.7, pi), (3, -0.6, 0.0)];
    let truths = |order: [usize; 3]| {
        let robots = order.map(|index| {
            let (seed, x_m, heading_rad) = places[index];
            ahead(seed, x_m, heading_rad)
        });
        let mut fleet = Together::new(robots.to_vec()).unwrap();
        for robot in 0..3 {
            drive(&mut fleet.robots[robot]);
        }
        fleet.advance(4_000_000);
        let place = |robot: usize| order.iter().position(|index| *index == robot).unwrap();
        [0, 1, 2].map(|robot| fleet.robots[place(robot)].truth())
    };
    let forth = truths([0, 1, 2]);
    assert_eq!(forth, truths([2, 0, 1]));
    assert!(forth.iter().all(|truth| truth.contacts > 0), "{forth:?}");
}

#[test]
fn robots_inside_each_other_are_refused() {
    let error = Together::new(vec![
        ahead(1, 0.0, 0.0),
        ahead(2, 3.0, 0.0),
        ahead(3, 0.1, 1.0),
    ]);
    assert_eq!(error.map(drop), Err(FleetError::Inside(0, 2)));
}
