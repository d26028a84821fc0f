//! Programs dropped on the page of a lab that has images in memory only.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests too")]

use rumbo_experiment::files::Overrides;
use rumbo_lab::{Made, OwnProgram, SimulatedRobot, Workshop};
use rumbo_log::{Choice, ProgramPhase};
use rumbo_session::{GivenProgram, LinkNews, Target, TargetError};
use std::path::{Path, PathBuf};

/// `rjmp .-2` at address 0, as Intel HEX: a program that does nothing.
const IDLE: &[u8] = b":02000000FFCF30\n:00000001FF\n";

fn robot() -> SimulatedRobot {
    let choice = Choice {
        scenario: "mode1".into(),
        world: None,
        rig: None,
        seed: 1,
    };
    SimulatedRobot::new(Overrides::default(), choice).unwrap()
}

#[test]
fn a_dropped_image_replaces_the_native_program_on_an_emulated_mega() {
    let mut robot = robot();
    assert!(robot.program().is_none());
    robot
        .run_program(GivenProgram::file("idle.hex", IDLE))
        .unwrap();
    assert_eq!(robot.news(), Some(LinkNews::Renewed));
    let program = robot.program().unwrap();
    assert_eq!(
        (program.name.as_str(), program.phase),
        ("idle.hex", ProgramPhase::Running)
    );
    let manifest = robot.manifest();
    assert_eq!(manifest.program, "idle.hex");
    assert!(manifest.image.is_some());
    robot.advance(5_000).unwrap();
    assert!(robot.type_in(0, "hello\n").is_ok());
    // It stays through a reset.
    let choice = robot.scene().unwrap().choice;
    robot.reset(&choice).unwrap();
    assert_eq!(robot.program().unwrap().name, "idle.hex");
}

#[test]
fn what_is_no_image_is_refused_with_the_reason_and_the_robot_goes_on() {
    let mut robot = robot();
    robot.advance(5_000).unwrap();
    let sketch = robot.run_program(GivenProgram::file("a.ino", b"void setup() {}"));
    assert_eq!(sketch, Err(TargetError::NoCompiler));
    let text = robot.run_program(GivenProgram::file("a.txt", b"hello"));
    assert_eq!(text, Err(TargetError::NotAProgram));
    let broken = robot.run_program(GivenProgram::file("a.elf", b"hello"));
    let why = broken.unwrap_err().to_string();
    assert!(why.contains("a.elf"), "{why}");
    assert!(robot.news().is_none() && robot.program().is_none());
    assert_eq!(robot.now_us(), 5_000);
}

/// Has made a file that is no image.
struct Wrong(Option<PathBuf>);

impl Workshop for Wrong {
    fn next(&mut self) -> Option<Made> {
        self.0.take().map(Made::Image)
    }
}

#[test]
fn an_image_that_is_refused_is_named_without_its_folder() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join("0badc0de.hex");
    std::fs::write(&path, "hello").unwrap();
    let mut robot = robot();
    robot
        .run_program(GivenProgram::file("idle.hex", IDLE))
        .unwrap();
    robot.own_program(OwnProgram::new(
        "ana.hex",
        Some(Box::new(Wrong(Some(path)))),
    ));
    let mut said = Vec::new();
    while let Some(news) = robot.news() {
        if let LinkNews::Program(_, text) = news {
            said.push(text);
        }
    }
    let complaints = robot.program().unwrap().complaints;
    said.extend(complaints.into_iter().map(|complaint| complaint.text));
    let told = said.iter().filter(|text| text.contains("firmware ana.hex"));
    assert_eq!(told.count(), 2, "{said:?}");
    let folder = folder.to_str().unwrap();
    assert!(!said.iter().any(|text| text.contains(folder)), "{said:?}");
}

/// What is said of a program in its first 0.1 s.
fn said_of(image: &[u8]) -> Vec<String> {
    let mut robot = robot();
    robot
        .run_program(GivenProgram::file("odd.hex", image))
        .unwrap();
    let mut said = Vec::new();
    for _ in 0..20 {
        robot.advance(5_000).unwrap();
        while let Some(news) = robot.news() {
            if let LinkNews::Program(_, text) = news {
                said.push(text);
            }
        }
    }
    said
}

#[test]
fn a_program_that_stands_still_for_good_is_reported_once_with_the_reason() {
    let [stands] = &said_of(IDLE)[..] else {
        panic!("once");
    };
    assert!(
        stands.contains("a loop of one instruction at 0x0"),
        "{stands}"
    );
    // `cli` and `rjmp .-2`, as behind a `main` that has returned.
    let [ends] = &said_of(b":04000000F894FFCFA2\n:00000001FF\n")[..] else {
        panic!("once");
    };
    assert!(ends.contains("main() returned"), "{ends}");
    // Sleeps with interrupts off.
    let [sleeps] = &said_of(b":0800000081E083BF8895FECF6B\n:00000001FF\n")[..] else {
        panic!("once");
    };
    assert!(sleeps.contains("sleeps with interrupts off"), "{sleeps}");
    // The same with interrupts on: `sei` first, and no interrupt comes.
    let enabled = b":0A000000789481E083BF8895FECF5D\n:00000001FF\n";
    assert_eq!(said_of(enabled), [""; 0]);
}
