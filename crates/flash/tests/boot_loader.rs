//! Programs are written to an emulated Mega by the boot loader that Arduino ships, and to boards on which that fails.
#![allow(clippy::unwrap_used, reason = "helpers of tests too")]

use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::image::Image;
use rumbo_emulator::model::ATMEGA2560;
use rumbo_flash::{BAUD, FlashError, IntoBootSection, Phase, PortAction, Programmer};
use std::path::Path;

/// As Debian's `arduino-core-avr` has it.
const BOOT_LOADER: &str =
    "/usr/share/arduino/hardware/arduino/avr/bootloaders/stk500v2/stk500boot_v2_mega2560.hex";
const CYCLES_PER_US: u64 = 16;
const STEP_US: u64 = 500;
const PAGE: usize = 256;
/// `rjmp .`
const HALT: [u8; 2] = [0xFF, 0xCF];

/// The boot loader; `None` where it is not installed, and CI has it.
fn boot_loader() -> Option<Image> {
    if let Ok(text) = std::fs::read(Path::new(BOOT_LOADER)) {
        return Some(Image::parse(&text).unwrap());
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "the boot loader is missing: install the package arduino-core-avr"
    );
    println!("skipped: arduino-core-avr is not installed");
    None
}

/// An Arduino Mega on its USB cable.
struct Board {
    chip: Chip,
    lines: bool,
    /// DTR reaches the reset.
    resets: bool,
    /// How often the programmer has pulled the line.
    pulls: u32,
    /// The cable is pulled out after so many bytes to the board.
    cable: usize,
    /// Changes what the board sends.
    noise: fn(usize, u8) -> u8,
    sent: usize,
}

impl Board {
    /// Its flash holds this before the boot loader.
    fn new(boot_loader: &Image, program: &[u8]) -> Self {
        let mut flash = boot_loader.flash().to_vec();
        flash[..program.len()].copy_from_slice(program);
        let mut board = Self {
            chip: Chip::new(&Image::of_flash(&flash)),
            lines: false,
            resets: true,
            pulls: 0,
            cable: usize::MAX,
            noise: |_, byte| byte,
            sent: 0,
        };
        board.pass(5_000_000);
        board
    }

    fn flash(&self) -> &[u8] {
        self.chip.cpu().flash()
    }

    /// What it sends within this time.
    fn pass(&mut self, us: u64) -> Vec<u8> {
        self.chip.run_until(self.chip.cycle() + us * CYCLES_PER_US);
        let outputs = self.chip.take_outputs().into_iter();
        let bytes = outputs.filter_map(|output| match output.event {
            Event::Byte { usart: 0, byte, .. } => Some(byte as u8),
            _ => None,
        });
        bytes
            .map(|byte| {
                self.sent += 1;
                (self.noise)(self.sent, byte)
            })
            .collect()
    }

    fn lines(&mut self, pulled: bool) {
        self.pulls += u32::from(pulled && !self.lines);
        if pulled && !std::mem::replace(&mut self.lines, pulled) && self.resets {
            // The flash stays.
            self.chip = Chip::new(&Image::of_flash(self.chip.cpu().flash()));
        }
        self.lines = pulled;
    }

    fn receive(&mut self, bytes: &[u8]) {
        let kept = bytes.len().min(self.cable);
        self.cable -= kept;
        for byte in &bytes[..kept] {
            let byte = Input::Serial {
                usart: 0,
                byte: *byte,
                baud: BAUD,
            };
            self.chip.input(self.chip.cycle(), byte);
        }
    }

    /// Writes a program; the phases on the way, and the outcome.
    fn write(&mut self, programmer: &mut Programmer) -> (Vec<Phase>, Result<(), FlashError>) {
        let (mut now_us, mut phases) = (0, Vec::new());
        loop {
            let (phase, part) = programmer.progress();
            assert!((0.0..=1.0).contains(&part));
            if phases.last() != Some(&phase) {
                phases.push(phase);
            }
            match programmer.poll(now_us) {
                Ok(PortAction::Lines(pulled)) => self.lines(pulled),
                Ok(PortAction::Send(bytes)) => self.receive(&bytes),
                Ok(PortAction::Wait) => {
                    now_us += STEP_US;
                    programmer.receive(&self.pass(STEP_US));
                }
                Ok(PortAction::Done) => return (phases, Ok(())),
                Err(error) => return (phases, Err(error)),
            }
        }
    }
}

/// A program of this many bytes, each page another one.
fn program(bytes: usize) -> Vec<u8> {
    let mut program: Vec<u8> = (0..bytes)
        .map(|at| (at / PAGE * 7 + at * 3) as u8)
        .collect();
    // It stands still after a word that does nothing.
    program[..4].copy_from_slice(&[0x00, 0x00, 0xFF, 0xCF]);
    program
}

