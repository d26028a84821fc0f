//! What one wheel's speed loop is made of; [`crate::drive`] runs it.

use crate::math::{clamp, max, min};
use crate::pid::Pid;

/// The ramp never leads the wheel by more than this [rad/s], so that a blocked wheel does not surge when freed.
pub(crate) const RAMP_LEAD_RAD_S: f32 = 4.0;

/// Duty for a speed at the nominal battery voltage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feedforward {
    /// Duty that balances friction, forward.
    pub static_forward: f32,
    /// The same backward.
    pub static_backward: f32,
    /// Duty per speed [s/rad].
    pub velocity: f32,
    /// Duty per acceleration [s^2/rad].
    pub acceleration: f32,
}

/// Configuration of one wheel's speed loop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedLoop {
    /// Duty from the reference alone.
    pub feedforward: Feedforward,
    /// First duty of a standing wheel.
    pub kick: f32,
    /// Corrects the rest; output is duty, limits 0..1.
    pub pid: Pid,
    /// Slope of the ramp when speeding up [rad/s per tick].
    pub accel_rad_s: f32,
    /// Slope of the ramp when slowing down [rad/s per tick].
    pub decel_rad_s: f32,
}

impl SpeedLoop {
    /// Advances the ramp by a tick: towards the target, and never far ahead of the wheel. `hold` keeps it from gaining
    /// speed.
    pub(crate) fn ramp(
        &self,
        before_rad_s: f32,
        target_rad_s: f32,
        measured_rad_s: f32,
        hold: bool,
    ) -> f32 {
        let target_rad_s = if hold {
            min(target_rad_s, before_rad_s)
        } else {
            target_rad_s
        };
        let (up, down) = (self.accel_rad_s, self.decel_rad_s);
        let next = before_rad_s + clamp(target_rad_s - before_rad_s, -down, up);
        let lead = measured_rad_s + max(RAMP_LEAD_RAD_S, up);
        if next > lead {
            max(lead, before_rad_s - down)
        } else {
            next
        }
    }
}
