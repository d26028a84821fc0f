//! Robots of a batch are the robots of runs.

#![allow(clippy::unwrap_used)]

use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_control::{ServoAngle, Wheels};
use rumbo_experiment::batch::{Batch, DrivenBy, OBSERVED, Robot, TRUE};
use rumbo_experiment::files::{Kind, Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run;
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::{Command, Decoder, FrameMessage, FromRobot, Received, Refusal, ToRobot};

const SEEDS: [u64; 3] = [1, 7, 1_000_003];
/// Between two looks [ticks].
const STEP: usize = 37;

fn setup(scenario: &str) -> Setup {
    let overrides = Overrides::default();
    Library::new().setup(scenario, &overrides).unwrap()
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.unwrap().install(work)
}

/// What a sample of a trace and a row of a batch both have.
fn of_sample(trace: &Trace, sample: &TruthSample) -> [u64; 8] {
    let [left, right, front] = [0, 1, 2].map(|sonar| trace.range_m(sample, sonar));
    let [left_rad_s, right_rad_s] = sample.wheel_rad_s;
    [
        sample.x_m,
        sample.y_m,
        left_rad_s,
        right_rad_s,
        left,
        right,
        front,
        sample.battery_v,
    ]
    .map(f64::to_bits)
}

fn of_robot(robot: &Robot) -> [u64; 8] {
    let truth = robot.true_values();
    let value = |name: &str| truth[TRUE.iter().position(|each| *each == name).unwrap()].to_bits();
    [
        "x_m",
        "y_m",
        "left_rad_s",
        "right_rad_s",
        "range_left_m",
        "range_right_m",
        "range_front_m",
        "battery_v",
    ]
    .map(value)
}

#[test]
fn each_robot_of_a_batch_is_bit_for_bit_that_of_a_run() {
    for scenario in Library::new().list(Kind::Scenario) {
        let setup = setup(&scenario);
        let runs = SEEDS.map(|seed| run::run(&setup, seed).unwrap());
        for threads in [1, 2] {
            on_threads(threads, || {
                let mut batch = Batch::new(&setup, DrivenBy::Scenario, &SEEDS).unwrap();
                // Uneven steps: where a caller looks changes nothing.
                let ticks = runs[0].trace.samples.len();
                for at in (0..ticks - STEP).step_by(STEP) {
                    batch.advance(STEP as u32);
                    for (robot, run) in batch.robots().zip(&runs) {
                        let sample = &run.trace.samples[at + STEP - 1];
                        assert_eq!(
                            of_robot(robot),
                            of_sample(&run.trace, sample),
                            "{scenario}, seed {}, {threads} threads, tick {}",
                            run.seed,
                            at + STEP
                        );
                    }
                }
            });
        }
    }
}

/// Drives by actions that change, and gives all that is known and true at the end of each step.
fn driven(batch: &mut Batch, steps: u32) -> Vec<(Vec<u32>, Vec<u64>)> {
    batch.for_each(|_, group| {
        group.robots_mut()[0].command(&Command::Arm).unwrap();
        group.advance(50);
    });
    let robots = batch.robots().count();
    let (mut known, mut truth) = (
        vec![0.0; robots * OBSERVED.len()],
        vec![0.0; robots * TRUE.len()],
    );
    let mut rows = Vec::new();
    for step in 0..steps {
        batch.step(&mut known, &mut truth, 10, |_, robots| {
            let robot = &mut robots[0];
            // By the seed: the same robot does the same in every batch.
            let speed = 4.0 + (step * 7 % 5) as f32 - (robot.seed() % 3) as f32;
            let wheels = Wheels {
                left: speed,
                right: speed - 0.5,
            };
            robot.command(&Command::WheelReference(wheels)).unwrap();
            robot.aim(Some(ServoAngle((step % 3) as f32 * 0.4 - 0.4)));
            true
        });
        let known = known.iter().map(|value| value.to_bits()).collect();
        let truth = truth.iter().map(|value| value.to_bits()).collect();
        rows.push((known, truth));
    }
    rows
}

#[test]
fn a_driven_robot_is_the_same_alone_and_among_others_on_any_threads() {
    let mut setup = setup("mode8-random");
    setup.scenario.mode = ModeId::WheelSpeed;
    let make = |seeds: &[u64]| Batch::new(&setup, DrivenBy::Caller, seeds).unwrap();
    let together = [1, 2].map(|threads| on_threads(threads, || driven(&mut make(&SEEDS), 60)));
    assert!(together[0] == together[1]);
    for (index, seed) in SEEDS.into_iter().enumerate() {
        let alone = driven(&mut make(&[seed]), 60);
        for ((known, truth), (all_known, all_truth)) in alone.iter().zip(&together[0]) {
            assert!(known[..] == all_known[index * OBSERVED.len()..][..OBSERVED.len()]);
            assert!(truth[..] == all_truth[index * TRUE.len()..][..TRUE.len()]);
        }
    }
}

#[test]
fn a_driven_robot_turns_its_wheels_and_its_servo_as_commanded_and_knows_it() {
    let setup = setup("mode5");
    let mut batch = Batch::new(&setup, DrivenBy::Caller, &[3]).unwrap();
    let robot = batch.robot_mut(0).unwrap();
    robot.command(&Command::Arm).unwrap();
    let wheels = Wheels {
        left: 6.0,
        right: 3.0,
    };
    robot.command(&Command::WheelReference(wheels)).unwrap();
    robot.aim(Some(ServoAngle(0.5)));
    robot.advance(300);
    let (known, truth) = (robot.observed(), robot.sim().truth());
    assert!((truth.wheel_rad_s[0] - 6.0).abs() < 0.4 && (truth.wheel_rad_s[1] - 3.0).abs() < 0.4);
    assert!((f64::from(known[0]) - truth.wheel_rad_s[0]).abs() < 0.3);
    assert!((truth.servo_rad - 0.5).abs() < 0.05 && known[8] == 0.5);
    assert!(
        robot.sim().fault().is_none(),
        "nobody is missed on a link that is not there"
    );
}

#[test]
fn a_snapshot_continues_bit_for_bit_the_same() {
    for driver in [DrivenBy::Scenario, DrivenBy::Caller] {
        let mut batch = Batch::new(&setup("mode4-final"), driver, &SEEDS).unwrap();
        if driver == DrivenBy::Caller {
            for index in 0..SEEDS.len() {
                let robot = batch.robot_mut(index).unwrap();
                robot.command(&Command::Mode(ModeId::WheelSpeed)).unwrap();
                robot.command(&Command::Arm).unwrap();
                robot.drive(Wheels::both(5.0), ServoAngle(0.3));
                robot.advance(20);
                robot.drive_duty(Wheels::both(-0.2), ServoAngle(-0.3));
                robot
                    .instruct("parameter = \"speed_ki_left\"\nvalue = 0")
                    .unwrap();
                robot.aim(None);
                assert!(robot.instruct("mode = \"mission\"").is_err());
            }
        }
        batch.advance(300);
        let mut again = batch.clone();
        // As another process would: by what was done to them.
        let lives = batch.lives();
        let mut relived =
            Batch::of_lives(&setup("mode4-final"), vec![driver], &lives, &|| Ok(())).unwrap();
        assert_eq!(relived.lives(), lives);
        for all in [&mut batch, &mut again, &mut relived] {
            all.advance(300);
        }
        let robots = batch.robots();
        for (one, (other, third)) in robots.zip(again.robots().zip(relived.robots())) {
            assert_eq!(of_robot(one), of_robot(other));
            assert_eq!(of_robot(one), of_robot(third));
        }
    }
}

#[test]
fn wheels_are_driven_open_loop_by_shares_of_the_pwm_while_armed() {
    let mut batch = Batch::new(&setup("mode5"), DrivenBy::Caller, &[3]).unwrap();
    let robot = batch.robot_mut(0).unwrap();
    let duty = Wheels {
        left: 0.8,
        right: -0.6,
    };
    robot.drive_duty(duty, ServoAngle(0.0));
    robot.advance(50);
    assert_eq!(robot.sim().truth().wheel_rad_s, [0.0; 2], "it is not armed");
    robot.command(&Command::Arm).unwrap();
    robot.advance(200);
    let given = robot.sim().duty();
    assert_eq!([given.left.counts(), given.right.counts()], [204, -153]);
    let [left, right] = robot.sim().truth().wheel_rad_s;
    assert!(left > 4.0 && right < -1.0, "{left} {right}");
    robot.drive(Wheels::both(6.0), ServoAngle(0.0));
    robot.advance(200);
    let [left, right] = robot.sim().truth().wheel_rad_s;
    assert!((left - 6.0).abs() < 0.4 && (right - 6.0).abs() < 0.4);
}

#[test]
fn a_renewed_robot_is_that_of_its_seed_and_the_others_go_on() {
    let mut batch = Batch::new(&setup("mode1"), DrivenBy::Scenario, &[1, 2]).unwrap();
    let mut fresh = Batch::new(&setup("mode1"), DrivenBy::Scenario, &[9]).unwrap();
    batch.advance(100);
    let second = of_robot(batch.robots().nth(1).unwrap());
    batch.renew(&[(0, 9)], &|| Ok(())).unwrap();
    assert_eq!(of_robot(batch.robots().nth(1).unwrap()), second);
    batch.advance(200);
    fresh.advance(200);
    assert_eq!(
        of_robot(batch.robots().next().unwrap()),
        of_robot(fresh.robots().next().unwrap())
    );
}

#[test]
fn a_command_in_words_is_checked_as_in_a_scenario() {
    let mut batch = Batch::new(&setup("mode1"), DrivenBy::Caller, &[1]).unwrap();
    batch.advance(50);
    let robot = batch.robot_mut(0).unwrap();
    robot.instruct("reference_m = 0.4").unwrap();
    robot.instruct("arm = true").unwrap();
    let said = |result: Result<(), _>| -> String {
        rumbo_experiment::files::FileError::to_string(&result.unwrap_err())
    };
    assert!(said(robot.instruct("referenc_m = 0.4")).contains("reference_m"));
    assert!(said(robot.instruct("reference_m = 9")).contains("0.02"));
    assert!(said(robot.instruct("mode = \"mission\"")).contains("refused"));
    assert!(said(robot.instruct("goal = \"world\"")).contains("mode"));
    assert!(said(robot.instruct("arm = true\nat_s = 3")).contains("at_s"));
    let mut scenario = Batch::new(&setup("mode1"), DrivenBy::Scenario, &[1]).unwrap();
    assert!(said(scenario.robot_mut(0).unwrap().instruct("arm = true")).contains("scenario"));
}

#[test]
fn a_recorded_robot_has_the_trace_of_its_run() {
    // Over the link, by the report's program without one, and after a calibration.
    for (scenario, program) in [
        ("mode8-random", NativeProgram::Rumbo),
        ("mode4", NativeProgram::Baseline),
        ("mode9-random", NativeProgram::Rumbo),
    ] {
        let overrides = Overrides {
            program,
            ..Overrides::default()
        };
        let setup = Library::new().setup(scenario, &overrides).unwrap();
        let run = run::run(&setup, 7).unwrap();
        let mut batch = Batch::new(&setup, DrivenBy::Scenario, &[7]).unwrap();
        batch.robot_mut(0).unwrap().record().unwrap();
        batch.advance(run.trace.samples.len() as u32);
        assert_eq!(
            batch.robots().next().unwrap().trace(),
            Some(&run.trace),
            "{scenario}"
        );
    }
}

#[test]
fn recording_changes_no_bit_of_a_driven_robot() {
    let mut setup = setup("mode8-random");
    setup.scenario.mode = ModeId::WheelSpeed;
    for seeds in [&[1][..], &[1, 2, 3]] {
        on_threads(1, || {
            let make = || Batch::new(&setup, DrivenBy::Caller, seeds).unwrap();
            let unrecorded = driven(&mut make(), 60);
            let mut batch = make();
            batch.robot_mut(0).unwrap().record().unwrap();
            assert!(driven(&mut batch, 60) == unrecorded);
            // From somewhere on, and once more.
            let mut batch = make();
            batch.advance(33);
            let mut other = batch.clone();
            batch.robot_mut(0).unwrap().record().unwrap();
            batch.advance(20);
            batch.robot_mut(0).unwrap().record().unwrap();
            other.advance(20);
            assert!(driven(&mut batch, 60) == driven(&mut other, 60));
            let trace = batch.robots().next().unwrap().trace().unwrap();
            assert_eq!(trace.samples.len(), 650);
            assert!((trace.samples[0].t_s - 0.54).abs() < 1e-9);
        });
    }
}

#[test]
fn a_driven_robot_says_to_the_tap_what_it_knows_and_what_it_was_commanded() {
    let mut batch = Batch::new(&setup("mode5"), DrivenBy::Caller, &[3]).unwrap();
    let robot = batch.robot_mut(0).unwrap();
    robot
        .instruct("parameter = \"front_kp\"\nvalue = 5")
        .unwrap();
    robot.record().unwrap();
    let parameters = robot.trace().unwrap().parameters.unwrap();
    assert_eq!(parameters.get(ParamId::FrontKp), 5.0);
    robot.instruct("arm = true").unwrap();
    let (mut telemetry, mut known) = (Vec::new(), Vec::new());
    for step in 0..60u8 {
        let wheels = Wheels::both(f32::from(step) / 10.0);
        robot.command(&Command::WheelReference(wheels)).unwrap();
        robot.advance(1);
        known.push(robot.sim().knowledge().unwrap());
    }
    assert!(robot.instruct("mode = \"manual\"").is_err());
    robot.advance(1);
    let mut commands = Vec::new();
    let mut others = Vec::new();
    let mut decoder = [Decoder::<160>::default(), Decoder::default()];
    for burst in robot.trace().unwrap().link.iter() {
        for byte in burst.bytes {
            let decoder = &mut decoder[usize::from(burst.to_robot)];
            let Some(Received::Frame(body)) = decoder.push(*byte) else {
                continue;
            };
            if burst.to_robot {
                if let Ok(ToRobot::Command { command, .. }) = ToRobot::from_body(&body) {
                    commands.push(command);
                }
                continue;
            }
            match FromRobot::from_body(&body).unwrap() {
                FromRobot::Telemetry(each) => telemetry.push(each),
                other => others.push(other),
            }
        }
    }
    assert_eq!(commands, [Command::Arm, Command::Mode(ModeId::Manual)]);
    let is_refused = |message: &FromRobot| matches!(message, FromRobot::Ack(ack) if ack.result == Err(Refusal::Armed));
    assert!(matches!(others[1], FromRobot::Ack(_)) || matches!(others[0], FromRobot::Ack(_)));
    assert!(others.iter().any(is_refused), "{others:?}");
    assert!(
        others
            .iter()
            .any(|each| matches!(each, FromRobot::Hello(_)))
    );
    assert!(
        others
            .iter()
            .any(|each| matches!(each, FromRobot::Status(_)))
    );
    // Every 40 ms, with the speeds of its tick and of the second before it.
    assert_eq!(telemetry.len(), 15);
    for each in &telemetry {
        let tick = usize::from(each.t_ms / 10);
        let (before, now) = (&known[tick - 2], &known[tick]);
        let near = |one: f32, other: f32| (one - other).abs() < 0.01;
        assert!(
            near(each.wheel_rad_s[0].left, before.wheel_rad_s[1].left),
            "{tick}"
        );
        assert!(
            near(each.wheel_rad_s[1].left, now.wheel_rad_s[1].left),
            "{tick}"
        );
        assert!(
            near(each.wheel_ref_rad_s.right, now.wheel_ref_rad_s.right),
            "{tick}"
        );
        assert!(near(each.pose.x_m, now.pose.x_m) && each.armed && !each.faulted);
    }
    assert!(telemetry.last().unwrap().wheel_rad_s[1].left > 1.0);
}
