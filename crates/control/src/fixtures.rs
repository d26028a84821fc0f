//! What tests of several modules need: parameters of a rig, and what the robot perceives.

use crate::estimate::Estimate;
use crate::params::{ParamId, Params};
use crate::rig::Rig;
use crate::types::{AgedRange, Drive, Pose, Range};

/// The defaults on a rig.
pub(crate) fn params(rig: Rig) -> Params {
    let mut params = Params::default();
    params.set(ParamId::Rig, f32::from(rig as u8)).unwrap();
    params
}

/// Fresh ranges of the sonars left, right and front.
pub(crate) fn with_ranges(ranges: [Range; 3]) -> Estimate {
    Estimate {
        ranges: ranges.map(AgedRange::fresh),
        ..Estimate::default()
    }
}

/// The same in metres; 0 is nothing in range.
pub(crate) fn with_ranges_m(ranges_m: [f32; 3]) -> Estimate {
    with_ranges(ranges_m.map(|range_m| match range_m > 0.0 {
        true => Range::Valid(range_m),
        false => Range::Clear,
    }))
}

/// A pose and a speed.
pub(crate) fn at(x_m: f32, y_m: f32, heading_rad: f32, forward_m_s: f32) -> Estimate {
    let mut estimate = Estimate {
        pose: Pose {
            x_m,
            y_m,
            heading_rad,
        },
        forward_m_s,
        ..Estimate::default()
    };
    estimate.motion.left.standing = forward_m_s == 0.0;
    estimate.motion.right.standing = forward_m_s == 0.0;
    estimate
}

/// The speeds forward and of yaw; 0 of anything but a twist.
pub(crate) fn twist(drive: Drive) -> (f32, f32) {
    match drive {
        Drive::Twist {
            forward_m_s,
            yaw_rad_s,
        } => (forward_m_s, yaw_rad_s),
        _ => (0.0, 0.0),
    }
}
