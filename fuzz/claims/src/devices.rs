//! Any register writes and any inputs: the chip keeps running, and alike however its run is divided. Four bytes are a
//! step.

use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Cause, Input, Output};
use rumbo_emulator::image::Image;

const PORTS: &[u8; 11] = b"ABCDEFGHJKL";
const BAUD: [u32; 6] = [0, 300, 9_600, 115_200, 2_000_000, u32::MAX];

/// Every vector returns; the program counts for a while and sleeps, in turns.
const PROGRAM: [u16; 6] = [0x9478, 0xE040, 0x9543, 0xF7F1, 0x9588, 0xCFFC];

fn flash() -> Vec<u8> {
    let mut words: Vec<u16> = [0x9518, 0x0000].repeat(0x40);
    words[..2].copy_from_slice(&[0x940C, 0x80]);
    words.extend(PROGRAM);
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn input(kind: u8, a: u8, b: u8) -> Input {
    let baud = BAUD[usize::from(a / 8) % BAUD.len()];
    match kind % 8 {
        0..=2 => {
            let letter = char::from(PORTS[usize::from(a) % PORTS.len()]);
            let level = [None, Some(false), Some(true)][usize::from(b / 8) % 3];
            match Pin::new(letter, b % 8) {
                Some(pin) => Input::Pin(pin, level),
                None => Input::Reset(Cause::BrownOut),
            }
        }
        3 | 4 => Input::Serial {
            usart: a % 5,
            byte: b,
            baud,
        },
        5 => Input::Frame {
            usart: a % 4,
            bits: u16::from_le_bytes([a, b]),
            count: b,
            baud,
        },
        6 => Input::Volts {
            channel: a % 20,
            volts: f64::from(b) / 40.0 - 0.5,
        },
        _ => Input::Reset(Cause::External),
    }
}

/// Does it all; runs in pieces of `piece` cycles at the most.
fn run(steps: &[[u8; 4]], piece: u64) -> (Vec<Output>, Chip) {
    let mut chip = Chip::new(&Image::of_flash(&flash()));
    let mut now = 10;
    let mut seen = Vec::new();
    for [kind, low, high, value] in steps {
        let address = 0x20 + u16::from_le_bytes([*low, *high]) % 0x120;
        match kind % 8 {
            0..=3 if !(0x5B..0x60).contains(&address) => chip.write_data(address, *value),
            4 => {
                chip.read_data(address);
            }
            5 | 6 => chip.input(now + u64::from(*value) * 16, input(*kind / 8, *low, *high)),
            _ => {
                let end = now + ((u64::from(*value) + 1) << (high % 11));
                while now < end {
                    now = end.min(now + piece);
                    chip.run_until(now);
                }
                now = now.max(chip.cycle());
                seen.extend(chip.take_outputs());
            }
        }
    }
    (seen, chip)
}

/// Panics if the claim does not hold.
pub fn check(bytes: &[u8]) {
    let (steps, _) = bytes.as_chunks::<4>();
    let steps = &steps[..steps.len().min(256)];
    let (seen, chip) = run(steps, u64::MAX / 4);
    let (again, pieces) = run(steps, 1_009);
    assert_eq!(seen, again);
    assert_eq!(chip.cycle(), pieces.cycle());
    assert_eq!(chip.cpu().registers(), pieces.cpu().registers());
    assert_eq!(chip.devices().eeprom(), pieces.devices().eeprom());
}
