//! A debugger that attaches to a running simulation and detaches.

use super::rig::Person;
use rumbo_sim::debugging::Debugging;
use std::process::{Command, Stdio};

/// Steps of 5 ms, as in the lab.
const STEP_US: u64 = 5_000;
/// And of 1 ms, far apart, until the debugger has come, however long it takes to start: the robot must not reach a wall.
const WAITING_US: u64 = 1_000;

#[test]
fn while_a_debugger_holds_the_program_robot_and_world_stand() {
    let Some(mut person) = Person::at_the_bench("free", None) else {
        return;
    };
    person.send("DUTY 200");
    person.wait_s(1.0);
    let mut untouched = person.sim.clone();
    let mut debugging = Debugging::at(0).unwrap();
    let port = debugging.port().unwrap();
    let image = super::rig::image("bench").unwrap();
    let mut gdb = Command::new("avr-gdb");
    gdb.args(["--quiet", "--nx", "--batch"])
        .arg(image)
        .args(["-ex", &format!("target remote 127.0.0.1:{port}")])
        .args(["-ex", "break countLeft", "-ex", "continue"])
        .args(["-ex", "print leftCount > 0", "-ex", "shell sleep 0.5"])
        .args(["-ex", "stepi", "-ex", "delete", "-ex", "detach"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let Ok(gdb) = gdb.spawn() else {
        assert!(
            std::env::var_os("CI").is_none(),
            "avr-gdb is missing: install the package gdb-avr"
        );
        println!("skipped: avr-gdb is not installed");
        return;
    };
    let mut news = Vec::new();
    let (mut stood, mut waited) = (0, 0);
    while !news.iter().any(|line: &String| line.contains("left")) {
        let before = person.sim.now_us();
        let (step_us, pause_ms) = match news.is_empty() {
            true => (WAITING_US, 20),
            false => (STEP_US, 1),
        };
        debugging.advance(&mut person.sim, (before / step_us + 1) * step_us);
        news.extend(debugging.take_news());
        let came = !news.is_empty();
        stood += u32::from(came && person.sim.now_us() == before);
        waited += 1;
        assert!(waited < 20_000, "{news:?}");
        std::thread::sleep(std::time::Duration::from_millis(pause_ms));
    }
    let output = gdb.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.contains("Breakpoint 1, countLeft"), "{said}");
    assert!(
        said.contains("$1 = 1") || said.contains("$1 = true"),
        "{said}"
    );
    let count = |what: &str| news.iter().filter(|line| line.contains(what)).count();
    assert_eq!(count("a debugger has come"), 1, "{news:?}");
    assert!(count("the program stands at 0x") >= 1, "{news:?}");
    assert!(stood > 50, "{stood}");
    // Neither robot nor program noticed the debugger.
    let end_us = person.sim.now_us();
    untouched.advance(end_us);
    person.sim.advance(end_us + 500_000);
    untouched.advance(end_us + 500_000);
    assert_eq!(person.sim.truth(), untouched.truth());
    let cycles = [&person.sim, &untouched].map(|sim| sim.mega().unwrap().chip().cycle());
    assert_eq!(cycles[0], cycles[1]);
}
