//! Random loops that count and read running counters, left out beside the plain interpreter.

use super::assembler::*;
use super::plain::{Pair, is_full};
use super::program::Random;
use crate::common::{RETI, SEI, chip_of, pin};
use rumbo_emulator::devices::Input;

/// TCNT0 and SREG among the I/O registers; TCNT1 in the data space.
const TCNT0: u8 = 0x26;
const SREG: u8 = 0x3F;
const TCNT1: u16 = 0x84;
/// Where timer 0's overflow leads, and where the program begins [words].
const OVERFLOW: usize = 0x2E;
const START: usize = 0x72;
/// Variables.
const DATA: u16 = 0x300;

/// An instruction of a loop, or a few that belong together.
fn some(random: &mut Random) -> Vec<u16> {
    let mut register = || 16 + random.below(10) as u8;
    let (d, r) = (register(), register());
    let k = random.pick(&[0, 1, 1, 2, 0xFF, 0x7F, 0x80, 100]);
    let variable = DATA + random.below(4);
    let words = i16::from(random.below(2) == 0) + 1;
    let flag = random.below(6) as u8;
    match random.below(20) {
        0..3 => {
            let base = random.pick(&[
                0x0400, 0x0800, 0x0C00, 0x1000, 0x1400, 0x1800, 0x1C00, 0x2000, 0x2400, 0x2800,
                0x2C00,
            ]);
            // CPSE may skip what is no whole instruction: then both do that.
            vec![two(base, d, r)]
        }
        3..6 => vec![immediate(
            random.pick(&[0x3000, 0x4000, 0x5000, 0x6000, 0x7000]),
            d,
            k,
        )],
        // A counter of two bytes, or of four.
        6 => vec![immediate(0x5000, 16, 1), two(0x0800, 17, 1)],
        7 => vec![
            immediate(0x5000, 18, 0xFF),
            two(0x0800, 19, 0),
            two(0x0800, 20, 0),
        ],
        8 => vec![random.pick(&[0x9600, 0x9700]) | random.pick(&[0, 0x10]) | random.below(4)],
        9 | 10 => vec![one(
            random.pick(&[
                0x9400, 0x9401, 0x9402, 0x9403, 0x9405, 0x9406, 0x9407, 0x940A,
            ]),
            d,
        )],
        11 | 12 => vec![input(d, TCNT0)],
        13 => [lds(d, TCNT1), lds(r, TCNT1 + 1)].concat(),
        14 => [
            lds(d, variable).as_slice(),
            &[one(0x9403, d)],
            &sts(variable, d),
        ]
        .concat(),
        15 => sts(variable, d).to_vec(),
        16 => vec![one(0x920F, d), two(0x0C00, d, r), one(0x900F, r)],
        // What `micros` does with SREG.
        17 => vec![input(d, SREG), 0x94F8, input(r, TCNT0), output(SREG, d)],
        18 => vec![
            branch(0xF000 | random.pick(&[0, 0x400]), flag, words - 1),
            two(0x0C00, d, r),
        ],
        _ => vec![
            random.pick(&[0xFC00, 0xFE00]) | u16::from(d) << 4 | u16::from(flag),
            one(0x9403, r),
        ],
    }
}

/// Loops until a flag says otherwise, then does something else and loops again.
fn program(random: &mut Random) -> Vec<u16> {
    let mut words = vec![0x940C, START as u16];
    words.resize(START, RETI);
    // TOV0: INC r2.
    words.splice(
        OVERFLOW..OVERFLOW + 4,
        [input(3, SREG), one(0x9403, 2), output(SREG, 3), RETI],
    );
    // r0 is -1, r1 is 0; timer 0 as Arduino's core has it, timer 1 over 8.
    words.extend([two(0x2400, 1, 1), ldi(16, 0xFF), mov(0, 16)]);
    for (address, value) in [(0x44, 3), (0x45, 3), (0x6E, 1), (0x81, 2)] {
        words.push(ldi(16, value));
        words.extend(sts(address, 16));
    }
    for register in 16..26 {
        words.push(ldi(register, random.below(256) as u8));
    }
    words.push(SEI);
    let outer = words.len();
    let register = 16 + random.below(10) as u8;
    words.push(random.pick(&[
        one(0x9403, register),
        two(0x2C00, register, 2),
        two(0x0C00, register, 2),
    ]));
    let inner = words.len();
    for _ in 0..=random.below(6) {
        words.extend(some(random));
    }
    let back = |to: usize, words: &[u16]| to as i16 - words.len() as i16 - 1;
    let flag = random.pick(&[0, 0, 1, 1, 2, 3, 4, 5]);
    words.push(branch(
        random.pick(&[0xF000, 0xF400]),
        flag,
        back(inner, &words),
    ));
    words.push(relative(0xC000, back(outer, &words)));
    words
}

