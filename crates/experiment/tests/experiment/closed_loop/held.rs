//! A wheel that is held, a robot that has met something, and an encoder that loses most of its edges: the motors are
//! released soon, whatever drives them.

use super::encoders::fault;
use super::{RPM, setup};
use rumbo_control::Fault;
use rumbo_control::mode::ModeId;
use rumbo_experiment::files::{FileError, Kind, Library, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run, run_all, run_by};
use rumbo_plant::drivetrain::Side;
use rumbo_sim::wire_fault::{TimedWireFault, Wire, WireFault};
use rumbo_wire::Command;

/// More friction than any motor has torque [N m].
const HELD_N_M: f64 = 2.0;
/// How long a motor may push against what does not give way [s].
const RELEASED_S: f64 = 0.5;

/// A robot at this speed, with a wall 1.2 m ahead of it.
fn towards_a_wall(mode: &str, command: &str) -> Setup {
    let text = format!(
        "title = 'A wall'\nrobot = 'memoria'\nrig = 'final'\nworld = 'wall_front'\nmode = '{mode}'\nduration_s = 25\n\
         [[command]]\nat_s = 0.4\n{command}\n[[command]]\nat_s = 0.5\narm = true\n[[command]]\nat_s = 0.6\n{command}\n"
    );
    Library::new()
        .holding(Kind::Scenario, "towards_a_wall", &text)
        .setup("towards_a_wall", &Overrides::default())
        .unwrap()
}

/// One run, with these wheels held from `at_s` on.
fn holding(setup: &Setup, seed: u64, at_s: f64, sides: &[Side]) -> RunResult {
    run_by::<FileError>(setup, seed, |run| {
        while !run.is_over() {
            if run.sim().now_us() as f64 * 1e-6 >= at_s {
                for side in sides {
                    run.sim().hold(*side, HELD_N_M);
                }
            }
            run.advance();
        }
        Ok(())
    })
    .unwrap()
}

/// For how long the bridge has driven one of these wheels since then [s].
fn driven_s(run: &RunResult, since_s: f64, sides: &[Side]) -> f64 {
    let samples = run.trace.between(since_s, f64::INFINITY).iter();
    let driven = samples.filter(|sample| sides.iter().any(|side| sample.duty[side.index()] != 0));
    0.01 * driven.count() as f64
}

/// A fault's words begin with what is likeliest of a sound robot, before any wire.
fn names_what_it_met(fault: Fault) -> bool {
    let (_, why) = fault.explanation().split_once(": ").unwrap();
    why.starts_with("the robot met something") || why.starts_with("something holds the")
}

#[test]
fn a_robot_that_drives_into_a_wall_lets_go_of_it_and_says_so() {
    let mut setups = Vec::new();
    for mode in ["wheel_speed", "straight_line"] {
        for rpm in [20, 60, 120] {
            setups.push(towards_a_wall(mode, &format!("speed_rpm = {rpm}")));
        }
    }
    setups.push(towards_a_wall("waypoints", "route_m = [[1.3, 0], [1, 1]]"));
    for setup in &setups {
        for seed in 1..4 {
            let run = run(setup, seed).unwrap();
            let touched = run.trace.samples.iter().find(|sample| sample.touching);
            let touched_s = touched.unwrap().t_s;
            let what = format!("{:?}, seed {seed}", setup.scenario.commands[2].command);
            let (at_s, fault) = fault(&run).expect(&what);
            println!("{what}: {fault:?} {:.2} s after it", at_s - touched_s);
            // Tyres of fast wheels slip along the floor first, as they would on ice.
            assert!(at_s - touched_s <= 1.3, "{what}: {at_s} s");
            assert!(
                run.trace
                    .between(at_s, 25.0)
                    .iter()
                    .all(|sample| sample.duty == [0; 2]),
                "{what}"
            );
            // In mode 7 it turns against the wall first, with one wheel only.
            let alone = fault != Fault::Blocked && setup.scenario.mode == ModeId::Waypoints;
            assert!(fault == Fault::Blocked || alone, "{what}: {fault:?}");
            assert!(names_what_it_met(fault), "{what}: {fault:?}");
        }
    }
}

