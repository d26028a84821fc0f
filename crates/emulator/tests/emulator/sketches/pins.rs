//! Sketches that need pins and timers only.

use super::board::{Board, CYCLES_PER_US, widths};

/// What a call of `digitalWrite`, the clock's interrupt and its step of 4 us may add to a time [cycles].
const CALL: u64 = 320;

/// All pins of the Mega with PWM.
const PWM_PINS: [u8; 15] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 44, 45, 46];

#[test]
fn the_lamp_blinks_once_a_second() {
    let Some(mut board) = Board::with("blink") else {
        return;
    };
    board.run_us(5_000_000);
    let edges = board.edges(13);
    // `pinMode` drives it low first.
    assert_eq!(edges.len(), 11);
    for two in edges[1..].windows(2) {
        let half = two[1].0 - two[0].0;
        assert!(half.abs_diff(8_000_000) < CALL, "{half}");
    }
}

#[test]
fn analog_write_makes_each_pins_own_wave() {
    let Some(mut board) = Board::with("pwm") else {
        return;
    };
    board.run_us(100_000);
    for pin in PWM_PINS {
        let edges = board.edges(pin);
        let rises: Vec<u64> = edges.iter().filter(|e| e.1).map(|e| e.0).collect();
        let value = 10 + 5 * u64::from(pin);
        // Timer 0 of pins 4 and 13 counts up only, over 64; the others up and down.
        let (period, high) = match pin {
            4 | 13 => (64 * 256, 64 * (value + 1)),
            _ => (64 * 510, 64 * 2 * value),
        };
        for two in rises[1..].windows(2) {
            assert_eq!(two[1] - two[0], period, "pin {pin}");
        }
        assert!(rises.len() > 45, "pin {pin}");
        // The first pulse may be cut: the wave was there before the pin was given to it.
        let pulses = &widths(&edges, true)[1..];
        assert!(
            pulses.iter().all(|width| *width == high),
            "pin {pin}: {pulses:?}"
        );
    }
    let level = |pin| board.edges(pin).last().map(|edge| edge.1);
    assert_eq!((level(22), level(23)), (Some(true), Some(false)));
}

#[test]
fn pulse_in_measures_a_sonars_echo() {
    let Some(mut board) = Board::with("pulse_in") else {
        return;
    };
    let widths_us = [116, 580, 1_000, 5_800, 11_600, 20_000];
    for width_us in widths_us {
        board.forget();
        while board.edges(22).last().is_none_or(|edge| !edge.1) {
            board.run_us(50);
        }
        let start = board.cycle() + 450 * CYCLES_PER_US;
        board.set(start, 13, true);
        board.set(start + width_us * CYCLES_PER_US, 13, false);
        board.run_us(450 + width_us + 100);
        let trigger = widths(&board.edges(12), true);
        assert!(
            trigger[0].abs_diff(10 * CYCLES_PER_US) < CALL,
            "{trigger:?}"
        );
    }
    board.run_us(10_000);
    for (index, width_us) in widths_us.into_iter().enumerate() {
        let measured_us = board.long("width_us", index);
        // It counts loops of a microsecond; the clock's interrupt, 1 in 1,024 us, is not counted.
        let missed_us = 8 * (1 + width_us / 1024);
        assert!(
            measured_us <= width_us + 2 && measured_us + missed_us >= width_us,
            "{measured_us} of {width_us} us"
        );
    }
}

#[test]
fn pulse_in_gives_up_after_a_million_rounds() {
    let Some(mut board) = Board::with("pulse_in") else {
        return;
    };
    board.run_us(1_100_000);
    let [count] = board.variable("count", 0);
    assert_eq!((count, board.long("width_us", 0)), (1, 0));
    let waited = widths(&board.edges(22), true)[0];
    // The default of a second is a million rounds of 16 cycles; while it waits for the start, a round takes 11. The clock's
    // interrupt comes on top.
    assert!((11_000_000..11_100_000).contains(&waited), "{waited}");
}

#[test]
fn interrupts_count_every_edge_of_both_encoders() {
    let Some(mut board) = Board::with("encoders") else {
        return;
    };
    board.run_us(1_000);
    // 20,000 and 12,500 edges a second, a hundred times what the motors make.
    let start = board.cycle();
    for edge in 0..4_000 {
        board.set(start + edge * 800, 20, edge % 2 == 1);
    }
    for edge in 0..2_500 {
        board.set(start + edge * 1_280, 21, edge % 2 == 1);
    }
    board.run_us(210_000);
    assert_eq!(
        (board.long("right", 0), board.long("left", 0)),
        (4_000, 2_500)
    );
}

