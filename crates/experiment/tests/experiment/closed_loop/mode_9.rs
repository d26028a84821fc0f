//! Mode 9: a goal by a learned network, in the integers of the robot.

use super::{seeds, setup};
use rumbo_control::mode::policy::{SERVO_RAD, WHEEL_RAD_S, shares};
use rumbo_control::policy::{DECISION_TICKS, decide};
use rumbo_control::{Drive, Wheels};
use rumbo_experiment::batch::{DrivenBy, Robot};
use rumbo_experiment::campaign::judge;
use std::sync::Arc;

#[test]
fn forty_worlds_show_what_is_required_of_a_thousand() {
    let setup = setup("mode9-random");
    for finding in judge(&setup, &seeds(&setup, 101..141)) {
        assert!(finding.met, "{finding:?}");
    }
}

#[test]
fn every_decision_is_what_the_network_makes_of_what_the_robot_knew_a_decision_before() {
    let setup = Arc::new(setup("mode9-random"));
    let policy = setup.policy.clone().unwrap();
    let read = |at: u16| policy.bytes[usize::from(at)];
    let mut servo_rad = Vec::new();
    for seed in 1..4 {
        let mut robot = Robot::new(&setup, DrivenBy::Caller, seed).unwrap();
        robot.advance(50);
        for command in ["goal = \"world\"", "arm = true"] {
            robot.instruct(command).unwrap();
        }
        robot.advance(1);
        let mut seen = robot.observed();
        for decision in 0..80 {
            robot.advance(DECISION_TICKS.into());
            let [left, right, servo] = shares(decide(&policy.shape, read, &seen));
            seen = robot.observed();
            let mut later = robot.clone();
            later.advance(1);
            let wheels = Wheels { left, right }.map(|share| share * WHEEL_RAD_S);
            let request = later.sim().loops().unwrap().request;
            assert_eq!(
                request,
                Drive::WheelSpeed(wheels),
                "seed {seed}, decision {decision}"
            );
            servo_rad.push(servo * SERVO_RAD);
        }
    }
    assert!(
        servo_rad.iter().any(|angle| *angle != servo_rad[0]),
        "it looks around"
    );
}

#[test]
fn without_a_policy_the_robot_refuses_to_start() {
    let setup = rumbo_experiment::files::Setup {
        policy: None,
        ..setup("mode9-random")
    };
    let mut robot = Robot::new(&Arc::new(setup), DrivenBy::Caller, 1).unwrap();
    robot.advance(50);
    let refused = robot.instruct("arm = true").unwrap_err().to_string();
    assert!(refused.contains("the robot has no policy"), "{refused}");
}
