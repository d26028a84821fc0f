//! What else has registers only, and addresses without any (2549Q, sections 9 and 33).
#![cfg(test)]

use crate::common;
use common::*;

#[test]
fn every_register_of_the_chip_is_one_and_nothing_else_is() {
    // Reserved addresses of the data space (section 33, from page 399).
    let reserved = [
        0x49, 0x4F, 0x52, 0x56, 0x58, 0x59, 0x5A, 0x62, 0x63, 0x67, 0x76, 0x77, 0x83, 0x8E, 0x8F,
        0x93, 0x9E, 0x9F, 0xA3, 0xAE, 0xAF, 0xB5, 0xB7, 0xBE, 0xBF, 0xC3, 0xC7, 0xCB, 0xCF, 0xD3,
        0x123, 0x12E, 0x12F, 0x133,
    ];
    let ranges = [0xD7..=0xFF, 0x10C..=0x11F, 0x137..=0x1FF];
    let (mut chip, _) = set_up(&[(0x3E, 0)]);
    for address in 0x20..0x200u16 {
        // EIND, RAMPZ, the stack pointer and SREG are the CPU's own.
        if !matches!(address, 0x5B..=0x5F) {
            read(&mut chip, address);
        }
    }
    let addresses: Vec<u16> = chip
        .unmodelled()
        .iter()
        .map(|access| access.address)
        .collect();
    let mut expected: Vec<u16> = reserved.into();
    expected.extend(ranges.into_iter().flatten());
    expected.sort_unstable();
    assert_eq!(addresses, expected);
}

#[test]
fn memory_that_is_not_there_is_reported() {
    let (mut chip, _) = set_up(&[(0x74, 0x80), (0x2200, 1)]);
    chip.run_until(50);
    let addresses: Vec<u16> = chip
        .unmodelled()
        .iter()
        .map(|access| access.address)
        .collect();
    assert_eq!(addresses, [0x74, 0x2200]);
}
