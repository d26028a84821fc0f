//! The program starts again in the middle of a drive.

use super::drive::{Drive, setup, under_way_in_each};
use crate::board::image;
use rumbo_control::mode::{Movement, MovementLevel};
use rumbo_emulator::devices::{Cause, Input};
use rumbo_wire::{Command, FromRobot, Refusal, ResetCause, ToRobot};

/// A jump to itself.
const FOR_EVER: u16 = 0xCFFF;

/// The robot has restarted for this reason: disarmed, and it does not continue by itself.
fn has_started_again(drive: &mut Drive, cause: ResetCause) {
    drive.send(&ToRobot::Hello);
    drive.wait_s(0.7);
    assert_eq!(drive.hello().reset, cause);
    assert!(!drive.status().armed);
    // After the restart it has no wall estimate yet, but it can be armed again.
    let answer = drive.command(Command::Arm);
    assert!(
        matches!(answer, Ok(_) | Err(Refusal::SonarNotReady)),
        "{answer:?}"
    );
}

/// The chip is reset in the middle of each drive.
fn starts_again_when_reset(how: Cause, cause: ResetCause) {
    for mut drive in under_way_in_each() {
        let from_s = drive.now_s();
        let chip = drive.sim.mega_mut().unwrap().chip_mut();
        chip.input(chip.cycle(), Input::Reset(how));
        drive.released_after_s(from_s, 0.1);
        has_started_again(&mut drive, cause);
    }
}

#[test]
fn a_brown_out_releases_the_wheels_and_is_reported() {
    starts_again_when_reset(Cause::BrownOut, ResetCause::BrownOut);
}

#[test]
fn a_supply_that_falls_while_it_drives_resets_it_and_it_stays_released() {
    let setup = setup("manual-straight", |setup| {
        let battery = [
            ("battery.open_circuit_v", 5.5),
            ("battery.resistance_ohm", 3.0),
        ];
        for (key, value) in battery {
            setup.scenario.plant.insert(key.into(), value);
        }
    });
    let Some(setup) = setup else {
        return;
    };
    let mut drive = Drive::under_way(&setup, 1.0);
    // Full duty at once pulls the old battery down.
    drive.received.clear();
    let command = Command::Move {
        movement: Movement::Forward,
        level: MovementLevel::Duty(1.0),
    };
    let frame = drive.frame_of(command);
    drive.sim.send(&frame);
    while !drive
        .received
        .iter()
        .any(|(_, message)| matches!(message, FromRobot::Hello(_)))
    {
        drive.wait_s(0.05);
        assert!(drive.now_s() < 20.0, "{:?}", drive.status());
    }
    println!(
        "{:.1} s: {:.2} V",
        drive.now_s(),
        drive.sim.truth().battery_v
    );
    assert_eq!(drive.hello().reset, ResetCause::BrownOut);
    let from_s = drive.now_s();
    drive.released_after_s(from_s, 0.0);
    assert!(!drive.status().armed);
}

#[test]
fn a_tick_that_hangs_is_reset_by_the_watchdog_within_140_ms() {
    let Some(image) = image() else {
        return;
    };
    let place = image
        .function_named("rumbo_inputs_latched")
        .unwrap()
        .address;
    let was = image.flash()[2 * place as usize..][..2].try_into().unwrap();
    for mut drive in under_way_in_each() {
        let from_s = drive.now_s();
        let chip = drive.sim.mega_mut().unwrap().chip_mut();
        chip.cpu_mut().write_flash(place, FOR_EVER);
        // After the reset it hangs again, until the program is restored.
        let took_s = drive.released_after_s(from_s, 0.145);
        println!("released {took_s:.3} s after the tick began to hang");
        let chip = drive.sim.mega_mut().unwrap().chip_mut();
        chip.cpu_mut().write_flash(place, u16::from_le_bytes(was));
        drive.wait_s(0.3);
        has_started_again(&mut drive, ResetCause::Watchdog);
    }
}

#[test]
fn the_reset_button_releases_the_wheels_and_is_reported() {
    starts_again_when_reset(Cause::External, ResetCause::External);
}
