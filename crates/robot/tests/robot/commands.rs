//! Commands: once each, answered each time, refused with a reason and without a trace.

use crate::support;
use proptest::prelude::*;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};
use rumbo_control::params::ParamId;
use rumbo_control::{Micros, Wheels};
use rumbo_wire::{
    COMMAND_LIFE_MS, Command, EventKind, Frame, Kind, Recalled, Refusal, RobotTime, ToRobot, crc16,
};
use support::{Bench, SESSION};

#[test]
fn a_repeated_command_is_applied_once_and_answered_each_time() {
    let mut bench = Bench::alive();
    bench
        .numbered(SESSION, 1, Command::Mode(ModeId::WheelSpeed))
        .unwrap();
    bench.numbered(SESSION, 2, Command::Arm).unwrap();
    bench.numbered(SESSION, 3, Command::Disarm).unwrap();
    let before = bench.acks();
    // The link repeats the last command and, late, one before it.
    assert_eq!(bench.numbered(SESSION, 3, Command::Disarm), Ok(0.0));
    assert_eq!(bench.acks().last(), before.last());
    bench.send(&ToRobot::Command {
        session: SESSION,
        number: 2,
        command: Command::Arm,
        seen: bench.seen,
    });
    bench.ticks(20);
    assert_eq!(bench.acks().len(), before.len() + 1);
    assert!(!bench.status().armed);
    let armed = bench
        .events()
        .iter()
        .filter(|event| **event == EventKind::Armed)
        .count();
    assert_eq!(armed, 1);
}

#[test]
fn a_refusal_too_is_repeated_as_it_was() {
    let mut bench = Bench::alive();
    assert_eq!(
        bench.numbered(SESSION, 1, Command::Reference(1.0)),
        Err(Refusal::NotInThisMode)
    );
    bench
        .numbered(SESSION + 1, 0, Command::Mode(ModeId::FrontDistance))
        .unwrap();
    assert_eq!(
        bench.numbered(SESSION + 1, 1, Command::Reference(-1.0)),
        Err(Refusal::OutOfRange)
    );
    assert_eq!(
        bench.numbered(SESSION + 1, 1, Command::Reference(-1.0)),
        Err(Refusal::OutOfRange)
    );
}

#[test]
fn another_session_starts_its_own_numbers() {
    let mut bench = Bench::alive();
    bench
        .numbered(1, 500, Command::Mode(ModeId::WheelSpeed))
        .unwrap();
    assert_eq!(bench.numbered(2, 0, Command::Reference(3.0)), Ok(3.0));
    assert_eq!(bench.status().reference.numbers(), [3.0; 2]);
}

#[test]
fn a_value_that_is_not_finite_or_out_of_range_changes_nothing() {
    let mut bench = Bench::alive();
    bench.command(Command::Mode(ModeId::WheelSpeed)).unwrap();
    bench.command(Command::Reference(4.0)).unwrap();
    for (value, refusal) in [
        (f32::NAN, Refusal::NotFinite),
        (f32::INFINITY, Refusal::NotFinite),
        (1e6, Refusal::OutOfRange),
    ] {
        assert_eq!(bench.command(Command::Reference(value)), Err(refusal));
        let half = Wheels {
            left: 1.0,
            right: value,
        };
        assert_eq!(bench.command(Command::WheelReference(half)), Err(refusal));
        let id = ParamId::Base as u8;
        assert_eq!(bench.command(Command::SetParam { id, value }), Err(refusal));
        assert_eq!(
            bench.command(Command::GetParam { id }),
            Ok(ParamId::Base.limits().default)
        );
    }
    assert_eq!(bench.status().reference.numbers(), [4.0; 2]);
}

#[test]
fn the_mode_changes_only_while_disarmed() {
    let mut bench = Bench::alive();
    bench.drive();
    assert_eq!(
        bench.command(Command::Mode(ModeId::Manual)),
        Err(Refusal::Armed)
    );
    assert_eq!(bench.command(Command::ResetParams), Err(Refusal::Armed));
    assert_eq!(bench.command(Command::ResetPose), Err(Refusal::Armed));
    assert_eq!(bench.status().mode, ModeId::WheelSpeed);
    bench.command(Command::Disarm).unwrap();
    assert_eq!(bench.command(Command::Mode(ModeId::Manual)), Ok(0.0));
    assert_eq!(bench.status().mode, ModeId::Manual);
}

