//! A debugger attached to our own image, on its way to a wall: it stops at a line of the source and shows arguments,
//! variables and callers by name.

use crate::board::image_path;
use crate::faults::drive::{Drive, setup};
use rumbo_sim::debugging::Debugging;
use std::process::{Command, Stdio};

const SOURCE: &str = include_str!("../../crates/control/src/pid.rs");
/// Where it stops: the output is as the controller would have it.
const LINE: &str = "let output = clamp(free";
const STEP_US: u64 = 5_000;

/// Attaches a debugger with these commands to a driving robot; returns its output, and the true wheel speeds before
/// [rad/s]. `None` where image or debugger is missing.
fn debug(commands: &[&str]) -> Option<(String, [f64; 2])> {
    let mut drive = Drive::under_way(&setup("mode1", |_| {})?, 1.0);
    let truth = drive.sim.truth().wheel_rad_s;
    let mut debugging = Debugging::at(0).unwrap();
    let port = debugging.port().unwrap();
    let mut gdb = Command::new("avr-gdb");
    gdb.args(["--quiet", "--nx", "--batch"])
        .arg(image_path()?)
        .args(["-ex", &format!("target remote 127.0.0.1:{port}")]);
    for command in commands {
        gdb.args(["-ex", command]);
    }
    let Ok(mut gdb) = gdb
        .args(["-ex", "delete", "-ex", "detach"])
        .stdout(Stdio::piped())
        .spawn()
    else {
        assert!(
            std::env::var_os("CI").is_none(),
            "avr-gdb is missing: install the package gdb-avr"
        );
        println!("skipped: avr-gdb is not installed");
        return None;
    };
    // Time stands still until it is attached: without heartbeats the robot would have stopped.
    let (mut step_us, mut turns) = (0, 0);
    while gdb.try_wait().unwrap().is_none() {
        let until_us = drive.sim.now_us() + step_us;
        debugging.advance(&mut drive.sim, until_us);
        if !debugging.take_news().is_empty() {
            step_us = STEP_US;
        }
        turns += 1;
        if turns == 60_000 {
            gdb.kill().unwrap();
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let output = gdb.wait_with_output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    Some((text, truth))
}

/// The number that GDB has printed behind `$number = `.
fn printed(text: &str, number: u32) -> f32 {
    let name = format!("${number} = ");
    let value = text.lines().find_map(|line| line.strip_prefix(&name));
    value
        .and_then(|value| value.parse().ok())
        .unwrap_or_else(|| panic!("{name}: {text}"))
}

#[test]
fn a_debugger_stops_at_a_line_and_knows_arguments_variables_and_callers_by_name() {
    let line = 1 + SOURCE.lines().position(|line| line.contains(LINE)).unwrap();
    let Some((text, wheels_rad_s)) = debug(&[
        &format!("break pid.rs:{line}"),
        "continue",
        "print dt_s",
        "print measurement",
        "print free",
        "print state.measurement",
        "backtrace",
    ]) else {
        return;
    };
    assert!(
        text.contains("Breakpoint 1, rumbo_control::pid::Pid::step ("),
        "{text}"
    );
    assert!(text.contains(&format!(" at src/pid.rs:{line}\n")), "{text}");
    // A constant, an argument and a variable in four registers each.
    let [dt_s, measurement, free] = [1, 2, 3].map(|number| printed(&text, number));
    assert_eq!(dt_s, 0.01);
    let is_near = |truth: f64| (f64::from(measurement) - truth).abs() < 1.0;
    assert!(
        wheels_rad_s.into_iter().any(is_near),
        "{wheels_rad_s:?}: {text}"
    );
    assert!((0.1..1.5).contains(&free), "a duty: {text}");
    // What lies in the frame leads to the measurement of the tick before.
    let last = text
        .split("::Some(")
        .nth(1)
        .and_then(|value| value.split(')').next());
    let last: f32 = last.unwrap().parse().unwrap();
    assert!((last - measurement).abs() < 1.0, "{text}");
    // Callers on both sides of 64 KB, which is as far as the 16 bits of LLVM's addresses reach.
    let callers = [
        "Pid::step",
        "WheelState::speed",
        "DriveLayer::step",
        "Pilot::step",
        "Robot::tick",
        "rumbo::run",
    ];
    let frames = text.lines().filter(|line| line.starts_with('#'));
    let mut frames = frames.map(|frame| (frame, frame.split_once(" (").unwrap().0));
    for caller in callers {
        assert!(
            frames.any(|(_, name)| name.ends_with(caller)),
            "{caller}: {text}"
        );
    }
}
