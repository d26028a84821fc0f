//! `rumbo identify --drive`: simulated robots with known parameters are driven, recorded and identified.
//!
//! Two robots by default; `RUMBO_ROBOTS=100` for the campaign.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::support;
use rumbo_station::log_file;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;

/// Robots of a sample, and the seed of the first one.
const SAMPLE: u64 = 2;
const FIRST: u64 = 8_001;
/// Share of the true values that lie inside their 95 % intervals, of those that differ from robot to robot.
const INSIDE: f64 = 0.90;
/// From so many robots on that is asked of each parameter.
const MANY: usize = 50;
/// What any drive excites, and the widest interval of it, as the median of the robots.
const EXCITED: [&str; 4] = [
    "motor.back_emf_v_s",
    "wheels.right.strength",
    "motor.inertia_kg_m2",
    "wheels.left.viscous_n_m_s",
];
const WIDEST: f64 = 0.10;

fn identified(folder: &Path, seed: u64) -> Value {
    let seed = seed.to_string();
    let output = support::program()
        .args(["identify", "--drive", "lab", "--json", "--seed", &seed])
        .arg("--out")
        .arg(folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "seed {seed}: {said}");
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The first robot's folder and result, driven once for all tests.
fn first() -> &'static (tempfile::TempDir, Value) {
    static FIRST_ROBOT: OnceLock<(tempfile::TempDir, Value)> = OnceLock::new();
    FIRST_ROBOT.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let found = identified(folder.path(), FIRST);
        (folder, found)
    })
}

#[test]
fn the_true_parameters_lie_within_their_intervals() {
    let robots = std::env::var("RUMBO_ROBOTS").map_or(SAMPLE, |robots| robots.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let mut of: BTreeMap<String, Vec<(bool, f64, f64)>> = BTreeMap::new();
    for seed in FIRST..FIRST + robots {
        let found = match seed {
            FIRST => first().1.clone(),
            _ => identified(folder.path(), seed),
        };
        for row in found["against_truth"].as_array().unwrap() {
            let number = |key: &str| row[key].as_f64().unwrap();
            let (value, within, truth) = (number("value"), number("within"), number("truth"));
            let inside = (value - truth).abs() <= within;
            let rows = of.entry(row["key"].as_str().unwrap().to_owned());
            rows.or_default().push((inside, within / value, truth));
        }
    }
    let (mut inside, mut all) = (0, 0);
    let mut missed = Vec::new();
    for (key, rows) in &mut of {
        rows.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (count, median) = (
            rows.iter().filter(|row| row.0).count(),
            rows[(rows.len() - 1) / 2].1,
        );
        let line = format!(
            "{key:<38}{count:>4} of {:<4} +- {:.1} %",
            rows.len(),
            100.0 * median
        );
        println!("{line}");
        // A value that all robots share is believed beforehand: it lies inside whatever the drive shows.
        let drawn = rows.iter().any(|row| row.2 != rows[0].2);
        if drawn {
            (inside, all) = (inside + count, all + rows.len());
        }
        let few = drawn && rows.len() >= MANY && (count as f64) < INSIDE * rows.len() as f64;
        let wide = EXCITED.contains(&key.as_str()) && median > WIDEST;
        if few || wide {
            missed.push(line);
        }
    }
    let share = f64::from(inside as u32) / f64::from(all as u32);
    println!("inside, of those drawn: {inside} of {all}");
    assert!(share >= INSIDE, "{share}");
    assert!(missed.is_empty(), "{missed:#?}");
}

#[test]
fn a_drive_is_an_ordinary_log_that_is_identified_again_and_written_into_a_robot_file() {
    let folder = tempfile::tempdir().unwrap();
    let (_, first) = first();
    let log = first["log"].as_str().unwrap();
    let file = folder.path().join("mine.toml");
    let output = support::program()
        .args(["identify", log, "--json", "--write"])
        .arg(&file)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let again: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(first["parameters"], again["parameters"]);
    assert!(
        std::fs::read_to_string(&file)
            .unwrap()
            .contains("# Identified by `rumbo identify`")
    );

    // Not taken for a fit: the robot file stays as it is.
    let before = std::fs::read(&file).unwrap();
    let output = support::program()
        .args(["identify", log, "--leave-one-out", "--robot"])
        .arg(&file)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("there is one log only"), "{said}");
    assert_eq!(std::fs::read(&file).unwrap(), before);
}

#[cfg(unix)]
fn drives(log: &rumbo_log::Log) -> bool {
    let mut rows = log.rows.iter();
    rows.any(|row| row.signal("left_pwm") > Some(0.0))
}

/// What is left of a drive of the robot at a port that gets Ctrl-C once its log, in the folder, shows that the wheels
/// turn. Nothing if the drive has ended by itself, before or meanwhile: where the machine is busy, a robot may be silent
/// for so long that it is stopped.
#[cfg(unix)]
fn interrupted(port: &str, folder: &Path) -> Option<std::process::Output> {
    use std::io::{BufRead, BufReader, Write};
    use std::process::{Command, Stdio};
    let mut drive = support::program()
        .args(["identify", "--drive", port, "--out"])
        .arg(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(drive.stdout.as_mut().unwrap()).lines();
    let asks = |line: std::io::Result<String>| {
        let line = line.unwrap();
        assert!(!line.contains("\\n"), "{line}");
        line.contains("press Enter")
    };
    if lines.any(asks) {
        drive.stdin.as_mut().unwrap().write_all(b"\n").unwrap();
    }
    let until = std::time::Instant::now() + std::time::Duration::from_secs(60);
    while drive.try_wait().unwrap().is_none() {
        assert!(std::time::Instant::now() < until, "it does not drive");
        // Its log reaches the file while it drives.
        if log_file::read_signals(&support::only_file(folder)).is_ok_and(|log| drives(&log)) {
            // Of one that has just ended nobody is there to be asked.
            let _ = Command::new("kill")
                .args(["-INT", &drive.id().to_string()])
                .status();
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(200));
    }
    let output = drive.wait_with_output().unwrap();
    println!("{}", support::stderr(&output));
    (output.status.code() != Some(2)).then_some(output)
}

/// The behaviour of Ctrl-C, at a real serial port as far as the program can see.
#[cfg(unix)]
#[test]
fn ctrl_c_stops_the_robot_and_keeps_the_log() {
    // Each time another robot: one that was left alone has a fault.
    let lab = ["lab", "--pty", "--scenario", "free", "--world", "open"];
    let ended = (0..5).find_map(|_| {
        let robot = support::Running::start(&lab);
        let folder = tempfile::tempdir().unwrap();
        interrupted(&robot.said, folder.path()).map(|output| (folder, output))
    });
    let (folder, output) = ended.expect("each drive ended by itself");
    let said = support::stderr(&output);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("what was driven is in"), "{said}");
    let log = log_file::read(&support::only_file(folder.path())).unwrap();
    assert_eq!(log.cut, None);
    assert!(drives(&log));
    let last = log.rows.last().unwrap();
    assert_eq!(last.signal("armed"), Some(0.0));
    assert_eq!(last.signal("left_pwm"), Some(0.0));
}
