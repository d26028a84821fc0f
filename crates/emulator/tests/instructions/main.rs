//! Instructions and their cycles, against simavr as a separate program, on random programs and on compiled ones.
#![cfg(test)]

mod assembler;
mod bench;
mod compiled;
mod program;
mod simavr;

use bench::Bench;
use program::Program;
use rumbo_emulator::cpu::{Cpu, Stopped};
use std::path::Path;

/// Programs in an image: each takes about 350 words.
const PROGRAMS: u16 = 320;

fn bytes(words: &[u16]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// What our CPU reports, a line for each program.
fn ours(program: &Program) -> Vec<String> {
    let mut cpu = Cpu::new(&bytes(&program.words));
    let mut bench = Bench::default();
    // The end: SLEEP with interrupts off comes round for ever.
    let stopped = cpu.run(&mut bench, 200_000_000);
    assert_eq!(stopped, Stopped::Reached);
    assert_eq!(bench.strange, None, "no access to what the bench has not");
    let text = String::from_utf8(bench.sent).unwrap();
    text.lines().map(str::to_owned).collect()
}

/// What simavr reports; `None` where it is not installed.
fn simavrs(program: &Program, name: &str) -> Option<Vec<String>> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join(format!("{name}.hex"));
    std::fs::write(&path, hex(&bytes(&program.words))).unwrap();
    simavr::reports(&path)
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
    for seed in 0..32 {
        let program = Program::image(seed, PROGRAMS);
        let ours = ours(&program);
        assert_eq!(ours.len(), usize::from(PROGRAMS));
        let Some(theirs) = simavrs(&program, &format!("random{seed}")) else {
            return;
        };
        assert_eq!(theirs.len(), ours.len(), "seed {seed}");
        for (number, (ours, theirs)) in ours.iter().zip(&theirs).enumerate() {
            assert_eq!(ours, theirs, "seed {seed}, program {number}");
        }
    }
}
