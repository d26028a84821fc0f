//! Any flash runs to its end or to a verdict, observed or not: the first 32 bytes are the registers, the rest is the
//! program.

use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::image::Image;
use rumbo_emulator::observe::profile::Profile;

/// Cycles that a program gets.
const CYCLES: u64 = 50_000;

/// Panics if the claim does not hold.
pub fn check(bytes: &[u8]) {
    let Some((registers, flash)) = bytes.split_first_chunk::<32>() else {
        return;
    };
    let mut chip = Chip::new(&Image::of_flash(flash));
    *chip.cpu_mut().registers_mut() = *registers;
    let mut seen = chip.clone();
    seen.observers_mut()
        .profile(Profile::new(&Image::default()));
    let stopped = chip.run_until(CYCLES);
    assert_eq!(stopped, seen.run_until(CYCLES));
    if let Stopped::Ended(verdict) = stopped {
        assert!(!verdict.to_string().contains('\n'));
    }
    assert_eq!(chip.cpu().registers(), seen.cpu().registers());
    assert_eq!(chip.take_outputs(), seen.take_outputs());
}
