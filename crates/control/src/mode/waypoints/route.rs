//! The route of mode 7: up to sixteen waypoints.

use crate::mode::SetpointError;
use crate::mode::within;

/// Most waypoints of a route.
pub const MAX_WAYPOINTS: usize = 16;
/// Farthest coordinate of a waypoint or a goal from the origin [m].
pub const FARTHEST_M: f32 = 20.0;

/// A position to drive to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Waypoint {
    /// Forward of the origin [m].
    pub x_m: f32,
    /// Left of the origin [m].
    pub y_m: f32,
    /// Heading to turn to there [rad]; `None`: any.
    pub heading_rad: Option<f32>,
}

/// The waypoints to visit in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Route {
    waypoints: [Waypoint; MAX_WAYPOINTS],
    len: u8,
    /// Starts over at the end, until it is stopped.
    pub repeat: bool,
    /// The waypoints are relative to the pose where the robot starts, not to the origin.
    pub relative: bool,
}

impl Default for Route {
    /// The square of the report: 1 m, counter-clockwise, once.
    fn default() -> Self {
        let mut route = Route::empty(false, false);
        for corner in 0..4_u8 {
            let ahead = matches!(corner, 0 | 1);
            let left = matches!(corner, 1 | 2);
            let corner = Waypoint {
                x_m: f32::from(u8::from(ahead)),
                y_m: f32::from(u8::from(left)),
                heading_rad: None,
            };
            // Four of sixteen fit.
            let _ = route.push(corner);
        }
        route
    }
}

impl Route {
    /// A route without waypoints.
    pub fn empty(repeat: bool, relative: bool) -> Self {
        Self {
            waypoints: [Waypoint::default(); MAX_WAYPOINTS],
            len: 0,
            repeat,
            relative,
        }
    }

    /// The waypoints.
    pub fn waypoints(&self) -> &[Waypoint] {
        self.waypoints
            .get(..usize::from(self.len))
            .unwrap_or_default()
    }

    /// Appends a waypoint.
    ///
    /// # Errors
    /// It is not finite, too far away, or the route is full; the route is as before.
    pub fn push(&mut self, waypoint: Waypoint) -> Result<(), SetpointError> {
        within(waypoint.x_m, -FARTHEST_M, FARTHEST_M)?;
        within(waypoint.y_m, -FARTHEST_M, FARTHEST_M)?;
        within(waypoint.heading_rad.unwrap_or(0.0), -7.0, 7.0)?;
        let slot = self
            .waypoints
            .get_mut(usize::from(self.len))
            .ok_or(SetpointError::OutOfRange)?;
        *slot = waypoint;
        self.len += 1;
        Ok(())
    }
}
