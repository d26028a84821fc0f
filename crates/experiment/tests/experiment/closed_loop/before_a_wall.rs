//! Modes 1 and 2: requirements before a wall, on each rig, and with a sonar that fails.

use super::{Person, fault, seeds, setup, twenty, worst};
use rumbo_control::mode::ModeId;
use rumbo_control::{Fault, SonarId};
use rumbo_experiment::files::Setup;
use rumbo_experiment::note::Note;
use rumbo_plant::world::Block;
use rumbo_sim::sonar_fault::{SonarFault, TimedSonarFault};
use rumbo_wire::{Command, FrameMessage, FromRobot, Refusal, ToRobot};

const TWO_DEGREES: f64 = 0.0349;

#[test]
fn stands_square_to_the_wall_at_each_distance_of_the_report() {
    for (scenario, share) in [("mode2", 1.0), ("mode2-final", 1.5)] {
        let runs = twenty(scenario);
        let worst = |metric: &str| worst(&runs, metric);
        assert!(worst("step1.settling_s") <= 2.6 * share, "{scenario}");
        assert!(worst("step3.within_2cm_s") <= 2.0 * share, "{scenario}");
        assert!(worst("step3.overshoot_m") <= 0.01 * share, "{scenario}");
        for step in 1..=4 {
            let steady_m = worst(&format!("step{step}.steady_error_m"));
            assert!(steady_m <= 0.005 * share, "{scenario}, step {step}");
            let angle_rad = worst(&format!("step{step}.angle_rad"));
            assert!(angle_rad <= TWO_DEGREES * share, "{scenario}, step {step}");
        }
        assert_eq!(worst("contacts"), 0.0, "{scenario}");
    }
}

#[test]
fn starts_30_degrees_askew_to_either_side_and_ends_square() {
    for scenario in ["mode2", "mode2-final"] {
        for askew_deg in [-30.0f64, -10.0, 0.0, 30.0] {
            let mut setup = setup(scenario);
            setup.scenario.start.heading_rad = askew_deg.to_radians();
            let runs = seeds(&setup, 1..11);
            let angle_rad = worst(&runs, "step2.angle_rad");
            assert!(
                angle_rad <= 1.5 * TWO_DEGREES,
                "{scenario}, {askew_deg}: {angle_rad}"
            );
            assert!(
                worst(&runs, "step2.steady_error_m") <= 0.005,
                "{scenario}, {askew_deg}"
            );
            assert_eq!(worst(&runs, "contacts"), 0.0, "{scenario}, {askew_deg}");
        }
    }
}

#[test]
fn mode_1_does_the_same_on_the_final_rig() {
    let runs = twenty("mode1-final");
    assert!(worst(&runs, "step1.settling_s") <= 2.4);
    assert!(worst(&runs, "step2.settling_s") <= 1.1);
    assert!(worst(&runs, "step1.steady_error_m") <= 0.005);
    assert_eq!(worst(&runs, "contacts"), 0.0);
}

/// Errors of mode 2's bearing estimate [rad], from the heading reference on the link: on the way beyond and within
/// 0.7 m of the wall, and at rest.
fn bearing_errors(scenario: &str, seed: u64) -> [Vec<f64>; 3] {
    let mut person = Person::at(scenario);
    person.sim = setup(scenario).sim(seed).unwrap();
    let (mut errors, mut truth, mut wanted_rad) = ([const { Vec::new() }; 3], Vec::new(), None);
    for tick in 0..850u64 {
        match tick {
            20 => person.command(Command::Mode(ModeId::FrontAlign)),
            50 => person.command(Command::Arm),
            tick if tick % 10 == 0 => person.sim.send(ToRobot::Heartbeat.frame(0).bytes()),
            _ => {}
        }
        truth.push(person.sim.truth().pose);
        for message in person.receive_until((tick + 1) * 10_000) {
            match message {
                FromRobot::HeadingRef(heading_rad) => wanted_rad = Some(heading_rad),
                FromRobot::Telemetry(frame) => {
                    let Some(wanted_rad) = wanted_rad.take() else {
                        continue;
                    };
                    let bearing_rad = f64::from(wanted_rad - frame.pose.heading_rad);
                    // The wall's normal is the world's x axis.
                    let pose = truth[usize::from(frame.t_ms) / 10];
                    let error_rad = bearing_rad + pose.heading_rad;
                    match frame.state {
                        1 if pose.x_m < 0.37 => errors[0].push(error_rad),
                        1 | 2 => errors[1].push(error_rad),
                        4 => errors[2].push(error_rad),
                        _ => {}
                    }
                }
                _ => {}
            }
        }
    }
    errors
}

