//! *Run the experiment*: the scenario commands the robot of the lab.

use crate::bench::Bench;
use rumbo_control::params::ParamId;
use rumbo_experiment::files::{Library, Overrides};
use rumbo_experiment::note::Note;
use rumbo_experiment::run;
use rumbo_log::{ExperimentPhase, ExperimentState};
use rumbo_session::Order;
use rumbo_wire::Command;

/// Plays a scenario to its end, and a little more.
fn played(bench: &mut Bench, duration_s: f64) -> ExperimentState {
    bench.order(Order::Play);
    bench.pass(duration_s + 0.5);
    bench.state().experiment.clone().unwrap()
}

#[test]
fn an_experiment_has_the_numbers_of_the_run_of_the_command_line() {
    // A calibrated one, one after another goal is reached, and one of 45 movements.
    for (scenario, parameter) in [
        ("mode1", None),
        ("mode1", Some(2.0)),
        ("mode6", None),
        ("mode5", None),
    ] {
        let mut bench = Bench::of(scenario);
        bench.pass(3.0);
        let mut overrides = Overrides::default();
        if let Some(value) = parameter {
            bench.order(Order::Robot(Command::SetParam {
                id: ParamId::FrontKp as u8,
                value: value as f32,
            }));
            bench.pass(1.0);
            overrides.parameters.push(("front_kp".into(), value));
        }
        let setup = Library::new().setup(scenario, &overrides).unwrap();
        let result = run::run(&setup, 1).unwrap();
        let state = played(&mut bench, setup.scenario.duration_s);
        assert_eq!(
            state.phase == ExperimentPhase::Passed,
            result.pass,
            "{scenario}: {:?}",
            state.failures
        );
        let failures: Vec<_> = result.failures.iter().map(Note::to_string).collect();
        assert_eq!(state.failures, failures, "{scenario}");
        assert_eq!(state.parameters, overrides.parameters, "{scenario}");
        assert!(!state.limits.is_empty(), "{scenario}");
        for limit in &state.limits {
            let value = result.metrics.get(&limit.name).copied();
            assert_eq!(
                limit.value.map(f64::to_bits),
                value.map(f64::to_bits),
                "{scenario}: {}",
                limit.name
            );
            assert_eq!(
                limit.kept,
                !failures.iter().any(|line| line.starts_with(&limit.name)),
                "{scenario}: {}",
                limit.name
            );
        }
        assert!(
            !bench.state().robot.armed,
            "{scenario}: it is switched off at the end"
        );
    }
}

#[test]
fn stop_ends_an_experiment_and_the_robot_obeys_the_page_again() {
    let mut bench = Bench::of("mode5");
    bench.pass(3.0);
    bench.order(Order::Play);
    bench.pass(4.0);
    assert!(bench.state().robot.armed && bench.wheel_rad_s() > 4.0);
    bench.order(Order::Robot(Command::Arm));
    bench.pass(0.2);
    assert!(bench.told("refused, the experiment runs; STOP ends it"));
    bench.order(Order::Robot(Command::Stop));
    bench.pass(2.0);
    let state = bench.state().experiment.clone().unwrap();
    assert_eq!(state.phase, ExperimentPhase::Stopped);
    assert!(!bench.state().robot.armed && bench.wheel_rad_s().abs() < 0.1);
    bench.order(Order::Robot(Command::Arm));
    bench.pass(0.5);
    assert!(bench.state().robot.armed && bench.state().link.connected);
}
