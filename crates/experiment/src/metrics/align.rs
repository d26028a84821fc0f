//! Metrics of approaching a wall, square to it: the perpendicular distance from the middle of the forward sonars to the
//! nearest obstacle, and the angle between the robot's heading and the direction to it.
//!
//! The distance is that of the true pose in the world, times the run's scale of the speed of sound: the robot cannot
//! know that scale.

use super::Metrics;
use super::step::{DISTANCE_BAND, STEADY_SHARE, sound_scale, steps};
use crate::files::Setup;
use rumbo_plant::world::World;
use rumbo_sim::Sim;
use rumbo_sim::trace::{Trace, TruthSample};

/// Band of a step of the distance, beside the one that is a share of the step [m].
const BAND_M: f64 = 0.02;
/// Step with which the direction to the nearest point is found [m].
const PROBE_M: f64 = 1e-6;

/// The nearest obstacle, from the middle of the forward sonars.
struct Ahead {
    world: World,
    ahead_m: f64,
    scale: f64,
}

impl Ahead {
    fn new(setup: &Setup, sim: &Sim) -> Option<Self> {
        Some(Self {
            world: setup.world.world().ok()?,
            ahead_m: setup.rig.front.or(setup.rig.left)?.x_m,
            scale: sound_scale(sim),
        })
    }

    fn middle(&self, sample: &TruthSample) -> [f64; 2] {
        let (sin, cos) = sample.heading_rad.sin_cos();
        [
            sample.x_m + cos * self.ahead_m,
            sample.y_m + sin * self.ahead_m,
        ]
    }

    fn distance_from_m(&self, point: [f64; 2]) -> f64 {
        let obstacles = self.world.obstacles().iter();
        obstacles
            .map(|obstacle| obstacle.distance_m(point))
            .fold(f64::INFINITY, f64::min)
    }

    fn distance_m(&self, sample: &TruthSample) -> f64 {
        self.distance_from_m(self.middle(sample)) * self.scale
    }

    /// Direction to the nearest point, from straight ahead.
    fn angle_rad(&self, sample: &TruthSample) -> f64 {
        let [x, y] = self.middle(sample);
        let away_x =
            self.distance_from_m([x + PROBE_M, y]) - self.distance_from_m([x - PROBE_M, y]);
        let away_y =
            self.distance_from_m([x, y + PROBE_M]) - self.distance_from_m([x, y - PROBE_M]);
        let (sin, cos) = sample.heading_rad.sin_cos();
        (sin * away_x - cos * away_y).atan2(-cos * away_x - sin * away_y)
    }
}

/// Steps of the distance, and how square to the wall the robot stands after each.
pub(super) fn aligning(setup: &Setup, sim: &Sim, trace: &Trace, metrics: &mut Metrics) {
    let Some(ahead) = Ahead::new(setup, sim) else {
        return;
    };
    let steps = steps(&setup.scenario.commands, setup.scenario.duration_s);
    for (index, step) in steps.iter().enumerate() {
        let samples = trace.between(step.from_s, step.until_s);
        let Some(first) = samples.first() else {
            continue;
        };
        let [reference, _] = step.reference;
        let band = DISTANCE_BAND * (reference - ahead.distance_m(first)).abs();
        let respond = |band| step.response(trace, 0, band, |sample| ahead.distance_m(sample));
        let (Some(response), Some(within)) = (respond(band), respond(BAND_M)) else {
            continue;
        };
        let steady = &samples[(samples.len() as f64 * (1.0 - STEADY_SHARE)) as usize..];
        let angle_rad = steady
            .iter()
            .map(|sample| ahead.angle_rad(sample).abs())
            .fold(0.0, f64::max);
        let mut put =
            |name: &str, value| metrics.insert(format!("step{}.{name}", index + 1), value);
        put("settling_s", response.settling_s);
        put("within_2cm_s", within.settling_s);
        put("overshoot_m", response.overshoot);
        put("steady_error_m", response.resting_error());
        put("angle_rad", angle_rad);
        put("rms_m", response.rms);
        put("ripple_m", response.ripple);
    }
}
