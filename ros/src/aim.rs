//! A goal of ROS 2 in the robot's terms: the order for it, and whether it is what the robot does.

use crate::station::{Order, Waypoint};
use rumbo_log::{End, MapPose, RobotState};

/// A goal in the robot's terms.
#[derive(Clone, Copy)]
pub(super) struct Aim {
    pub(super) in_odom: MapPose,
    /// From its origin [m], rad.
    pub(super) x_m: f32,
    pub(super) y_m: f32,
    pub(super) heading_rad: Option<f32>,
}

/// The order for a goal in the robot's mode, by its name; `None`: that mode has no goals.
pub(super) fn order(aim: &Aim, mode: &str) -> Option<Order> {
    let Aim {
        x_m,
        y_m,
        heading_rad,
        ..
    } = *aim;
    match mode {
        "mission" => Some(Order::Goal { x_m, y_m }),
        "waypoints" => Some(Order::Route {
            repeat: false,
            relative: false,
            waypoints: [Waypoint {
                x_m,
                y_m,
                heading_rad,
            }],
        }),
        _ => None,
    }
}

/// Whether the robot's task is this goal, or was until it reached it.
pub(super) fn is_task(aim: &Aim, robot: &RobotState) -> bool {
    let is_it = |x_m: f32, y_m: f32| (x_m, y_m) == (aim.x_m, aim.y_m);
    match (&robot.task.goal, &robot.task.route) {
        (Some([x_m, y_m]), _) => is_it(*x_m, *y_m),
        (None, Some(route)) => match route.waypoints.as_slice() {
            [only] => is_it(only.x_m, only.y_m),
            _ => false,
        },
        (None, None) => robot.task.end == Some(End::Reached),
    }
}
