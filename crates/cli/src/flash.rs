//! `rumbo flash`: writes the image to an Arduino Mega with avrdude, after a check of the port.

use crate::args::FlashArgs;
use crate::failure::Failure;
use crate::output;
use crate::place;
use rumbo_experiment::files::firmware;
use rumbo_station::port::Port;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Where `cargo xtask firmware` puts the image, in the folder of what is built.
const BUILT: &str = "firmware/rumbo.hex";
/// Baud rate of the Mega's boot loader (STK500v2).
const BOOT_BAUD: u32 = 115_200;
/// Signature of an ATmega2560 (2549Q, section 29.3).
const SIGNATURE: [u8; 3] = [0x1E, 0x98, 0x01];
/// The image that a release carries.
#[cfg(carries_image)]
const CARRIED: Option<&[u8]> = Some(include_bytes!(env!("RUMBO_IMAGE")));
#[cfg(not(carries_image))]
const CARRIED: Option<&[u8]> = None;
/// How an ELF file begins.
const ELF: &[u8] = b"\x7fELF";

/// Checks image and board, then writes; or prints the commands that do.
pub(crate) fn flash(args: &FlashArgs) -> Result<(), Failure> {
    let image = image(args)?;
    let look = avrdude(&args.port, &["-U", "signature:r:-:h"]);
    let write = format!("flash:w:{}:{}", image.display(), format_of(&image)?);
    // The boot loader erases page by page; the saved parameters stay.
    let write = avrdude(&args.port, &["-D", "-U", &write]);
    if args.print {
        output::line(&shown(&look)?)?;
        return output::line(&shown(&write)?);
    }
    check_port(&args.port)?;
    check_signature(args, look)?;
    output::line(&format!("writing {} to {}", image.display(), args.port))?;
    let mut write = write;
    let done = write.status().map_err(missing)?;
    if !done.success() {
        return Err(Failure::Input(format!(
            "avrdude could not write {} to {} ({done}); its own words are above",
            image.display(),
            args.port
        )));
    }
    output::line("done: the robot starts again, disarmed")
}

/// The requested image, or the one built here, or the one that this release carries; in any case a program for this chip.
fn image(args: &FlashArgs) -> Result<PathBuf, Failure> {
    let path = match &args.image {
        Some(path) => path.clone(),
        None => {
            let target = std::env::var_os("CARGO_TARGET_DIR");
            let built = target
                .map_or_else(|| PathBuf::from("target"), PathBuf::from)
                .join(BUILT);
            if let (false, Some(carried)) = (built.exists(), CARRIED) {
                return unpack(carried);
            }
            if !built.exists() {
                return Err(Failure::Input(format!(
                    "there is no firmware {}: build it with `cargo xtask firmware` in the folder of Rumbo's sources, or give one with --image",
                    built.display()
                )));
            }
            built
        }
    };
    firmware::read(&path)?;
    Ok(path)
}

/// Puts the carried image where avrdude can read it, also for a command that is printed.
fn unpack(image: &[u8]) -> Result<PathBuf, Failure> {
    let folder = dirs::cache_dir()
        .unwrap_or_else(std::env::temp_dir)
        .join("rumbo");
    let path = folder.join(concat!("rumbo-", env!("CARGO_PKG_VERSION"), ".hex"));
    let written = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&path, image));
    written.map_err(|error| place::unwritable(&path, &error))?;
    Ok(path)
}

/// avrdude's letter for the file's format.
fn format_of(image: &Path) -> Result<char, Failure> {
    let bytes = firmware::bytes(image)?;
    Ok(if bytes.starts_with(ELF) { 'e' } else { 'i' })
}

fn avrdude(port: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new("avrdude");
    command
        .args(["-p", "atmega2560", "-c", "wiring", "-P", port])
        .args(["-b", &BOOT_BAUD.to_string()])
        .args(arguments);
    command
}

/// The command as one would type it into a shell of POSIX.
fn shown(command: &Command) -> Result<String, Failure> {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let quoted = words.map(|word| {
        let typed = word.to_str().filter(|word| output::visible(word) == *word);
        let quoted = typed.and_then(|word| shlex::try_quote(word).ok());
        quoted.ok_or_else(|| {
            Failure::Input(format!(
                "{}: cannot be printed as a command, it holds what nobody types; rename the file",
                word.to_string_lossy()
            ))
        })
    });
    Ok(quoted.collect::<Result<Vec<_>, _>>()?.join(" "))
}

