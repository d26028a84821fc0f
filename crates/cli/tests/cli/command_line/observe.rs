//! Observing a program: its profile, its pins, a debugger.

use crate::support::{file, folder, program, rumbo, stderr, stdout};
use std::io::{BufRead, BufReader};
use std::process::Stdio;

/// A program that stays where it is.
pub(crate) const SPIN: &str = ":02000000FFCF30\n:00000001FF\n";

#[test]
fn a_program_is_shown_as_a_profile_and_as_a_waveform() {
    file("spin.hex", SPIN);
    file(
        "moment.toml",
        "title = \"t\"\nrobot = \"memoria\"\nrig = \"front_single\"\nworld = \"open\"\nmode = 0\nduration_s = 0.2\n",
    );
    let arguments = "run moment.toml --firmware spin.hex --profile spin.folded --vcd spin.vcd --json --no-record --force";
    let output = rumbo(&arguments.split(' ').collect::<Vec<_>>());
    assert_ne!(output.status.code(), Some(2), "{}", stderr(&output));
    assert!(
        stderr(&output).contains(" cycles (0.200 s), 0.0 % asleep"),
        "{}",
        stderr(&output)
    );
    assert_eq!(stdout(&output).lines().count(), 1);
    let read = |name| std::fs::read_to_string(folder().join(name)).unwrap();
    let folded = read("spin.folded");
    assert!(folded.starts_with("# rumbo run ") && folded.contains("\n(unknown) "));
    assert!(read("spin.vcd").contains("left_enable"));
    // The same run writes them again, one with other options does not.
    for (seed, status) in [("1", 0), ("2", 2)] {
        for option in ["--profile spin.folded", "--vcd spin.vcd"] {
            let again =
                format!("run moment.toml --firmware spin.hex --no-record --seed {seed} {option}");
            let output = rumbo(&again.split(' ').collect::<Vec<_>>());
            let is_refused = stderr(&output).contains("is there already");
            assert_eq!(
                (output.status.code(), is_refused),
                (Some(status), status == 2),
                "{again}"
            );
        }
    }
    let output = rumbo(&[
        "run",
        "mode5",
        "--firmware",
        "spin.hex",
        "--profile",
        "x",
        "--runs",
        "2",
    ]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("one run, here are 2"));
    // What cannot be written is said before or after, and nothing half is left.
    for option in ["--profile", "--vcd"] {
        let run = [
            "run",
            "moment.toml",
            "--firmware",
            "spin.hex",
            "--no-record",
        ];
        let output = rumbo(&[&run[..], &[option, "nowhere/x.out"]].concat());
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).starts_with("error: nowhere/x.out: cannot be written"));
    }
    let output = rumbo(&["run", "mode5", "--vcd", "x"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_run_waits_for_a_debugger_and_ends_with_it() {
    use std::io::{Read, Write};
    file("held.hex", SPIN);
    let mut child = program()
        .current_dir(folder())
        .args(["run", "mode5", "--firmware", "held.hex", "--gdb", "0"])
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    lines.read_line(&mut line).unwrap();
    let digits = line
        .rsplit(':')
        .next()
        .unwrap()
        .trim_matches(|c: char| !c.is_ascii_digit());
    let mut debugger =
        std::net::TcpStream::connect(("127.0.0.1", digits.parse().unwrap())).unwrap();
    let receive = |debugger: &mut std::net::TcpStream, text: &str| {
        let mut bytes = vec![0; text.len()];
        debugger.read_exact(&mut bytes).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), text);
    };
    // A breakpoint where the program is; on to it; the end.
    for (command, answer) in [("$Z0,0,2#44", "+$OK#9a"), ("$c#63", "+$T05")] {
        debugger.write_all(command.as_bytes()).unwrap();
        receive(&mut debugger, answer);
    }
    debugger.write_all(b"+$k#6b").unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(2));
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    assert!(rest.contains("the debugger ended the run"), "{rest}");
}
