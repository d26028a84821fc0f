//! `rumbo flash`, with an emulated Mega at a pseudo terminal, which runs the boot loader that Arduino ships.

#![cfg(all(test, unix))]
#![allow(clippy::unwrap_used, reason = "helpers of tests too")]

use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::image::Image;
use rumbo_station::port::Pty;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A program that does nothing, as Intel HEX.
const IMAGE: &str = ":02000000FFCF30\n:00000001FF\n";
/// As Debian's `arduino-core-avr` has it.
const BOOT_LOADER: &str =
    "/usr/share/arduino/hardware/arduino/avr/bootloaders/stk500v2/stk500boot_v2_mega2560.hex";
/// SIGN_ON, before which the port's lines reset the board; a pseudo terminal has none.
const SIGN_ON: &[u8] = b"\x1b\x01\x00\x01\x0e\x01";
/// A start of the chip takes that long [us].
const START_US: u64 = 20_000;

/// A board at a port.
struct Board {
    port: String,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<Chip>>,
}

impl Board {
    /// With this in its flash; it answers nothing any more after so many bytes.
    fn new(flash: &[u8], cable: usize) -> Board {
        let mut pty = Pty::new(Duration::from_millis(1)).unwrap();
        let port = pty.path().to_owned();
        let ended = Arc::new(AtomicBool::new(false));
        let mut chip = Chip::new(&Image::of_flash(flash));
        let over = Arc::clone(&ended);
        let thread = std::thread::spawn(move || {
            let (mut bytes, mut left, mut since) = (Vec::new(), cable, Instant::now());
            while !over.load(Ordering::SeqCst) {
                bytes.clear();
                pty.read(&mut bytes);
                if bytes.starts_with(SIGN_ON) {
                    chip = Chip::new(&Image::of_flash(chip.cpu().flash()));
                    run(&mut chip, START_US);
                }
                bytes.truncate(left);
                left -= bytes.len();
                for byte in &bytes {
                    let byte = Input::Serial {
                        usart: 0,
                        byte: *byte,
                        baud: 115_200,
                    };
                    chip.input(chip.cycle(), byte);
                }
                let us = since.elapsed().as_micros().min(10_000);
                since = Instant::now();
                pty.write(&run(&mut chip, us as u64));
            }
            chip
        });
        Board {
            port,
            ended,
            thread: Some(thread),
        }
    }

    /// Its flash at the end.
    fn flash(mut self) -> Vec<u8> {
        self.ended.store(true, Ordering::SeqCst);
        let chip = self.thread.take().unwrap().join().unwrap();
        chip.cpu().flash().to_vec()
    }
}

/// What the chip sends within this time.
fn run(chip: &mut Chip, us: u64) -> Vec<u8> {
    chip.run_until(chip.cycle() + 16 * us);
    let outputs = chip.take_outputs().into_iter();
    let bytes = outputs.filter_map(|output| match output.event {
        Event::Byte { usart: 0, byte, .. } => Some(byte as u8),
        _ => None,
    });
    bytes.collect()
}

/// The boot loader's flash; `None` where it is not installed, and CI has it.
fn boot_loader() -> Option<Vec<u8>> {
    if let Ok(text) = std::fs::read(BOOT_LOADER) {
        return Some(Image::parse(&text).unwrap().flash().to_vec());
    }
    assert!(
        std::env::var_os("CI").is_none(),
        "the boot loader is missing: install the package arduino-core-avr"
    );
    println!("skipped: arduino-core-avr is not installed");
    None
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("flash-{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("image.hex"), IMAGE).unwrap();
    folder
}

fn flash(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .current_dir(folder)
        .env_remove("CARGO_TARGET_DIR")
        .arg("flash")
        .args(arguments)
        .output()
        .unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What a command that fails says, in one line.
fn complaint(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2));
    let said = stderr(output);
    assert_eq!(said.lines().count(), 1, "{said}");
    said
}

#[test]
fn an_image_is_written_to_a_mega_and_read_back() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    let folder = folder("mega");
    // Of some pages, the last of them not full.
    let program: Vec<u8> = (0..2_000).map(|at| (at * 7) as u8).collect();
    let lines = program.chunks(16).enumerate().map(|(index, data)| {
        let [high, low] = (16 * index as u16).to_be_bytes();
        let record = [&[data.len() as u8, high, low, 0], data].concat();
        let sum = record
            .iter()
            .fold(0_u8, |sum, byte| sum.wrapping_sub(*byte));
        let digits: String = record.iter().map(|byte| format!("{byte:02X}")).collect();
        format!(":{digits}{sum:02X}\n")
    });
    let hex = lines.collect::<String>() + ":00000001FF\n";
    std::fs::write(folder.join("program.hex"), hex).unwrap();
    let board = Board::new(&boot_loader, usize::MAX);
    let done = flash(&folder, &[&board.port, "--image", "program.hex"]);
    assert!(done.status.success(), "{}", stderr(&done));
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    let expected = format!(
        "writing program.hex (2048 bytes) to {}\ndone: the robot starts again, disarmed\n",
        board.port
    );
    assert_eq!(said, expected);
    assert_eq!(board.flash()[..program.len()], program);
}

#[test]
fn a_board_that_falls_silent_is_reported_with_what_is_left_on_it() {
    let Some(boot_loader) = boot_loader() else {
        return;
    };
    let folder = folder("silent");
    let board = Board::new(&boot_loader, 400);
    let said = complaint(&flash(&folder, &[&board.port, "--image", "image.hex"]));
    assert!(said.contains(&board.port), "{said}");
    assert!(said.contains("the boot loader answers no more"), "{said}");
    assert!(said.contains("does nothing until one is written"), "{said}");
    assert_eq!(board.flash()[..4], [0xFF, 0xCF, 0xFF, 0xCF]);
}

#[test]
fn what_goes_wrong_is_said_with_the_remedy() {
    let folder = folder("wrong");
    let said = |arguments: &[&str]| complaint(&flash(&folder, arguments));
    let unbuilt = said(&["/dev/no_such_port"]);
    assert!(unbuilt.contains("cargo xtask firmware"), "{unbuilt}");
    let absent = said(&["/dev/no_such_port", "--image", "image.hex"]);
    assert!(
        absent.contains("/dev/no_such_port cannot be opened"),
        "{absent}"
    );
    let network = said(&["tcp:robot:2000", "--image", "image.hex"]);
    assert!(network.contains("USB cable"), "{network}");
    // In the section of the boot loader.
    let boot = ":02000004000 3F7\n:02E00000FFCF50\n:00000001FF\n".replace(' ', "");
    std::fs::write(folder.join("boot.hex"), boot).unwrap();
    let boot = said(&["/dev/no_such_port", "--image", "boot.hex"]);
    assert!(
        boot.contains("firmware boot.hex: it reaches into the boot loader's section"),
        "{boot}"
    );
    // A port, and nobody at its other end.
    let deaf = Pty::new(Duration::from_millis(1)).unwrap();
    let silent = said(&[deaf.path(), "--image", "image.hex"]);
    assert!(silent.contains("no Arduino Mega answers"), "{silent}");
}
