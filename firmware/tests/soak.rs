//! A long drive with everything at once: telemetry at its full rate, as many bytes to the robot as the line carries,
//! commands in between. `RUMBO_SOAK_MINUTES` makes it longer; `cargo xtask campaign --only image` runs 75, past the
//! wrap of the microseconds at 71.6.

use crate::board::image;
use crate::faults::drive::{Drive, setup};
use rumbo_control::params::ParamId;
use rumbo_emulator::observe::profile::Profile;
use rumbo_wire::{Command, FromRobot, ToRobot};

/// Default duration [s].
const SHORT_S: f64 = 10.0;
/// A heartbeat is 5 bytes; 9 of them in 10 steps of 5 ms are 900 of the 960 bytes/s.
const STEP_US: u64 = 5_000;
const PAUSE_STEPS: u64 = 10;
/// Steps between two commands: an answer takes 13 bytes of the 78 bytes/s that telemetry, status and headings leave.
const COMMAND_STEPS: u64 = 80;
/// Bytes of a telemetry frame.
const FRAME_BYTES: f64 = 30.0;
/// Bytes that the stack leaves free at its deepest.
const STACK_MARGIN: u16 = 2_048;
/// Cycles of a microsecond.
const CYCLES_PER_US: f64 = 16.0;

fn duration_s() -> f64 {
    let minutes = std::env::var("RUMBO_SOAK_MINUTES").ok();
    let minutes: Option<f64> = minutes.and_then(|minutes| minutes.parse().ok());
    minutes.map_or(SHORT_S, |minutes| minutes * 60.0)
}

#[test]
fn under_full_telemetry_and_a_flood_of_bytes_no_frame_is_lost_and_the_interrupts_keep_their_times()
{
    let (Some(image), Some(setup)) = (image(), setup("mode7-repeat", |_| {})) else {
        return;
    };
    let mut drive = Drive::under_way(&setup, 2.0);
    let observers = drive.sim.mega_mut().unwrap().chip_mut().observers_mut();
    observers.profile(Profile::new(&image));
    observers.measure_stack();
    drive.heartbeats = false;
    drive.received.clear();
    let (from_s, lost) = (drive.now_s(), drive.frames_lost());
    let until_s = from_s + duration_s();
    let (mut telemetry, mut steps, mut answers) = (0u64, 0u64, 0u64);
    while drive.now_s() < until_s {
        steps += 1;
        if !steps.is_multiple_of(PAUSE_STEPS) {
            drive.send(&ToRobot::Heartbeat);
        } else if steps.is_multiple_of(COMMAND_STEPS) {
            let id = ParamId::Base as u8;
            let frame = drive.frame_of(Command::GetParam { id });
            drive.sim.send(&frame);
        }
        drive.wait_s(STEP_US as f64 * 1e-6);
        for (_, message) in std::mem::take(&mut drive.received) {
            match message {
                FromRobot::Telemetry(_) => telemetry += 1,
                FromRobot::Ack(_) => answers += 1,
                FromRobot::Status(status) => {
                    assert!(status.armed && status.fault.is_none(), "{status:?}");
                    assert_eq!(status.dropped, 0, "telemetry dropped at {}", drive.now_s());
                    drive.last_status = Some(status);
                }
                _ => {}
            }
        }
    }
    let took_s = drive.now_s() - from_s;
    let rate_hz = telemetry as f64 / took_s;
    let overruns = drive.last_status.map(|status| status.overruns);
    println!(
        "{took_s:.0} s: telemetry {rate_hz:.2} Hz, {:.0} bytes/s; {answers} answers; {overruns:?} overruns (modulo 256)",
        rate_hz * FRAME_BYTES
    );
    assert_eq!(drive.frames_lost(), lost, "frames lost");
    assert!((24.9..25.1).contains(&rate_hz) && rate_hz * FRAME_BYTES <= 753.0);
    assert!(answers + 2 >= steps / COMMAND_STEPS, "{answers}");
    drive.touched_nothing();
    let chip = drive.sim.mega().unwrap().chip();
    let lowest = chip.observers().lowest_stack_pointer().unwrap();
    let margin = lowest - image.data_end().unwrap();
    println!("stack margin {margin} bytes");
    assert!(margin >= STACK_MARGIN, "{margin}");
    for used in chip.observers().profiled().unwrap().interrupts() {
        println!("{used:?}");
        let latency_us = used.worst_latency as f64 / CYCLES_PER_US;
        let most_us = match used.vector {
            1 | 2 => 15.0,
            3 | 4 | 6 => 25.0,
            // The tick, and the outputs 3 ms after it. Both ends of a period may be late: 1 % of 10 ms.
            17 | 18 => 50.0,
            _ => f64::INFINITY,
        };
        assert!(latency_us <= most_us, "{used:?}");
    }
}
