//! Compiled C programs: what they report on both, for every level of optimisation.

use super::simavr;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::devices::Event;
use rumbo_emulator::image::Image;
use rumbo_emulator::model::{MODELS, Model};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Parts of the program, and rounds through them.
const REPORTS: usize = 6 * 3;

/// Builds `compiled.c`; `None` where the compiler is not installed.
fn build(model: &Model, level: &str) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs/compiled.c");
    let image = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}{level}.elf", model.name));
    let mut compiler = Command::new("avr-gcc");
    let chip = format!("-mmcu={}", model.name);
    compiler.args([&chip, level, "-std=gnu11", "-Wno-array-bounds", "-o"]);
    let Ok(status) = compiler.arg(&image).arg(source).arg("-lm").status() else {
        assert!(
            std::env::var_os("CI").is_none(),
            "avr-gcc is missing: install the packages gcc-avr and avr-libc"
        );
        println!("skipped: avr-gcc is not installed");
        return None;
    };
    assert!(status.success(), "{model:?} {level}");
    Some(image)
}

/// What our chip sends over USART0, a line for each part.
fn ours(model: &Model, path: &Path) -> Vec<String> {
    let image = Image::parse(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!(image.model(), model);
    let mut chip = Chip::new(&image);
    assert_eq!(chip.run_until(100_000_000), Stopped::Reached);
    assert!(chip.cpu().is_sleeping());
    let bytes = chip
        .take_outputs()
        .into_iter()
        .filter_map(|output| match output.event {
            Event::Byte { usart: 0, byte, .. } => Some(byte as u8),
            _ => None,
        });
    let text = String::from_utf8(bytes.collect()).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn compiled_programs_leave_the_same_registers_flags_memory_and_cycles() {
    for model in MODELS {
        for level in ["-O0", "-O1", "-O2", "-O3", "-Os"] {
            let Some(path) = build(model, level) else {
                return;
            };
            let ours = ours(model, &path);
            assert_eq!(ours.len(), REPORTS);
            let Some(theirs) = simavr::reports(model, &path) else {
                return;
            };
            assert_eq!(ours, theirs, "{model:?} {level}");
        }
    }
}
