//! A program for the board at a port of the page.

use rumbo_emulator::image::Image;
use rumbo_emulator::model::ATMEGA2560;
use rumbo_flash::Programmer;

/// Begins to write the program in a file, Intel HEX or ELF, to an Arduino Mega.
///
/// # Errors
/// What is wrong with the file, which is no program for that board.
pub fn programmer(file: &str, content: &[u8]) -> Result<Programmer, String> {
    let image = Image::parse(content).and_then(|image| image.on(&ATMEGA2560));
    let image = image.map_err(|error| format!("{file}: {error}"))?;
    Programmer::new(image.flash()).map_err(|error| format!("{file}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_program_for_a_mega_is_refused_with_its_name() {
        let why = |content: &[u8]| programmer("mine.hex", content).unwrap_err();
        assert!(why(b"no program").starts_with("mine.hex: neither an ELF file nor Intel HEX"));
        // A program in the section of the boot loader.
        let boot = b":020000040003F7\n:02E00000FFCF50\n:00000001FF\n";
        assert!(why(boot).starts_with("mine.hex: it reaches into the boot loader's section"));
        let fine = programmer("mine.hex", b":02000000FFCF30\n:00000001FF\n");
        assert_eq!(fine.unwrap().bytes(), 256);
    }
}
