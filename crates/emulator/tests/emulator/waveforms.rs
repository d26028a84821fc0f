//! Every waveform mode of every timer on each of its pins, edge by edge (2549Q, tables 16-2 to 16-8, 17-2 to 17-5 and 20-2 to 20-8; the modes of the 16-bit timers on page 145).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_emulator::devices::{Event, Pwm};

/// What a pin does in the long run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wave {
    /// Not a mode of this timer.
    Port,
    Constant(bool),
    /// Ticks of a period, and of them high.
    Pulses(u64, u64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Count,
    Fast,
    Correct,
}

/// Where the top comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Top {
    Fixed(u64),
    CompareA,
    Capture,
}

const COMPARE_TOP: u64 = 199;
const CAPTURE_TOP: u64 = 299;
const COMPARE: u64 = 77;

/// The datasheet's word on a channel: COM 1, 2 or 3 in a mode.
fn expected(kind: Kind, top: Top, channel: usize, com: u8, toggles: bool) -> Wave {
    let (value, is_top) = match top {
        Top::Fixed(top) => (top, false),
        Top::CompareA => (COMPARE_TOP, channel == 0),
        Top::Capture => (CAPTURE_TOP, false),
    };
    let steps = match kind {
        Kind::Correct => 2 * value,
        _ => value + 1,
    };
    let high = match kind {
        Kind::Correct => 2 * COMPARE,
        _ => COMPARE + 1,
    };
    match (kind, com) {
        (Kind::Count, 1) => Wave::Pulses(2 * steps, steps),
        (Kind::Count, _) => Wave::Constant(com == 3),
        (_, 1) if channel == 0 && toggles => Wave::Pulses(2 * steps, steps),
        (_, 1) => Wave::Port,
        _ if is_top => Wave::Constant(com == 2),
        (_, 2) => Wave::Pulses(steps, high),
        _ => Wave::Pulses(steps, steps - high),
    }
}

/// What `pin` did after `from`, and the last PWM reported of it.
fn observed(chip: &mut Chip, pin: Pin, from: u64) -> (Wave, Option<Pwm>) {
    let (mut edges, mut reported) = (Vec::new(), None);
    for output in chip.take_outputs() {
        match output.event {
            Event::Pin(at, drive) if at == pin && output.cycle >= from => {
                edges.push((output.cycle, drive == Drive::High));
            }
            Event::Duty { pin: at, pwm } if at == pin => reported = pwm,
            _ => {}
        }
    }
    let wave = match edges[..] {
        [] => Wave::Constant(chip.devices().drive(pin) == Drive::High),
        [..] => {
            let rises: Vec<u64> = edges
                .iter()
                .filter(|edge| edge.1)
                .map(|edge| edge.0)
                .collect();
            let falls: Vec<u64> = edges
                .iter()
                .filter(|edge| !edge.1)
                .map(|edge| edge.0)
                .collect();
            let period = rises[1] - rises[0];
            assert!(rises.windows(2).all(|two| two[1] - two[0] == period));
            assert!(falls.windows(2).all(|two| two[1] - two[0] == period));
            let fall = falls.iter().find(|fall| **fall > rises[0]).unwrap();
            Wave::Pulses(period, fall - rises[0])
        }
    };
    (wave, reported)
}

/// One channel: registers written in order, then at least eight periods.
fn check(name: &str, writes: &[(u16, u8)], pin: Pin, wave: Wave, is_pwm: bool) {
    let direction = 0x24 + 3 * (pin.port() as u16 - 1);
    let direction = if pin.port() > 6 {
        0x101 + 3 * (pin.port() as u16 - 7)
    } else {
        direction
    };
    let mut all = vec![(direction, 1 << pin.bit())];
    all.extend(writes);
    let (mut chip, start) = set_up(&all);
    // The longest period is that of a toggle at 16 bits.
    let long = matches!(wave, Wave::Pulses(131_072, _));
    let (settled, end) = if long {
        (300_000, 800_000)
    } else {
        (10_000, 40_000)
    };
    chip.run_until(start + end);
    let (seen, reported) = observed(&mut chip, pin, start + settled);
    let meant = if wave == Wave::Port {
        Wave::Constant(false)
    } else {
        wave
    };
    assert_eq!(seen, meant, "{name}");
    let share = match wave {
        Wave::Port => None,
        _ if !is_pwm => None,
        Wave::Constant(high) => Some(f64::from(u8::from(high))),
        Wave::Pulses(period, high) => Some(high as f64 / period as f64),
    };
    let reported_share = reported.map(|pwm| pwm.share);
    assert!(
        share.is_none() == reported_share.is_none()
            && (share.unwrap_or_default() - reported_share.unwrap_or_default()).abs() < 1e-12,
        "{name}: {reported:?}, not {share:?}"
    );
    if let Wave::Pulses(period, _) = wave
        && let Some(reported) = reported
    {
        assert_eq!(reported.period_cycles, Some(period), "{name}");
    }
}

