//! What the robot was asked to reach, and what came of it: for the map and the state line.
//!
//! Made of the commands that the robot acknowledged and of its events; telemetry does not repeat a route.

use crate::scene::{Place, RoutePlan};
use rumbo_control::Pose;
use rumbo_control::mode::ModeId;
use rumbo_control::mode::waypoints::Route;
use rumbo_wire::{Command, EventKind};
use serde::{Deserialize, Serialize};

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum End {
    Reached,
    Unreachable,
}

/// What the robot is asked to reach. Places are from the robot's origin.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Errand {
    /// The goal of mode 8 \[m\]; `None` once it is reached, since the origin may have moved there.
    pub(crate) goal: Option<[f32; 2]>,
    /// Mode 8 follows a lane.
    pub(crate) lane: bool,
    /// The route of mode 7.
    pub(crate) route: Option<RoutePlan>,
    /// Where the robot stood when a relative route began: x, y \[m\] and heading \[rad\].
    pub(crate) from: Option<[f32; 3]>,
    /// How it ended; `None` while it goes on.
    pub(crate) end: Option<End>,
}

impl Errand {
    /// The robot has applied a command in this mode.
    pub(crate) fn applied(&mut self, command: &Command, mode: ModeId) {
        match *command {
            Command::Mode(mode) => *self = Self::of(mode),
            Command::Goal { x_m, y_m } if mode == ModeId::Mission => {
                *self = Self {
                    goal: Some([x_m, y_m]),
                    ..Self::default()
                };
            }
            Command::Goal { x_m, y_m } => self.begin(RoutePlan {
                waypoints: vec![Place {
                    x_m,
                    y_m,
                    heading_rad: None,
                }],
                ..RoutePlan::default()
            }),
            Command::Lane => {
                *self = Self {
                    lane: true,
                    ..Self::default()
                };
            }
            Command::Route { repeat, relative } => self.begin(RoutePlan {
                repeat,
                relative,
                waypoints: Vec::new(),
            }),
            Command::Waypoint(waypoint) => {
                self.end = None;
                if let Some(route) = &mut self.route {
                    route.waypoints.push(waypoint.into());
                }
            }
            Command::Reference(_) | Command::WheelReference(_) => self.end = None,
            _ => {}
        }
    }

    /// Something happened in this mode, with the robot at `pose`.
    pub(crate) fn happened(&mut self, kind: EventKind, mode: ModeId, pose: Pose) {
        match kind {
            EventKind::ModeChanged(mode) => *self = Self::of(mode),
            EventKind::Armed => {
                self.end = None;
                self.from = Some([pose.x_m, pose.y_m, pose.heading_rad]);
            }
            EventKind::Reached => {
                self.end = Some(End::Reached);
                if mode == ModeId::Mission {
                    self.goal = None;
                }
            }
            EventKind::Unreachable => self.end = Some(End::Unreachable),
            EventKind::Disarmed
            | EventKind::Faulted(_)
            | EventKind::Cleared(_)
            | EventKind::Recalled(_)
            | EventKind::Saved => {}
        }
    }

    /// A mode that has just been selected: mode 7 begins with a route of its own.
    fn of(mode: ModeId) -> Self {
        let own = Route::default();
        let route = (mode == ModeId::Waypoints).then(|| RoutePlan {
            repeat: own.repeat,
            relative: own.relative,
            waypoints: own.waypoints().iter().copied().map(Place::from).collect(),
        });
        Self {
            route,
            ..Self::default()
        }
    }

    fn begin(&mut self, route: RoutePlan) {
        self.route = Some(route);
        self.end = None;
    }
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
        errand.applied(&GOAL, ModeId::Mission);
        errand.happened(EventKind::Unreachable, ModeId::Mission, Pose::default());
        assert_eq!(
            (errand.goal, errand.end),
            (Some([1.0, -0.5]), Some(End::Unreachable))
        );
        errand.applied(&GOAL, ModeId::Mission);
        assert_eq!(errand.end, None);
        errand.happened(EventKind::Reached, ModeId::Mission, Pose::default());
        assert_eq!((errand.goal, errand.end), (None, Some(End::Reached)));
    }

    #[test]
    fn mode_7_begins_with_the_square_and_takes_another_route_place_by_place() {
        let mut errand = Errand::default();
        errand.applied(&Command::Mode(ModeId::Waypoints), ModeId::Manual);
        assert_eq!(errand.route.as_ref().unwrap().waypoints.len(), 4);
        let begin = Command::Route {
            repeat: true,
            relative: false,
        };
        errand.applied(&begin, ModeId::Waypoints);
        for x_m in [1.0, 2.0] {
            let place = Waypoint {
                x_m,
                ..Waypoint::default()
            };
            errand.applied(&Command::Waypoint(place), ModeId::Waypoints);
        }
        let route = errand.route.as_ref().unwrap();
        assert!(route.repeat && route.waypoints.len() == 2);
        errand.applied(&GOAL, ModeId::Waypoints);
        assert_eq!(errand.route.as_ref().unwrap().waypoints.len(), 1);
        errand.applied(&Command::Mode(ModeId::Manual), ModeId::Waypoints);
        assert_eq!(errand, Errand::default());
    }
}
