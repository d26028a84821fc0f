//! Timers of the whole chip, with exact cycles (2549Q, sections 16, 17, 18 and 20; registers of the 16-bit timers on pages 154 to 157).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Event, Input, Output, Pwm};

/// Distances between the edges of a pin, from its `first` on.
fn distances(edges: &[(u64, bool)], rising: bool) -> Vec<u64> {
    let times: Vec<u64> = edges
        .iter()
        .filter(|(_, high)| *high == rising)
        .map(|(cycle, _)| *cycle)
        .collect();
    times.windows(2).map(|two| two[1] - two[0]).collect()
}

#[test]
fn a_phase_and_frequency_correct_period_is_twice_its_top() {
    // Timer 5, mode 8, ICR 50,000, over 8; OC5A toggles nothing, B is non-inverting at a quarter.
    let [high, low] = 50_000u16.to_be_bytes();
    let [quarter_high, quarter_low] = 12_500u16.to_be_bytes();
    let (mut chip, _) = set_up(&[
        (0x10A, 0x10),
        (0x121, 0x10),
        (0x127, high),
        (0x126, low),
        (0x12B, quarter_high),
        (0x12A, quarter_low),
        (0x120, 0x20),
        (0x121, 0x12),
    ]);
    chip.run_until(4_000_000);
    let edges = edges(&mut chip, pin('L', 4));
    let periods = distances(&edges, true);
    assert!(
        periods.len() >= 3 && periods.iter().all(|period| *period == 800_000),
        "{periods:?}"
    );
    let up = edges.iter().rposition(|(_, high)| *high).unwrap();
    let widths: Vec<u64> = edges[..up]
        .windows(2)
        .filter(|two| two[0].1)
        .map(|two| two[1].0 - two[0].0)
        .collect();
    assert!(widths.last() == Some(&200_000), "{widths:?}");
}

#[test]
fn the_pwm_of_the_mega_on_pin_5_is_490_hz_and_as_wide_as_asked() {
    // Timer 3, mode 1, over 64, OC3A on PE3 at 100 of 255.
    let (mut chip, _) = set_up(&[(0x2D, 0x08), (0x98, 100), (0x90, 0x81), (0x91, 0x03)]);
    chip.run_until(200_000);
    let edges = edges(&mut chip, pin('E', 3));
    let periods = distances(&edges, true);
    assert!(
        periods.len() >= 3 && periods.iter().all(|period| *period == 32_640),
        "{periods:?}"
    );
    for two in edges.windows(2).filter(|two| two[0].1) {
        assert_eq!(two[1].0 - two[0].0, 2 * 100 * 64);
    }
}

#[test]
fn clear_on_compare_interrupts_every_top_plus_one_ticks() {
    // Vector 47, TIMER5 COMPA, toggles PB7 by SBI PINB, 7. Timer 5 in mode 4 at 1 kHz: over 64, top 249.
    let mut words = vec![0x0000; 0x90];
    words[..2].copy_from_slice(&[0x940C, 0x90]);
    words[2 * 47..2 * 47 + 2].copy_from_slice(&[sbi(0x03, 7), RETI]);
    for (address, value) in [
        (0x24, 0x80),
        (0x129, 0),
        (0x128, 249),
        (0x73, 2),
        (0x121, 0x0B),
    ] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    words.extend([SEI, 0xCFFF]);
    let mut chip = chip_of(&words);
    chip.run_until(200_000);
    let times: Vec<u64> = edges(&mut chip, pin('B', 7))
        .iter()
        .map(|(cycle, _)| *cycle)
        .skip(2)
        .collect();
    let steps: Vec<u64> = times.windows(2).map(|two| two[1] - two[0]).collect();
    // RJMP takes two cycles: an interrupt may wait for one.
    assert!(
        steps.len() >= 10 && steps.iter().all(|step| step.abs_diff(16_000) <= 1),
        "{steps:?}"
    );
    assert_eq!(
        times[times.len() - 1] - times[0],
        16_000 * (times.len() as u64 - 1)
    );
}

#[test]
fn the_counter_is_read_whole_through_its_latch() {
    // Timer 1 over 1: LDS low, LDS high into r24 and r25, 5,000 cycles later.
    let mut words = vec![ldi(16, 1)];
    words.extend(sts(0x81, 16));
    words.extend(vec![NOP; 5_000]);
    words.extend([0x9180, 0x84, 0x9190, 0x85, 0xCFFF]);
    let mut chip = chip_of(&words);
    chip.run_until(5_010);
    let registers = chip.cpu().registers();
    // The timer starts in cycle 2; the low byte is read in cycle 5,004.
    assert_eq!(u16::from_le_bytes([registers[24], registers[25]]), 5_002);
}

