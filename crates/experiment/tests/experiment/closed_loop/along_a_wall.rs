//! Modes 3 and 4: requirements along a wall, at its end, before a corner, and with a sonar that fails.

use super::{Person, fault, seeds, setup, twenty, worst};
use rumbo_control::mode::ModeId;
use rumbo_control::{Fault, SonarId};
use rumbo_experiment::files::Setup;
use rumbo_experiment::note::Note;
use rumbo_experiment::run::RunResult;
use rumbo_plant::world::Wall;
use rumbo_sim::Sim;
use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};
use rumbo_wire::text::TextRow;
use rumbo_wire::{Command, FromRobot};

/// A scenario in a world of these walls, each from one point to another.
fn between(scenario: &str, walls_m: &[[[f64; 2]; 2]]) -> Setup {
    let mut setup = setup(scenario);
    setup.world.walls = walls_m
        .iter()
        .map(|[from_m, to_m]| Wall {
            from_m: *from_m,
            to_m: *to_m,
            thickness_m: 0.0,
        })
        .collect();
    setup
}

/// All runs stopped, touched nothing, and reported one of these faults as the cause.
fn assert_stopped(runs: &[RunResult], causes: &[Fault]) {
    for run in runs {
        let (name, seed) = (&run.scenario, run.seed);
        let cause = fault(run);
        assert!(
            cause.is_some_and(|cause| causes.contains(&cause)),
            "{name}, seed {seed}: {cause:?}"
        );
        assert_eq!(run.metrics["contacts"], 0.0, "{name}, seed {seed}");
        let last = run.trace.samples.last().unwrap();
        assert_eq!(last.duty, [0; 2], "{name}, seed {seed} drives on");
    }
}

#[test]
fn holds_the_distance_of_the_start_for_27_s_on_either_side_and_with_one_sonar() {
    for (scenario, share) in [("mode3", 1.0), ("mode3-right", 1.0), ("mode3-final", 1.5)] {
        let runs = twenty(scenario);
        assert!(
            worst(&runs, "distance_rms_m") <= 0.006 * share,
            "{scenario}"
        );
        assert!(
            worst(&runs, "distance_worst_m") <= 0.018 * share,
            "{scenario}"
        );
        assert_eq!(worst(&runs, "contacts"), 0.0, "{scenario}");
        assert!(runs.iter().all(|run| run.metrics["cruise_m_s"] >= 0.14));
    }
}

#[test]
fn goes_to_each_distance_of_the_report_in_half_its_time_and_hardly_beyond() {
    for (scenario, share) in [("mode4", 1.0), ("mode4-right", 1.0), ("mode4-final", 1.5)] {
        let runs = twenty(scenario);
        for (step, within_s) in [(1, 3.0), (2, 4.0), (3, 3.0)] {
            let metric = |name: &str| worst(&runs, &format!("step{step}.{name}"));
            assert!(
                metric("within_2cm_s") <= within_s * share,
                "{scenario}, step {step}"
            );
            assert!(
                metric("overshoot_m") <= 0.01 * share,
                "{scenario}, step {step}"
            );
        }
        assert_eq!(worst(&runs, "contacts"), 0.0, "{scenario}");
        assert!(runs.iter().all(|run| run.metrics["cruise_m_s"] >= 0.14));
    }
}

#[test]
fn a_start_10_degrees_askew_is_straightened_without_touching_the_wall() {
    for scenario in ["mode3", "mode3-right", "mode3-final"] {
        for askew_rad in [-0.17, 0.17] {
            let mut setup = setup(scenario);
            setup.scenario.start.heading_rad += askew_rad;
            let runs = seeds(&setup, 1..21);
            assert!(worst(&runs, "distance_rms_m") <= 0.012, "{scenario}");
            assert!(worst(&runs, "distance_worst_m") <= 0.06, "{scenario}");
            assert_eq!(worst(&runs, "contacts"), 0.0, "{scenario}");
        }
    }
}

