//! The units of the text protocol, and what its rows show for a range.

use rumbo_control::Range;

/// rad/s in one rpm.
pub const RAD_S_PER_RPM: f32 = core::f32::consts::PI / 30.0;
/// rad in one degree.
pub const RAD_PER_DEG: f32 = core::f32::consts::PI / 180.0;
/// cm in one m.
pub const CM_PER_M: f32 = 100.0;

/// Length of the longest row, CR and LF included.
pub const MAX_LINE: usize = 128;

/// What a text row shows for a range [cm]: the original has numbers only. 0 is *faulty*, 400 (the end of the
/// HC-SR04's scale, beyond the reach that is used) is *clear*.
pub fn cm_from_range(range: Range) -> f32 {
    match range {
        Range::Valid(range_m) => range_m * CM_PER_M,
        Range::Clear => CLEAR_CM,
        Range::Faulty => 0.0,
    }
}

/// Inverse of [`cm_from_range`].
pub fn range_from_cm(range_cm: f32) -> Range {
    if range_cm >= CLEAR_CM {
        Range::Clear
    } else if range_cm > 0.0 {
        Range::Valid(range_cm / CM_PER_M)
    } else {
        Range::Faulty
    }
}

const CLEAR_CM: f32 = 400.0;
