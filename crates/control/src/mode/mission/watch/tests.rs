//! What raises doubt about a sonar, and what makes it faulty.

use super::*;
use crate::types::{AgedRange, SonarView};

/// Answers of all three sonars in turn, while the robot rolls `rolled_m` per tick; the front one looks ahead.
fn watched(
    answers: impl Fn(SonarId, u16) -> Range,
    ticks: u16,
    rolled_m: f32,
) -> Result<Watch, (u16, Fault)> {
    let mut watch = Watch::default();
    for tick in 0..ticks {
        let sonar = SonarId::ALL[usize::from(tick / 2 % 3)];
        let axis_rad = match sonar {
            SonarId::Left => FRAC_PI_2,
            SonarId::Right => -FRAC_PI_2,
            SonarId::Front => 0.0,
        };
        let mut estimate = Estimate {
            rolled_m,
            facing: (0.0, 1.0),
            ..Estimate::default()
        };
        estimate.pose.x_m = f32::from(tick) * rolled_m;
        let left = &mut estimate.ranges[SonarId::Left as usize];
        (left.range, left.age_ticks) = (answers(SonarId::Left, tick), 0);
        if tick % 2 == 0 {
            let reading = SonarReading {
                sonar,
                range: answers(sonar, tick),
                view: SonarView {
                    axis_rad,
                    ..SonarView::default()
                },
                servo_rad: 0.0,
            };
            watch.hear(&estimate, &reading);
        }
        watch
            .step(&estimate, 0.5, false)
            .map_err(|fault| (tick, fault))?;
    }
    Ok(watch)
}

/// A wall that the robot approaches by 2 mm per tick, measured with some noise.
fn near(_: SonarId, tick: u16) -> Range {
    let noise_m = 1e-3 * f32::from(tick * 7 % 5);
    Range::Valid(1.1 - 2e-3 * f32::from(tick) + noise_m)
}

#[test]
fn sonars_that_answer_are_believed() {
    let sides = |_, tick: u16| Range::Valid(0.4 + 1e-3 * f32::from(tick * 7 % 5));
    for (answers, rolled_m) in [(sides as fn(SonarId, u16) -> Range, 0.0), (near, 0.002)] {
        let front = |sonar, tick| match sonar {
            SonarId::Front => answers(sonar, tick),
            _ => sides(sonar, tick),
        };
        assert!(watched(front, 400, rolled_m).is_ok_and(|watch| !watch.doubts()));
    }
    assert!(
        watched(|_, _| Range::Clear, 500, 0.002).is_ok(),
        "free floor"
    );
}

#[test]
fn a_silent_line_is_a_fault_after_three_answers_and_one_is_none() {
    let cut = watched(|_, _| Range::Faulty, 500, 0.002).map(|_| ());
    assert!(matches!(cut, Err((12, Fault::SonarFaulty))), "{cut:?}");
    let once = |sonar, tick: u16| {
        if tick.is_multiple_of(60) {
            Range::Faulty
        } else {
            near(sonar, 0)
        }
    };
    assert!(watched(once, 500, 0.0).is_ok());
}

#[test]
fn a_stuck_sonar_whose_stamps_differ_now_and_then_is_found_too() {
    let late = |tick: u16, range_m: f32| match tick / 6 % 4 {
        0 => Range::Valid(range_m + 0.000_17),
        _ => Range::Valid(range_m),
    };
    let stuck = watched(|_, tick| late(tick, 0.8), 500, 0.002).map(|_| ());
    assert!(
        matches!(stuck, Err((tick, Fault::SonarFaulty)) if tick < 90),
        "{stuck:?}"
    );
}

#[test]
fn an_answer_that_never_changes_while_the_robot_drives_is_a_fault_within_half_a_second() {
    let stuck = watched(|_, _| Range::Valid(0.8), 500, 0.002).map(|_| ());
    assert!(
        matches!(stuck, Err((tick, Fault::SonarFaulty)) if tick < 50),
        "{stuck:?}"
    );
}

