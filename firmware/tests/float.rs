//! The image's float arithmetic, function by function, against the PC's: the sums and comparisons of
//! `firmware/src/float.S`, and the functions from avr-libc.

use crate::board::image;
use crate::world::Random;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::model::ATMEGA2560;

/// Rows of each kind and function.
const ROWS: u32 = 3_000;

/// Two floats of a difficult kind.
fn row(kind: u32, random: &mut Random) -> [f32; 2] {
    let mut any = || (random.below(0x1_0000) << 16) | random.below(0x1_0000);
    let (a, b) = (any(), any());
    let near =
        |bits: u32, exponents: u32| (bits & 0x807F_FFFF) | ((115 + (bits >> 24) % exponents) << 23);
    let [a, b] = match kind {
        // Any bits: all magnitudes, subnormal, infinite, not a number.
        0 => [a, b],
        1 => [near(a, 32), near(b, 32)],
        2 => [near(a, 2), near(b, 2)],
        // Almost or exactly opposite.
        3 => [a, a ^ 0x8000_0000 ^ (b & 3)],
        // Zeros of both signs and the smallest numbers.
        4 => [a & 0x8000_0007, b],
        // Halves of the last place: ties.
        5 => [
            (a & 0x80FF_FFFF) | 0x3F00_0000,
            (b & 0x80F0_0000) | 0x3300_0000,
        ],
        _ => [a & 0xFFFF_0000, b & 0xFFF0_0000],
    };
    [f32::from_bits(a), f32::from_bits(b)]
}

/// Calls a function of two floats as avr-gcc does, on a chip that runs nothing else; returns r22 to r25.
fn call(chip: &mut Chip, function: u32, a: f32, b: f32) -> [u8; 4] {
    let cpu = chip.cpu_mut();
    // It returns to address 0.
    let (start, end) = (ATMEGA2560.sram_start, ATMEGA2560.ram_end);
    let stack = end - 3;
    cpu.sram_mut()[usize::from(stack - start) + 1..].fill(0);
    cpu.set_stack_pointer(stack);
    let registers = cpu.registers_mut();
    registers[1] = 0;
    registers[18..22].copy_from_slice(&b.to_le_bytes());
    registers[22..26].copy_from_slice(&a.to_le_bytes());
    cpu.set_program_counter(function);
    assert_eq!(chip.run_until(u64::MAX / 2), Stopped::Breakpoint);
    let cpu = chip.cpu();
    assert_eq!((cpu.stack_pointer(), cpu.registers()[1]), (end, 0));
    cpu.registers()[22..26].try_into().unwrap()
}

fn try_all(names: &[&str], right: impl Fn(&str, f32, f32, [u8; 4]) -> bool) {
    let Some(image) = image() else {
        return;
    };
    let mut chip = Chip::new(&image);
    chip.cpu_mut().set_breakpoint(0);
    let mut random = Random::new(1);
    for name in names {
        let function = image.function_named(name).unwrap().address;
        for index in 0..7 * ROWS {
            let [a, b] = row(index / ROWS, &mut random);
            let got = call(&mut chip, function, a, b);
            assert!(right(name, a, b, got), "{name} {a:e} {b:e}: {got:02x?}");
        }
    }
}

#[test]
fn sums_products_and_roots_have_the_bits_of_the_pc() {
    try_all(
        &["__addsf3", "__subsf3", "__mulsf3", "__divsf3", "sqrt"],
        |name, a, b, got| {
            let expected = match name {
                "__addsf3" => a + b,
                "__subsf3" => a - b,
                "__mulsf3" => a * b,
                // avr-libc rounds a quotient below the normal numbers once too often.
                "__divsf3" if (a / b).is_subnormal() => return true,
                "__divsf3" => a / b,
                _ => a.sqrt(),
            };
            let got = f32::from_le_bytes(got);
            got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan()
        },
    );
}

#[test]
fn comparisons_agree_with_the_pc_also_where_one_is_not_a_number() {
    try_all(
        &[
            "__eqsf2",
            "__nesf2",
            "__ltsf2",
            "__lesf2",
            "__gtsf2",
            "__gesf2",
            "__unordsf2",
        ],
        |name, a, b, [_, _, got, _]| match (name, a.partial_cmp(&b)) {
            ("__unordsf2", order) => (got != 0) == order.is_none(),
            (_, Some(order)) => got.cast_signed() == order as i8,
            // The sign that makes the comparison false.
            ("__gtsf2" | "__gesf2", None) => got.cast_signed() == -1,
            (_, None) => got.cast_signed() == 1,
        },
    );
}