#[test]
fn it_knows_the_bearing_of_the_wall_within_2_degrees_near_it_and_half_a_degree_at_rest() {
    for scenario in ["mode2", "mode2-final"] {
        let runs: Vec<_> = (1..21).map(|seed| bearing_errors(scenario, seed)).collect();
        for (index, (state, most_deg)) in [("far", 4.0), ("near", 2.0), ("at rest", 0.5)]
            .iter()
            .enumerate()
        {
            let errors: Vec<f64> = runs.iter().flat_map(|run| run[index].clone()).collect();
            let mean_square = errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64;
            let rms_deg = mean_square.sqrt().to_degrees();
            let worst_deg = errors
                .iter()
                .fold(0.0, |worst: f64, e| worst.max(e.abs()))
                .to_degrees();
            println!(
                "{scenario} {state}: {} values, rms {rms_deg:.2} deg, worst {worst_deg:.2} deg",
                errors.len()
            );
            assert!(
                errors.len() >= 20 && rms_deg <= *most_deg,
                "{scenario} {state}: {rms_deg}"
            );
        }
    }
}

/// Modes 1 and 2 on their rigs, with the sonars that they need.
const CASES: [(&str, SonarId); 5] = [
    ("mode1", SonarId::Front),
    ("mode1-final", SonarId::Front),
    ("mode2", SonarId::Left),
    ("mode2", SonarId::Right),
    ("mode2-final", SonarId::Front),
];

fn failing(scenario: &str, sonar: SonarId, at_s: f64, fault: SonarFault) -> Setup {
    let mut setup = setup(scenario);
    let timed = TimedSonarFault { at_s, sonar, fault };
    setup.scenario.sonar_faults.push(timed);
    setup
}

#[test]
fn a_sonar_cut_or_stuck_on_the_way_stops_the_robot_before_the_wall_and_is_reported() {
    for (scenario, sonar) in CASES {
        for kind in [SonarFault::Cut, SonarFault::Stuck] {
            // At full speed, and half a second after that.
            for at_s in [1.4, 1.9] {
                for run in seeds(&failing(scenario, sonar, at_s, kind), 1..21) {
                    let case = format!(
                        "{scenario}, {sonar:?} {kind:?} at {at_s} s, seed {}",
                        run.seed
                    );
                    assert_eq!(run.metrics["contacts"], 0.0, "{case}");
                    let causes = [Some(Fault::SonarFaulty), Some(Fault::SonarStale)];
                    assert!(causes.contains(&fault(&run)), "{case}: {:?}", fault(&run));
                    let last = run.trace.samples.last().unwrap();
                    assert_eq!(last.duty, [0; 2], "{case}: drives on");
                }
            }
        }
    }
}

#[test]
fn a_sonar_that_sticks_while_the_robot_stands_stops_it_when_it_drives_again() {
    for (scenario, sonar) in CASES {
        for run in seeds(&failing(scenario, sonar, 4.5, SonarFault::Stuck), 1..21) {
            let case = format!("{scenario}, {sonar:?}, seed {}", run.seed);
            assert_eq!(run.metrics["contacts"], 0.0, "{case}");
            assert!(fault(&run).is_some(), "{case}");
        }
    }
}

#[test]
fn a_spiking_sonar_slows_or_stops_the_robot_and_never_leads_it_into_the_wall() {
    for (scenario, sonar) in CASES {
        for share in [0.3, 0.6, 1.0] {
            for at_s in [1.0, 1.6] {
                let setup = failing(scenario, sonar, at_s, SonarFault::Spiking(share));
                for run in seeds(&setup, 1..31) {
                    let case = format!(
                        "{scenario}, {sonar:?}, {share} from {at_s} s, seed {}",
                        run.seed
                    );
                    assert_eq!(run.metrics["contacts"], 0.0, "{case}");
                    assert!(fault(&run).is_some(), "{case}: no cause is named");
                }
            }
        }
    }
}

#[test]
fn something_that_stands_before_one_sonar_of_the_pair_is_not_touched() {
    let mut setup = setup("mode2");
    setup.scenario.start.heading_rad = 0.0;
    setup.world.boxes.push(Block {
        center_m: [0.75, 0.15],
        size_m: [0.1, 0.16],
        heading_rad: 0.0,
    });
    for run in seeds(&setup, 1..21) {
        assert_eq!(run.metrics["contacts"], 0.0, "seed {}", run.seed);
    }
}

#[test]
fn on_a_rig_without_its_sonars_a_mode_is_refused_with_the_reason() {
    for (scenario, rig) in [
        ("mode1", "front_pair"),
        ("mode2", "front_single"),
        ("mode2", "side_pair_left"),
    ] {
        let mut setup = setup(scenario);
        setup.scenario.rig = rig.into();
        setup.rig = setup.robot.rigs[rig];
        setup.scenario.duration_s = 3.0;
        let run = &seeds(&setup, 1..2)[0];
        let mentions_rig =
            |note: &Note| matches!(note, Note::Refused { why, .. } if *why == Refusal::WrongRig);
        assert!(
            run.failures.iter().any(mentions_rig),
            "{scenario} on {rig}: {:?}",
            run.failures
        );
        assert!(run.trace.samples.iter().all(|sample| sample.duty == [0; 2]));
    }
}