#[test]
fn random_ranges_slow_the_robot_and_then_stop_it_and_an_edge_that_flickers_does_neither() {
    const RANDOM_M: [f32; 10] = [1.3, 0.4, 2.2, 0.9, 0.2, 1.7, 0.6, 2.0, 1.1, 0.3];
    let wild = |sonar, tick: u16| match sonar {
        SonarId::Front => Range::Valid(RANDOM_M[usize::from(tick / 6) % RANDOM_M.len()]),
        _ => near(sonar, 0),
    };
    assert!(watched(wild, 34, 0.0).is_ok_and(|watch| watch.doubts() && !watch.is_wild()));
    assert!(
        watched(wild, 60, 0.0).is_ok_and(|watch| watch.is_wild()),
        "it stands"
    );
    let end = watched(wild, 400, 0.0).map(|_| ());
    assert!(matches!(end, Err((_, Fault::SonarFaulty))), "{end:?}");
    let edge = |_, tick: u16| match tick / 6 % 3 {
        0 => Range::Valid(0.4),
        1 => Range::Valid(0.9),
        _ => Range::Clear,
    };
    assert!(watched(edge, 400, 0.0).is_ok_and(|watch| !watch.doubts()));
}

#[test]
fn a_face_ahead_that_falls_silent_raises_doubt_and_then_is_to_be_proven() {
    let deaf = |sonar, tick: u16| match sonar {
        SonarId::Front if tick < 100 => near(sonar, tick),
        _ => Range::Clear,
    };
    let after = |ticks| watched(deaf, ticks, 0.002).unwrap();
    assert!(after(120).doubts() && !after(120).suspects());
    assert!(after(160).suspects());
    let never = watched(|_, _| Range::Clear, 200, 0.002).unwrap();
    assert!(!never.doubts() && !never.suspects(), "free floor");
}

#[test]
fn a_way_beside_a_wall_without_an_echo_is_to_be_proven_and_an_echo_ends_it() {
    let beside = |until: u16| {
        move |sonar, tick: u16| match sonar {
            SonarId::Left => Range::Valid(0.2 + 1e-3 * f32::from(tick * 7 % 5)),
            SonarId::Front if tick >= until => near(sonar, tick - until),
            _ => Range::Clear,
        }
    };
    let after = |ticks, until| watched(beside(until), ticks, 0.002).unwrap();
    assert!(!after(160, 500).suspects());
    assert!(after(200, 500).suspects());
    assert!(!after(240, 200).suspects());
}

#[test]
fn a_wall_beside_the_robot_that_leaves_two_looks_unanswered_is_to_be_proven() {
    let aside = |watch: &mut Watch, range: Range, left: Range| {
        let mut estimate = Estimate {
            rolled_m: 0.06,
            facing: (0.0, 1.0),
            ..Estimate::default()
        };
        estimate.ranges[SonarId::Left as usize] = AgedRange::fresh(left);
        watch.step(&estimate, 0.5, false).unwrap();
        let view = SonarView {
            axis_rad: SWEEP_RAD,
            ..SonarView::default()
        };
        let reading = SonarReading {
            sonar: SonarId::Front,
            range,
            view,
            servo_rad: SWEEP_RAD,
        };
        (0..2).for_each(|_| watch.hear(&estimate, &reading));
    };
    let (wall, far) = (Range::Valid(0.2), Range::Clear);
    let mut watch = Watch::default();
    aside(&mut watch, Range::Clear, far);
    assert!(!watch.doubts(), "nothing must answer there");
    aside(&mut watch, Range::Clear, wall);
    assert!(watch.doubts() && !watch.suspects());
    let mut silent = watch;
    aside(&mut silent, Range::Clear, wall);
    assert!(silent.suspects());
    aside(&mut watch, Range::Valid(0.2), wall);
    assert!(!watch.doubts(), "it answers");
}

#[test]
fn a_long_way_without_an_echo_is_to_be_proven_unless_there_never_was_one() {
    let until = |last: u16| {
        move |sonar, tick: u16| match sonar {
            SonarId::Left => Range::Valid(0.45 + 1e-3 * f32::from(tick * 7 % 5)),
            SonarId::Front if tick < last => near(sonar, tick),
            _ => Range::Clear,
        }
    };
    let after = |ticks, last| watched(until(last), ticks, 0.02).unwrap();
    assert!(
        !after(60, 20)
            .silent_m
            .is_some_and(|silent_m| silent_m > SILENT_M)
    );
    assert!(after(100, 20).suspects());
    assert!(!after(100, 0).suspects(), "free floor");
}

#[test]
fn no_answer_at_all_is_stale() {
    let mut watch = Watch::default();
    let results: [_; 60] = core::array::from_fn(|_| watch.step(&Estimate::default(), 0.5, false));
    assert_eq!(results[40], Ok(()));
    assert_eq!(results[59], Err(Fault::SonarStale));
}