#[test]
fn a_command_belongs_to_its_mode() {
    let mut bench = Bench::alive();
    assert_eq!(
        bench.command(Command::Reference(0.5)),
        Err(Refusal::NotInThisMode)
    );
    let forward = Command::Move {
        movement: Movement::Forward,
        level: MovementLevel::Duty(0.5),
    };
    assert_eq!(bench.command(forward), Ok(0.5));
    bench.command(Command::Mode(ModeId::FrontDistance)).unwrap();
    assert_eq!(bench.command(forward), Err(Refusal::NotInThisMode));
    assert_eq!(bench.command(Command::Reference(0.5)), Ok(0.5));
}

#[test]
fn parameters_are_read_set_and_reset() {
    let mut bench = Bench::alive();
    let id = ParamId::Base as u8;
    assert_eq!(
        bench.command(Command::SetParam { id, value: 0.12 }),
        Ok(0.12)
    );
    assert_eq!(bench.command(Command::GetParam { id }), Ok(0.12));
    bench.command(Command::ResetParams).unwrap();
    assert_eq!(
        bench.command(Command::GetParam { id }),
        Ok(ParamId::Base.limits().default)
    );
    assert_eq!(
        bench.command(Command::GetParam { id: 250 }),
        Err(Refusal::UnknownParam)
    );
}

#[test]
fn a_command_that_is_not_understood_is_refused_by_its_number() {
    let mut bench = Bench::alive();
    bench.bytes_in(Frame::new(Kind::Command, 0, &[SESSION, 9, 0, 200]).bytes());
    bench.ticks(20);
    assert_eq!(
        bench.acks().last().map(|ack| (ack.number, ack.result)),
        Some((9, Err(Refusal::Malformed)))
    );
}

