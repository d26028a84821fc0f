//! The lab of a page with several robots in one world.

use crate::lab::{drive, is, state};
use rumbo_browser::{Lab, Start};
use rumbo_experiment::files::{Kind, Library, Overrides};
use rumbo_lab::run_hash;
use std::cell::Cell;

const CORNERS: &str = include_str!("../../../../examples/fleet/corners.toml");
const SQUARE: &str = include_str!("../../../../examples/fleet/square.toml");

fn three() -> Start {
    Start {
        scenario: "free".into(),
        robots: 3,
        ..Start::default()
    }
}

/// As its files are dropped on the page.
fn corners() -> Start {
    Start {
        scenario: "corners".into(),
        file: Some(CORNERS.replace("duration_s = 120", "duration_s = 4")),
        edited: Some(SQUARE.into()),
        ..Start::default()
    }
}

/// The page is that of this robot; whether it is armed.
fn armed(lab: &mut Lab, clock_us: &Cell<u64>, robot: usize) -> bool {
    lab.select(robot);
    let messages = drive(lab, clock_us, 0.5);
    let greeted = format!("\"robot\":{robot}");
    assert!(messages[0].contains(&greeted), "{}", messages[0]);
    state(&messages).contains("\"armed\":true")
}

#[test]
fn a_page_is_of_one_robot_at_a_time_and_stop_stops_all() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(three(), 0.0).unwrap();
    let messages = drive(&mut lab, &clock_us, 1.0);
    let hello = messages.iter().find(is("hello")).unwrap();
    assert!(
        hello.contains(r#""robots":["robot1","robot2","robot3"]"#),
        "{hello}"
    );
    for robot in [1, 2] {
        assert!(!armed(&mut lab, &clock_us, robot));
        lab.order(r#"{"type":"arm"}"#);
        drive(&mut lab, &clock_us, 0.5);
    }
    let are = [0, 1, 2].map(|robot| armed(&mut lab, &clock_us, robot));
    assert_eq!(are, [false, true, true]);
    lab.select(0);
    lab.order(r#"{"type":"stop"}"#);
    drive(&mut lab, &clock_us, 0.5);
    let are = [0, 1, 2].map(|robot| armed(&mut lab, &clock_us, robot));
    assert_eq!(are, [false; 3]);
    // There is no such robot.
    lab.select(3);
    assert!(
        !drive(&mut lab, &clock_us, 0.1)
            .iter()
            .any(|it| is("hello")(&it))
    );
}

#[test]
fn each_robot_has_a_recording_and_sees_the_others() {
    let clock_us = Cell::new(0);
    let mut lab = Lab::new(three(), 0.0).unwrap();
    drive(&mut lab, &clock_us, 1.0);
    for (robot, others) in [["robot2", "robot3"], ["robot1", "robot3"]]
        .iter()
        .enumerate()
    {
        lab.select(robot);
        let (name, bytes) = lab.log("2026-11-26T10:00:00Z".into()).unwrap();
        assert!(name.contains(&format!("robot{}", robot + 1)), "{name}");
        let log = rumbo_log::Log::read(std::io::Cursor::new(bytes)).unwrap();
        let reading = log.readings.last().unwrap();
        for other in others {
            assert!(
                reading.signal(&format!("{other}_x_m")).is_some(),
                "{reading:?}"
            );
        }
    }
}

#[test]
fn a_scenario_that_is_given_runs_and_is_in_the_link() {
    let clock_us = Cell::new(0);
    let start = corners();
    let mut lab = Lab::new(start.clone(), 0.0).unwrap();
    let hello = &drive(&mut lab, &clock_us, 0.5)[0];
    assert!(hello.contains("\"south_west\",\"south_east\""), "{hello}");
    let shared = lab.share();
    assert_eq!((&shared.file, &shared.edited), (&start.file, &start.edited));
    assert_eq!((shared.robots, shared.drive), (1, None));
    assert!(shared.why_not.unwrap().contains("several robots"));
}

#[test]
fn its_run_without_a_page_is_that_of_the_files() {
    let start = corners();
    let library = Library::new()
        .holding(Kind::Scenario, "corners", start.file.as_ref().unwrap())
        .holding(Kind::World, "square.toml", SQUARE);
    let native = library.setup("corners", &Overrides::default()).unwrap();
    let hash = |setup, seed| run_hash(setup, seed, None).unwrap();
    let [here, there, other] = [
        (start.setup().unwrap(), 1),
        (native.clone(), 1),
        (native, 2),
    ]
    .map(|(setup, seed)| hash(setup, seed));
    assert_eq!(here, there);
    assert_ne!(here, other);
}

#[test]
fn what_cannot_be_started_says_why() {
    let why = |start| Lab::new(start, 0.0).err().unwrap().to_string();
    let twice = Start {
        robots: 3,
        ..corners()
    };
    assert!(why(twice).contains("has robots of its own"));
    let many = Start {
        robots: 1_000,
        ..three()
    };
    assert!(why(many).contains("has room for"));
    let world = Start {
        edited: None,
        ..corners()
    };
    assert!(why(world).contains("square.toml"));
}
