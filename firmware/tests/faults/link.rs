//! The link falls silent, is flooded, or flips bits.

use super::drive::{Drive, setup, under_way_in_each};
use crate::world::Random;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};
use rumbo_control::{Fault, Wheels};
use rumbo_wire::message::Waypoint;
use rumbo_wire::{Command, Refusal};

/// Silence stops the robot within this time, the transit of the last byte included [s].
const STOP_S: f64 = 0.5;

#[test]
fn a_link_that_falls_silent_stops_the_robot_within_half_a_second() {
    for mut drive in under_way_in_each() {
        drive.heartbeats = false;
        let from_s = drive.now_s();
        let took_s = drive.released_after_s(from_s, STOP_S);
        println!("released {took_s:.3} s after the last heartbeat left the station at the latest");
        drive.latched(Fault::LinkLost);
    }
}

#[test]
fn random_bytes_at_line_rate_are_no_sign_of_life_and_no_command() {
    for mut drive in under_way_in_each() {
        drive.heartbeats = false;
        let mut random = Random::new(3);
        let from_s = drive.now_s();
        // 2.5 s of what 9600 baud carry.
        let flood: Vec<u8> = (0..2_400).map(|_| random.below(256) as u8).collect();
        drive.sim.send(&flood);
        drive.released_after_s(from_s, STOP_S);
        drive.wait_s(1.0);
        // Where noise ends in the middle of a piece, the frame after it goes down with it.
        drive.sim.send(&[0]);
        drive.latched(Fault::LinkLost);
        assert!(drive.status().crc_errors > 0);
    }
}

#[test]
fn between_random_bytes_a_heartbeat_keeps_it_going() {
    let Some(setup) = setup("mode5", |_| {}) else {
        return;
    };
    let mut drive = Drive::under_way(&setup, 1.0);
    let mut random = Random::new(4);
    for _ in 0..20 {
        // 60 bytes take 62 ms of the 100 ms between heartbeats.
        let noise: Vec<u8> = (0..60).map(|_| random.below(256) as u8).collect();
        drive.sim.send(&noise);
        drive.sim.send(&[0]);
        drive.wait_s(0.1);
    }
    assert!(drive.status().armed && drive.speed_rad_s() > 1.0);
    drive.touched_nothing();
}

/// One of each.
fn commands() -> Vec<Command> {
    let waypoint = Waypoint {
        x_m: 1.0,
        y_m: -0.5,
        heading_rad: Some(0.3),
    };
    vec![
        Command::Stop,
        Command::Arm,
        Command::Disarm,
        Command::ClearFault,
        Command::Mode(ModeId::Manual),
        Command::Reference(0.7),
        Command::WheelReference(Wheels::both(3.0)),
        Command::Move {
            movement: Movement::Forward,
            level: MovementLevel::Duty(0.9),
        },
        Command::SetParam { id: 2, value: 0.2 },
        Command::GetParam { id: 2 },
        Command::ResetParams,
        Command::SaveParams,
        Command::ResetPose,
        Command::Goal { x_m: 1.0, y_m: 0.5 },
        Command::Lane,
        Command::Route {
            repeat: true,
            relative: false,
        },
        Command::Waypoint(waypoint),
    ]
}

#[test]
fn a_command_with_a_byte_flipped_anywhere_does_nothing() {
    if let Some(setup) = setup("mode5", |_| {}) {
        nothing_comes_of_flips(Drive::under_way(&setup, 1.0));
    }
    under_way_in_each().for_each(nothing_comes_of_flips);
}

fn nothing_comes_of_flips(mut drive: Drive) {
    drive.wait_s(0.6);
    let before = drive.status();
    let mut flips = 0;
    for (index, command) in commands().into_iter().enumerate() {
        let whole = drive.frame_of(command);
        for at in 0..whole.len() {
            let mut frame = whole.clone();
            // All bits at one place, and one bit after the other over the places.
            frame[at] ^= if (at + index) % 2 == 0 {
                0xFF
            } else {
                1 << (at % 8)
            };
            drive.sim.send(&frame);
            // What follows must not be lost with it.
            drive.sim.send(&[0]);
            drive.wait_s(0.02);
            flips += 1;
        }
        drive.wait_s(0.1);
        // A 0 behind a frame leaves its CRC right and its length wrong.
        let answer = drive.answer();
        assert!(
            matches!(answer, None | Some(Err(Refusal::Malformed))),
            "{answer:?}"
        );
    }
    let status = drive.status();
    assert!(status.armed && status.fault.is_none(), "{status:?}");
    assert_eq!(
        (status.mode, status.reference),
        (before.mode, before.reference)
    );
    assert!(drive.param(rumbo_control::params::ParamId::Base) < 0.2);
    drive.touched_nothing();
    println!("{flips} flips");
    // And whole it does.
    drive.command(Command::Stop).unwrap();
    let from_s = drive.now_s();
    drive.released_after_s(from_s, 0.1);
}