fn missing(error: std::io::Error) -> Failure {
    Failure::Input(format!(
        "avrdude cannot be started ({error}): install it (Debian, Ubuntu: `sudo apt install avrdude`; macOS: `brew install avrdude`; Windows: \
         from github.com/avrdudes/avrdude/releases, into a folder of the PATH)"
    ))
}

/// Opens the port for a moment: an error names the remedy.
fn check_port(port: &str) -> Result<(), Failure> {
    if port.starts_with("tcp:") {
        return Err(Failure::Input(format!(
            "{port} is no serial port: the Mega is written over its USB cable; `rumbo list ports` shows the ports"
        )));
    }
    Port::open(port, BOOT_BAUD)
        .map(drop)
        .map_err(Failure::input)
}

/// Reads and checks the chip's signature.
fn check_signature(args: &FlashArgs, mut look: Command) -> Result<(), Failure> {
    let port = &args.port;
    let answer = look.stdin(Stdio::null()).output().map_err(missing)?;
    let said = String::from_utf8_lossy(&answer.stdout);
    let complaint = String::from_utf8_lossy(&answer.stderr);
    let signature = bytes_of(&said).or_else(|| signature_in(&complaint));
    let hex = |bytes: [u8; 3]| bytes.map(|byte| format!("{byte:02x}")).concat();
    match signature {
        Some(SIGNATURE) if answer.status.success() => Ok(()),
        Some(other) if other != SIGNATURE => Err(Failure::Input(format!(
            "the chip on {port} has the signature {}, an ATmega2560 has {}: is that board an Arduino Mega 2560?",
            hex(other),
            hex(SIGNATURE)
        ))),
        _ => {
            let last = complaint
                .lines()
                .rfind(|line| line.contains("avrdude"))
                .unwrap_or("avrdude printed nothing");
            Err(Failure::Input(format!(
                "no Arduino Mega answers on {port} ({}): is it on the USB cable, is the port the right one (`rumbo list ports`), \
                 does another program use it?",
                last.trim()
            )))
        }
    }
}

/// A signature as `-U signature:r:-:h` prints it: `0x1e,0x98,0x1`.
fn bytes_of(text: &str) -> Option<[u8; 3]> {
    let line = text
        .lines()
        .find(|line| line.trim_start().starts_with("0x"))?;
    let mut bytes = line.trim().split(',').map(|byte| {
        let digits = byte.trim().strip_prefix("0x")?;
        u8::from_str_radix(digits, 16).ok()
    });
    Some([bytes.next()??, bytes.next()??, bytes.next()??])
}

/// The signature in an error of avrdude: `device signature = 0x1e950f`, also with blanks between the bytes.
fn signature_in(complaint: &str) -> Option<[u8; 3]> {
    let (_, rest) = complaint.split_once("signature = ")?;
    let digits: String = rest
        .replace("0x", "")
        .chars()
        .filter(|c| *c != ' ')
        .take_while(char::is_ascii_hexdigit)
        .take(6)
        .collect();
    let [_, high, middle, low] = u32::from_str_radix(&digits, 16).ok()?.to_be_bytes();
    (digits.len() == 6).then_some([high, middle, low])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signatures_are_read_as_the_versions_of_avrdude_print_them() {
        assert_eq!(bytes_of("0x1e,0x98,0x1\n"), Some(SIGNATURE));
        assert_eq!(
            bytes_of("reading\n0x1e,0x95,0xf\n"),
            Some([0x1E, 0x95, 0x0F])
        );
        assert_eq!(bytes_of(""), None);
        let old = "avrdude: Device signature = 0x1e950f (probably m328p)";
        assert_eq!(signature_in(old), Some([0x1E, 0x95, 0x0F]));
        assert_eq!(
            signature_in("avrdude: device signature = 1E 98 01 (ATmega2560)"),
            Some(SIGNATURE)
        );
        assert_eq!(signature_in("avrdude: stk500v2_getsync(): timeout"), None);
    }

    #[test]
    fn a_command_is_shown_as_one_would_type_it() {
        let shown = |image: &str| shown(&avrdude("COM5", &["-D", "-U", image]));
        let said = shown("flash:w:it's $(mine)/my image.hex:i").unwrap();
        let words = [
            "avrdude",
            "-p",
            "atmega2560",
            "-c",
            "wiring",
            "-P",
            "COM5",
            "-b",
            "115200",
            "-D",
            "-U",
            "flash:w:it's $(mine)/my image.hex:i",
        ];
        assert_eq!(shlex::split(&said).unwrap(), words);
        assert!(said.starts_with("avrdude -p atmega2560 -c wiring -P COM5 -b 115200 -D -U "));
        assert!(shown("flash:w:a\u{1b}[2Kb.hex:i").is_err());
    }
}
