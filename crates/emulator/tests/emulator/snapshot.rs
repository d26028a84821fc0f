//! A run is the same every time, and so is its continuation from a snapshot: all state, all outputs.
#![cfg(test)]

use crate::common;
use common::*;
use proptest::prelude::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::{Input, Output};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Timer 1 interrupts at 32 kHz and toggles PB7, timer 3 makes PWM on PE3, USART0 sends by interrupt, INT0 counts edges; the loop
/// computes and uses the stack.
fn busy() -> Chip {
    let mut words = vec![NOP; 0x80];
    words[..2].copy_from_slice(&[0x940C, 0x80]);
    for (vector, target) in [(1, 0x78), (17, 0x72), (26, 0x74)] {
        words[2 * vector..2 * vector + 2].copy_from_slice(&[0x940C, target]);
    }
    let [store, address] = sts(0xC6, 17);
    words[0x72..0x78].copy_from_slice(&[sbi(0x03, 7), RETI, store, address, 0x9513, RETI]);
    // INC r18; RETI.
    words[0x78..0x7A].copy_from_slice(&[0x9523, RETI]);
    for (register, value) in [
        (0x90, 0x81),
        (0x91, 0x03),
        (0x98, 0x40),
        (0x89, 0x01),
        (0x88, 0xF3),
        (0x81, 0x09),
        (0x6F, 0x02),
        (0xC4, 8),
        (0xC1, 0x28),
        (0x69, 0x01),
        (0x3D, 0x01),
        (0x2D, 0x08),
        (0x24, 0x80),
    ] {
        words.push(ldi(16, value));
        words.extend(sts(register, 16));
    }
    // SEI; then INC r20, ADD r21, r20, MUL r20, r21, PUSH r0, POP r22, STS, back.
    words.extend([SEI, 0x9543, 0x0F54, 0x9F45, 0x920F, 0x916F]);
    words.extend(sts(0x300, 22));
    words.push(0xCFF8);
    chip_of(&words)
}

/// Everything that a chip is, and what it has done since it was last asked.
fn state(chip: &mut Chip) -> (u64, Vec<Output>) {
    let outputs = chip.take_outputs();
    let cpu = chip.cpu();
    let mut hash = DefaultHasher::new();
    (
        cpu.cycle(),
        cpu.program_counter(),
        cpu.stack_pointer(),
        cpu.status().bits(),
    )
        .hash(&mut hash);
    (cpu.registers(), cpu.sram(), cpu.is_sleeping()).hash(&mut hash);
    format!("{:?}", chip.devices()).hash(&mut hash);
    (hash.finish(), outputs)
}

const END: u64 = 60_000;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_snapshot_at_any_cycle_goes_on_bit_for_bit(
        mut cycles in prop::collection::vec(0..END, 1..6),
        edges in prop::collection::vec((0..END, any::<bool>()), 0..20),
    ) {
        let mut first = busy();
        for (cycle, level) in edges {
            first.input(cycle, Input::Pin(pin('D', 0), Some(level)));
        }
        let (mut other, mut straight) = (first.clone(), first.clone());
        cycles.sort_unstable();
        let mut outputs = Vec::new();
        for cycle in cycles {
            first.run_until(cycle);
            other.run_until(cycle);
            // The copy continues; the original runs elsewhere, and must not matter.
            let mut copy = other.clone();
            other.run_until(cycle + 777);
            outputs.extend(copy.take_outputs());
            other = copy;
        }
        for chip in [&mut first, &mut other, &mut straight] {
            chip.run_until(END);
        }
        let (hash, whole) = state(&mut first);
        let (other_hash, rest) = state(&mut other);
        outputs.extend(rest);
        prop_assert!(whole.len() > 200, "{}", whole.len());
        prop_assert_eq!(&whole, &outputs);
        prop_assert_eq!(hash, other_hash);
        // A single run gives the same, whatever the peripherals have deferred.
        prop_assert_eq!(straight.cpu().registers(), first.cpu().registers());
        prop_assert_eq!(straight.cpu().sram(), first.cpu().sram());
        prop_assert_eq!(whole, straight.take_outputs());
    }
}
