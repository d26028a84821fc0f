//! Duration of the interrupt handlers, and the delay that they cause to others, while everything happens at once.

use crate::board::image;
use crate::faults::drive::{self, setup};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::observe::profile::Profile;
use rumbo_wire::{Command, Decoder, FrameMessage, FromRobot, Received};

const CYCLES_PER_MS: u64 = 16_000;
/// Vectors of the encoders, and of the echoes.
const ENCODERS: [u8; 2] = [1, 2];
const ECHOES: [u8; 3] = [3, 4, 6];

fn pin(port: char, bit: u8) -> Pin {
    Pin::new(port, bit).unwrap()
}

#[test]
fn handlers_are_short_and_wait_little_while_both_wheels_turn_echoes_come_and_bytes_flood() {
    let Some(image) = image() else {
        return;
    };
    let mut chip = Chip::new(&image);
    // Once it runs: flags that rise before interrupts are on would count as waiting.
    chip.run_until(20 * CYCLES_PER_MS);
    chip.observers_mut().profile(Profile::new(&image));
    for ms in 20..1_020 {
        let at = ms * CYCLES_PER_MS;
        let level = |period_ms: u64| Some((ms / period_ms).is_multiple_of(2));
        // Not in step with each other, nor with the tick.
        chip.input(at + 97 * ms % 16_000, Input::Pin(pin('D', 0), level(1)));
        chip.input(at + 89 * ms % 16_000, Input::Pin(pin('D', 1), level(1)));
        chip.input(at + 83 * ms % 16_000, Input::Pin(pin('D', 2), level(3)));
        chip.input(at + 79 * ms % 16_000, Input::Pin(pin('D', 3), level(4)));
        chip.input(at + 73 * ms % 16_000, Input::Pin(pin('E', 5), level(5)));
        let (usart, byte, baud) = (2, (ms * 31) as u8, 9_600);
        chip.input(at, Input::Serial { usart, byte, baud });
        chip.run_until(at + CYCLES_PER_MS);
        chip.take_outputs();
    }
    let profile = chip.observers().profiled().unwrap();
    let used = profile.interrupts();
    for vector in ENCODERS.into_iter().chain(ECHOES) {
        assert!(
            used.iter()
                .any(|used| used.vector == vector && used.count > 150),
            "{vector}"
        );
    }
    for used in used {
        println!("{used:?}");
        let (longest, latency) = match used.vector {
            vector if ENCODERS.contains(&vector) => (110, 240),
            vector if ECHOES.contains(&vector) => (160, 400),
            _ => (160, u64::MAX),
        };
        assert!(
            used.longest <= longest && used.worst_latency <= latency,
            "{used:?}"
        );
    }
}

#[test]
fn the_servo_s_pulses_keep_their_length_while_everything_happens_at_once() {
    let Some(image) = image() else {
        return;
    };
    let mut chip = Chip::new(&image);
    chip.run_until(50 * CYCLES_PER_MS);
    chip.take_outputs();
    let mut edges = Vec::new();
    for ms in 50..2_050 {
        let at = ms * CYCLES_PER_MS;
        // Encoders and echoes out of step with each other, and the line full.
        for (n, (port, bit)) in [('D', 0), ('D', 1), ('D', 2), ('D', 3), ('E', 5)]
            .into_iter()
            .enumerate()
        {
            let (n, level) = (n as u64, Some(ms % 2 == 0));
            let jitter = (ms * (97 - 8 * n)) % 15_000;
            chip.input(at + jitter, Input::Pin(pin(port, bit), level));
        }
        let (usart, byte, baud) = (2, (ms * 31) as u8, 9_600);
        chip.input(at, Input::Serial { usart, byte, baud });
        chip.run_until(at + CYCLES_PER_MS);
        for output in chip.take_outputs() {
            if let Event::Pin(moved, drive) = output.event
                && moved == pin('H', 6)
            {
                edges.push((output.cycle, drive == Drive::High));
            }
        }
    }
    let first = edges.iter().position(|(_, high)| *high).unwrap();
    let rises = edges[first..].iter().step_by(2).map(|(cycle, _)| *cycle);
    let rises: Vec<u64> = rises.collect();
    let falls: Vec<u64> = edges[first + 1..]
        .iter()
        .step_by(2)
        .map(|(cycle, _)| *cycle)
        .collect();
    assert!(rises.len() > 90, "{}", rises.len());
    let width = |(rise, fall): (&u64, &u64)| fall - rise;
    let widths: Vec<u64> = rises.iter().zip(&falls).map(width).collect();
    let periods: Vec<u64> = rises.windows(2).map(|two| two[1] - two[0]).collect();
    let spread = |of: &[u64]| of.iter().max().unwrap() - of.iter().min().unwrap();
    println!("pulses of {} cycles, spread {}", widths[0], spread(&widths));
    // 1472 us, and not a cycle more or less: the timer makes the edges.
    assert_eq!((widths[0], spread(&widths)), (1_472 * 16, 0));
    assert_eq!((periods[0], spread(&periods)), (20_480 * 16, 0));
}

#[test]
fn it_sends_hello_at_once_and_telemetry_25_times_a_second() {
    let Some(image) = image() else {
        return;
    };
    let mut chip = Chip::new(&image);
    chip.observers_mut().measure_stack();
    chip.run_until(2_000 * CYCLES_PER_MS);
    let (mut decoder, mut messages) = (Decoder::<48>::default(), Vec::new());
    for output in chip.take_outputs() {
        let Event::Byte { usart, byte, baud } = output.event else {
            continue;
        };
        assert_eq!((usart, baud.round()), (2, 9_615.0));
        if let Some(Received::Frame(body)) = decoder.push(byte as u8) {
            messages.push(FromRobot::from_body(&body).unwrap());
        }
    }
    assert!(
        matches!(messages.first(), Some(FromRobot::Hello(hello)) if hello.image != 0),
        "{messages:?}"
    );
    let telemetry = messages
        .iter()
        .filter(|message| matches!(message, FromRobot::Telemetry(_)))
        .count();
    assert!((48..=50).contains(&telemetry), "{telemetry}");
    assert_eq!(decoder.crc_errors(), 0);
    // What lies between the variables and the deepest that the stack has been.
    let lowest = chip.observers().lowest_stack_pointer().unwrap();
    let margin = lowest - image.data_end().unwrap();
    println!("stack margin {margin} bytes");
    assert!(margin >= 2_048, "{margin}");
}

#[test]
fn the_stack_keeps_its_margin_around_the_boxes() {
    let (Some(image), Some(setup)) = (image(), setup("mode8-obstacles", |_| {})) else {
        return;
    };
    let mut drive = drive::Drive::new(&setup);
    let chip = drive.sim.mega_mut().unwrap().chip_mut();
    chip.observers_mut().measure_stack();
    drive.wait_s(0.3);
    drive.command(Command::Mode(setup.scenario.mode)).unwrap();
    drive.follow(&setup, 12.0);
    // It may be sweeping just then.
    let until_s = drive.now_s() + 3.0;
    while drive.speed_rad_s() <= 1.0 && drive.now_s() < until_s {
        drive.wait_s(0.1);
    }
    println!("drives at {:.1} s", drive.now_s());
    assert!(drive.speed_rad_s() > 1.0, "it drives");
    let chip = drive.sim.mega().unwrap().chip();
    let lowest = chip.observers().lowest_stack_pointer().unwrap();
    let margin = lowest - image.data_end().unwrap();
    println!("stack margin {margin} bytes");
    assert!(margin >= 2_048, "{margin}");
}
