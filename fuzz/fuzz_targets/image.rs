//! Any file is a program for the chip or gives an error of one line.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rumbo_emulator::image::Image;

fuzz_target!(|bytes: &[u8]| {
    match Image::parse(bytes) {
        Ok(image) => assert!(!image.flash().is_empty()),
        Err(error) => assert!(!error.to_string().contains('\n')),
    }
});
