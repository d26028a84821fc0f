//! Metrics of following a wall: the distance from the middle of the side sonars to the nearest obstacle, and the speed
//! along it.
//!
//! The distance is that of the true pose in the world, times the run's scale of the speed of sound: the robot cannot
//! know that scale.

use super::Metrics;
use super::step::{sound_scale, steps};
use crate::files::Setup;
use rumbo_plant::world::World;
use rumbo_sim::Sim;
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::Command;

/// Time from arming in which the robot may still gather speed [s].
const START_S: f64 = 1.5;
/// Time over which the speed is averaged [s].
const WINDOW_S: f64 = 0.5;
/// Band of a step of the distance [m].
const BAND_M: f64 = 0.02;

/// Distance from the middle of the side sonars to the nearest thing in the world.
struct Beside {
    world: World,
    /// The points beside the robot at which it may be measured: ahead and left.
    points_m: Vec<[f64; 2]>,
    scale: f64,
}

impl Beside {
    fn new(setup: &Setup, sim: &Sim) -> Option<Self> {
        let (left, right) = (setup.rig.left?, setup.rig.right?);
        let points_m = if left.y_m * right.y_m < 0.0 {
            // One on each side: the wall is where it is nearer.
            vec![[left.x_m, left.y_m], [right.x_m, right.y_m]]
        } else {
            vec![[0.5 * (left.x_m + right.x_m), 0.5 * (left.y_m + right.y_m)]]
        };
        Some(Self {
            world: setup.world.world().ok()?,
            points_m,
            scale: sound_scale(sim),
        })
    }

    fn distance_m(&self, sample: &TruthSample) -> f64 {
        let (sin, cos) = sample.heading_rad.sin_cos();
        self.points_m
            .iter()
            .flat_map(|[ahead, left]| {
                let point = [
                    sample.x_m + cos * ahead - sin * left,
                    sample.y_m + sin * ahead + cos * left,
                ];
                let obstacles = self.world.obstacles().iter();
                obstacles.map(move |obstacle| obstacle.distance_m(point))
            })
            .fold(f64::INFINITY, f64::min)
            * self.scale
    }
}

/// Following a wall, held at the distance of the start or stepped by references.
pub(super) fn following(setup: &Setup, sim: &Sim, trace: &Trace, metrics: &mut Metrics) {
    let commands = &setup.scenario.commands;
    let armed = commands
        .iter()
        .find(|timed| matches!(timed.command, Command::Arm));
    let (Some(beside), Some(armed)) = (Beside::new(setup, sim), armed) else {
        return;
    };
    let samples = trace.between(armed.at_s, f64::INFINITY);
    let distances: Vec<f64> = samples.iter().map(|s| beside.distance_m(s)).collect();
    let Some(&start_m) = distances.first() else {
        return;
    };
    metrics.insert(
        "cruise_m_s".into(),
        slowest_m_s(samples, armed.at_s + START_S),
    );
    let references = steps(commands, setup.scenario.duration_s);
    if references.is_empty() {
        let errors = || distances.iter().map(|distance_m| distance_m - start_m);
        let mean_square = errors().map(|e| e * e).sum::<f64>() / distances.len() as f64;
        metrics.insert("distance_rms_m".into(), mean_square.sqrt());
        let worst_m = errors().map(f64::abs).fold(0.0, f64::max);
        metrics.insert("distance_worst_m".into(), worst_m);
    }
    for (index, step) in references.iter().enumerate() {
        let response = step.response(trace, 0, BAND_M, |sample| beside.distance_m(sample));
        let Some(response) = response else { continue };
        let mut put =
            |name: &str, value| metrics.insert(format!("step{}.{name}", index + 1), value);
        put("within_2cm_s", response.settling_s);
        put("overshoot_m", response.overshoot);
        put("steady_error_m", response.resting_error());
        put("rms_m", response.rms);
        put("ripple_m", response.ripple);
    }
}

/// The slowest way over the floor in any half second, as a speed.
fn slowest_m_s(samples: &[TruthSample], from_s: f64) -> f64 {
    let samples = &samples[samples.partition_point(|sample| sample.t_s < from_s)..];
    let mut way_m = vec![0.0];
    for two in samples.windows(2) {
        let step_m = (two[1].x_m - two[0].x_m).hypot(two[1].y_m - two[0].y_m);
        way_m.push(way_m[way_m.len() - 1] + step_m);
    }
    let window = (WINDOW_S * 1e6 / rumbo_sim::trace::SAMPLE_US as f64) as usize;
    way_m
        .windows(window + 1)
        .map(|way_m| (way_m[window] - way_m[0]) / WINDOW_S)
        .fold(f64::NAN, f64::min)
}
