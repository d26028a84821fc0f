//! Runs at once and waiting loops left out, beside the plain interpreter: one instruction after the other, as a chip runs that is
//! observed. Same state, same outputs, wherever a run pauses.

use super::bytes;
use super::program::{Program, Random};
use crate::common::{NOP, SEI, chip_of, ldi, pin, sbi, sts};
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Input;
use rumbo_emulator::image::Image;
use rumbo_emulator::model::{ATMEGA328P, ATMEGA2560, Model};
use std::path::Path;

/// Every check that there is, as `cargo xtask test --full` wants it.
pub(super) fn is_full() -> bool {
    std::env::var_os("RUMBO_FULL").is_some()
}

/// A chip, and the same under observation.
pub(super) struct Pair {
    pub(super) fast: Chip,
    plain: Chip,
    outputs: usize,
}

impl Pair {
    pub(super) fn new(fast: Chip) -> Pair {
        let mut plain = fast.clone();
        plain.observers_mut().measure_stack();
        Pair {
            fast,
            plain,
            outputs: 0,
        }
    }

    fn both(&mut self, change: impl Fn(&mut Chip)) {
        change(&mut self.fast);
        change(&mut self.plain);
    }

    pub(super) fn input(&mut self, cycle: u64, input: Input) {
        self.both(|chip| chip.input(cycle, input));
    }

    /// Runs both to a cycle and compares everything that is kept; returns whether they go on.
    pub(super) fn agree_at(&mut self, cycle: u64, what: &str) -> bool {
        let stopped = self.fast.run_until(cycle);
        assert_eq!(stopped, self.plain.run_until(cycle), "{what}");
        let [fast, plain] = [&self.fast, &self.plain].map(Chip::cpu);
        let where_ = format!("{what}, to cycle {cycle}");
        let scalars = |chip: &Chip| {
            let cpu = chip.cpu();
            let (pc, sp) = (cpu.program_counter(), cpu.stack_pointer());
            (
                cpu.cycle(),
                pc,
                sp,
                cpu.status().bits(),
                cpu.is_sleeping(),
                cpu.restarts(),
            )
        };
        assert_eq!(scalars(&self.fast), scalars(&self.plain), "{where_}");
        assert_eq!(fast.registers(), plain.registers(), "{where_}");
        assert!(fast.sram() == plain.sram(), "{where_}: memory differs");
        let outputs = self.fast.take_outputs();
        assert_eq!(outputs, self.plain.take_outputs(), "{where_}");
        self.outputs += outputs.len();
        assert_eq!(self.fast.unmodelled(), self.plain.unmodelled(), "{where_}");
        stopped == Stopped::Reached
    }

    /// What a program would read in each register, and the flash.
    fn registers_agree(&self, what: &str) {
        let [fast, plain] = [&self.fast, &self.plain].map(|chip| chip.cpu().flash());
        assert!(fast == plain, "{what}: flash differs");
        for address in 0x20..0x137 {
            let [fast, plain] = [&self.fast, &self.plain].map(|chip| chip.read_data(address));
            assert_eq!(fast, plain, "{what}, register {address:#x}");
        }
    }
}

/// Runs an image for so many milliseconds, with edges and bytes from outside at random, paused at random.
fn agrees(image: &Image, ms: u64, what: &str) {
    let model = image.model();
    let mut random = Random(ms ^ model.flash_words as u64);
    let mut pair = Pair::new(Chip::new(image));
    let mut cycle = 0;
    let mut level = false;
    while cycle < ms * 16_000 {
        level ^= true;
        let port = random.pick(&['B', 'C', 'D', 'E', 'J']);
        if let Some(pin) = rumbo_emulator::devices::ports::Pin::new(port, random.below(8) as u8) {
            pair.input(
                cycle + u64::from(random.below(4_000)),
                Input::Pin(pin, Some(level)),
            );
        }
        if random.below(8) == 0 {
            let usart = random.below(4) as u8;
            let byte = random.pick(b"ON\nREF 20\nx\xFF\0");
            pair.input(
                cycle,
                Input::Serial {
                    usart,
                    byte,
                    baud: 9600,
                },
            );
        }
        cycle += u64::from(random.below(30_000));
        if !pair.agree_at(cycle, what) {
            break;
        }
    }
    pair.registers_agree(what);
}

#[test]
fn random_programs_do_the_same_one_by_one() {
    let count = |model: &Model| (model.flash_words / super::WORDS) as u16;
    // 32 images of 327 programs, and 32 of 40.
    let seeds = if is_full() { 0..32 } else { 0..1 };
    for (model, cycles) in [(&ATMEGA2560, 5_000_000), (&ATMEGA328P, 700_000)] {
        for seed in seeds.clone() {
            let program = Program::image(model, seed, count(model));
            let image = Image::of_flash(&bytes(&program.words)).on(model).unwrap();
            let mut pair = Pair::new(Chip::new(&image));
            let mut random = Random(seed);
            let mut cycle = 0;
            while cycle < cycles {
                cycle += u64::from(random.below(if cycle % 7 == 0 { 60_000 } else { 300 }));
                assert!(pair.agree_at(cycle, &format!("{model:?}, seed {seed}")));
            }
        }
    }
}

#[test]
fn sketches_do_the_same_one_by_one() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().unwrap();
    let folders = ["sketches", "firmware"].map(|name| target.join(name));
    let files = folders
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok());
    let ms = if is_full() { 5_000 } else { 120 };
    let mut count = 0;
    for file in files.flatten() {
        let path = file.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "elf") {
            let image = Image::parse(&std::fs::read(&path).unwrap()).unwrap();
            agrees(&image, ms, &path.display().to_string());
            count += 1;
        }
    }
    assert!(
        count > 30 || std::env::var_os("CI").is_none(),
        "{count} images"
    );
}