/// It knows the chip as the emulator does.
#[test]
fn signature_page_and_boot_section_are_those_of_the_chip() {
    let start = 2 * ATMEGA2560.boot_start(ATMEGA2560.fuses) as usize;
    assert_eq!((start, 2 * ATMEGA2560.page_words), (0x3_E000, PAGE));
    assert!(Programmer::new(&vec![0; start]).is_ok());
    assert!(Programmer::new(&vec![0; start + 1]).is_err());
}

fn programmer(program: &[u8]) -> Programmer {
    Programmer::new(program).unwrap()
}

#[test]
fn a_program_replaces_another_one_and_starts() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    let (before, after) = (program(20 * PAGE), program(11 * PAGE + 100));
    let before: Vec<u8> = before.iter().map(|byte| !byte).collect();
    let mut board = Board::new(&boot_loader, &before);
    let mut programmer = programmer(&after);
    let (phases, outcome) = board.write(&mut programmer);
    assert_eq!(outcome, Ok(()));
    assert_eq!(
        phases,
        [
            Phase::Connecting,
            Phase::Writing,
            Phase::Verifying,
            Phase::Finishing
        ]
    );
    assert_eq!(board.flash()[..after.len()], after);
    assert!(
        board.flash()[after.len()..12 * PAGE]
            .iter()
            .all(|byte| *byte == 0xFF)
    );
    let boot = 0x3_E000;
    assert_eq!(
        board.flash()[boot..boot_loader.flash().len()],
        boot_loader.flash()[boot..]
    );
    assert_eq!(programmer.progress().1, 1.0);
    assert_eq!(programmer.aftermath(), "");
    board.pass(100_000);
    assert_eq!(board.chip.cpu().program_counter(), 1, "it runs");
}

#[test]
fn a_program_of_one_page_and_the_largest_one_fit_and_no_larger_one() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    for bytes in [4, PAGE] {
        let wanted = program(bytes);
        let mut board = Board::new(&boot_loader, &[]);
        assert_eq!(board.write(&mut programmer(&wanted)).1, Ok(()));
        assert_eq!(board.flash()[..bytes], wanted);
    }
    let boot = 0x3_E000;
    assert!(Programmer::new(&program(boot)).is_ok());
    let why = Programmer::new(&program(boot + 2)).unwrap_err();
    assert_eq!(why, IntoBootSection);
    let with_boot_loader = Programmer::new(boot_loader.flash()).unwrap_err();
    assert!(
        with_boot_loader
            .to_string()
            .contains("without a boot loader")
    );
}

#[test]
fn wherever_the_cable_is_pulled_out_the_board_runs_a_whole_program_or_none() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    let (before, after) = (program(6 * PAGE), program(5 * PAGE));
    let before: Vec<u8> = [&HALT[..], &before[2..]].concat();
    let all = {
        let mut board = Board::new(&boot_loader, &before);
        board.cable = 1 << 20;
        assert_eq!(board.write(&mut programmer(&after)).1, Ok(()));
        (1 << 20) - board.cable
    };
    let mut unfinished = 0;
    for cable in (0..all).step_by(97) {
        let mut board = Board::new(&boot_loader, &before);
        board.cable = cable;
        let mut programmer = programmer(&after);
        assert!(board.write(&mut programmer).1.is_err());
        let flash = board.flash();
        let stands_still = flash[..PAGE] == HALT.repeat(PAGE / 2);
        let is_whole = flash[..before.len()] == before || flash[..after.len()] == after;
        assert!(stands_still || is_whole, "after {cable} of {all} bytes");
        // What is said is true, or too careful.
        if stands_still {
            unfinished += 1;
            assert!(programmer.aftermath().contains("no complete program"));
        }
        // Once more, with the cable in place.
        if cable % 5 == 0 {
            board.cable = usize::MAX;
            assert_eq!(board.write(&mut self::programmer(&after)).1, Ok(()));
            assert_eq!(board.flash()[..after.len()], after);
        }
    }
    assert!(unfinished > 10, "{unfinished}");
}

