//! What the robot was asked to reach, and what came of it: for the map and the state line.
//!
//! Made of the commands that the robot acknowledged and of its events; telemetry does not repeat a route.

use rumbo_control::Pose;
use rumbo_control::mode::ModeId;
use rumbo_control::mode::waypoints::Route;
use rumbo_log::{End, Errand, Place, RoutePlan};
use rumbo_wire::{Command, EventKind};

/// The robot has applied a command in this mode.
pub(crate) fn applied(errand: &mut Errand, command: &Command, mode: ModeId) {
    match *command {
        Command::Mode(mode) => *errand = of(mode),
        Command::Goal { x_m, y_m } if mode == ModeId::Mission => {
            *errand = Errand {
                goal: Some([x_m, y_m]),
                ..Errand::default()
            };
        }
        Command::Goal { x_m, y_m } => begin(
            errand,
            RoutePlan {
                waypoints: vec![Place {
                    x_m,
                    y_m,
                    heading_rad: None,
                }],
                ..RoutePlan::default()
            },
        ),
        Command::Lane => {
            *errand = Errand {
                lane: true,
                ..Errand::default()
            };
        }
        Command::Route { repeat, relative } => begin(
            errand,
            RoutePlan {
                repeat,
                relative,
                waypoints: Vec::new(),
            },
        ),
        Command::Waypoint(waypoint) => {
            errand.end = None;
            if let Some(route) = &mut errand.route {
                route.waypoints.push(waypoint.into());
            }
        }
        Command::Reference(_) | Command::WheelReference(_) => errand.end = None,
        _ => {}
    }
}

/// Something happened in this mode, with the robot at `pose`.
pub(crate) fn happened(errand: &mut Errand, kind: EventKind, mode: ModeId, pose: Pose) {
    match kind {
        EventKind::ModeChanged(mode) => *errand = of(mode),
        EventKind::Armed => {
            errand.end = None;
            errand.from = Some([pose.x_m, pose.y_m, pose.heading_rad]);
        }
        EventKind::Reached => {
            errand.end = Some(End::Reached);
            if mode == ModeId::Mission {
                errand.goal = None;
            }
        }
        EventKind::Unreachable => errand.end = Some(End::Unreachable),
        EventKind::Disarmed
        | EventKind::Faulted(_)
        | EventKind::Cleared(_)
        | EventKind::Recalled(_)
        | EventKind::Saved => {}
    }
}

/// A mode that has just been selected: mode 7 begins with a route of its own.
fn of(mode: ModeId) -> Errand {
    let own = Route::default();
    let route = (mode == ModeId::Waypoints).then(|| RoutePlan {
        repeat: own.repeat,
        relative: own.relative,
        waypoints: own.waypoints().iter().copied().map(Place::from).collect(),
    });
    Errand {
        route,
        ..Errand::default()
    }
}

fn begin(errand: &mut Errand, route: RoutePlan) {
    errand.route = Some(route);
    errand.end = None;
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
    fn a_goal_is_gone_once_it_is_reached_and_stays_while_it_is_unreachable() {
        let mut errand = Errand::default();
        applied(&mut errand, &GOAL, ModeId::Mission);
        happened(
            &mut errand,
            EventKind::Unreachable,
            ModeId::Mission,
            Pose::default(),
        );
        assert_eq!(
            (errand.goal, errand.end),
            (Some([1.0, -0.5]), Some(End::Unreachable))
        );
        applied(&mut errand, &GOAL, ModeId::Mission);
        assert_eq!(errand.end, None);
        happened(
            &mut errand,
            EventKind::Reached,
            ModeId::Mission,
            Pose::default(),
        );
        assert_eq!((errand.goal, errand.end), (None, Some(End::Reached)));
    }

    #[test]
    fn mode_7_begins_with_the_square_and_takes_another_route_place_by_place() {
        let mut errand = Errand::default();
        applied(
            &mut errand,
            &Command::Mode(ModeId::Waypoints),
            ModeId::Manual,
        );
        assert_eq!(errand.route.as_ref().unwrap().waypoints.len(), 4);
        let begin = Command::Route {
            repeat: true,
            relative: false,
        };
        applied(&mut errand, &begin, ModeId::Waypoints);
        for x_m in [1.0, 2.0] {
            let place = Waypoint {
                x_m,
                ..Waypoint::default()
            };
            applied(&mut errand, &Command::Waypoint(place), ModeId::Waypoints);
        }
        let route = errand.route.as_ref().unwrap();
        assert!(route.repeat && route.waypoints.len() == 2);
        applied(&mut errand, &GOAL, ModeId::Waypoints);
        assert_eq!(errand.route.as_ref().unwrap().waypoints.len(), 1);
        applied(
            &mut errand,
            &Command::Mode(ModeId::Manual),
            ModeId::Waypoints,
        );
        assert_eq!(errand, Errand::default());
    }
}