#[test]
fn every_mode_of_the_wide_timers_makes_its_wave_on_every_pin() {
    let modes = [
        (0, Kind::Count, Top::Fixed(0xFFFF)),
        (1, Kind::Correct, Top::Fixed(0xFF)),
        (2, Kind::Correct, Top::Fixed(0x1FF)),
        (3, Kind::Correct, Top::Fixed(0x3FF)),
        (4, Kind::Count, Top::CompareA),
        (5, Kind::Fast, Top::Fixed(0xFF)),
        (6, Kind::Fast, Top::Fixed(0x1FF)),
        (7, Kind::Fast, Top::Fixed(0x3FF)),
        (8, Kind::Correct, Top::Capture),
        (9, Kind::Correct, Top::CompareA),
        (10, Kind::Correct, Top::Capture),
        (11, Kind::Correct, Top::CompareA),
        (12, Kind::Count, Top::Capture),
        (14, Kind::Fast, Top::Capture),
        (15, Kind::Fast, Top::CompareA),
    ];
    let timers = [
        (1, 0x80, [('B', 5), ('B', 6), ('B', 7)]),
        (3, 0x90, [('E', 3), ('E', 4), ('E', 5)]),
        (4, 0xA0, [('H', 3), ('H', 4), ('H', 5)]),
        (5, 0x120, [('L', 3), ('L', 4), ('L', 5)]),
    ];
    for (timer, base, pins) in timers {
        for (mode, kind, top) in modes {
            for (channel, (port, bit)) in pins.into_iter().enumerate() {
                // All of timer 1; of the others, which are its like, one channel in turn.
                if timer != 1 && (usize::from(mode) + timer) % 3 != channel {
                    continue;
                }
                for com in 1..=3 {
                    let wave = expected(kind, top, channel, com, matches!(mode, 9 | 11 | 14 | 15));
                    let a = if top == Top::CompareA {
                        COMPARE_TOP
                    } else {
                        COMPARE
                    };
                    let control_a = com << (6 - 2 * channel) | mode & 3;
                    let control_b = (mode >> 2) << 3;
                    let [high, low] = (CAPTURE_TOP as u16).to_be_bytes();
                    let writes = [
                        (base, control_a),
                        (base + 1, control_b),
                        (base + 7, high),
                        (base + 6, low),
                        (base + 9, 0),
                        (base + 8, a as u8),
                        (base + 11, 0),
                        (base + 10, COMPARE as u8),
                        (base + 13, 0),
                        (base + 12, COMPARE as u8),
                        (base + 1, control_b | 1),
                    ];
                    let name = format!("timer {timer}, mode {mode}, channel {channel}, COM {com}");
                    check(&name, &writes, pin(port, bit), wave, kind != Kind::Count);
                }
            }
        }
    }
}

#[test]
fn every_mode_of_the_narrow_timers_makes_its_wave_on_every_pin() {
    let modes = [
        (0, Kind::Count, Top::Fixed(0xFF)),
        (1, Kind::Correct, Top::Fixed(0xFF)),
        (2, Kind::Count, Top::CompareA),
        (3, Kind::Fast, Top::Fixed(0xFF)),
        (5, Kind::Correct, Top::CompareA),
        (7, Kind::Fast, Top::CompareA),
    ];
    let timers = [
        (0, 0x44, [('B', 7), ('G', 5)]),
        (2, 0xB0, [('B', 4), ('H', 6)]),
    ];
    for (timer, base, pins) in timers {
        for (mode, kind, top) in modes {
            for (channel, (port, bit)) in pins.into_iter().enumerate() {
                for com in 1..=3 {
                    let wave = expected(kind, top, channel, com, matches!(mode, 5 | 7));
                    let a = if top == Top::CompareA {
                        COMPARE_TOP
                    } else {
                        COMPARE
                    };
                    let writes = [
                        (base, com << (6 - 2 * channel) | mode & 3),
                        (base + 3, a as u8),
                        (base + 4, COMPARE as u8),
                        (base + 1, (mode >> 2) << 3 | 1),
                    ];
                    let name = format!("timer {timer}, mode {mode}, channel {channel}, COM {com}");
                    check(&name, &writes, pin(port, bit), wave, kind != Kind::Count);
                }
            }
        }
    }
}

#[test]
fn the_pin_of_oc0a_and_oc1c_has_both_or_either() {
    // Timer 0, fast, high for 64 of 256; timer 1, mode 5, high for 128 of 256; both start together from a prescaler that is held.
    for (port, high) in [(0x00, 64), (0x80, 128)] {
        let (mut chip, start) = set_up(&[
            (0x43, 0x81),
            (0x24, 0x80),
            (0x25, port),
            (0x47, 63),
            (0x44, 0x83),
            (0x45, 0x02),
            (0x8D, 0),
            (0x8C, 127),
            (0x80, 0x09),
            (0x81, 0x0A),
            (0x43, 0x00),
        ]);
        chip.run_until(start + 40_000);
        let (seen, _) = observed(&mut chip, pin('B', 7), start + 10_000);
        assert_eq!(seen, Wave::Pulses(256 * 8, high * 8));
    }
}
