//! The counter alone.

use super::*;

fn wave(wide: bool, wgm: u8, compare: [u16; 3], capture: u16) -> Wave {
    let mut wave = Wave::new(wide, if wide { 3 } else { 2 });
    wave.set_mode(if wide {
        Mode::wide(wgm)
    } else {
        Mode::narrow(wgm)
    });
    wave.compare = compare;
    wave.buffered = compare;
    wave.capture = capture;
    wave
}

/// The ticks at which `flag` is raised in `ticks` ticks; it is cleared each time.
fn raised(wave: &mut Wave, flag: u8, ticks: u64) -> Vec<u64> {
    let mut times = Vec::new();
    for tick in 1..=ticks {
        wave.tick(1);
        if wave.flags & flag != 0 {
            times.push(tick);
        }
        wave.flags = 0;
    }
    times
}

#[test]
fn periods_are_those_of_the_tables() {
    for (wide, wgm, compare, capture, flag, period) in [
        (false, 0, 0, 0, OVERFLOW, 256),
        (false, 1, 0, 0, OVERFLOW, 510),
        (false, 2, 99, 0, MATCH[0], 100),
        (false, 3, 0, 0, OVERFLOW, 256),
        (false, 5, 99, 0, OVERFLOW, 198),
        (false, 7, 99, 0, OVERFLOW, 100),
        (true, 1, 0, 0, OVERFLOW, 510),
        (true, 2, 0, 0, OVERFLOW, 1022),
        (true, 3, 0, 0, OVERFLOW, 2046),
        (true, 4, 499, 0, MATCH[0], 500),
        (true, 5, 0, 0, OVERFLOW, 256),
        (true, 6, 0, 0, OVERFLOW, 512),
        (true, 7, 0, 0, OVERFLOW, 1024),
        (true, 8, 0, 300, OVERFLOW, 600),
        (true, 9, 300, 0, OVERFLOW, 600),
        (true, 10, 0, 300, OVERFLOW, 600),
        (true, 11, 300, 0, OVERFLOW, 600),
        (true, 12, 0, 300, CAPTURE, 301),
        (true, 14, 0, 300, OVERFLOW, 301),
        (true, 15, 300, 0, OVERFLOW, 301),
    ] {
        let mut wave = wave(wide, wgm, [compare, 0, 0], capture);
        let times = raised(&mut wave, flag, 4 * period);
        assert!(times.len() >= 3, "mode {wgm} of {wide}: {times:?}");
        let steps: Vec<_> = times.windows(2).map(|two| two[1] - two[0]).collect();
        assert!(
            steps.iter().all(|step| *step == period),
            "mode {wgm}: {steps:?}"
        );
        assert_eq!(wave.period(), period, "mode {wgm}");
    }
}

#[test]
fn one_stride_is_the_same_as_many_single_ticks() {
    for wgm in [0, 1, 3, 4, 8, 9, 11, 12, 14, 15] {
        for stride in [1u64, 7, 100, 1_000] {
            let start = wave(true, wgm, [700, 250, 251], 900);
            let (mut once, mut singly) = (start, start);
            once.pin_mode = [2, 3, 1];
            singly.pin_mode = [2, 3, 1];
            for _ in 0..50 {
                let mut left = stride;
                while left > 0 {
                    let step = once.quiet_ticks(0xFF).min(left);
                    once.tick(step);
                    left -= step;
                }
                (0..stride).for_each(|_| {
                    singly.tick(1);
                });
                assert_eq!(once.count, singly.count, "mode {wgm}");
                assert_eq!((once.flags, once.output), (singly.flags, singly.output));
            }
        }
    }
}

/// Ticks per period for which channel B's output is high.
fn high(wgm: u8, pin_mode: u8, compare: u16) -> u64 {
    let mut wave = wave(true, wgm, [0, compare, 0], 1000);
    wave.pin_mode[1] = pin_mode;
    let period = wave.period();
    (0..2 * period).for_each(|_| {
        wave.tick(1);
    });
    let high = |wave: &mut Wave| {
        wave.tick(1);
        u64::from(wave.output[1])
    };
    (0..period).map(|_| high(&mut wave)).sum()
}

#[test]
fn pulses_are_as_wide_as_the_datasheet_says() {
    // Fast: OCR + 1 of TOP + 1; a spike of one tick at the bottom, all high at the top.
    assert_eq!(
        [high(14, 2, 0), high(14, 2, 250), high(14, 2, 1000)],
        [1, 251, 1001]
    );
    assert_eq!(high(14, 3, 250), 1001 - 251);
    // Phase correct: 2 OCR of 2 TOP; all low at the bottom, all high at the top.
    assert_eq!(
        [high(10, 2, 0), high(10, 2, 250), high(10, 2, 1000)],
        [0, 500, 2000]
    );
    assert_eq!(high(8, 3, 250), 2000 - 500);
}

#[test]
fn a_new_compare_value_waits_for_top_or_bottom() {
    for (wgm, taken_at) in [(14, 0), (10, 999), (8, 1)] {
        let mut wave = wave(true, wgm, [0, 10, 0], 1000);
        (0..500).for_each(|_| {
            wave.tick(1);
        });
        wave.set_compare(1, 20);
        while wave.compare[1] == 10 {
            wave.tick(1);
        }
        assert_eq!(wave.count, taken_at, "mode {wgm}");
    }
    let mut wave = wave(true, 4, [1000, 10, 0], 0);
    wave.set_compare(1, 20);
    assert_eq!(wave.compare[1], 20, "without PWM at once");
}

#[test]
fn a_written_counter_misses_the_match_of_the_next_tick() {
    let mut wave = wave(true, 4, [1000, 10, 0], 0);
    wave.count = 10;
    wave.blocked = true;
    wave.tick(1);
    assert_eq!(wave.flags & MATCH[1], 0);
    wave.count = 9;
    wave.blocked = true;
    wave.tick(2);
    wave.tick(1);
    assert_eq!(wave.flags & MATCH[1], MATCH[1]);
}
