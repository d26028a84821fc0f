use super::*;
use crate::mode::SetpointError;

fn standing(x_m: f32, y_m: f32, heading_rad: f32) -> Estimate {
    let mut estimate = Estimate {
        pose: Pose {
            x_m,
            y_m,
            heading_rad,
        },
        ..Estimate::default()
    };
    estimate.motion.left.standing = true;
    estimate.motion.right.standing = true;
    estimate
}

/// The number of the state after a few ticks at one position.
fn rest(route: &Route, state: &mut State, estimate: &Estimate) -> (u8, bool) {
    let params = Params::default();
    let mut last = (0, false);
    for _ in 0..6 {
        let action = Waypoints::new(&params, route)
            .step(state, estimate)
            .unwrap();
        last = (action.state, action.reached);
    }
    last
}

fn route(points: &[(f32, f32, Option<f32>)], repeat: bool, relative: bool) -> Route {
    let mut route = Route::empty(repeat, relative);
    for (x_m, y_m, heading_rad) in points {
        route
            .push(Waypoint {
                x_m: *x_m,
                y_m: *y_m,
                heading_rad: *heading_rad,
            })
            .unwrap();
    }
    route
}

#[test]
fn an_empty_route_waits_and_is_not_reached() {
    let route = route(&[], true, false);
    let mut state = State::default();
    assert_eq!(
        rest(&route, &mut state, &standing(0.0, 0.0, 0.0)),
        (Phase::Wait as u8, false)
    );
}

#[test]
fn it_turns_drives_turns_and_reports_when_it_is_done() {
    let route = route(&[(0.0, 1.0, Some(0.0))], false, false);
    let mut state = State::default();
    let mut at = |x_m, y_m, heading_rad| rest(&route, &mut state, &standing(x_m, y_m, heading_rad));
    assert_eq!(at(0.0, 0.0, 0.0), (Phase::Turn as u8, false));
    assert_eq!(at(0.0, 0.0, 1.57), (Phase::Drive as u8, false));
    assert_eq!(at(0.0, 0.999, 1.57), (Phase::FinalTurn as u8, false));
    // Arrival is latched: a turn that moves the robot a little does not restart the drive.
    assert_eq!(at(0.02, 1.02, 0.5), (Phase::FinalTurn as u8, false));
    assert_eq!(at(0.02, 1.02, 0.0), (Phase::Done as u8, true));
}

#[test]
fn a_relative_route_is_measured_from_its_start() {
    let route = route(&[(1.0, 0.0, None)], false, true);
    let mut state = State::default();
    rest(&route, &mut state, &standing(2.0, 1.0, 1.570_796_4));
    let (x_m, y_m) = state.target();
    assert!((x_m - 2.0).abs() < 1e-5 && (y_m - 2.0).abs() < 1e-5);
}

#[test]
fn a_waypoint_appended_to_a_finished_route_is_driven_to() {
    let mut route = route(&[(0.0, 0.0, None)], false, false);
    let mut state = State::default();
    let here = standing(0.0, 0.0, 0.0);
    assert_eq!(rest(&route, &mut state, &here), (Phase::Done as u8, true));
    route
        .push(Waypoint {
            x_m: -1.0,
            ..Waypoint::default()
        })
        .unwrap();
    assert_eq!(rest(&route, &mut state, &here), (Phase::Turn as u8, false));
}

#[test]
fn a_repeated_route_starts_over() {
    let route = route(&[(0.0, 0.0, None), (1.0, 0.0, None)], true, false);
    let mut state = State::default();
    assert_eq!(route.waypoints().len(), 2);
    rest(&route, &mut state, &standing(0.0, 0.0, 0.0));
    assert_eq!(state.target(), (1.0, 0.0));
    rest(&route, &mut state, &standing(1.0, 0.0, 0.0));
    assert_eq!(state.target(), (0.0, 0.0));
}

#[test]
fn a_waypoint_too_far_or_not_finite_or_one_too_many_is_refused() {
    let mut route = Route::default();
    for x_m in [21.0, f32::NAN] {
        let wrong = Waypoint {
            x_m,
            ..Waypoint::default()
        };
        assert!(route.push(wrong).is_err());
    }
    assert_eq!(route, Route::default());
    for _ in 4..MAX_WAYPOINTS {
        route.push(Waypoint::default()).unwrap();
    }
    assert_eq!(
        route.push(Waypoint::default()),
        Err(SetpointError::OutOfRange)
    );
}
