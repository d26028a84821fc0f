//! What outlives a reset, and what causes one; analog inputs and buses.

use super::board::{Board, CYCLES_PER_US};
use rumbo_emulator::devices::{Cause, Input};

#[test]
fn the_eeprom_takes_its_time_and_outlives_a_reset() {
    let Some(mut board) = Board::with("eeprom") else {
        return;
    };
    board.run_us(100_000);
    // An erased byte is 255.
    assert_eq!(board.variable("starts", 0), [0]);
    // Two bytes of 3.4 ms at most, 3.3 ms typically.
    let write_us = board.long("write_us", 0);
    assert!((6_500..6_900).contains(&write_us), "{write_us}");
    assert!(board.long("update_us", 0) < 50);
    let [a, b, c, d, low, high] = board.variable("settings", 0);
    assert_eq!(f32::from_le_bytes([a, b, c, d]), 1.5);
    assert_eq!(i16::from_le_bytes([low, high]), -7);
    let now = board.cycle();
    board.chip.input(now, Input::Reset(Cause::External));
    board.run_us(100_000);
    assert_eq!(board.variable("starts", 0), [1]);
}

#[test]
fn a_watchdog_that_is_not_fed_resets_the_chip() {
    let Some(mut board) = Board::with("watchdog") else {
        return;
    };
    board.run_us(50_000);
    // PORF: the power was switched on.
    assert_eq!(board.variable("cause", 0), [1]);
    board.run_us(500_000);
    let fed = board.edges(22).last().unwrap().0;
    assert_eq!(board.resets(), []);
    board.run_us(50_000);
    let [(cycle, cause)] = board.resets() else {
        panic!("{:?}", board.resets())
    };
    assert_eq!(*cause, Cause::Watchdog);
    // 32,768 periods of its own 128 kHz.
    let waited = cycle - fed;
    assert!(waited.abs_diff(256_000 * CYCLES_PER_US) < 200, "{waited}");
    // WDRF; the clock takes 65 ms to start again.
    board.run_us(100_000);
    assert_eq!(board.variable("cause", 0), [8]);
}

#[test]
fn analog_inputs_are_read_in_their_time() {
    let Some(mut board) = Board::with("analog") else {
        return;
    };
    let volts_of = |channel: u8| f64::from(channel) * 0.3 + 0.1;
    for channel in 0..16 {
        let volts = volts_of(channel);
        board.chip.input(0, Input::Volts { channel, volts });
    }
    board.run_us(100_000);
    assert_eq!(board.variable("done", 0), [1]);
    for channel in 0..16 {
        let read = u16::from_le_bytes(board.variable("readings", usize::from(channel)));
        let expected = volts_of(channel) / 5.0 * 1024.0;
        assert!(
            (f64::from(read) - expected).abs() <= 1.0,
            "{channel}: {read}"
        );
    }
    // 13 periods of 125 kHz each, 104 us, and the call.
    let each_us = board.long("conversions_us", 0) / 16;
    assert!((104..125).contains(&each_us), "{each_us}");
}

#[test]
fn buses_with_nothing_connected_do_not_block() {
    let Some(mut board) = Board::with("buses") else {
        return;
    };
    board.run_us(100_000);
    assert_eq!(board.variable("done", 0), [1]);
    // 2: nobody acknowledged the address.
    assert_eq!(board.variable("wire_result", 0), [2]);
}
