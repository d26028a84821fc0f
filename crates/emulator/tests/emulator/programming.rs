//! Boot section, SPM, fuses and signature (2549Q, section 29).
#![cfg(test)]

use crate::common;
use common::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Fuses;
use rumbo_emulator::image::Image;
use rumbo_emulator::model::ATMEGA2560;

const SPMCSR: u8 = 0x37;
const SPM: u16 = 0x95E8;
/// Start of the boot section [bytes].
const BOOT: usize = 0x3_E000;

/// Puts `r1:r0` to r20 and r21, Z to r30 and r31, RAMPZ to 0, and does `command`.
fn spm(command: u8, word: u16, z: u16) -> Vec<u16> {
    let [low, high] = word.to_le_bytes();
    let [z_low, z_high] = z.to_le_bytes();
    // MOV r0, r20 and r1, r21.
    vec![
        ldi(20, low),
        ldi(21, high),
        0x2E04,
        0x2E15,
        ldi(30, z_low),
        ldi(31, z_high),
        ldi(16, command),
        out(SPMCSR, 16),
        SPM,
    ]
}

/// A chip with `words` in its boot section, and an endless loop of 0x1234 everywhere in its second page.
fn with_boot(words: &[u16], fuses: Fuses) -> Chip {
    with_application(words, fuses, 512)
}

/// The same with this many bytes of an application.
fn with_application(words: &[u16], fuses: Fuses, bytes_of_it: u16) -> Chip {
    let mut records = vec![ihex::Record::ExtendedLinearAddress(3)];
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    for (index, chunk) in bytes.chunks(16).enumerate() {
        records.push(ihex::Record::Data {
            offset: (BOOT % 0x1_0000 + 16 * index) as u16,
            value: chunk.to_vec(),
        });
    }
    records.push(ihex::Record::ExtendedLinearAddress(0));
    for offset in (0..bytes_of_it).step_by(16) {
        records.push(ihex::Record::Data {
            offset,
            value: [0x34, 0x12].repeat(8),
        });
    }
    records.push(ihex::Record::EndOfFile);
    let text = ihex::create_object_file_representation(&records).unwrap();
    Chip::with_fuses(&Image::parse(text.as_bytes()).unwrap(), fuses)
}

#[test]
fn a_boot_loader_erases_and_writes_a_page() {
    let mut words = spm(0x01, 0xBEEF, 0x0104);
    words.extend(spm(0x01, 0x0001, 0x0104));
    words.extend(spm(0x03, 0, 0x0100));
    let erased = words.len() as u64;
    // Waits for SPMEN to fall: IN r17, SPMCSR; SBRC r17, 0; RJMP back.
    let wait = [0xB717, 0xFD10, 0xCFFD];
    words.extend(wait);
    words.extend(spm(0x05, 0, 0x0100));
    words.extend(wait);
    words.extend(spm(0x11, 0, 0));
    words.push(0xCFFF);
    let mut chip = with_boot(&words, ATMEGA2560.fuses);
    assert_eq!(chip.cpu().program_counter() as usize, BOOT / 2, "BOOTRST");
    chip.run_until(erased + 71_990);
    assert_eq!(chip.cpu().flash()[0x100..0x104], [0xFF; 4]);
    assert_eq!(read(&mut chip, 0x57), 0x43, "busy, and the section too");
    chip.run_until(erased + 72_020);
    assert_eq!(
        chip.cpu().flash()[0x100..0x108],
        [0xFF, 0xFF, 0xFF, 0xFF, 0xEF, 0xBE, 0xFF, 0xFF]
    );
    chip.run_until(200_000);
    assert_eq!(read(&mut chip, 0x57), 0);
    assert_eq!(chip.cpu().flash()[..2], [0x34, 0x12], "other pages stay");
    assert_eq!(chip.cpu().flash()[0x200..0x202], [0xFF, 0xFF]);
}

#[test]
fn a_page_of_the_boot_section_holds_the_cpu() {
    // ELPM's RAMPZ is 3 for the last page.
    let mut words = vec![ldi(16, 3), out(0x3B, 16)];
    words.extend(spm(0x03, 0, 0xFF00));
    let begun = words.len() as u64;
    words.push(0xCFFF);
    let mut chip = with_boot(&words, ATMEGA2560.fuses);
    chip.run_until(begun);
    chip.step();
    assert_eq!(chip.cpu().cycle(), begun + 72_000);
}

