use super::*;
use crate::fixtures::{at, twist};

fn step(start: Point, points: &[Point], estimate: &Estimate) -> PursuitStep {
    let mut state = PursuitState::from(start);
    step_on(&mut state, points, estimate)
}

fn step_on(state: &mut PursuitState, points: &[Point], estimate: &Estimate) -> PursuitStep {
    Pursuit::new(&Params::default()).step(state, estimate, f32::MAX, |number| {
        points.get(usize::from(number)).copied()
    })
}

#[test]
fn left_of_the_line_it_steers_right_and_on_it_straight() {
    let path = [(2.0, 0.0)];
    let beside = step((0.0, 0.0), &path, &at(1.0, 0.05, 0.0, 0.3));
    assert!((beside.cross_m - 0.05).abs() < 1e-6);
    assert!(twist(beside.drive).1 < 0.0 && beside.heading_ref_rad < 0.0);
    let (_, yaw) = twist(step((0.0, 0.0), &path, &at(1.0, 0.0, 0.0, 0.3)).drive);
    assert!(yaw.abs() < 1e-6);
}

#[test]
fn on_a_circle_it_steers_with_the_circles_curvature() {
    // Radius 0.5 about (0, 0.5), as chords of 6 degrees; the robot is at the origin.
    let points: [Point; 20] = core::array::from_fn(|i| {
        let (sin, cos) = crate::math::sin_cos(f32::from(i as u8 + 1) * 0.105);
        (0.5 * sin, 0.5 - 0.5 * cos)
    });
    let (forward, yaw) = twist(step((0.0, 0.0), &points, &at(0.0, 0.0, 0.0, 0.3)).drive);
    assert!((yaw / forward - 2.0).abs() < 0.1, "{}", yaw / forward);
}

#[test]
fn the_last_piece_is_prolonged_so_the_end_pulls_to_no_side() {
    let close = step((0.0, 0.0), &[(1.0, 0.0)], &at(0.97, 0.01, 0.0, 0.05));
    let (forward, yaw) = twist(close.drive);
    assert!(forward > 0.0 && yaw.abs() < 0.2, "{yaw}");
}

#[test]
fn a_point_is_passed_where_the_next_piece_is_nearer_and_the_last_never_is() {
    let corner = [(1.0, 0.0), (1.0, 1.0)];
    let passed = |x_m, y_m| step((0.0, 0.0), &corner, &at(x_m, y_m, 0.5, 0.3)).passed;
    assert!(!passed(0.9, 0.05) && passed(0.97, 0.05) && passed(1.02, 0.0));
    let last = step((0.0, 0.0), &corner[..1], &at(1.1, 0.0, 0.0, 0.3));
    assert!(!last.passed);
}

#[test]
fn it_slows_down_in_bends_and_before_the_end_whatever_the_lookahead() {
    let fast = |estimate, points: &[Point]| {
        let mut state = PursuitState::from((0.0, 0.0));
        (0..200)
            .map(|_| twist(step_on(&mut state, points, &estimate).drive).0)
            .last()
            .unwrap_or_default()
    };
    let straight = fast(at(0.5, 0.0, 0.0, 0.4), &[(3.0, 0.0)]);
    let bend = fast(at(0.5, 0.0, 0.0, 0.4), &[(0.52, 0.0), (0.52, 1.0)]);
    let end = fast(at(0.5, 0.0, 0.0, 0.4), &[(0.6, 0.0)]);
    assert!(
        straight > 0.44 && bend < 0.35 && end < 0.25,
        "{straight} {bend} {end}"
    );
}

#[test]
fn it_stands_and_turns_to_a_path_that_begins_behind_it() {
    let back = step((0.0, 0.0), &[(-1.0, 0.0)], &at(0.0, 0.0, 0.0, 0.0));
    assert!(back.turn && back.drive == Drive::Release);
    assert!(back.heading_ref_rad.abs() > 3.0);
}

#[test]
fn the_reports_lookahead_is_the_point_after_the_nearest() {
    let mut params = Params::default();
    params.set(ParamId::PursuitSpacing, 0.2).unwrap();
    let pursuit = Pursuit::new(&params);
    let near = |value: f32, wanted: f32| (value - wanted).abs() < 1e-6;
    assert!(near(pursuit.lookahead_m(0.0, 0.4), 0.2));
    assert!(near(pursuit.lookahead_m(0.09, 0.4), 0.11));
    assert!(near(pursuit.lookahead_m(0.11, 0.4), 0.29));
}

#[test]
fn a_path_without_points_or_with_points_on_one_place_is_no_harm() {
    assert_eq!(
        step((0.0, 0.0), &[], &at(0.0, 0.0, 0.0, 0.0)).drive,
        Drive::Release
    );
    let same = step((0.3, 0.0), &[(0.3, 0.0); 3], &at(0.3, 0.0, 1.0, 0.2));
    assert!(same.heading_ref_rad.is_finite() && same.cross_m.is_finite());
}
