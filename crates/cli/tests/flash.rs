//! `rumbo flash`, with a stand-in for avrdude and the simulated robot's port for a board's.

#![cfg(all(test, unix))]
#![allow(clippy::unwrap_used, reason = "helpers of tests too")]

use std::io::{BufRead, BufReader};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// A program that does nothing, as Intel HEX.
const IMAGE: &str = ":02000000FFCF30\n:00000001FF\n";

/// Where a test lives: an image, and an avrdude that notes how it was called.
struct Bench {
    folder: PathBuf,
    robot: Child,
    port: String,
}

impl Bench {
    /// `avrdude` is what the stand-in does, in the words of the shell, after it noted its arguments.
    fn new(name: &str, avrdude: &str) -> Bench {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("flash-{name}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(folder.join("bin")).unwrap();
        std::fs::write(folder.join("image.hex"), IMAGE).unwrap();
        let script = format!(
            "#!/bin/sh\necho \"$@\" >> {}/calls\n{avrdude}\n",
            folder.display()
        );
        let program = folder.join("bin/avrdude");
        std::fs::write(&program, script).unwrap();
        std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
        let mut robot = Command::new(env!("CARGO_BIN_EXE_rumbo"))
            .args(["lab", "--pty"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut port = String::new();
        BufReader::new(robot.stdout.as_mut().unwrap())
            .read_line(&mut port)
            .unwrap();
        Bench {
            folder,
            robot,
            port: port.trim().to_owned(),
        }
    }

    fn flash(&self, arguments: &[&str]) -> Output {
        let path = format!("{}/bin:/usr/bin:/bin", self.folder.display());
        Command::new(env!("CARGO_BIN_EXE_rumbo"))
            .current_dir(&self.folder)
            .env("PATH", path)
            .env_remove("CARGO_TARGET_DIR")
            .arg("flash")
            .args(arguments)
            .output()
            .unwrap()
    }

    /// How avrdude was called, a line each.
    fn calls(&self) -> Vec<String> {
        let calls = std::fs::read_to_string(self.folder.join("calls"));
        calls
            .unwrap_or_default()
            .lines()
            .map(str::to_owned)
            .collect()
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = self.robot.kill();
        let _ = self.robot.wait();
    }
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The signature of a Mega.
const MEGA: &str = "case \"$*\" in *signature*) echo 0x1e,0x98,0x1;; esac";

#[test]
fn a_mega_is_asked_for_its_signature_and_then_written() {
    let bench = Bench::new("mega", MEGA);
    let done = bench.flash(&[&bench.port, "--image", "image.hex"]);
    assert!(done.status.success(), "{}", stderr(&done));
    let common = format!("-p atmega2560 -c wiring -P {} -b 115200", bench.port);
    assert_eq!(
        bench.calls(),
        [
            format!("{common} -U signature:r:-:h"),
            format!("{common} -D -U flash:w:image.hex:i")
        ]
    );
}

#[test]
fn another_chip_is_not_written() {
    let bench = Bench::new(
        "uno",
        "echo 'avrdude: Device signature = 0x1e950f' >&2; exit 1",
    );
    let refused = bench.flash(&[&bench.port, "--image", "image.hex"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = stderr(&refused);
    assert!(
        said.contains("signature 1e950f, an ATmega2560 has 1e9801"),
        "{said}"
    );
    assert_eq!(bench.calls().len(), 1, "looked at, not written");
}

#[test]
fn what_goes_wrong_is_said_with_the_remedy() {
    let bench = Bench::new(
        "silent",
        "echo 'avrdude: stk500v2_getsync(): timeout' >&2; exit 1",
    );
    let said = |arguments: &[&str]| {
        let output = bench.flash(arguments);
        assert_eq!(output.status.code(), Some(2));
        let said = stderr(&output);
        assert_eq!(said.lines().count(), 1, "{said}");
        said
    };
    let silent = said(&[&bench.port, "--image", "image.hex"]);
    assert!(
        silent.contains("no Arduino Mega answers") && silent.contains("timeout"),
        "{silent}"
    );
    let unbuilt = said(&[&bench.port]);
    assert!(unbuilt.contains("cargo xtask firmware"), "{unbuilt}");
    let absent = said(&["/dev/no_such_port", "--image", "image.hex"]);
    assert!(
        absent.contains("/dev/no_such_port cannot be opened"),
        "{absent}"
    );
    let network = said(&["tcp:robot:2000", "--image", "image.hex"]);
    assert!(network.contains("USB cable"), "{network}");
    std::fs::write(bench.folder.join("text.hex"), "no program\n").unwrap();
    let text = said(&[&bench.port, "--image", "text.hex"]);
    assert!(text.contains("text.hex"), "{text}");
    std::fs::remove_file(bench.folder.join("bin/avrdude")).unwrap();
    let path = bench.folder.join("bin");
    let without = Command::new(env!("CARGO_BIN_EXE_rumbo"))
        .current_dir(&bench.folder)
        .env("PATH", path)
        .args(["flash", &bench.port, "--image", "image.hex"])
        .output()
        .unwrap();
    assert!(
        stderr(&without).contains("apt install avrdude"),
        "{}",
        stderr(&without)
    );
}

#[test]
fn the_commands_can_be_printed_in_place_of_being_run() {
    let bench = Bench::new("print", MEGA);
    let printed = bench.flash(&["/dev/ttyACM0", "--image", "image.hex", "--print"]);
    let lines = String::from_utf8_lossy(&printed.stdout).into_owned();
    assert_eq!(
        lines.lines().last(),
        Some("avrdude -p atmega2560 -c wiring -P /dev/ttyACM0 -b 115200 -D -U flash:w:image.hex:i")
    );
    assert!(bench.calls().is_empty());
}
