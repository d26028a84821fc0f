//! Any file is a program for the chip or gives an error of one line.

use rumbo_emulator::image::Image;

/// Panics if the claim does not hold.
pub fn check(bytes: &[u8]) {
    match Image::parse(bytes) {
        Ok(image) => assert!(!image.flash().is_empty()),
        Err(error) => assert!(!error.to_string().contains('\n')),
    }
}