#[test]
fn where_the_wall_ends_it_stops_and_reports_it() {
    for scenario in ["mode3", "mode4", "mode3-final", "mode4-final"] {
        let end = between(scenario, &[[[-0.8, 0.65], [1.5, 0.65]]]);
        let runs = seeds(&end, 1..21);
        assert_stopped(&runs, &[Fault::WallLost]);
        for run in &runs {
            let last = run.trace.samples.last().unwrap();
            assert!(last.x_m < 2.0, "{scenario} drove on to {} m", last.x_m);
            let heading_rad = last.heading_rad;
            assert!(
                heading_rad.abs() < 0.6,
                "{scenario} turned by {heading_rad} round the end"
            );
        }
    }
}

#[test]
fn a_gap_with_another_wall_behind_it_stops_it() {
    let walls_m = [
        [[-0.8, 0.65], [1.5, 0.65]],
        [[2.3, 0.65], [6.8, 0.65]],
        [[0.0, 1.4], [6.8, 1.4]],
    ];
    for scenario in ["mode3", "mode4", "mode3-final", "mode4-final"] {
        let runs = seeds(&between(scenario, &walls_m), 1..21);
        assert_stopped(
            &runs,
            &[Fault::WallLost, Fault::SonarStale, Fault::SonarFaulty],
        );
    }
}

#[test]
fn the_final_rig_stops_before_a_wall_across_its_way() {
    let walls_m = [[[-0.8, 0.65], [1.5, 0.65]], [[1.5, -1.0], [1.5, 0.65]]];
    for scenario in ["mode3-final", "mode4-final"] {
        let runs = seeds(&between(scenario, &walls_m), 1..21);
        assert_stopped(&runs, &[Fault::Blocked]);
        for run in &runs {
            let last = run.trace.samples.last().unwrap();
            let left_m = 1.5 - (last.x_m + 0.13);
            assert!((0.08..0.2).contains(&left_m), "{scenario}: {left_m}");
        }
    }
}

fn failing(scenario: &str, sonar: SonarId, at_s: f64, fault: SonarFault) -> Setup {
    let mut setup = setup(scenario);
    let timed = TimedSonarFault { at_s, sonar, fault };
    setup.scenario.sonar_faults.push(timed);
    setup
}

#[test]
fn a_sonar_cut_or_stuck_beside_the_wall_stops_it_within_a_second() {
    for (scenario, sonar) in [
        ("mode3", SonarId::Left),
        ("mode4", SonarId::Left),
        ("mode4", SonarId::Right),
        ("mode3-final", SonarId::Left),
        ("mode4-final", SonarId::Left),
    ] {
        for kind in [SonarFault::Cut, SonarFault::Stuck] {
            // On the straight, and on the way to another distance.
            for at_s in [5.0, 8.2] {
                let runs = seeds(&failing(scenario, sonar, at_s, kind), 1..11);
                assert_stopped(&runs, &[Fault::SonarFaulty]);
                for run in &runs {
                    let after = run.trace.between(at_s + 1.0, f64::INFINITY);
                    assert!(after.iter().all(|sample| sample.duty == [0; 2]));
                }
            }
        }
    }
}

#[test]
fn a_front_sonar_stuck_on_the_way_to_a_wall_stops_it() {
    let mut setup = between(
        "mode3-final",
        &[[[-0.8, 0.65], [2.5, 0.65]], [[2.5, -1.0], [2.5, 0.65]]],
    );
    let timed = TimedSonarFault {
        at_s: 5.0,
        sonar: SonarId::Front,
        fault: SonarFault::Stuck,
    };
    setup.scenario.sonar_faults.push(timed);
    assert_stopped(&seeds(&setup, 1..21), &[Fault::SonarFaulty]);
}

#[test]
fn a_spiking_sonar_slows_or_stops_it_and_never_leads_it_astray() {
    for (scenario, sonar) in [
        ("mode3", SonarId::Left),
        ("mode3", SonarId::Right),
        ("mode3-final", SonarId::Left),
        ("mode3-final", SonarId::Front),
    ] {
        let setup = failing(scenario, sonar, 5.0, SonarFault::Spiking(0.4));
        for run in seeds(&setup, 1..21) {
            let (seed, metrics) = (run.seed, &run.metrics);
            assert_eq!(metrics["contacts"], 0.0, "{scenario}, seed {seed}");
            assert!(
                metrics["distance_worst_m"] < 0.03,
                "{scenario}, seed {seed}"
            );
            assert!(
                metrics["cruise_m_s"] < 0.12,
                "{scenario}, seed {seed} drives on"
            );
        }
    }
}