#[test]
fn a_board_that_is_not_there_or_is_not_reset_is_reported() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    let mut absent = Board::new(&boot_loader, &program(PAGE));
    absent.cable = 0;
    let mut first = programmer(&program(PAGE));
    assert_eq!(absent.write(&mut first).1, Err(FlashError::NoAnswer));
    assert_eq!(first.aftermath(), "");
    assert_eq!(absent.pulls, 5);
    // Its program runs, and no boot loader.
    let mut deaf = Board::new(&boot_loader, &HALT);
    deaf.resets = false;
    assert_eq!(
        deaf.write(&mut programmer(&program(PAGE))).1,
        Err(FlashError::NoAnswer)
    );
    // In its boot loader by its button, but not by the port.
    let mut stuck = Board::new(&boot_loader, &HALT);
    stuck.lines(true);
    stuck.lines(false);
    stuck.resets = false;
    let mut second = programmer(&program(3 * PAGE));
    assert_eq!(stuck.write(&mut second).1, Err(FlashError::NoReset));
    assert_eq!(stuck.flash()[..PAGE], HALT.repeat(PAGE / 2));
    assert!(second.aftermath().contains("does nothing"));
}

#[test]
fn a_byte_that_is_read_back_wrong_is_named_with_its_address() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    for at in [[9, 40], [PAGE - 2, PAGE - 1]] {
        let error = damaged(&boot_loader, at).expect("it is not written");
        let address = 2 * PAGE + at[0];
        let written = program(4 * PAGE)[address];
        assert_eq!(
            error,
            FlashError::Mismatch {
                address,
                written,
                read: written ^ 0x10
            }
        );
        let said = format!("at 0x{address:05x} the board has");
        assert!(error.to_string().starts_with(&said), "{error}");
    }
}

/// Two bits flip on the way to the board, at these places of the third page: the XOR of the message stays. `None`: it
/// is written all the same.
fn damaged(boot_loader: &Image, at: [usize; 2]) -> Option<FlashError> {
    let mut board = Board::new(boot_loader, &[]);
    let mut programmer = programmer(&program(4 * PAGE));
    let (mut now_us, mut pages) = (0, 0);
    let error = loop {
        match programmer.poll(now_us) {
            Ok(PortAction::Lines(pulled)) => board.lines(pulled),
            Ok(PortAction::Send(mut bytes)) => {
                pages += u32::from(bytes[5] == 0x13);
                if bytes[5] == 0x13 && pages == 3 {
                    at.iter().for_each(|at| bytes[15 + at] ^= 0x10);
                }
                board.receive(&bytes);
            }
            Ok(PortAction::Wait) => {
                now_us += STEP_US;
                programmer.receive(&board.pass(STEP_US));
            }
            Ok(PortAction::Done) => return None,
            Err(error) => break error,
        }
    };
    assert_eq!(board.flash()[..PAGE], HALT.repeat(PAGE / 2));
    Some(error)
}

#[test]
fn a_line_that_damages_a_byte_ends_the_writing_and_another_attempt_succeeds() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    let wanted = program(4 * PAGE);
    let mut board = Board::new(&boot_loader, &[]);
    // Of the answer to the first page.
    board.noise = |at, byte| if at == 75 { byte ^ 0x10 } else { byte };
    let failed = board.write(&mut programmer(&wanted)).1;
    assert_eq!(failed, Err(FlashError::Silent(Phase::Writing)));
    assert_eq!(board.write(&mut programmer(&wanted)).1, Ok(()));
    assert_eq!(board.flash()[..wanted.len()], wanted);
}

#[test]
fn another_chip_is_not_written() {
    // A board that answers as its boot loader would, and has the signature of an ATmega328P.
    let mut programmer = programmer(&program(PAGE));
    let (mut now_us, mut written) = (0, Vec::new());
    let error = loop {
        match programmer.poll(now_us) {
            Ok(PortAction::Lines(_)) => {}
            Ok(PortAction::Send(message)) => {
                let [_, number, _, _, _, body @ .., _] = &message[..] else {
                    panic!("{message:?}");
                };
                written.push(body[0]);
                let answer = match body {
                    [0x1B, _, _, _, index, ..] => {
                        vec![0x1B, 0, [0x1E, 0x95, 0x0F][usize::from(*index)], 0]
                    }
                    [command, ..] => vec![*command, 0],
                    [] => panic!("no command"),
                };
                let mut framed = vec![0x1B, *number, 0, answer.len() as u8, 0x0E];
                framed.extend(answer);
                framed.push(framed.iter().fold(0, |sum, byte| sum ^ byte));
                programmer.receive(&framed);
            }
            Ok(PortAction::Wait) => now_us += STEP_US,
            Ok(PortAction::Done) => panic!("it is written"),
            Err(error) => break error,
        }
    };
    assert!(
        error
            .to_string()
            .contains("signature 1e950f, an ATmega2560 has 1e9801"),
        "{error}"
    );
    assert_eq!(written, [0x01, 0x1B, 0x1B, 0x1B], "looked at, not written");
    assert_eq!(programmer.aftermath(), "");
}
