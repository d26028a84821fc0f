//! Instructions and their cycles, against simavr as a separate program, on random programs and on compiled ones.
#![cfg(test)]

mod assembler;
mod bench;
mod compiled;
mod loops;
mod plain;
mod program;
mod simavr;

use bench::Bench;
use program::Program;
use rumbo_emulator::cpu::{Cpu, Stopped};
use rumbo_emulator::model::{ATMEGA328P, ATMEGA2560, Model};
use std::path::Path;

/// Words of flash for each program, which takes about 350.
const WORDS: u32 = 400;

fn bytes(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// What our CPU reports, a line for each program.
fn ours(model: &'static Model, program: &Program) -> Vec<String> {
    let mut cpu = Cpu::new(model, &bytes(&program.words));
    let mut bench = Bench::default();
    // The end: SLEEP with interrupts off comes round for ever.
    let stopped = cpu.run(&mut bench, 200_000_000);
    assert_eq!(stopped, Stopped::Reached);
    assert_eq!(bench.strange, None, "no access to what the bench has not");
    let text = String::from_utf8(bench.sent).unwrap();
    text.lines().map(str::to_owned).collect()
}

/// What simavr reports; `None` where it is not installed.
fn simavrs(model: &Model, program: &Program, name: &str) -> Option<Vec<String>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join(format!("{name}.hex"));
    std::fs::write(&path, hex(&bytes(&program.words))).unwrap();
    simavr::reports(model, &path)
}

fn hex(bytes: &[u8]) -> String {
    use ihex::Record;
    let mut records = Vec::new();
    for (index, chunk) in bytes.chunks(16).enumerate() {
        let address = index * 16;
        if address % 0x1_0000 == 0 {
            records.push(Record::ExtendedLinearAddress((address >> 16) as u16));
        }
        records.push(Record::Data {
            offset: (address & 0xFFFF) as u16,
            value: chunk.to_vec(),
        });
    }
    records.push(Record::EndOfFile);
    ihex::create_object_file_representation(&records).unwrap()
}

#[test]
fn random_programs_leave_the_same_registers_flags_memory_and_cycles() {
    for (model, seeds) in [(&ATMEGA2560, 0..32), (&ATMEGA328P, 100..132)] {
        for seed in seeds {
            let count = (model.flash_words / WORDS) as u16;
            let program = Program::image(model, seed, count);
            assert!(program.words.len() < model.flash_words as usize);
            let ours = ours(model, &program);
            assert_eq!(ours.len(), usize::from(count));
            let Some(theirs) = simavrs(model, &program, &format!("random{seed}")) else {
                return;
            };
            assert_eq!(theirs.len(), ours.len(), "seed {seed}");
            for (number, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
                assert_eq!(ours, theirs, "{model:?}, seed {seed}, program {number}");
            }
        }
    }
}
