//! What approaches, how the robot gives way to it, and its pause before a detour.

use super::super::{Detour, Mode, Params, Place, Side, Task};
use super::*;
use crate::types::{SonarId, SonarView};

/// Time between two looks [s].
const LOOK_S: f32 = 0.06;

/// After how many of 20 looks a thing approaches that is `range_m(time)` away along an axis, before a robot this fast.
fn approaches(axis_rad: f32, robot_m_s: f32, range_m: impl Fn(f32) -> f32) -> Option<u8> {
    let mut track = Track::default();
    (1..=20).find(|look| {
        let reading = SonarReading {
            sonar: SonarId::Front,
            range: Range::Valid(range_m(LOOK_S * f32::from(*look))),
            view: SonarView {
                axis_rad,
                ..SonarView::default()
            },
            servo_rad: axis_rad,
        };
        let since = Since {
            age_s: LOOK_S,
            rolled_m: LOOK_S * robot_m_s,
            turned_rad: 0.0,
            aside_rad: 0.0,
        };
        track.ingest(&reading, &since).is_some()
    })
}

#[test]
fn a_wall_that_the_robot_drives_to_does_not_approach_and_a_person_does() {
    assert_eq!(approaches(0.0, 0.4, |time_s| 1.1 - 0.4 * time_s), None);
    assert_eq!(approaches(0.0, -0.2, |time_s| 0.5 + 0.2 * time_s), None);
    // Half a metre away, at 0.3 m/s: seen at the third look, before a robot that stands and one that drives.
    assert_eq!(approaches(0.0, 0.0, |time_s| 0.5 - 0.3 * time_s), Some(3));
    assert_eq!(approaches(0.0, 0.4, |time_s| 0.5 - 0.7 * time_s), Some(3));
    assert_eq!(approaches(1.5, 0.4, |time_s| 0.5 - 0.6 * time_s), Some(3));
    // It goes away.
    assert_eq!(approaches(0.0, 0.0, |time_s| 0.3 + 0.3 * time_s), None);
}

#[test]
fn another_face_in_the_beam_does_not_approach() {
    let corner = |time_s: f32| if time_s > 0.3 { 0.35 } else { 0.41 };
    assert_eq!(approaches(1.5, 0.0, corner), None);
}

/// What a standing robot does first about something that approaches, at 0.5 m/s and half a metre away.
fn first_drive(off_rad: f32, sure: bool, detour: Option<Detour>) -> Option<Drive> {
    let params = Params::default();
    let mission = Mission::new(&params, &Task::Goal { x_m: 3.0, y_m: 0.0 });
    let mut state = State {
        phase: Phase::GoToGoal,
        gap_m: 1.0,
        detour,
        ..State::default()
    };
    let approach = Approach {
        off_rad,
        range_m: 0.5,
        speed_m_s: 0.5,
        sure,
    };
    state.movement.step(Some(&approach), false, 0.0);
    let mut estimate = Estimate::default();
    (
        estimate.motion.left.standing,
        estimate.motion.right.standing,
    ) = (true, true);
    mission.give_way(&mut state, &estimate)
}

#[test]
fn it_drives_out_of_the_way_of_what_is_abeam_and_backs_off_from_what_is_farther_ahead() {
    for side in [1.0, -1.0] {
        assert_eq!(first_drive(1.5 * side, true, None), Some(straight(OUT_M_S)));
        assert_eq!(
            first_drive(1.2 * side, true, None),
            Some(straight(-BACK_M_S))
        );
        assert_eq!(
            first_drive(0.5 * side, true, None),
            Some(straight(-BACK_M_S))
        );
    }
}

#[test]
fn around_an_obstacle_it_backs_off_from_what_surely_approaches() {
    let detour = Some(Detour {
        side: Side::Left,
        met: Place::default(),
        least_m: 3.0,
        way_m: 0.0,
        away: false,
        vain: 0,
        changes: 0,
        wound_rad: 0.0,
        bearing_rad: 0.0,
    });
    assert_eq!(first_drive(1.2, true, detour), Some(straight(-BACK_M_S)));
    // Another obstacle may be behind: it stands.
    assert_eq!(first_drive(1.2, false, detour), Some(Drive::Release));
}

/// How many ticks a robot stands before a detour at a place, where something moves at some of them.
fn pause_ticks(x_m: f32, moves: impl Fn(u16) -> bool) -> u16 {
    let mut estimate = Estimate::default();
    estimate.pose.x_m = x_m;
    (
        estimate.motion.left.standing,
        estimate.motion.right.standing,
    ) = (true, true);
    let mut movement = MotionMemory::default();
    movement.pause(x_m);
    let mut tick = 0;
    loop {
        tick += 1;
        movement.step(None, moves(tick), 0.0);
        if !movement.pauses(&estimate) {
            return tick;
        }
    }
}

#[test]
fn a_pause_before_a_detour_is_as_long_as_the_place_says_and_longer_where_something_moves() {
    assert_eq!(pause_ticks(0.0, |_| false), 30);
    assert_eq!(pause_ticks(7.0 / 4_000.0, |_| false), 135);
    // Known from then on: 0.6 s from there.
    assert_eq!(pause_ticks(0.0, |tick| tick == 20), 19 + 60);
    // What moves all the time is not waited for without an end.
    assert_eq!(pause_ticks(0.0, |_| true), 399 + 60);
    assert_eq!(pause_ticks(7.0 / 4_000.0, |_| true), 600);
}

#[test]
fn the_servo_stays_with_something_new_and_looks_ahead_for_a_while() {
    let mut movement = MotionMemory::default();
    assert_eq!(movement.swing(false), None);
    movement.wonder(0.7);
    assert_eq!(movement.swing(false), Some((-AROUND_RAD, 0.7)));
    assert_eq!(movement.swing(true), None, "around an obstacle");
    // The robot turns to it.
    movement.step(None, false, 0.2);
    let (right_rad, left_rad) = movement.swing(false).expect("it looks there");
    assert!(right_rad == -AROUND_RAD && abs(left_rad - 0.5) < 1e-6);
    for _ in 1..WONDER_TICKS {
        movement.step(None, false, 0.0);
    }
    assert!(!movement.wonders());
    assert_eq!(movement.swing(false), None);
}