#[test]
fn a_held_wheel_is_released_in_every_mode_that_drives() {
    // When it is held: at rest, at a steady speed, or in a turn.
    let drives = [
        ("mode1-final", 0.0),
        ("mode1-final", 1.5),
        ("mode2-final", 0.0),
        ("mode2-final", 3.0),
        ("mode3-final", 0.0),
        ("mode3-final", 3.0),
        ("mode4-final", 0.0),
        ("mode4-final", 3.0),
        ("mode5", 0.0),
        ("mode5", 3.0),
        ("mode5-reversal", 3.3),
        ("mode6", 0.0),
        ("mode6", 3.0),
        ("mode7", 0.0),
        ("mode7", 4.0),
        ("pursuit-curve", 0.0),
        ("pursuit-curve", 3.0),
        ("mode8-obstacles", 0.0),
        ("mode8-obstacles", 3.3),
        ("mode8-lane", 3.0),
        ("mode9-random", 0.0),
        ("mode9-random", 3.0),
        ("manual-straight-speed", 0.0),
        ("manual-turn-left-speed", 2.0),
    ];
    let both = [Side::Left, Side::Right];
    let wheels: [&[Side]; 3] = [&both[..1], &both[1..], &both];
    let mut longest_s = 0.0_f64;
    for (name, at_s) in drives {
        let mut setup = setup(name);
        setup.scenario.duration_s = setup.scenario.duration_s.min(at_s + 6.0);
        for (sides, seed) in wheels.iter().zip([1, 2, 3]) {
            let run = holding(&setup, seed, at_s, sides);
            let what = format!("{name}, {sides:?} held at {at_s} s");
            let (_, fault) = fault(&run).expect(&what);
            let driven_s = driven_s(&run, at_s, sides);
            println!("{what}: {fault:?} after {driven_s:.2} s");
            longest_s = longest_s.max(driven_s);
            let named = match sides {
                [Side::Left] => &[Fault::LeftEncoderSilent, Fault::LeftEncoderImplausible][..],
                [_] => &[Fault::RightEncoderSilent, Fault::RightEncoderImplausible],
                _ => &[Fault::Blocked],
            };
            assert!(named.contains(&fault), "{what}: {fault:?}");
            assert!(names_what_it_met(fault), "{what}: {fault:?}");
        }
    }
    assert!(longest_s <= RELEASED_S, "{longest_s} s");
}

#[test]
fn a_held_wheel_is_released_in_open_loop_too_where_its_pwm_moves_any_free_one() {
    // 45 and 70 % PWM.
    for (name, sides, within_s) in [
        ("manual-straight", [Side::Left], 2.5),
        ("manual-turn-left", [Side::Right], 2.5),
        ("manual-pivot-left-forward", [Side::Right], RELEASED_S),
    ] {
        let run = holding(&setup(name), 1, 0.0, &sides);
        let (_, fault) = fault(&run).expect(name);
        let driven_s = driven_s(&run, 0.0, &sides);
        println!("{name}, {sides:?} held: {fault:?} after {driven_s:.2} s");
        assert!(driven_s <= within_s, "{name}: {driven_s} s");
    }
}

#[test]
fn a_wheel_held_at_any_speed_above_15_rpm_is_released_within_half_a_second() {
    let mut setup = setup("mode5");
    setup.scenario.duration_s = 6.0;
    for rpm in [16.0, 20.0, 30.0, 45.0, 90.0, 140.0] {
        for backward in [1.0, -1.0] {
            for timed in &mut setup.scenario.commands {
                if let Command::Reference(speed_rad_s) = &mut timed.command {
                    *speed_rad_s = (backward * rpm * RPM) as f32;
                }
            }
            for at_s in [0.0, 3.0] {
                let sides = [Side::Right];
                let run = holding(&setup, 4, at_s, &sides);
                let what = format!("{backward} * {rpm} rpm, held at {at_s} s");
                let (_, fault) = fault(&run).expect(&what);
                let driven_s = driven_s(&run, at_s, &sides);
                println!("{what}: {fault:?} after {driven_s:.2} s");
                // A fast wheel does not stop between two edges: the last ones may be uneven.
                let own = [Fault::RightEncoderSilent, Fault::RightEncoderImplausible];
                assert!(own.contains(&fault), "{what}: {fault:?}");
                assert!(driven_s <= RELEASED_S, "{what}: {driven_s} s");
            }
        }
    }
}

#[test]
fn an_encoder_that_loses_most_of_its_edges_is_named_before_the_robot_runs_into_anything() {
    // Seed 5011 with 90 % was driven at full duty for 0.6 s, and hit a box at 0.3 m/s.
    let drives = [
        ("mode8-obstacles", 4.4, 5_011, 0.9),
        ("mode8-obstacles", 5.7, 6_021, 0.95),
        ("mode8-random", 3.3, 6_002, 0.8),
        ("mode8-random", 9.1, 6_003, 0.98),
        ("mode8-lane", 3.3, 6_004, 0.7),
        ("mode4-final", 3.3, 6_005, 0.9),
        ("mode1-final", 1.2, 6_006, 0.95),
        ("mode7", 4.4, 6_007, 0.9),
        ("mode6", 4.4, 6_008, 0.6),
    ];
    let mut setups = Vec::new();
    for (name, at_s, from, share) in drives {
        for side in [Side::Left, Side::Right] {
            let mut setup = setup(name);
            setup.scenario.wire_faults = vec![TimedWireFault {
                at_s,
                wire: Wire::Encoder(side),
                fault: WireFault::Losing(share),
            }];
            setups.push((setup, from, at_s));
        }
    }
    let jobs: Vec<_> = setups
        .iter()
        .flat_map(|(setup, from, _)| (*from..from + 4).map(move |seed| (setup, seed)))
        .collect();
    run_all(&jobs, |setup, run| {
        let timed = &setup.scenario.wire_faults[0];
        let what = format!("{}, seed {}, {timed:?}", run.scenario, run.seed);
        let (at_s, fault) = fault(&run).expect(&what);
        println!("{what}: {fault:?} at {at_s:.2} s");
        assert_eq!(run.metrics["contacts"], 0.0, "{what}");
        Ok::<(), FileError>(())
    })
    .unwrap();
}
