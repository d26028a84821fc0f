//! A simulated robot that must not drive on.

#![allow(clippy::unwrap_used)]

use super::*;
use rumbo_log::MapPose;
use rumbo_session::Standing;
use rumbo_station::log_file;

/// The straight part, with the wall this far from the wheels' axis.
fn straight_on(wall_m: f64) -> (Result<(), Failure>, rumbo_log::Log) {
    let folder = tempfile::tempdir().unwrap();
    let choice = Choice {
        scenario: "free".into(),
        world: Some("wall_front".into()),
        rig: None,
        seed: 1,
    };
    let mut robot = SimulatedRobot::new(Overrides::default(), choice).unwrap();
    let pose = |x_m| MapPose {
        x_m,
        y_m: 0.0,
        heading_rad: 0.0,
    };
    robot.place(Standing {
        at: pose(1.2 - wall_m),
        estimated: pose(0.0),
    });
    let mut driven = Driven::begin(robot, folder.path()).unwrap();
    let asked = AtomicBool::new(false);
    let done =
        answer(&mut driven, &asked).and_then(|()| drive_part(&mut driven, &plan()[1], &asked));
    let path = driven.path();
    let done = end(driven, done).map(|_| ());
    (done, log_file::read(&path).unwrap())
}

#[test]
fn something_near_ahead_stops_the_robot_and_the_drive_says_so() {
    let (done, log) = straight_on(0.6);
    let said = done.unwrap_err().to_string();
    assert!(
        said.contains("m ahead of the robot: it was stopped"),
        "{said}"
    );
    let last = log.rows.last().unwrap();
    assert_eq!(last.signal("armed"), Some(0.0));
    assert_eq!(last.signal("left_pwm"), Some(0.0));
    // It had driven, and has not touched the wall.
    assert!(
        log.rows
            .iter()
            .any(|row| row.signal("left_pwm") > Some(0.0))
    );
    assert!(
        log.rows
            .iter()
            .all(|row| row.signal("true_x_m") < Some(1.2 - 0.13))
    );
}

#[test]
fn a_metre_of_free_floor_suffices() {
    let (done, _) = straight_on(1.13);
    done.unwrap();
}
