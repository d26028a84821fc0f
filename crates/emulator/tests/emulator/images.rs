//! Files that are no program for this chip: one clear line each, and no file stops the emulator.
#![cfg(test)]

use crate::common;
use common::*;
use proptest::prelude::*;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Input;
use rumbo_emulator::image::{Image, ImageError};
use rumbo_emulator::model::{ATMEGA328P, ATMEGA2560, MODELS};
use rumbo_emulator::observe::profile::Profile;

const AVR: u16 = 83;
const AVR6: u32 = 6;

/// An ELF file of segments: physical address and contents.
struct Elf {
    machine: u16,
    flags: u32,
    kind: u16,
    segments: Vec<(u32, Vec<u8>)>,
}

impl Elf {
    fn of(segments: &[(u32, &[u8])]) -> Elf {
        Elf {
            machine: AVR,
            flags: AVR6,
            kind: 2,
            segments: segments
                .iter()
                .map(|(at, bytes)| (*at, bytes.to_vec()))
                .collect(),
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let count = self.segments.len() as u16;
        let mut bytes = b"\x7fELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
        bytes.extend(self.kind.to_le_bytes());
        bytes.extend(self.machine.to_le_bytes());
        for word in [1, 0, 52, 0, self.flags] {
            bytes.extend(u32::to_le_bytes(word));
        }
        for half in [52, 32, count, 40, 0, 0] {
            bytes.extend(u16::to_le_bytes(half));
        }
        let mut offset = 52 + 32 * u32::from(count);
        for (at, contents) in &self.segments {
            let size = contents.len() as u32;
            for word in [1, offset, *at, *at, size, size, 5, 1] {
                bytes.extend(u32::to_le_bytes(word));
            }
            offset += size;
        }
        bytes.extend(self.segments.iter().flat_map(|(_, contents)| contents));
        bytes
    }

    fn error(&self) -> ImageError {
        Image::parse(&self.bytes()).unwrap_err()
    }
}

#[test]
fn an_elf_file_is_loaded_to_the_memories_it_names() {
    let elf = Elf::of(&[
        (0, &[1, 2]),
        (6, &[3]),
        (0x81_0004, &[9]),
        (0x82_0000, &[0xFF]),
    ]);
    let image = Image::parse(&elf.bytes()).unwrap();
    assert_eq!(image.flash(), [1, 2, 0xFF, 0xFF, 0xFF, 0xFF, 3]);
    assert_eq!(image.eeprom(), [0xFF, 0xFF, 0xFF, 0xFF, 9]);
}

#[test]
fn a_program_for_another_machine_is_recognised() {
    let elf = Elf {
        machine: 62,
        ..Elf::of(&[(0, &[1])])
    };
    assert_eq!(elf.error(), ImageError::Processor(62));
    // The flags of an ATtiny85's program; the top bit allows the linker to relax.
    let elf = Elf {
        flags: 0x99,
        ..Elf::of(&[(0, &[1])])
    };
    assert_eq!(elf.error(), ImageError::Chip(25));
    let elf = Elf {
        kind: 1,
        ..Elf::of(&[])
    };
    assert_eq!(elf.error(), ImageError::Object);
}

#[test]
fn an_image_says_which_board_it_is_for_and_is_refused_on_another() {
    let uno = Elf {
        flags: 5,
        ..Elf::of(&[(0, &[1])])
    };
    let image = Image::parse(&uno.bytes()).unwrap();
    assert_eq!(image.model().name, "atmega328p");
    assert!(image.clone().on(&ATMEGA328P).is_ok());
    let refused = image.on(&ATMEGA2560).unwrap_err().to_string();
    assert!(
        refused.contains("an Arduino Uno or Nano, and this robot has an Arduino Mega")
            && refused.contains("Tools > Board > Arduino Mega or Mega 2560"),
        "{refused}"
    );
}

#[test]
fn what_does_not_fit_is_refused_with_the_memory_and_its_size() {
    let error = |at, bytes: &[u8]| Elf::of(&[(0, &[1]), (at, bytes)]).error();
    let too_large = |memory, end, size| ImageError::TooLarge { memory, end, size };
    assert_eq!(
        error(0x3_FFFF, &[1, 2]),
        too_large("flash", 0x4_0001, 0x4_0000)
    );
    assert_eq!(
        error(0x81_0FFF, &[1, 2]),
        too_large("EEPROM", 0x1001, 0x1000)
    );
    assert_eq!(error(0, &[1]), ImageError::Overlap(0));
}

#[test]
fn a_file_that_is_cut_off_is_refused_wherever_it_is_cut() {
    let whole = Elf::of(&[(0, &[1, 2, 3, 4])]).bytes();
    for end in 1..whole.len() {
        let error = Image::parse(&whole[..end]).unwrap_err();
        let line = error.to_string();
        assert!(!line.is_empty() && !line.contains('\n'), "{line}");
    }
}

/// Bytes that get past the first look of the loader.
fn nearly_a_file() -> impl Strategy<Value = Vec<u8>> {
    let noise = prop::collection::vec(any::<u8>(), 0..300);
    let hex = "(:[0-9A-F]{10,44}\r?\n){0,9}(:00000001FF\n)?".prop_map(String::into_bytes);
    let segments = prop::collection::vec(
        (any::<u32>(), prop::collection::vec(any::<u8>(), 0..40)),
        0..4,
    );
    let elf = (
        segments,
        prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
    );
    let elf = elf.prop_map(|(segments, changes)| {
        let mut bytes = Elf {
            segments,
            ..Elf::of(&[])
        }
        .bytes();
        for (index, value) in changes {
            let at = index.index(bytes.len());
            bytes[at] = value;
        }
        bytes
    });
    prop_oneof![noise, hex, elf]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_file_stops_the_loader(bytes in nearly_a_file()) {
        if let Err(error) = Image::parse(&bytes) {
            prop_assert!(!error.to_string().contains('\n'));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_stream_of_instructions_stops_the_chip(
        words in prop::collection::vec(any::<u16>(), 1..400),
        registers in prop::array::uniform32(any::<u8>()),
        levels in prop::collection::vec((0u64..4000, 0u8..8, prop::option::of(any::<bool>())), 0..20),
        observed in any::<bool>(),
    ) {
        let mut chip = chip_of(&words);
        *chip.cpu_mut().registers_mut() = registers;
        for (cycle, bit, level) in levels {
            chip.input(cycle, Input::Pin(pin('D', bit), level));
        }
        if observed {
            chip.observers_mut().profile(Profile::new(&Image::default()));
            chip.observers_mut().trace(0..500);
            chip.observers_mut().measure_stack();
        }
        let mut again = chip.clone();
        let stopped = chip.run_until(20_000);
        // Both run alike, whatever the program, in one run or in pieces.
        let mut end = Stopped::Reached;
        for cycle in (0..=20_000).step_by(1000) {
            end = again.run_until(cycle);
        }
        prop_assert_eq!(stopped, end);
        prop_assert_eq!(chip.cpu().registers(), again.cpu().registers());
        prop_assert_eq!(chip.cpu().sram(), again.cpu().sram());
        prop_assert_eq!(chip.take_outputs(), again.take_outputs());
    }
}

#[test]
fn a_hex_file_s_board_is_known_by_where_its_stack_begins() {
    // RJMP over a vector, EOR r1, OUT SREG, LDI r28 and r29, OUT SPH and SPL, a loop.
    let hex = |end: u16| {
        let [low, high] = end.to_le_bytes();
        let words = [
            0xC001,
            0,
            0x2411,
            0xBE1F,
            ldi(28, low),
            ldi(29, high),
            out(0x3E, 29),
            out(0x3D, 28),
            0xCFFF,
        ];
        let value: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let records = [
            ihex::Record::Data { offset: 0, value },
            ihex::Record::EndOfFile,
        ];
        ihex::create_object_file_representation(&records).unwrap()
    };
    let parse = |stack| Image::parse(hex(stack).as_bytes());
    for model in MODELS {
        assert_eq!(parse(model.ram_end).unwrap().model(), model);
    }
    let refused = parse(0x08FF).unwrap().on(&ATMEGA2560).unwrap_err();
    assert!(matches!(refused, ImageError::Board { .. }));
    let line = parse(0x0AFF).unwrap_err().to_string();
    assert!(
        line.contains("0x0aff") && line.contains("Arduino Leonardo"),
        "{line}"
    );
    // One that does not show it is for the board on which it is put, if it fits.
    let silent = Image::parse(b":02000000FFCF30\n:00000001FF\n").unwrap();
    assert_eq!(silent.on(&ATMEGA328P).unwrap().model(), &ATMEGA328P);
    let long = Image::of_flash(&[0; 0x8002]).on(&ATMEGA328P).unwrap_err();
    assert!(matches!(long, ImageError::TooLarge { size: 0x8000, .. }));
}
