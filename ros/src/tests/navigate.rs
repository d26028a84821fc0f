//! The goals of the action, as its clients see them.

use crate::bridge::Caller;
use crate::navigate::{Cancel, Distribution, Goals, Id, Question, Status, question};
use rumbo_ros::messages::Time;
use std::f64::consts::FRAC_PI_2;

const FIRST: Id = [1; 16];
const SECOND: Id = [2; 16];

fn at(sec: i32) -> Time {
    Time { sec, nanosec: 0 }
}

fn caller(number: i64) -> Caller {
    Caller {
        service: 0,
        client: [9; 16],
        number,
    }
}

fn by(id: Id, sec: i32) -> Cancel {
    Cancel {
        id,
        until: (sec, 0),
    }
}

/// A request of Fast DDS: a goal 1.5 m ahead, turned to the left.
fn goal(turn: [f64; 4]) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend(FIRST);
    bytes.extend([0; 8]);
    bytes.extend([5, 0, 0, 0]);
    bytes.extend(b"odom\0\0\0\0");
    // The body is at 36: the next multiple of 8 is 40.
    bytes.extend([0; 4]);
    for number in [1.5, -0.5, 0.0].iter().chain(&turn) {
        bytes.extend(f64::to_le_bytes(*number));
    }
    bytes.extend([1, 0, 0, 0, 0]);
    bytes
}

#[test]
fn a_goal_is_read_with_and_without_a_heading() {
    let half = 0.5_f64.sqrt();
    let Some(Question::Send(turned)) = question(0, &goal([0.0, 0.0, half, half])) else {
        panic!("no goal");
    };
    assert_eq!((turned.id, turned.frame.as_str()), (FIRST, "odom"));
    assert_eq!((turned.at.x_m, turned.at.y_m), (1.5, -0.5));
    assert!(turned.has_heading && (turned.at.heading_rad - FRAC_PI_2).abs() < 1e-12);
    let Some(Question::Send(plain)) = question(0, &goal([0.0; 4])) else {
        panic!("no goal");
    };
    assert!(!plain.has_heading);
    for short in [0, 4, 20, 99] {
        assert_eq!(question(0, &goal([0.0; 4])[..short]), None);
    }
}

#[test]
fn the_end_of_a_goal_is_known_to_those_who_wait_and_to_those_who_ask_later() {
    let mut goals = Goals::default();
    assert_eq!(goals.result(FIRST, caller(1)).unwrap().status, 0);
    goals.begin(FIRST, at(3));
    assert!(goals.knows(FIRST) && !goals.knows(SECOND));
    assert_eq!(goals.result(FIRST, caller(1)), None);
    assert_eq!(goals.result(FIRST, caller(2)), None);
    let answered = goals.end(FIRST, Status::Aborted, "there is no way");
    assert_eq!(
        answered
            .iter()
            .map(|(who, _)| who.number)
            .collect::<Vec<_>>(),
        [1, 2]
    );
    let (status, result) = (answered[0].1.status, answered[0].1.result.clone());
    assert_eq!((status, result.error_code), (6, 9000));
    assert_eq!(result.error_msg, "there is no way");
    assert_eq!(goals.result(FIRST, caller(3)).unwrap(), answered[0].1);
    // Answered once.
    assert!(goals.end(FIRST, Status::Aborted, "").is_empty());
}

#[test]
fn goals_are_canceled_by_identity_by_time_or_all() {
    let mut goals = Goals::default();
    let code = |goals: &mut Goals, cancel| goals.cancel(cancel).0.return_code;
    assert_eq!(code(&mut goals, by(FIRST, 0)), 2);
    goals.begin(FIRST, at(3));
    goals.end(FIRST, Status::Succeeded, "");
    assert_eq!(code(&mut goals, by(FIRST, 0)), 3);
    goals.begin(SECOND, at(5));
    assert_eq!(goals.cancel(by(Id::default(), 4)).1, Vec::<Id>::new());
    assert_eq!(goals.cancel(by(FIRST, 4)).1, Vec::<Id>::new());
    for cancel in [by(SECOND, 0), by(Id::default(), 5), Cancel::default()] {
        let (answer, ids) = goals.cancel(cancel);
        assert_eq!((answer.return_code, ids), (0, vec![SECOND]));
        assert_eq!(answer.goals_canceling[0].stamp, at(5));
    }
    let status = goals.status().status_list;
    let status: Vec<_> = status.iter().map(|each| each.status).collect();
    assert_eq!(status, [4, 3]);
}

#[test]
fn old_goals_and_waiting_clients_do_not_pile_up() {
    let mut goals = Goals::default();
    for number in 1..=200 {
        let id = [number; 16];
        goals.begin(id, at(0));
        goals.end(id, Status::Succeeded, "");
    }
    assert_eq!(goals.status().status_list.len(), 20);
    goals.begin(FIRST, at(0));
    for number in 0..1_000 {
        goals.result(FIRST, caller(number));
    }
    assert_eq!(goals.end(FIRST, Status::Succeeded, "").len(), 100);
}

#[test]
fn a_result_has_the_size_that_a_distribution_allows() {
    let mut goals = Goals::default();
    goals.begin(FIRST, at(0));
    goals.end(FIRST, Status::Aborted, "no");
    let ended = goals.result(FIRST, caller(0)).unwrap();
    let whole = [0, 1, 0, 0, 6, 0, 0x28, 0x23, 3, 0, 0, 0, b'n', b'o', 0];
    for (distribution, length) in [
        (Distribution::Humble, 6),
        (Distribution::Jazzy, 8),
        (Distribution::Kilted, 15),
    ] {
        assert_eq!(distribution.encode(&ended).unwrap(), whole[..length]);
    }
}
