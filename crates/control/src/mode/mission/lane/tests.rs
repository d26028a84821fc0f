//! A lane's parts: what is ahead, the sweep, the side, the middle.

use super::*;
use crate::types::{AgedRange, SonarView};

/// What the robot knows when the front sonar answers with the servo at an angle.
fn hears(range: Range, servo_rad: f32) -> Estimate {
    Estimate {
        reading: Some(SonarReading {
            sonar: SonarId::Front,
            range,
            view: SonarView::default(),
            servo_rad,
        }),
        ..Estimate::default()
    }
}

/// What it knows with these ranges at its sides.
fn between(left: Range, right: Range) -> Estimate {
    let mut estimate = Estimate::default();
    for (sonar, range) in [(SonarId::Left, left), (SonarId::Right, right)] {
        estimate.ranges[sonar as usize] = AgedRange::fresh(range);
    }
    estimate
}

#[test]
fn one_wrong_look_ahead_changes_nothing_and_way_rolled_counts() {
    let mut ahead = FaceAhead::default();
    ahead.step(&hears(Range::Valid(0.8), 0.0), 0.0);
    ahead.step(&hears(Range::Valid(0.8), 0.0), 0.0);
    assert_eq!(ahead.range_m(), None, "two looks are too few");
    ahead.step(&hears(Range::Valid(2.1), 0.0), 0.0);
    assert_eq!(ahead.range_m(), Some(0.8));
    ahead.step(&hears(Range::Valid(0.2), 0.5), 0.0);
    assert_eq!(ahead.range_m(), Some(0.8), "a look aside");
    ahead.step(&hears(Range::Faulty, 0.0), 0.0);
    assert_eq!(ahead.range_m(), Some(0.8), "no look at all");
    let rolled = Estimate {
        rolled_m: 0.1,
        ..Estimate::default()
    };
    ahead.step(&rolled, 0.0);
    assert!((ahead.range_m().unwrap() - 0.7).abs() < 1e-6);
}

#[test]
fn a_face_that_looks_agreed_on_is_missing_until_it_is_seen_again_or_one_behind_it_is() {
    let look = |ahead: &mut FaceAhead, range: Range| ahead.step(&hears(range, 0.0), 0.0);
    let mut ahead = FaceAhead::default();
    (0..5).for_each(|_| look(&mut ahead, Range::Valid(0.5)));
    assert!(!ahead.is_missing());
    for (range_m, missing) in [(1.9, false), (2.4, false), (0.9, false), (1.4, true)] {
        look(&mut ahead, Range::Valid(range_m));
        assert_eq!(ahead.is_missing(), missing, "{range_m}");
    }
    (0..50).for_each(|_| look(&mut ahead, Range::Clear));
    assert!(ahead.is_missing(), "silence proves nothing");
    let mut behind = ahead;
    (0..4).for_each(|_| look(&mut behind, Range::Valid(1.5)));
    assert!(!behind.is_missing());
    (0..2).for_each(|_| look(&mut ahead, Range::Valid(0.5)));
    assert!(!ahead.is_missing());
}

#[test]
fn a_look_across_the_lane_is_none_ahead() {
    let mut ahead = FaceAhead::default();
    (0..5).for_each(|_| ahead.step(&hears(Range::Valid(0.5), 0.0), 0.3));
    assert_eq!(ahead.range_m(), None);
}

/// A sweep over a face that ends at `end_rad`, with a look lost at `lost_rad`.
fn swept(sign: f32, end_rad: f32, lost_rad: f32) -> Swept {
    let mut sweep = SweepSide::default();
    for _ in 0..100 {
        let at_rad = sweep.target_rad;
        let lost = (at_rad - lost_rad).abs() < 0.5 * STEP_RAD;
        let range = if at_rad > end_rad || lost {
            Range::Clear
        } else {
            Range::Valid(0.3)
        };
        match sweep.step(&hears(range, sign * at_rad), sign, 0.6) {
            Swept::Going => {}
            result => return result,
        }
    }
    Swept::Going
}

#[test]
fn a_sweep_ends_at_the_first_of_two_looks_beyond_the_face_to_either_side() {
    for sign in [-1.0, 1.0] {
        let Swept::Open(angle_rad) = swept(sign, 0.5, 9.0) else {
            panic!("no opening");
        };
        assert!((angle_rad - 0.6).abs() < 1e-5, "{angle_rad}");
    }
}

#[test]
fn a_lost_echo_is_no_opening_and_a_face_without_end_is_closed() {
    assert_eq!(swept(1.0, 9.0, 0.6), Swept::Closed);
}

#[test]
fn a_look_of_before_the_servo_got_there_does_not_count() {
    let mut sweep = SweepSide::default();
    sweep.step(&hears(Range::Clear, 0.0), 1.0, 0.6);
    let target_rad = sweep.target_rad;
    sweep.step(&hears(Range::Clear, 0.0), 1.0, 0.6);
    assert_eq!((sweep.target_rad, sweep.beyond), (target_rad, 0));
}

/// The change of heading after a sweep with openings at these angles [rad].
fn decision(right_rad: Option<f32>, left_rad: Option<f32>, sides: &Estimate) -> f32 {
    let mut lane = Lane {
        face_m: 0.25,
        right_rad,
        left_rad,
        ..Lane::default()
    };
    lane.decide(sides);
    assert_eq!(lane.stage, Stage::Turn);
    lane.heading_rad
}

#[test]
fn it_turns_to_the_nearer_opening_that_the_sonar_at_that_side_confirms() {
    let (near, far) = (Range::Valid(0.3), Range::Clear);
    let both = between(far, far);
    assert_eq!(decision(Some(0.6), Some(0.9), &both), -FRAC_PI_2);
    assert_eq!(decision(Some(0.9), Some(0.6), &both), FRAC_PI_2);
    let left_only = between(far, near);
    assert_eq!(
        decision(Some(0.6), None, &left_only),
        FRAC_PI_2,
        "a gap at a corner is no opening"
    );
}

#[test]
fn without_a_sonar_that_confirms_the_angles_decide_and_without_an_opening_it_turns_back() {
    let walls = between(Range::Valid(0.3), Range::Valid(0.3));
    assert_eq!(decision(None, Some(0.9), &walls), FRAC_PI_2);
    assert_eq!(decision(Some(0.3), Some(0.9), &walls), -FRAC_PI_2);
    assert!((decision(None, None, &walls).abs() - PI).abs() < 1e-6);
}

#[test]
fn openings_at_the_same_angle_leave_it_to_the_room_at_the_sides() {
    let more_left = between(Range::Valid(1.4), Range::Valid(0.8));
    assert_eq!(decision(Some(0.6), Some(0.6), &more_left), FRAC_PI_2);
    let more_right = between(Range::Valid(0.8), Range::Valid(1.4));
    assert_eq!(decision(Some(0.6), Some(0.6), &more_right), -FRAC_PI_2);
}

#[test]
fn it_keeps_to_the_middle_between_two_walls_and_off_a_single_near_one() {
    let middle = |left, right| aside_rad(&between(left, right));
    let (wall, far) = (Range::Valid, Range::Clear);
    assert_eq!(middle(wall(0.3), wall(0.3)), 0.0);
    assert!(
        middle(wall(0.4), wall(0.3)) > 0.0,
        "to the left, where there is room"
    );
    assert_eq!(
        middle(wall(0.3), far),
        0.0,
        "a gap beside a wall is ignored"
    );
    assert!(
        middle(wall(0.1), far) < 0.0,
        "away from a near wall on the left"
    );
    assert_eq!(middle(wall(0.58), wall(0.05)), MOST_ASIDE_RAD);
}
