//! Any register writes, any inputs: the chip keeps running, and alike however its run is divided.
#![cfg(test)]

use crate::common;
use common::*;
use proptest::prelude::*;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Cause, Input};

/// One thing that happens.
#[derive(Clone, Debug)]
enum Step {
    Write(u16, u8),
    Read(u16),
    Input(u64, Input),
    Run(u64),
}

fn any_pin() -> impl Strategy<Value = Pin> {
    let letters = prop::sample::select("ABCDEFGHJKL".chars().collect::<Vec<_>>());
    (letters, 0..8u8).prop_map(|(letter, bit)| pin(letter, bit))
}

fn any_input() -> impl Strategy<Value = Input> {
    let baud = prop::sample::select(vec![0u32, 300, 9_600, 115_200, 2_000_000, u32::MAX]);
    prop_oneof![
        8 => (any_pin(), any::<Option<bool>>()).prop_map(|(pin, level)| Input::Pin(pin, level)),
        4 => (0..5u8, any::<u8>(), baud.clone())
            .prop_map(|(usart, byte, baud)| Input::Serial { usart, byte, baud }),
        2 => (0..4u8, any::<u16>(), any::<u8>(), baud)
            .prop_map(|(usart, bits, count, baud)| Input::Frame { usart, bits, count, baud }),
        2 => (0..20u8, -1.0..6.0f64).prop_map(|(channel, volts)| Input::Volts { channel, volts }),
        1 => Just(Input::Reset(Cause::External)),
    ]
}

fn any_step() -> impl Strategy<Value = Step> {
    // Not EIND, RAMPZ, stack pointer and SREG, which are the CPU's.
    let address = (0x20..0x140u16).prop_filter("the CPU's", |at| !(0x5B..0x60).contains(at));
    prop_oneof![
        10 => (address.clone(), any::<u8>()).prop_map(|(at, value)| Step::Write(at, value)),
        2 => address.prop_map(Step::Read),
        2 => (0..3_000u64, any_input()).prop_map(|(delay, input)| Step::Input(delay, input)),
        2 => (1..2_000u64).prop_map(Step::Run),
        1 => (1..200_000u64).prop_map(Step::Run),
    ]
}

/// Does it all; runs in pieces of `piece` cycles at the most. Gives a value that depends on everything that was seen.
fn outcome(steps: &[Step], piece: u64) -> (Vec<String>, u64) {
    // Interrupts on, every vector returns; the program sleeps, then loops for a while, in turns.
    let mut words: Vec<u16> = [RETI, NOP].repeat(0x40);
    words[..2].copy_from_slice(&[0x940C, 0x80]);
    words.extend([SEI, ldi(20, 0), 0x9543, 0xF7F1, SLEEP, 0xCFFC]);
    let mut chip: Chip = chip_of(&words);
    let mut seen = Vec::new();
    let mut now = 10;
    for step in steps {
        match step {
            Step::Write(address, value) => write(&mut chip, *address, *value),
            Step::Read(address) => seen.push(format!("{address:#x} {}", read(&mut chip, *address))),
            Step::Input(delay, input) => chip.input(now + delay, *input),
            Step::Run(cycles) => {
                let end = now + cycles;
                while now < end {
                    now = end.min(now + piece);
                    chip.run_until(now);
                }
                now = now.max(chip.cpu().cycle());
                let outputs = chip.take_outputs().into_iter();
                seen.extend(outputs.map(|output| format!("{output:?}")));
            }
        }
    }
    (seen, chip.cpu().cycle())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_stops_the_chip_and_its_run_can_be_divided(
        steps in prop::collection::vec(any_step(), 1..150),
    ) {
        let whole = outcome(&steps, u64::MAX / 4);
        let pieces = outcome(&steps, 1_009);
        prop_assert_eq!(whole, pieces);
    }
}