#[test]
fn a_basic_movement_drives_the_wheels_by_its_duty() {
    let mut bench = Bench::alive();
    bench.command(Command::Arm).unwrap();
    bench
        .command(Command::Move {
            movement: Movement::TurnLeft,
            level: MovementLevel::Duty(0.4),
        })
        .unwrap();
    let counts = bench.outputs.drive.map(|duty| duty.counts());
    assert_eq!(
        counts,
        Wheels {
            left: -102,
            right: 102
        }
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn garbage_at_line_rate_changes_nothing(noise in prop::collection::vec(any::<u8>(), 2_000..4_000)) {
        // `ON` is a command however it came to be; three bytes that spell it come once in a hundred runs of this test.
        prop_assume!(!noise.windows(3).any(|bytes| bytes.eq_ignore_ascii_case(b"on\n")));
        let mut quiet = Bench::alive();
        quiet.drive();
        let mut noisy = Bench::alive();
        noisy.drive();
        for bytes in noise.chunks(10) {
            noisy.bytes_in(bytes);
            // Ends what the noise began, so that the heartbeats get through.
            noisy.bytes_in(&[0]);
            noisy.ticks(1);
            quiet.ticks(1);
            prop_assert_eq!(noisy.outputs, quiet.outputs);
        }
        prop_assert_eq!(noisy.events(), quiet.events());
        prop_assert!(noisy.lines.is_empty(), "{:?}", noisy.lines);
    }
}

/// Runs until the robot reports that its save is complete.
fn save(bench: &mut Bench, memory: &mut [u8]) {
    for _ in 0..600 {
        if let Some(cell) = bench.robot.store() {
            memory[usize::from(cell.address)] = cell.value;
        }
        bench.ticks(1);
    }
    assert!(bench.events().contains(&EventKind::Saved));
}

#[test]
fn saved_parameters_are_there_after_the_next_start_by_either_language() {
    for in_text in [false, true] {
        let mut memory = vec![0xFF; 4_096];
        let mut bench = Bench::alive();
        let id = ParamId::Base as u8;
        bench
            .command(Command::SetParam { id, value: 0.12 })
            .unwrap();
        if in_text {
            b"SAVE\n".iter().for_each(|byte| bench.robot.receive(*byte));
            // Back to frames, to receive the event that it is done.
            bench.command(Command::GetParam { id }).unwrap();
        } else {
            bench.command(Command::SaveParams).unwrap();
        }
        save(&mut bench, &mut memory);
        let mut bench = Bench::new();
        bench.robot.recall(|at| memory[usize::from(at)]);
        bench.ticks(50);
        assert_eq!(bench.command(Command::GetParam { id }), Ok(0.12));
        assert!(
            bench
                .events()
                .contains(&EventKind::Recalled(Recalled::Second))
        );
        // Requested again, it is sent again.
        bench.received.clear();
        bench.send(&ToRobot::Hello);
        bench.ticks(50);
        assert!(
            bench
                .events()
                .contains(&EventKind::Recalled(Recalled::Second))
        );
    }
}

#[test]
fn a_save_while_driving_disturbs_nothing() {
    let (mut saving, mut other) = (Bench::alive(), Bench::alive());
    saving.drive();
    other.drive();
    saving.command(Command::SaveParams).unwrap();
    other.command(Command::GetParam { id: 0 }).unwrap();
    for _ in 0..600 {
        saving.robot.store();
        saving.ticks(1);
        other.ticks(1);
        assert_eq!(saving.outputs, other.outputs);
    }
    assert!(saving.events().contains(&EventKind::Saved) && saving.status().armed);
}

/// Each kind of command that changes what the robot drives, in mode 0, disarmed.
const TIMED: [Command; 3] = [
    Command::Arm,
    Command::Mode(ModeId::Manual),
    Command::Move {
        movement: Movement::Forward,
        level: MovementLevel::Duty(0.5),
    },
];

#[test]
fn a_command_that_is_too_old_is_refused_and_one_that_is_old_enough_is_not() {
    for (age_ms, refused) in [
        (COMMAND_LIFE_MS, false),
        (COMMAND_LIFE_MS + 10, true),
        (60_000, true),
    ] {
        for command in TIMED {
            let mut bench = Bench::alive();
            let seen = bench.time();
            bench.ticks(age_ms / 10);
            bench.seen = seen;
            let answer = bench.numbered(SESSION, 1, command);
            assert_eq!(
                answer == Err(Refusal::TooOld),
                refused,
                "{command:?} {age_ms} ms: {answer:?}"
            );
        }
    }
}

#[test]
fn a_command_from_the_future_or_from_before_the_start_is_refused() {
    for (start, ahead_ms) in [(0, 1_000), (1, 0), (255, 0)] {
        for command in TIMED {
            let mut bench = Bench::alive();
            bench.seen.start = start;
            bench.seen.ms += ahead_ms;
            assert_eq!(
                bench.command(command),
                Err(Refusal::TooOld),
                "{start} {ahead_ms}"
            );
            assert!(!bench.status().armed);
        }
    }
}

#[test]
fn an_old_stop_or_off_is_obeyed() {
    for command in [Command::Stop, Command::Disarm] {
        let mut bench = Bench::alive();
        bench.drive();
        bench.seen = RobotTime { start: 9, ms: 9 };
        assert_eq!(bench.command(command), Ok(0.0));
        assert!(!bench.is_driven());
    }
}

#[test]
fn the_age_of_a_command_is_right_where_the_clock_of_microseconds_wraps() {
    let mut bench = Bench::at(Micros(u32::MAX - 700_000));
    bench.ticks(100);
    assert_eq!(bench.command(Command::Arm), Ok(0.0));
    bench.command(Command::Disarm).unwrap();
    let seen = bench.seen;
    bench.ticks(250);
    bench.seen = seen;
    assert_eq!(bench.command(Command::Arm), Err(Refusal::TooOld));
}

#[test]
fn a_repeated_command_is_answered_as_before_however_old_it_has_become() {
    let mut bench = Bench::alive();
    let seen = bench.seen;
    bench.numbered(SESSION, 1, Command::Arm).unwrap();
    bench.ticks(250);
    bench.seen = seen;
    assert_eq!(bench.numbered(SESSION, 1, Command::Arm), Ok(0.0));
}

#[test]
fn the_status_after_hello_carries_the_time_since_the_start() {
    let mut bench = Bench::alive();
    bench.ticks(25);
    bench.received.clear();
    bench.send(&ToRobot::Hello);
    bench.ticks(15);
    let at = bench.status().at;
    assert_eq!(at.start, 0);
    assert!((750..=850).contains(&at.ms), "{at:?}");
}

/// A network of one layer whose outputs are zero.
fn network() -> Vec<u8> {
    let mut bytes = b"RPN\x01\x26\x00\x01\x01\x03".to_vec();
    bytes.resize(36, 0);
    let crc = bytes.iter().fold(0xFFFF, |crc, byte| crc16(crc, *byte));
    bytes.extend(crc.to_le_bytes());
    bytes
}

#[test]
fn mode_9_starts_only_with_a_whole_network() {
    let starts = |network: &[u8]| {
        let mut bench = Bench::new();
        bench
            .robot
            .learn(|at| network.get(usize::from(at)).copied().unwrap_or(0xFF));
        bench.ticks(50);
        bench.command(Command::Mode(ModeId::Policy)).unwrap();
        bench.command(Command::Arm)
    };
    let whole = network();
    assert_eq!(starts(&whole), Ok(0.0));
    assert_eq!(starts(&[]), Err(Refusal::NoPolicy), "erased flash");
    for at in 0..whole.len() {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x10;
        assert_eq!(starts(&damaged), Err(Refusal::NoPolicy), "byte {at}");
    }
}
