//! Guarantees of the drive layer to every mode that requests wheel speeds.

use super::{fault, seeds, setup};
use rumbo_control::mode::{Movement, MovementLevel};
use rumbo_experiment::files::TimedCommand;
use rumbo_experiment::run::RunResult;
use rumbo_wire::Command;

/// Wheel angle of one edge [rad].
const EDGE_RAD: f64 = std::f64::consts::TAU / 384.0;

/// Motion of the wheels in the second after a command that turns both in the directions `signs`.
struct Start {
    /// Time between the first edges of both wheels [s].
    apart_s: f64,
    /// Farthest that one wheel was ahead of the other, as a heading [rad].
    ahead_rad: f64,
}

fn start(run: &RunResult, from_s: f64, signs: [f64; 2]) -> Start {
    let (mut turned_rad, mut first_s, mut ahead_rad) = ([0.0; 2], [f64::NAN; 2], 0.0_f64);
    for sample in run.trace.between(from_s, from_s + 1.0) {
        for wheel in 0..2 {
            turned_rad[wheel] += 0.01 * f64::max(sample.wheel_rad_s[wheel] * signs[wheel], 0.0);
            if first_s[wheel].is_nan() && turned_rad[wheel] > EDGE_RAD {
                first_s[wheel] = sample.t_s;
            }
        }
        ahead_rad = ahead_rad.max((turned_rad[0] - turned_rad[1]).abs() * 0.0325 / 0.10);
    }
    Start {
        apart_s: (first_s[0] - first_s[1]).abs(),
        ahead_rad,
    }
}

fn assert_together(scenario: &str, from_s: f64, signs: [f64; 2], apart_s: f64, ahead_deg: f64) {
    let robots = if crate::is_full() { 50 } else { 15 };
    for run in seeds(&setup(scenario), 1..robots + 1) {
        let start = start(&run, from_s, signs);
        assert!(
            start.apart_s <= apart_s && start.ahead_rad <= ahead_deg.to_radians(),
            "{scenario} from {from_s} s, seed {}: {:.3} s apart, {:.1} deg",
            run.seed,
            start.apart_s,
            start.ahead_rad.to_degrees()
        );
    }
}

#[test]
fn both_wheels_start_together_from_rest() {
    assert_together("manual-straight-speed", 0.5, [1.0, 1.0], 0.011, 2.5);
    assert_together("manual-turn-left-speed", 0.5, [-1.0, 1.0], 0.031, 5.0);
}

#[test]
fn both_wheels_start_together_after_a_reversal() {
    assert_together("mode5-reversal", 5.5, [-1.0, -1.0], 0.021, 3.0);
    assert_together("mode5-reversal", 10.5, [1.0, 1.0], 0.021, 3.0);
}

#[test]
fn an_open_loop_reversal_is_no_silent_encoder() {
    let mut setup = setup("manual-straight");
    let arm = setup.scenario.commands[0];
    let moves = [
        (0.5, Movement::Forward),
        (1.1, Movement::Stop),
        (1.7, Movement::Backward),
    ];
    setup.scenario.commands = vec![arm];
    setup
        .scenario
        .commands
        .extend(moves.map(|(at_s, movement)| TimedCommand {
            at_s,
            command: Command::Move {
                movement,
                level: MovementLevel::Duty(0.9),
            },
            ..arm
        }));
    setup.scenario.duration_s = 2.5;
    // In these robots one wheel comes to rest long before the other. Driven at once it would jolt the robot, whose other
    // wheel would give edges, and then none.
    for run in seeds(&setup, 2217..2219) {
        assert_eq!(fault(&run), None, "seed {}", run.seed);
    }
}