#[test]
fn servos_get_pulses_of_their_angle_every_20_ms() {
    let Some(mut board) = Board::with("servo") else {
        return;
    };
    board.run_us(100_000);
    for step in 0..5u64 {
        board.run_us(250_000);
        board.forget();
        board.run_us(150_000);
        let up_us = 544 + step * (2_400 - 544) / 4;
        for (pin, expected_us) in [(9, up_us), (10, 544 + 2_400 - up_us)] {
            let edges = board.edges(pin);
            for width in widths(&edges, true) {
                assert!(
                    width.abs_diff(expected_us * CYCLES_PER_US) < 10 * CYCLES_PER_US,
                    "step {step}, pin {pin}: {width}"
                );
            }
            let rises: Vec<u64> = edges.iter().filter(|e| e.1).map(|e| e.0).collect();
            assert!(rises.len() >= 6);
            for two in rises.windows(2) {
                let round = two[1] - two[0];
                assert!(
                    round.abs_diff(20_000 * CYCLES_PER_US) < 40 * CYCLES_PER_US,
                    "{round}"
                );
            }
        }
        board.run_us(100_000);
    }
}

#[test]
fn tones_have_their_pitch() {
    let Some(mut board) = Board::with("tone") else {
        return;
    };
    board.run_us(1_300_000);
    let edges = board.edges(8);
    // Timer 2 clears on compare: the smallest divisor whose top fits in 8 bits, and an interrupt that toggles.
    let mut from = 0;
    for (note_hz, divisor) in [(31, 1024), (440, 128), (1_000, 32), (4_978, 8)] {
        let top = 16_000_000 / note_hz / 2 / divisor - 1;
        let half = divisor * (top + 1);
        let halves = 2 * note_hz / 4;
        let notes: Vec<u64> = edges[from..]
            .windows(2)
            .map(|two| two[1].0 - two[0].0)
            .take_while(|width| *width < 2 * half)
            .collect();
        let mean = notes[1..].iter().sum::<u64>() as f64 / (notes.len() - 1) as f64;
        assert!(
            (mean - half as f64).abs() < 1.0,
            "{note_hz} Hz: {mean} for {half}"
        );
        assert!(
            (notes.len() as u64).abs_diff(halves) <= 2,
            "{note_hz} Hz: {}",
            notes.len()
        );
        from += notes.len() + 1;
    }
}

#[test]
fn the_clock_keeps_time() {
    let Some(mut board) = Board::with("clock") else {
        return;
    };
    board.run_us(2_500_000);
    assert_eq!(board.variable("count", 0), [200]);
    let edges = board.edges(22);
    let edges = &edges[edges.len() - 200..];
    let micros = |index| board.long("micros_at", index);
    // It counts 4 us; what is left is the time until its timer starts and the call.
    let late: Vec<u64> = (0..200)
        .map(|index| edges[index].0 - CYCLES_PER_US * micros(index))
        .collect();
    let (least, most) = (late.iter().min().unwrap(), late.iter().max().unwrap());
    assert!(most - least < 64 && *most < 16_000, "{least} to {most}");
    // It counts 1.024 ms and makes up for the difference.
    for index in 0..200 {
        let behind_ms = micros(index) as f64 / 1_000.0 - board.long("millis_at", index) as f64;
        assert!((-0.1..2.1).contains(&behind_ms), "{behind_ms}");
    }
}

#[test]
fn delays_last_as_long_as_asked() {
    let Some(mut board) = Board::with("delays") else {
        return;
    };
    board.run_us(200_000);
    let edges = board.edges(22);
    let gaps: Vec<u64> = edges.windows(2).map(|two| two[1].0 - two[0].0).collect();
    let gaps = &gaps[gaps.len() - 9..];
    for (gap, us) in gaps.iter().zip([3, 10, 100, 1_000, 16_000]) {
        assert!(gap.abs_diff(us * CYCLES_PER_US) <= 18, "{gap} for {us} us");
    }
    for (gap, ms) in gaps[6..].iter().zip([1, 20, 100]) {
        assert!(gap.abs_diff(ms * 16_000) < CALL, "{gap} for {ms} ms");
    }
}
