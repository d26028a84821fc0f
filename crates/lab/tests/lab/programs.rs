//! Programs dropped on the page of a lab that has images in memory only.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests too")]

use rumbo_experiment::files::Overrides;
use rumbo_lab::{Made, OwnProgram, SimulatedRobot, Sketches, Workshop};
use rumbo_log::{Choice, ProgramPhase};
use rumbo_session::{GivenProgram, LinkNews, Target, TargetError};
use rumbo_sim::boards::Board;
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

/// Compiles anything into [`IDLE`], for an Uno only; `broken.ino` into what is no image.
fn make(board: &'static Board, program: GivenProgram) -> Result<Box<dyn Workshop>, TargetError> {
    assert_eq!(board.name, "uno");
    let image: &[u8] = if program.name == "broken" { b"?" } else { IDLE };
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}.hex", program.name));
    std::fs::write(&path, image).unwrap();
    Ok(Box::new(Wrong(Some(path))))
}

#[test]
fn a_sketch_brings_the_robot_that_it_is_wired_for() {
    let mut robot = robot();
    robot.take_sketches(Sketches {
        make,
        examples: Vec::new,
        example: |_| None,
    });
    let given = |name: &str, robot: &str| GivenProgram {
        name: name.into(),
        robot: Some(robot.into()),
        ..GivenProgram::file("a.ino", b"")
    };
    let car = "title = \"A car\"\nboard = \"uno\"\n[wiring.own]\nleft_enable = 5\nleft_forward = 7\nleft_backward = 8\n\
               right_enable = 6\nright_forward = 11\nright_backward = 9\n";
    let wrong = robot.run_program(given("a", &car.replace("= 7", "= 77")));
    let why = wrong.unwrap_err().to_string();
    assert!(why.contains("robot.toml:5") && why.contains("77"), "{why}");

    // What does not start leaves the robot that is there.
    robot.run_program(given("broken", car)).unwrap();
    while robot.news().is_some() {}
    assert!(robot.chip_board().is_none());
    assert_eq!(robot.scene().unwrap().choice.scenario, "mode1");

    robot.run_program(given("a", car)).unwrap();
    let mut news = std::iter::from_fn(|| robot.news());
    assert!(news.any(|news| news == LinkNews::Renewed));
    assert_eq!(robot.chip_board().map(|board| board.name), Some("uno"));
    assert_eq!(robot.scene().unwrap().choice.scenario, "free");
    assert_eq!(robot.manifest().files["robot"], car);
    // It stays that one in another world, and with another program.
    let choice = Choice {
        world: Some("line_loop".into()),
        ..robot.scene().unwrap().choice
    };
    robot.reset(&choice).unwrap();
    robot.run_program(GivenProgram::file("b.ino", b"")).unwrap();
    while robot.news().is_some() {}
    assert_eq!(robot.manifest().files["robot"], car);
    assert_eq!(robot.scene().unwrap().choice, choice);
}
