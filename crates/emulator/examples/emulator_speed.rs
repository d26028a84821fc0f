//! How fast the chip runs a program: `cargo run --release --example emulator_speed -- IMAGE SECONDS`.
//!
//! Nothing is wired to it: what `rumbo run --firmware` adds is the plant.

use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::image::Image;
use std::time::Instant;

const HERTZ: u64 = 16_000_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("which image?")?;
    let seconds: u64 = arguments.next().as_deref().unwrap_or("10").parse()?;
    let image = Image::parse(&std::fs::read(&path)?).map_err(|error| format!("{path}: {error}"))?;
    let mut chip = Chip::new(&image);
    let start = Instant::now();
    for millisecond in 1..=1000 * seconds {
        if let Stopped::Ended(verdict) = chip.run_until(millisecond * HERTZ / 1000) {
            return Err(verdict.to_string().into());
        }
        chip.take_outputs();
    }
    let wall_s = start.elapsed().as_secs_f64();
    println!("{:.1}", seconds as f64 / wall_s);
    Ok(())
}
