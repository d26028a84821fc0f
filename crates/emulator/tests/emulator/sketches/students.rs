//! Programs as students write them: libraries of their own, timers taken over, sleep, tasks, text.

use super::board::{Board, CYCLES_PER_US, widths};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Cause, Input};

fn text(board: &Board, usart: u8) -> String {
    let bytes = board.sent(usart);
    bytes.iter().map(|(_, byte)| char::from(*byte)).collect()
}

#[test]
fn floats_strings_tables_and_objects_print_what_the_c_library_says() {
    let Some(mut board) = Board::with("text") else {
        return;
    };
    board.run_us(120_000);
    let said = text(&board, 0);
    // simavr gives the same.
    let expected = [
        "10.6200 106.20",
        "14.6005 39.81",
        "18.3115 37.11",
        "21.1684 28.57",
        "0.333333",
        "nan",
        "ovf",
        "-0.00",
        "852.630",
        "FF",
        "11111111111111111111111111110110",
        "4000000000",
        "REF 40 1.250 cm",
        "53",
        "15",
        "    3.14",
        "  -42|ab   |beef|123456789",
        "-3.00",
        "9;7;3;-5;4711",
        "21.57",
        "1",
        "far away10",
        "7",
    ];
    assert_eq!(said.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn numbers_and_lines_are_read_as_they_come_and_up_to_a_time_out() {
    let Some(mut board) = Board::with("text") else {
        return;
    };
    board.run_us(120_000);
    for (said, wait_us, answer) in [
        ("i-123 ", 20_000, "-246\r\n"),
        // Without a terminator, only the time-out of 50 ms ends it.
        ("f2.5", 60_000, "5.000\r\n"),
        ("REF 40\n", 20_000, "<REF 40>\r\n"),
        ("half", 60_000, "<half>\r\n"),
    ] {
        board.forget();
        let now = board.cycle();
        for byte in said.bytes() {
            let (usart, baud) = (0, 115_200);
            board.chip.input(now, Input::Serial { usart, byte, baud });
        }
        board.run_us(wait_us);
        // The space after the number is a line of its own.
        assert!(
            text(&board, 0).starts_with(answer),
            "{said}: {}",
            text(&board, 0)
        );
        board.run_us(60_000);
    }
}

#[test]
fn tasks_that_a_timer_switches_keep_their_registers() {
    let Some(mut board) = Board::with("tasks") else {
        return;
    };
    board.run_us(500_000);
    assert_eq!(board.variable("intact", 0), [1]);
    let [low, high] = board.variable("switches", 0);
    let switches = u16::from_le_bytes([low, high]);
    assert!((490..=500).contains(&switches), "{switches}");
    let [first, second] = [0, 1].map(|task| board.long("counts", task));
    assert!(
        first > 3_000 && first.abs_diff(second) < first / 10,
        "{first} {second}"
    );
}

#[test]
fn an_echo_is_timed_by_a_timer_by_capture_and_by_a_wait_that_ends() {
    let Some(mut board) = Board::with("sonars") else {
        return;
    };
    board.set(0, 2, false);
    board.run_us(300);
    let trigger = board.edges(3);
    let (end, _) = *trigger.iter().find(|(_, high)| !high).unwrap();
    // An echo of 1500 us on pin 2, and one of 700 us on the capture pin, 48.
    for (after_us, pin, level) in [(450, 2, true), (1_950, 2, false)] {
        board.set(end + after_us * CYCLES_PER_US, pin, level);
    }
    let capture = Pin::new('L', 1).unwrap();
    for (after_us, level) in [(600, true), (1_300, false)] {
        let at = end + after_us * CYCLES_PER_US;
        board.chip.input(at, Input::Pin(capture, Some(level)));
    }
    while board.edges(3).len() < 4 {
        board.run_us(100);
    }
    let [low, high] = board.variable("ping_us", 0);
    let ping_us = u16::from_le_bytes([low, high]);
    assert!((1_464..=1_536).contains(&ping_us), "{ping_us}");
    let [low, high] = board.variable("captured_ticks", 0);
    assert_eq!(u16::from_le_bytes([low, high]), 1_400);
    assert_eq!(board.variable("captures", 0), [1, 0]);
    // Nothing came: 25,000 rounds of 11 cycles, not of the 16 that the Arduino core assumes.
    assert_eq!(board.long("gave", 0), 0);
    let given_up_us = board.long("given_up_us", 0);
    assert!((17_180..17_500).contains(&given_up_us), "{given_up_us}");
    let trigger = board.edges(3);
    let (end, _) = *trigger.last().unwrap();
    for (after_us, level) in [(450, true), (3_450, false)] {
        board.set(end + after_us * CYCLES_PER_US, 2, level);
    }
    board.run_us(10_000);
    let seen_us = board.long("seen_us", 0);
    assert!((2_975..=3_010).contains(&seen_us), "{seen_us}");
}

#[test]
fn sleep_ends_with_what_may_wake_it_and_with_nothing_else() {
    let Some(mut board) = Board::with("sleepy") else {
        return;
    };
    board.run_us(2_000_000);
    assert_eq!(board.variable("stage", 0), [1]);
    assert_eq!(board.variable("watchdogs", 0), [3]);
    // 65,536 cycles of 128 kHz are 512 ms, and the crystal takes a millisecond.
    let times: Vec<u64> = board.edges(22).iter().map(|(cycle, _)| *cycle).collect();
    for two in times.windows(2) {
        let us = (two[1] - two[0]) / CYCLES_PER_US;
        assert!((511_900..513_200).contains(&us), "{us}");
    }
    // Timer 0 stood.
    assert!(board.long("awake_ms", 0) <= 1);
    let now = board.cycle();
    let a8 = Pin::new('K', 0).unwrap();
    board.chip.input(now, Input::Pin(a8, Some(false)));
    board.run_us(20_000);
    assert_eq!(
        [board.variable("stage", 0), board.variable("pins", 0)],
        [[2], [1]]
    );
    let now = board.cycle();
    board.set(now, 2, false);
    board.set(now + 1_000 * CYCLES_PER_US, 2, true);
    board.forget();
    board.run_us(200_000);
    assert_eq!(board.variable("externals", 0), [1]);
    assert_eq!(board.variable("compares", 0), [5]);
    let [.., from, to] = board.edges(22)[..] else {
        panic!()
    };
    let us = (to.0 - from.0) / CYCLES_PER_US;
    assert!((49_990..50_020).contains(&us), "{us}");
    // For ever, but for a reset.
    board.run_us(3_000_000);
    assert_eq!(board.variable("stage", 0), [4]);
    let now = board.cycle();
    board.chip.input(now, Input::Reset(Cause::External));
    board.run_us(1_000_000);
    assert_eq!(board.variable("stage", 0), [0]);
}

/// Period and width of the last whole wave of a pin [cycles].
fn wave(board: &Board, pin: u8) -> [u64; 2] {
    let edges = board.edges(pin);
    let [.., high, low] =
        [widths(&edges, true), widths(&edges, false)].map(|widths| widths[widths.len() - 2]);
    [high + low, high]
}

#[test]
fn pwm_has_the_frequency_that_the_program_gave_its_timer() {
    let Some(mut board) = Board::with("frequencies") else {
        return;
    };
    board.run_us(19_000);
    for (pin, period, width) in [
        (5, 510, 200),
        (6, 510 * 8, 400 * 8),
        (11, 800, 200),
        (12, 800, 600),
        (9, 256, 64),
    ] {
        assert_eq!(wave(&board, pin), [period, width], "pin {pin}");
    }
    // 0 and 255 are levels, by digitalWrite; 1 and 254 are waves again.
    board.run_us(3_000);
    board.forget();
    board.run_us(1_000);
    for (pin, high) in [(5, false), (6, true)] {
        assert_eq!(board.edges(pin), []);
        let pin = if pin == 5 { ('E', 3) } else { ('H', 3) };
        let pin = Pin::new(pin.0, pin.1).unwrap();
        assert_eq!(Chip::devices(&board.chip).level(pin), high);
    }
    board.run_us(10_000);
    assert_eq!(wave(&board, 5), [510, 2]);
    assert_eq!(wave(&board, 6), [510 * 8, 508 * 8]);
}

#[test]
fn clocks_run_past_their_ends() {
    let Some(mut board) = Board::with("rollover") else {
        return;
    };
    board.run_us(1_000_000);
    assert_eq!(board.variable("done", 0), [1]);
    // Steps of 1.024 ms, every 42nd of them two.
    assert!((299..=301).contains(&board.long("slept_ms", 0)));
    assert!((171..174).contains(&board.long("late_ms", 0)));
    let apart = board.long("micros_apart", 0);
    assert!((5_000..5_060).contains(&apart), "{apart}");
    let edges = board.edges(22);
    // The first is the pin's becoming an output.
    let edges = &edges[1..];
    assert_eq!(edges.len(), 200);
    let us = (edges[199].0 - edges[0].0) / CYCLES_PER_US;
    assert!(us.abs_diff(199 * 1_250) < 20, "{us}");
}

#[test]
fn bare_registers_do_as_the_datasheet_has_it() {
    let Some(mut board) = Board::with("registers") else {
        return;
    };
    for channel in [2, 3] {
        board.chip.input(
            0,
            Input::Volts {
                channel,
                volts: 1.28,
            },
        );
    }
    let [a8, a9] = [0, 1].map(|bit| Pin::new('K', bit).unwrap());
    board.run_us(1_000);
    let start = board.cycle();
    // Forwards 40 steps, back 10, 100 us each.
    let mut at = start;
    let mut phase = 2u8;
    for step in 0..50 {
        phase = if step < 40 { phase + 1 } else { phase - 1 };
        at += 100 * CYCLES_PER_US;
        let quarter = phase % 4;
        let gray = quarter ^ (quarter >> 1);
        for (bit, pin) in [a8, a9].into_iter().enumerate() {
            board
                .chip
                .input(at, Input::Pin(pin, Some(gray >> bit & 1 != 0)));
        }
    }
    // 'R' and 'u' as 7E2, and one whose parity is wrong.
    for (letter, wrong) in [(b'R', 0), (b'u', 0), (b'x', 1)] {
        let odd = letter.count_ones() as u16 & 1;
        let bits = u16::from(letter & 0x7F) | (odd ^ wrong) << 7 | 0x300;
        let (usart, count, baud) = (3, 10, 9_600);
        let input = Input::Frame {
            usart,
            bits,
            count,
            baud,
        };
        board.chip.input(start, input);
    }
    board.run_us(20_000);
    assert_eq!(text(&board, 3), "Rux");
    assert_eq!(board.variable("parity", 0), [1, 0]);
    let steps = i32::from_le_bytes(board.variable("position", 0));
    assert_eq!(steps.abs(), 30);
    assert_eq!(board.variable("errors", 0), [0, 0]);
    assert_eq!(board.long("free_running", 0), 512);
    let (before, now) = (board.long("conversions", 0), board.cycle());
    board.run_us(100_000);
    let conversions = board.long("conversions", 0) - before;
    let expected = (board.cycle() - now) / (13 * 128);
    assert!(
        conversions.abs_diff(expected) <= 1,
        "{conversions} {expected}"
    );
}
