//! The robot's task and its outcome, for the map and the state line.
//!
//! Derived from the acknowledged commands and the robot's events; telemetry does not repeat a route.

use rumbo_control::Pose;
use rumbo_control::mode::waypoints::Route;
use rumbo_control::mode::{ModeId, Takes};
use rumbo_log::{End, RoutePlace, RoutePlan, TaskState};
use rumbo_wire::{Command, EventKind};

/// Updates the task for a command applied in this mode.
pub(crate) fn applied(task: &mut TaskState, command: &Command, mode: ModeId) {
    match *command {
        Command::Mode(mode) => *task = of(mode),
        Command::Goal { x_m, y_m } if !takes_route(mode) => {
            *task = TaskState {
                goal: Some([x_m, y_m]),
                ..TaskState::default()
            };
        }
        Command::Goal { x_m, y_m } => begin(
            task,
            RoutePlan {
                waypoints: vec![RoutePlace {
                    x_m,
                    y_m,
                    heading_rad: None,
                }],
                ..RoutePlan::default()
            },
        ),
        Command::Lane => {
            *task = TaskState {
                lane: true,
                ..TaskState::default()
            };
        }
        Command::Route { repeat, relative } => begin(
            task,
            RoutePlan {
                repeat,
                relative,
                waypoints: Vec::new(),
            },
        ),
        Command::Waypoint(waypoint) => {
            task.end = None;
            if let Some(route) = &mut task.route {
                route.waypoints.push(waypoint.into());
            }
        }
        Command::Reference(_) | Command::WheelReference(_) => task.end = None,
        _ => {}
    }
}

/// Updates the task for an event, with the robot at `pose`.
pub(crate) fn happened(task: &mut TaskState, kind: EventKind, pose: Pose) {
    match kind {
        EventKind::ModeChanged(mode) => *task = of(mode),
        EventKind::Armed => {
            task.end = None;
            task.from = Some([pose.x_m, pose.y_m, pose.heading_rad]);
        }
        EventKind::Reached => {
            task.end = Some(End::Reached);
            task.goal = None;
        }
        EventKind::Unreachable => task.end = Some(End::Unreachable),
        EventKind::GaveUp { .. } => task.end = Some(End::GaveUp),
        EventKind::Disarmed
        | EventKind::Faulted(_)
        | EventKind::Cleared(_)
        | EventKind::Recalled(_)
        | EventKind::Saved => {}
    }
}

/// Whether a mode drives routes; a goal is then a route of one waypoint.
fn takes_route(mode: ModeId) -> bool {
    matches!(mode.description().takes, Some(Takes::Route(_)))
}

/// The task of a mode just selected: one of routes begins with the default route.
fn of(mode: ModeId) -> TaskState {
    let own = Route::default();
    let route = takes_route(mode).then(|| RoutePlan {
        repeat: own.repeat,
        relative: own.relative,
        waypoints: own
            .waypoints()
            .iter()
            .copied()
            .map(RoutePlace::from)
            .collect(),
    });
    TaskState {
        route,
        ..TaskState::default()
    }
}

fn begin(task: &mut TaskState, route: RoutePlan) {
    task.route = Some(route);
    task.end = None;
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::mode::waypoints::Waypoint;

    const GOAL: Command = Command::Goal {
        x_m: 1.0,
        y_m: -0.5,
    };

    #[test]
    fn a_goal_is_cleared_once_it_is_reached_and_stays_while_it_is_unreachable() {
        let mut task = TaskState::default();
        applied(&mut task, &GOAL, ModeId::Mission);
        happened(&mut task, EventKind::Unreachable, Pose::default());
        assert_eq!(
            (task.goal, task.end),
            (Some([1.0, -0.5]), Some(End::Unreachable))
        );
        applied(&mut task, &GOAL, ModeId::Mission);
        assert_eq!(task.end, None);
        happened(&mut task, EventKind::Reached, Pose::default());
        assert_eq!((task.goal, task.end), (None, Some(End::Reached)));
    }

    #[test]
    fn mode_7_begins_with_the_square_and_takes_another_route_waypoint_by_waypoint() {
        let mut task = TaskState::default();
        applied(&mut task, &Command::Mode(ModeId::Waypoints), ModeId::Manual);
        assert_eq!(task.route.as_ref().unwrap().waypoints.len(), 4);
        let begin = Command::Route {
            repeat: true,
            relative: false,
        };
        applied(&mut task, &begin, ModeId::Waypoints);
        for x_m in [1.0, 2.0] {
            let place = Waypoint {
                x_m,
                ..Waypoint::default()
            };
            applied(&mut task, &Command::Waypoint(place), ModeId::Waypoints);
        }
        let route = task.route.as_ref().unwrap();
        assert!(route.repeat && route.waypoints.len() == 2);
        applied(&mut task, &GOAL, ModeId::Waypoints);
        assert_eq!(task.route.as_ref().unwrap().waypoints.len(), 1);
        applied(&mut task, &Command::Mode(ModeId::Manual), ModeId::Waypoints);
        assert_eq!(task, TaskState::default());
    }
}
