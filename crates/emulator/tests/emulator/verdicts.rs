//! Programs that cannot go on: where, how they got there, and when.
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Input;
use rumbo_emulator::verdict::{Arrival, Verdict};

const ICALL: u16 = 0x9509;
const EIJMP: u16 = 0x9419;
const RET: u16 = 0x9508;

fn verdict_of(chip: &mut Chip) -> Verdict {
    let Stopped::Ended(verdict) = chip.run_until(100_000) else {
        panic!("it goes on")
    };
    verdict
}

fn arrival_of(words: &[u16]) -> (Arrival, String) {
    let verdict = verdict_of(&mut chip_of(words));
    let line = verdict.to_string();
    match verdict {
        Verdict::ErasedFlash { arrival, .. } | Verdict::IllegalInstruction { arrival, .. } => {
            (arrival, line)
        }
        Verdict::StackOverflow { .. } => panic!("{line}"),
    }
}

#[test]
fn every_verdict_has_location_and_cycle() {
    // RJMP into what was never written.
    let mut chip = chip_of(&[0xC0FF]);
    let Stopped::Ended(verdict) = chip.run_until(100) else {
        panic!()
    };
    assert_eq!(
        verdict,
        Verdict::ErasedFlash {
            program_counter: 0x100,
            arrival: Arrival::Jump { at: 0 },
            cycle: 2
        }
    );
    assert!(
        verdict.to_string().contains("0x00200 in cycle 2"),
        "{verdict}"
    );
    // It stays ended.
    assert_eq!(chip.run_until(200), Stopped::Ended(verdict));
    let mut chip = chip_of(&[NOP, 0x0001]);
    let Stopped::Ended(verdict) = chip.run_until(100) else {
        panic!()
    };
    assert_eq!(
        verdict,
        Verdict::IllegalInstruction {
            program_counter: 1,
            word: 1,
            arrival: Arrival::Sequence { at: 0 },
            cycle: 1
        }
    );
    // RCALL itself: 8191 bytes of SRAM and one below hold 2730 addresses and two thirds.
    let mut chip = chip_of(&[0xDFFF]);
    let Stopped::Ended(verdict) = chip.run_until(100_000) else {
        panic!()
    };
    let Verdict::StackOverflow {
        program_counter: 0,
        floor: 0x200,
        cycle,
        ..
    } = verdict
    else {
        panic!("{verdict}")
    };
    assert_eq!(cycle / 4, 8192 / 3);
}

#[test]
fn a_stack_among_the_data_is_no_overflow_but_one_that_grows_into_them_is() {
    let program = |to: [u8; 2]| {
        let [low, high] = to;
        chip_of(&[
            ldi(28, low),
            ldi(29, high),
            out(0x3E, 29),
            out(0x3D, 28),
            0x93CF,
            0x93CF,
            0xCFFF,
        ])
    };
    for (to, ends) in [([0x00, 0x05], false), ([0x01, 0x1F], true)] {
        let mut chip = program(to);
        chip.cpu_mut().set_stack_floor(0x1F02);
        let stopped = chip.run_until(1000);
        assert_eq!(
            matches!(stopped, Stopped::Ended(Verdict::StackOverflow { .. })),
            ends,
            "{stopped:?}"
        );
    }
}

#[test]
fn a_return_to_nowhere_names_itself_and_the_stack_pointer() {
    // Three bytes of 0xAA as an address: 0xAAAA, and a bit that the program counter does not have.
    let words = [ldi(16, 0xAA), 0x930F, 0x930F, 0x930F, RET];
    let (arrival, line) = arrival_of(&words);
    let at = 4;
    let stack_pointer = 0x21FF;
    assert_eq!(arrival, Arrival::Return { at, stack_pointer });
    assert!(line.contains("erased flash at 0x15554"), "{line}");
    assert!(
        line.contains("return at 0x00008 with the stack pointer at 0x21ff"),
        "{line}"
    );
}

#[test]
fn a_wrong_pointer_names_the_call_or_jump_through_it() {
    for (jump, mnemonic) in [(ICALL, "icall"), (EIJMP, "eijmp")] {
        let (arrival, line) = arrival_of(&[ldi(31, 0x40), ldi(30, 0), jump]);
        assert_eq!(arrival, Arrival::Pointer { at: 2, mnemonic });
        assert!(line.contains(mnemonic), "{line}");
    }
}

#[test]
fn an_end_that_is_run_over_names_the_last_instruction() {
    // LDS is two words.
    let (arrival, _) = arrival_of(&[NOP, 0x9100, 0x0200]);
    assert_eq!(arrival, Arrival::Sequence { at: 1 });
    // JMP 0x1000 from 0, then a constant that is no instruction: nobody ran into it but the jump.
    let (arrival, _) = arrival_of(&[0x940C, 0x0003, 0x0001, 0x940C, 0x1000]);
    assert_eq!(arrival, Arrival::Jump { at: 3 });
}

#[test]
fn an_interrupt_without_a_table_and_an_empty_image_are_recognised() {
    // EICRA: INT0 on any edge; EIMSK; SEI.
    let words = [ldi(16, 1), 0x9300, 0x0069, out(0x1D, 16), SEI, 0xCFFF];
    let mut long = vec![NOP; 0x40];
    long[..2].copy_from_slice(&[0x940C, 0x0030]);
    long[2..4].copy_from_slice(&[0xFFFF, 0xFFFF]);
    long[0x30..0x36].copy_from_slice(&words);
    let mut chip = chip_of(&long);
    chip.input(50, Input::Pin(pin('D', 0), Some(true)));
    let Verdict::ErasedFlash { arrival, .. } = verdict_of(&mut chip) else {
        panic!()
    };
    assert_eq!(arrival, Arrival::Interrupt { vector: 1 });
    assert_eq!(arrival_of(&[0xFFFF]).0, Arrival::Start);
}

#[test]
fn a_stack_overflow_reports_its_depth_and_the_functions_on_it() {
    // Two functions that call each other, with a byte pushed in between: seven bytes a round.
    let mut chip = chip_of(&[0xD001, 0xCFFF, 0x930F, 0xD000, 0xDFFD]);
    let Verdict::StackOverflow { depth, returns, .. } = verdict_of(&mut chip) else {
        panic!()
    };
    assert!((0x1FFF..0x2003).contains(&depth), "{depth:#x}");
    let [inner, .., outer] = returns[..] else {
        panic!("{returns:?}")
    };
    assert_eq!(outer, 1);
    assert!([4, 5].contains(&inner), "{inner}");
    assert!((2_000..2_400).contains(&returns.len()), "{}", returns.len());
}