#[test]
fn outside_of_the_boot_section_and_too_late_spm_does_nothing() {
    let mut words = spm(0x03, 0, 0x0000);
    words.push(0xCFFF);
    let mut chip = chip_of(&words);
    chip.run_until(1_000);
    assert_eq!(chip.cpu().flash()[0], words[0].to_le_bytes()[0]);
    let mut late = spm(0x03, 0, 0x0000);
    late.pop();
    late.extend([NOP, NOP, NOP, NOP, SPM, 0xCFFF]);
    let mut chip = with_boot(&late, ATMEGA2560.fuses);
    chip.run_until(1_000);
    assert_eq!(chip.cpu().flash()[0], 0x34);
}

#[test]
fn fuses_lock_bits_and_signature_are_read_with_lpm() {
    // LPM r`register`, Z after SPMCSR.
    let mut words = Vec::new();
    for (register, command, z) in [
        (2u8, 0x09u8, 0u8),
        (3, 0x09, 1),
        (4, 0x09, 2),
        (5, 0x09, 3),
        (6, 0x21, 0),
        (7, 0x21, 2),
        (8, 0x21, 4),
    ] {
        words.extend([ldi(30, z), ldi(31, 0), ldi(16, command), out(SPMCSR, 16)]);
        words.push(0x9004 | u16::from(register) << 4);
    }
    words.extend([ldi(30, 2), 0x9004 | 9 << 4, 0xCFFF]);
    let mut chip = chip_of(&words);
    chip.run_until(200);
    let expected = [
        0xFF,
        0xCF,
        0xFD,
        0xD8,
        0x1E,
        0x98,
        0x01,
        words[1].to_le_bytes()[0],
    ];
    assert_eq!(chip.cpu().registers()[2..10], expected);
}

#[test]
fn fuses_select_the_reset_address() {
    for (high, start) in [(0xD8u8, 0x1_F000), (0xDA, 0x1_F800), (0xDE, 0x1_FE00)] {
        let fuses = Fuses {
            high,
            ..ATMEGA2560.fuses
        };
        assert_eq!(ATMEGA2560.boot_start(fuses), start);
        assert!(fuses.starts_in_boot());
    }
    let application = Fuses {
        high: 0xD9,
        ..ATMEGA2560.fuses
    };
    assert_eq!(with_boot(&[NOP], application).cpu().program_counter(), 0);
    assert_eq!(chip_of(&[NOP]).cpu().program_counter(), 0, "nothing there");
}

#[test]
fn a_boot_loader_is_passed_when_it_has_jumped_to_the_application() {
    // 65,536 rounds of SBIW and BRNE, 4 cycles each, then JMP 0; the application is an endless loop of 0x1234.
    let words = [ldi(24, 0), ldi(25, 0), 0x9701, 0xF7F1, 0x940C, 0];
    let mut chip = with_boot(&words, ATMEGA2560.fuses);
    let early = {
        let mut chip = chip.clone();
        chip.pass_boot_loader(100_000);
        chip
    };
    assert!(early.cpu().program_counter() >= ATMEGA2560.boot_start(ATMEGA2560.fuses));
    chip.pass_boot_loader(u64::MAX);
    assert!(chip.cpu().program_counter() < 0x1000);
    let cycle = chip.cycle();
    assert!((262_144..262_144 + 1_100).contains(&cycle), "{cycle}");
    // Without one there is nothing to wait for.
    let mut bare = chip_of(&[0xCFFF]);
    bare.pass_boot_loader(u64::MAX);
    assert_eq!(bare.cycle(), 0);
}

#[test]
fn without_an_application_the_blank_flash_leads_to_the_boot_loader_again() {
    // JMP 0: three cycles, and one for each blank word.
    let mut chip = with_application(&[0x940C, 0], ATMEGA2560.fuses, 0);
    let start = ATMEGA2560.boot_start(ATMEGA2560.fuses);
    for round in 0..3 {
        assert_eq!(chip.cpu().program_counter(), start, "round {round}");
        chip.step();
        assert_eq!(chip.cpu().program_counter(), 0);
        let arrives = chip.cycle() + u64::from(start);
        assert_eq!(chip.run_until(arrives), Stopped::Reached);
        assert_eq!(chip.cycle(), arrives);
    }
    // Behind the end of an application it is an error, as without a boot loader.
    let mut chip = with_application(&[0x940C, 0], ATMEGA2560.fuses, 16);
    assert!(matches!(chip.run_until(1_000_000), Stopped::Ended(_)));
}