#[test]
fn rounds_that_count_are_left_out_and_leave_the_same() {
    let programs = if is_full() { 10_000 } else { 150 };
    let (mut left_out, mut cycles) = (0, 0);
    for seed in 0..programs {
        let mut random = Random(seed);
        let words = program(&mut random);
        let mut pair = Pair::new(chip_of(&words));
        let mut cycle = 0;
        while cycle < 150_000 {
            let longest = random.pick(&[300, 20_000, 20_000]);
            cycle += u64::from(random.below(longest));
            if !pair.agree_at(cycle, &format!("seed {seed}: {words:04x?}")) {
                break;
            }
        }
        left_out += pair.fast.cpu().cycles_left_out();
        cycles += cycle;
    }
    assert!(
        left_out > cycles / 4,
        "{left_out} of {cycles} cycles are left out"
    );
}

/// A round of 244 cycles polls PB0 and a variable; an interrupt every 2,048 cycles counts elsewhere, every sixteenth time also
/// in the variable.
fn polls() -> Vec<u16> {
    let (other, polled) = (DATA, DATA + 1);
    let mut words = vec![0x940C, START as u16];
    words.resize(OVERFLOW, RETI);
    let (save, restore) = (one(0x920F, 16), one(0x900F, 16));
    words.extend([save, input(16, SREG), save]);
    words.extend(lds(16, other));
    words.push(one(0x9403, 16));
    words.extend(sts(other, 16));
    // The lower half is zero.
    words.extend([immediate(0x7000, 16, 0x0F), branch(0xF400, 1, 2)]);
    words.extend(sts(polled, 0));
    words.extend([restore, output(SREG, 16), restore, RETI]);
    words.resize(START, RETI);
    // r0 is 1; timer 0 over 8.
    words.extend([ldi(16, 1), mov(0, 16)]);
    words.extend(sts(0x6E, 16));
    words.push(ldi(16, 2));
    words.extend(sts(0x45, 16));
    words.push(SEI);
    let begin = words.len();
    words.extend(lds(17, polled));
    words.extend([input(18, 3), immediate(0x7000, 18, 1)]);
    for _ in 0..58 {
        words.extend([one(0x920F, 17), one(0x900F, 19)]);
    }
    words.extend([two(0x2800, 17, 18), branch(0xF400, 1, 1)]);
    words.push(relative(0xC000, begin as i16 - words.len() as i16 - 1));
    // Both are noticed: the one is taken back, the other toggles PB7 until it is low again.
    words.extend(sts(polled, 1));
    words.push(bit_of_io(0x9A00, 3, 7));
    words.push(relative(0xC000, begin as i16 - words.len() as i16 - 1));
    words
}

#[test]
fn a_loop_waits_on_behind_an_interrupt_without_another_round() {
    let mut random = Random(5);
    let mut pair = Pair::new(chip_of(&polls()));
    let last = 4_000_000;
    for begin in (0..last).step_by(100_000) {
        for level in [true, false] {
            let at = begin + 1_000 * u64::from(level) + u64::from(random.below(1_000));
            pair.input(at, Input::Pin(pin('B', 0), Some(!level)));
        }
        for pause in 1..=20 {
            let until = begin + 5_000 * pause - u64::from(random.below(1_000));
            assert!(pair.agree_at(until, "polling"));
        }
    }
    // Of a search behind each event, a third of the cycles would run.
    let left_out = pair.fast.cpu().cycles_left_out();
    assert!(left_out > last / 4 * 3, "{left_out} of {last} cycles");
}