#[test]
fn a_spiking_sonar_on_the_way_to_another_distance_never_leads_it_into_a_wall() {
    for (scenario, sonar) in [
        ("mode4", SonarId::Left),
        ("mode4-right", SonarId::Right),
        ("mode4-final", SonarId::Left),
    ] {
        // On the way from 50 to 30 cm.
        for run in seeds(
            &failing(scenario, sonar, 8.2, SonarFault::Spiking(0.4)),
            1..11,
        ) {
            let what = format!("{scenario}, seed {}", run.seed);
            assert_eq!(run.metrics["contacts"], 0.0, "{what}");
            let side = sonar as usize;
            let after = run.trace.between(8.2, f64::INFINITY);
            let least_m = after.iter().map(|sample| run.trace.range_m(sample, side));
            let least_m = least_m.fold(f64::INFINITY, f64::min);
            assert!(least_m > 0.2, "{what}: {least_m} m");
        }
    }
}

#[test]
fn a_distance_out_of_range_is_refused_and_the_robot_keeps_its_last_one() {
    let mut person = Person::at("mode4");
    person.wait_s(0.5);
    for command in [
        Command::Mode(ModeId::WallFollow),
        Command::Reference(0.45),
        Command::Arm,
    ] {
        person.command(command);
        person.wait_s(0.2);
    }
    for wrong in [-0.2, 0.05, f32::NAN, 3.0] {
        person.command(Command::Reference(wrong));
        let received = person.wait_s(0.3);
        let refused =
            |message: &FromRobot| matches!(message, FromRobot::Ack(ack) if ack.result.is_err());
        assert!(received.iter().any(refused), "{wrong}");
    }
    person.wait_s(5.0);
    let left_m = person.sim.truth().range_m[0].unwrap();
    assert!((left_m - 0.45).abs() < 0.01, "{left_m}");
}

#[test]
fn without_a_wall_beside_it_or_on_a_rig_that_looks_ahead_only_it_does_not_start() {
    let mut alone = between("mode3", &[]);
    let mut ahead = setup("mode4");
    ahead.scenario.rig = "front_pair".into();
    ahead.rig = ahead.robot.rigs["front_pair"];
    for setup in [&mut alone, &mut ahead] {
        setup.scenario.duration_s = 3.0;
        for run in seeds(setup, 1..4) {
            let is_refused = |note: &Note| matches!(note, Note::Refused { .. });
            assert!(run.failures.iter().any(is_refused));
            assert!(run.trace.samples.iter().all(|sample| sample.duty == [0; 2]));
        }
    }
}

/// The last complete line that the robot sent during this time.
fn last_line(sim: &mut Sim, seconds: f64) -> String {
    let mut bytes = Vec::new();
    sim.advance(sim.now_us() + (seconds * 1e6) as u64);
    sim.receive(&mut bytes);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let whole = text.rsplit_once('\n').unwrap_or_default().0;
    whole.rsplit('\n').next().unwrap().trim().to_owned()
}

#[test]
fn in_text_both_modes_send_the_rows_of_the_report_with_the_front_sonar_of_the_pair_as_the_left_one()
{
    for (mode, reference_cm) in [(3, 57.5), (4, 45.0)] {
        let mut sim = setup("mode3").sim(3).unwrap();
        last_line(&mut sim, 0.5);
        for line in [format!("MODE {mode}\n"), "REF 45\n".into(), "ON\n".into()] {
            sim.send(line.as_bytes());
            last_line(&mut sim, 0.3);
        }
        last_line(&mut sim, 0.5);
        // Mode 4 is on its way to the wall by now: the front one is nearer.
        let Ok(TextRow::Distance(row)) = TextRow::parse(&last_line(&mut sim, 0.4)) else {
            panic!("mode {mode}")
        };
        assert_eq!(row.mode, mode);
        assert!((row.reference_cm - reference_cm).abs() < 1.0, "{row:?}");
        assert!((50.0..59.0).contains(&row.left_cm), "{row:?}");
        assert!(row.pwm.left > 0 && row.pwm.right > 0, "{row:?}");
        if mode == 4 {
            assert!(row.left_cm < row.right_cm - 3.0, "{row:?}");
        }
    }
}
