//! `rumbo new sketch` and `--sketch`: from nothing to a robot that drives, and errors with their place.

use crate::support::{folder, program, stderr, stdout};
use std::path::{Path, PathBuf};
use std::process::Output;

/// A fresh folder; `None` where no compiler is installed.
pub(super) fn bench(name: &str) -> Option<PathBuf> {
    if let Err(error) = rumbo_sketch::Toolchain::find() {
        assert!(std::env::var_os("CI").is_none(), "{error}");
        return None;
    }
    let bench = folder().join(name);
    let _ = std::fs::remove_dir_all(&bench);
    std::fs::create_dir_all(&bench).unwrap();
    Some(bench)
}

/// A sketch of `tests/programs/sketches`.
pub(super) fn ino(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs/sketches");
    std::fs::read_to_string(folder.join(format!("{name}.ino"))).unwrap()
}

pub(super) fn rumbo(bench: &PathBuf, arguments: &[&str]) -> Output {
    let mut command = program();
    command.current_dir(bench).args(arguments);
    command.env("RUMBO_CACHE", folder().join("sketches"));
    command.output().unwrap()
}

#[test]
fn a_new_sketch_passes_what_it_is_judged_by() {
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
    assert_eq!(
        stderr(&again),
        "error: mine: is there already; choose another name\n"
    );

    let run = rumbo(
        &bench,
        &["run", "mode1", "--sketch", "mine", "--json", "--no-record"],
    );
    // It keeps every limit.
    assert_eq!(run.status.code(), Some(0), "{}", stdout(&run));
}

#[test]
fn the_log_of_a_headless_run_shows_what_a_sketch_does_and_prints() {
    let Some(bench) = bench("logged") else {
        return;
    };
    assert!(rumbo(&bench, &["new", "sketch", "mine"]).status.success());
    let run = rumbo(
        &bench,
        &["run", "mode1", "--sketch", "mine", "--out", "logs"],
    );
    assert_ne!(run.status.code(), Some(2), "{}", stderr(&run));
    // It sends no telemetry, so there is nothing to draw: no error where no figure was asked for.
    let usual = rumbo(&bench, &["export", "logs/mode1-1.mcap", "--out", "usual"]);
    assert!(usual.status.success(), "{}", stderr(&usual));
    assert!(stderr(&usual).contains("there is no figure"));
    assert!(bench.join("usual/mode1-1.instruments.csv").is_file());
    let export = rumbo(&bench, &["export", "logs/mode1-1.mcap", "--format", "csv"]);
    assert!(export.status.success(), "{}", stderr(&export));
    let csv = |name: &str| std::fs::read_to_string(bench.join(name)).unwrap();
    let instruments = csv("mode1-1.instruments.csv");
    let mut lines = instruments.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|each| *each == name).unwrap();
    let (x, front) = (column("true_x_m"), column("true_range_front_m"));
    let row = |line: &str| -> Vec<f64> {
        let cells = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN));
        cells.collect()
    };
    let rows: Vec<Vec<f64>> = lines.map(row).collect();
    // 33 a second; what it has driven is missing before it.
    assert!(
        (rows[1][0] - rows[0][0] - 0.03).abs() < 1e-6,
        "{:?}",
        rows[1]
    );
    let [first, last] = [&rows[0], &rows[rows.len() - 1]];
    let driven_m = last[x] - first[x];
    assert!(driven_m > 0.5, "{driven_m}");
    let nearer_m = first[front] - last[front];
    assert!((nearer_m - driven_m).abs() < 0.03, "{nearer_m} {driven_m}");
    assert!(csv("mode1-1.printed0.csv").lines().count() > 50);
}

/// The metrics of a run.
fn metrics(bench: &PathBuf, arguments: &[&str]) -> serde_json::Value {
    let run = rumbo(bench, &[arguments, &["--json", "--no-record"]].concat());
    let result: Result<serde_json::Value, _> = serde_json::from_str(&stdout(&run));
    result.unwrap_or_else(|_| panic!("{}", stderr(&run)))["metrics"].take()
}