#[test]
fn the_prescaler_runs_on_and_its_reset_sets_the_phase() {
    // OC1A toggles at every overflow of top 0 in mode 4, over 64: every 64 cycles, in step with the prescaler.
    let toggle = [(0x24, 0x20), (0x80, 0x40), (0x81, 0x0B)];
    let (mut chip, _) = set_up(&toggle);
    chip.run_until(1_000);
    let free: Vec<u64> = edges(&mut chip, pin('B', 5))
        .iter()
        .skip(1)
        .map(|(cycle, _)| *cycle)
        .collect();
    assert_eq!(free[..3], [64, 128, 192]);
    let mut writes = Vec::from(toggle);
    writes.extend([(0x43, 0x01)]);
    let (mut chip, reset) = set_up(&writes);
    chip.run_until(1_000);
    let after: Vec<u64> = edges(&mut chip, pin('B', 5))
        .iter()
        .skip(1)
        .map(|(cycle, _)| *cycle)
        .collect();
    assert_eq!(after[..3], [reset + 64, reset + 128, reset + 192]);
}

#[test]
fn a_timer_counts_edges_of_its_pin() {
    // Timer 5 on PL2, rising.
    let (mut chip, _) = set_up(&[(0x121, 0x07)]);
    for n in 0..20 {
        chip.input(100 + 50 * n, Input::Pin(pin('L', 2), Some(n % 2 == 0)));
    }
    chip.run_until(2_000);
    assert_eq!(count_of(&mut chip, 0x124), 10);
}

#[test]
fn an_edge_on_the_capture_pin_takes_the_count() {
    // Timer 4 over 8, rising edges on PL0; and with the noise canceller four cycles later, if it lasts.
    for (control, late) in [(0x42, 0), (0xC2, 4)] {
        let (mut chip, start) = set_up(&[(0xA1, control)]);
        chip.input(4_001, Input::Pin(pin('L', 0), Some(true)));
        if late > 0 {
            chip.input(3_000, Input::Pin(pin('L', 0), Some(true)));
            chip.input(3_002, Input::Pin(pin('L', 0), Some(false)));
        }
        chip.run_until(5_000);
        let expected = (4_001 + late) / 8 - start / 8;
        assert_eq!(u64::from(count_of(&mut chip, 0xA6)), expected);
    }
}

#[test]
fn an_unwatched_timer_that_is_skipped_over_stands_where_a_watched_one_does() {
    for (mode, divisor) in [(0x01, 1u64), (0x02, 8)] {
        // Timer 3 alone, and with its overflow interrupt enabled but interrupts off.
        let [mut lazy, mut watched] =
            [0, 1].map(|enabled| set_up(&[(0x71, enabled), (0x91, mode)]).0);
        lazy.run_until(10_000_000);
        for cycle in (0..10_000_000).step_by(9_973) {
            watched.run_until(cycle);
        }
        watched.run_until(10_000_000);
        let (lazy, watched) = (count_of(&mut lazy, 0x94), count_of(&mut watched, 0x94));
        assert_eq!(lazy, watched, "over {divisor}");
    }
}

/// The changes reported of a pin's PWM.
fn duties(chip: &mut Chip, wanted: Pin) -> Vec<(u64, Option<Pwm>)> {
    let outputs = chip.take_outputs().into_iter();
    outputs
        .filter_map(|Output { cycle, event }| match event {
            Event::Duty { pin, pwm } if pin == wanted => Some((cycle, pwm)),
            _ => None,
        })
        .collect()
}

fn pwm(share: f64, period_cycles: u64) -> Option<Pwm> {
    let period_cycles = Some(period_cycles);
    Some(Pwm {
        share,
        period_cycles,
    })
}

#[test]
fn a_duty_is_reported_when_it_takes_effect_and_when_the_timer_releases_the_pin() {
    // Timer 3, mode 1, over 64, OC3A on PE3: 100 of 255.
    let (mut chip, start) = set_up(&[(0x2D, 0x08), (0x98, 100), (0x90, 0x81), (0x91, 0x03)]);
    chip.run_until(100_000);
    let e3 = pin('E', 3);
    let reported = duties(&mut chip, e3);
    assert_eq!(
        reported.last().unwrap(),
        &(start, pwm(100.0 / 255.0, 32_640))
    );
    // A new value waits for the top, tick 255, 765 and so on of the prescaler that began in cycle 0.
    write(&mut chip, 0x98, 200);
    chip.run_until(150_000);
    let [(cycle, new)] = duties(&mut chip, e3)[..] else {
        panic!()
    };
    assert_eq!(new, pwm(200.0 / 255.0, 32_640));
    assert_eq!((cycle - start / 64 * 64) % 32_640, 256 * 64);
    // Direction, digitalWrite (which disconnects), and a standing timer.
    write(&mut chip, 0x2D, 0);
    write(&mut chip, 0x2D, 0x08);
    write(&mut chip, 0x90, 0x01);
    write(&mut chip, 0x90, 0x81);
    write(&mut chip, 0x91, 0);
    let reported: Vec<_> = duties(&mut chip, e3)
        .into_iter()
        .map(|duty| duty.1)
        .collect();
    assert_eq!(reported[..4], [None, new, None, new]);
    assert_eq!(reported[4].unwrap().period_cycles, None);
}