/// LDS, a comparison of two bytes, PUSH, POP, LDI and MOV, STS, LDD and STD, sums and differences; then back.
fn runs() -> Vec<u16> {
    let mut words = vec![ldi(28, 0), ldi(29, 3), ldi(30, 0x20), ldi(31, 2)];
    let start = words.len();
    for register in [0, 1, 2, 3] {
        words.extend([0x9000 | register << 4, 0x200 + register]);
    }
    words.extend([
        0x930F, 0x931F, 0x932F, 0x933F, 0x913F, 0x912F, 0x911F, 0x910F,
    ]);
    words.extend([ldi(16, 0x5A), 0x2F10, 0x0198, ldi(20, 1), 0x2F54]);
    words.extend([
        0x0F04, 0x1F15, 0x1F26, 0x1B04, 0x0B15, 0x1704, 0x0715, 0x5003, 0x4010, 0x3040, 0x0751,
    ]);
    words.extend([0x8308, 0x8319, 0x8180, 0x8191, 0x81A2, 0x8300, 0x8311]);
    for register in [16, 17, 18] {
        words.extend([0x9200 | register << 4, 0x210 + register]);
    }
    // INC r20, STS 0x200, r20: not twice the same.
    words.extend([0x9543, 0x9340, 0x0200]);
    let back = start as i16 - words.len() as i16 - 1;
    words.push(0xC000 | back.cast_unsigned() & 0xFFF);
    words
}

#[test]
fn a_run_can_be_cut_anywhere_by_the_end_a_breakpoint_or_another_program() {
    let words = runs();
    let mut pair = Pair::new(chip_of(&words));
    for cycle in 1..2_000 {
        assert!(pair.agree_at(cycle, "cycle by cycle"));
    }
    for word in 4..words.len() as u32 {
        let mut pair = Pair::new(chip_of(&words));
        pair.agree_at(777, "before the breakpoint");
        pair.both(|chip| chip.cpu_mut().set_breakpoint(word));
        pair.agree_at(2_000, "a breakpoint");
        pair.both(|chip| chip.cpu_mut().clear_breakpoint(word));
        assert!(pair.agree_at(3_000, "without it"));
        // It may be the second half of an instruction: then it is another address.
        pair.both(|chip| chip.cpu_mut().write_flash(word, NOP));
        pair.agree_at(4_000, "another word");
    }
}

#[test]
fn a_loop_that_waits_ends_in_the_cycle_in_which_it_would() {
    // Timer 1 counts cycles over 8 up to 999; its flag is polled, then PINB0, UCSR0A, and a byte that an interrupt sets; each wait
    // toggles a pin at its end.
    let mut words = vec![0x940C, 0x60];
    words.resize(0x60, NOP);
    // INT0 at word 2: INC r20, RETI.
    words[2..4].copy_from_slice(&[0x9543, 0x9518]);
    for (register, value) in [
        (0x88, 0xE7),
        (0x89, 3),
        (0x81, 0x0A),
        (0x24, 0x80),
        (0x69, 1),
        (0x3D, 1),
        (0xC1, 0x10),
    ] {
        words.push(ldi(16, value));
        words.extend(sts(register, 16));
    }
    words.push(SEI);
    let start = words.len();
    // SBI: the flag is cleared. SBIS TIFR1, OCF1A; back. SBI PINB, 7: toggled.
    words.extend([0x9AB1, 0x9BB1, 0xCFFE, sbi(0x03, 7)]);
    // SBIC PINB, 0 and SBIS PINB, 0.
    words.extend([0x9918, 0xCFFE, sbi(0x03, 7), 0x9B18, 0xCFFE, sbi(0x03, 7)]);
    // LDS r17, UCSR0A; SBRS r17, 7; back; LDS r17, UDR0.
    words.extend([0x9110, 0xC0, 0xFF17, 0xCFFC, 0x9110, 0xC6, sbi(0x03, 7)]);
    // r20 by way of calls: RCALL, CP r20, r21, BREQ back; MOV r21, r20.
    words.extend([0xD005, 0x1745, 0xF3E9, 0x2F54, sbi(0x03, 7)]);
    let back = start as i16 - words.len() as i16 - 1;
    words.push(0xC000 | back.cast_unsigned() & 0xFFF);
    // PUSH r20, POP r22, RET.
    words.extend([0x934F, 0x916F, 0x9508]);
    let mut pair = Pair::new(chip_of(&words));
    let mut random = Random(7);
    for round in 0..300_u64 {
        let base = round * 40_000;
        let mut at = |from: u64| base + from + u64::from(random.below(9_000));
        let high = Input::Pin(pin('B', 0), Some(true));
        let low = Input::Pin(pin('B', 0), Some(false));
        let (one, other) = (at(0), at(9_000));
        pair.input(one, high);
        pair.input(other, low);
        pair.input(
            at(18_000),
            Input::Serial {
                usart: 0,
                byte: 7,
                baud: 1_000_000,
            },
        );
        for level in [true, false] {
            pair.input(at(27_000), Input::Pin(pin('D', 0), Some(level)));
        }
        let pauses = [at(0), at(9_000), at(18_000), at(27_000)];
        for pause in pauses {
            assert!(pair.agree_at(pause, "waiting"));
        }
    }
    assert!(pair.outputs > 1_000, "it goes from wait to wait");
    let [fast, plain] = [&pair.fast, &pair.plain].map(|chip| chip.cpu().cycles_left_out());
    assert!(
        fast > 6_000_000,
        "half of the time is left out, not {fast} cycles"
    );
    assert_eq!(plain, 0);
    pair.registers_agree("waiting");
}