#[test]
fn a_new_sketch_for_an_uno_drives_the_robot_with_an_uno_and_no_other() {
    let Some(bench) = bench("uno") else {
        return;
    };
    let made = rumbo(&bench, &["new", "sketch", "small", "--board", "uno"]);
    let judged = "run mode1 --robot uno --usb 'REF 50@5.5' --sketch small";
    assert!(stdout(&made).contains(judged), "{}", stdout(&made));
    let read = |name: &str| std::fs::read(bench.join("small/.vscode").join(name)).unwrap();
    let launch: serde_json::Value = serde_json::from_slice(&read("launch.json")).unwrap();
    assert_eq!(launch["configurations"][0]["robot"], "uno");
    let extension = read("extensions/rumbo-debug/package.json");
    let extension: serde_json::Value = serde_json::from_slice(&extension).unwrap();
    let debugger = &extension["contributes"]["debuggers"][0];
    assert_eq!(debugger["type"], launch["configurations"][0]["type"]);
    let arguments = "run mode1 --robot uno --sketch small --no-record --usb";
    let arguments: Vec<&str> = arguments.split(' ').chain(["REF 50@5.5"]).collect();
    let run = rumbo(&bench, &arguments);
    assert_eq!(run.status.code(), Some(0), "{}", stdout(&run));

    // A Mega's image is for another chip.
    let mut images = walk(&folder().join("sketches"));
    let image = images.find(|path| path.ends_with("small.elf")).unwrap();
    let image = image.to_str().unwrap();
    let refused = rumbo(&bench, &["run", "mode1", "--firmware", image]);
    assert_eq!(refused.status.code(), Some(2));
    let error = stderr(&refused);
    assert!(
        error.contains("Tools > Board > Arduino Mega") && error.ends_with("take the robot uno\n"),
        "{error}"
    );
}

/// The files two folders below.
fn walk(folder: &Path) -> impl Iterator<Item = PathBuf> + use<> {
    let inside = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.path())
    };
    inside(folder.to_owned()).flat_map(inside)
}

#[test]
fn the_library_s_wall_example_stops_at_the_wall_on_both_boards() {
    let Some(bench) = bench("library") else {
        return;
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let sketch = root.join("examples/arduino/RumboRobot/examples/Wall");
    let sketch = sketch.to_str().unwrap();
    for on in [
        &["run", "mode1-final"][..],
        &["run", "mode1", "--robot", "uno"],
    ] {
        let metrics = metrics(&bench, &[on, &["--sketch", sketch]].concat());
        assert_eq!(metrics["contacts"], 0.0, "{on:?}: {metrics}");
        // It stands there, or swings out at the end of the step.
        let settling_s = metrics["step1.settling_s"].as_f64().unwrap();
        assert!(settling_s < 3.5, "{on:?}: {metrics}");
    }
}

#[test]
fn what_the_compiler_refuses_is_said_with_file_and_line_and_status_2() {
    let Some(bench) = bench("broken") else {
        return;
    };
    assert!(rumbo(&bench, &["new", "sketch", "mine"]).status.success());
    let ino = bench.join("mine/mine.ino");
    let text = std::fs::read_to_string(&ino).unwrap();
    std::fs::write(&ino, text.replace("delay(40);", "delay(40)")).unwrap();
    let run = rumbo(&bench, &["run", "mode1", "--sketch", "mine"]);
    assert_eq!(run.status.code(), Some(2));
    let line = 1 + text
        .lines()
        .position(|line| line.contains("delay(40)"))
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
    let nowhere = rumbo(&bench, &["run", "mode1", "--sketch", "mine"]);
    assert_eq!(
        stderr(&nowhere),
        "error: mine: no such file or folder; `rumbo new sketch NAME` begins a sketch, and example:NAME takes an example\n"
    );
    let unknown = rumbo(&bench, &["run", "mode1", "--sketch", "example:wal"]);
    assert_eq!(
        stderr(&unknown),
        "error: no example `wal`; there are line, memoria, wall, wall_uno\n"
    );
}
