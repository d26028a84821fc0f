//! `rumbo new sketch` and `--sketch`: from nothing to a robot that drives, and errors with their place.

use crate::support::{folder, program, stderr, stdout};
use std::path::PathBuf;
use std::process::Output;

/// A fresh folder; `None` where no compiler is installed.
fn bench(name: &str) -> Option<PathBuf> {
    if let Err(error) = rumbo_sketch::Toolchain::find() {
        assert!(std::env::var_os("CI").is_none(), "{error}");
        return None;
    }
    let bench = folder().join(name);
    let _ = std::fs::remove_dir_all(&bench);
    std::fs::create_dir_all(&bench).unwrap();
    Some(bench)
}

fn rumbo(bench: &PathBuf, arguments: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(bench).args(arguments);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    command.output().unwrap()
}

#[test]
fn a_new_sketch_drives_to_the_wall_and_stops_before_it() {
    let Some(bench) = bench("new") else {
        return;
    };
    let made = rumbo(&bench, &["new", "sketch", "mine"]);
    assert_eq!(made.status.code(), Some(0), "{}", stderr(&made));
    let ino = std::fs::read_to_string(bench.join("mine/mine.ino")).unwrap();
    let code = ino.lines().filter(|line| !line.starts_with("//"));
    assert!(code.count() < 45);
    let again = rumbo(&bench, &["new", "sketch", "mine"]);
    assert_eq!(again.status.code(), Some(2));

    let run = rumbo(
        &bench,
        &["run", "mode1", "--sketch", "mine", "--json", "--no-record"],
    );
    let result: serde_json::Value = serde_json::from_str(&stdout(&run)).unwrap();
    assert_eq!(result["metrics"]["contacts"], 0.0, "{result}");
    let error_m = result["metrics"]["step1.steady_error_m"].as_f64().unwrap();
    assert!(error_m < 0.02, "{result}");
}

#[test]
fn what_the_compiler_refuses_is_said_with_file_and_line_and_status_2() {
    let Some(bench) = bench("broken") else {
        return;
    };
    assert!(rumbo(&bench, &["new", "sketch", "mine"]).status.success());
    let ino = bench.join("mine/mine.ino");
    let text = std::fs::read_to_string(&ino).unwrap();
    std::fs::write(&ino, text.replace("delay(50);", "delay(50)")).unwrap();
    let run = rumbo(&bench, &["run", "mode1", "--sketch", "mine"]);
    assert_eq!(run.status.code(), Some(2));
    let line = 1 + text
        .lines()
        .position(|line| line.contains("delay(50)"))
        .unwrap();
    let expected = format!(
        "mine.ino:{}:1: error: expected ';' before '}}' token\n",
        line + 1
    );
    assert_eq!(stderr(&run), expected);
}

#[test]
fn an_example_runs_by_name_and_receives_lines_typed_on_usb() {
    let Some(bench) = bench("example") else {
        return;
    };
    let echo = "void setup() { Serial.begin(9600); }\nvoid loop() { if (Serial.available()) Serial.write(Serial.read() + 1); }\n";
    std::fs::write(bench.join("echo.ino"), echo).unwrap();
    let arguments = [
        "run", "free", "--sketch", "echo.ino", "--usb", "HAL@1", "--out", "out",
    ];
    let run = rumbo(&bench, &arguments);
    assert_eq!(
        run.status.code(),
        Some(0),
        "{}{}",
        stdout(&run),
        stderr(&run)
    );
    let said = std::fs::read_to_string(bench.join("out/free-1-usart0.txt")).unwrap();
    assert!(said.starts_with("IBM"), "{said}");
    // The log knows which port it was.
    let again = rumbo(&bench, &["rerun", "out/free-1.mcap"]);
    assert_eq!(
        again.status.code(),
        Some(0),
        "{}{}",
        stdout(&again),
        stderr(&again)
    );
    let unknown = rumbo(&bench, &["run", "mode1", "--sketch", "example:wal"]);
    assert_eq!(
        stderr(&unknown),
        "error: no example `wal`; there are memoria, wall\n"
    );
}
