//! What comes back of the light: the field is seen in slices side by side, each up to the nearest thing in it.
//!
//! Light that comes back weakens with the square of the distance, so that of a thing before a wall the range is nearer to the
//! thing than to the wall, as the share of the field that it fills has it.

use crate::obstacle::cone_at;
use rumbo_plant::cone::{self, Hearing};
use rumbo_plant::contact::Pose;
use rumbo_plant::rig::Mount;
use rumbo_plant::world::World;

const FIELD_RAD: f64 = 25.0 / 180.0 * std::f64::consts::PI;
const SLICES: u8 = 5;
/// Its reach at the default limit of what comes back, in millions of counts a second, where that fills the field.
const REACH_M: f64 = 1.2;
const LIMIT: f64 = 0.25;
/// Nothing further away gives a count \[m\].
const FARTHEST_M: f64 = 8.0;
/// Nearer than that no more light comes back \[m\].
const NEAREST_M: f64 = 0.01;

/// Where a robot's sensors look from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Eyes {
    pub(crate) pose: Pose,
    /// Where its servo points: 0 ahead, positive to the left.
    pub(crate) servo_rad: f64,
}

/// What the sensor sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sight {
    /// Mean distance, each with the light that comes back from there \[m\].
    pub(crate) range_m: f64,
    /// Millions of counts a second; 0 where nothing is.
    pub(crate) rate: f64,
}

impl Sight {
    /// What a sensor sees that is mounted so.
    pub(crate) fn of(world: &World, eyes: &Eyes, mount: &Mount, now_us: u64) -> Self {
        let servo_rad = if mount.on_servo { eyes.servo_rad } else { 0.0 };
        let (at_m, angle_rad) = ([mount.x_m, mount.y_m], mount.angle_rad + servo_rad);
        let slice_rad = FIELD_RAD / f64::from(SLICES);
        let (mut weights, mut sum) = (0.0, 0.0);
        for slice in 0..SLICES {
            let off_rad = (f64::from(slice) + 0.5) * slice_rad - 0.5 * FIELD_RAD;
            let cone = cone_at(&eyes.pose, at_m, angle_rad + off_rad, 0.5 * slice_rad);
            let found = cone::nearest(world, now_us, &cone, &Hearing::geometric(FARTHEST_M));
            let Some(found) = found else { continue };
            let range_m = found.range_m.max(NEAREST_M);
            let weight = 1.0 / (range_m * range_m);
            weights += weight;
            sum += weight * range_m;
        }
        if weights == 0.0 {
            return Self::default();
        }
        Self {
            range_m: sum / weights,
            rate: LIMIT * REACH_M * REACH_M * weights / f64::from(SLICES),
        }
    }
}
