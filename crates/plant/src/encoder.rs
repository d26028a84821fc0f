//! Hall sensor on the motor shaft: which edges a motion passes, and when exactly.
//!
//! The poles of the disc are unevenly spaced, one pattern per wheel and seed. Edge `n` is the n-th boundary from angle
//! zero; the level is high after an even number of them. A boundary passed forward and back again gives two edges.

use crate::noise::{Noise, source};
use crate::params::Params;

const TURN_RAD: f64 = 2.0 * std::f64::consts::PI;

/// The disc of one wheel's motor.
#[derive(Clone, Debug)]
pub struct Encoder {
    /// Boundaries within one motor turn, as angles of the wheel, ascending; at least one.
    boundaries_rad: Box<[f64]>,
    motor_turn_rad: f64,
}

/// Where the sensor is on the disc: between two boundaries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// Boundaries passed forward minus those passed backward.
    pub count: i64,
    pub(crate) below_rad: f64,
    pub(crate) above_rad: f64,
}

/// One edge of the sensor's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// When, as a fraction 0 to 1 of the motion.
    pub fraction: f64,
    /// Level after the edge.
    pub level: bool,
}

impl Encoder {
    /// The disc of wheel `index` (0 left, 1 right).
    #[must_use]
    pub fn new(params: &Params, noise: &Noise, index: u32) -> Self {
        // A whole number from 1 on by the parameter's limits.
        let edges = (params.encoder.edges_per_motor_turn as usize).max(1);
        let motor_turn_rad = TURN_RAD / params.motor.gear_ratio;
        let pitch_rad = motor_turn_rad / edges as f64;
        let boundary_rad = |i: usize| {
            let shift = params.encoder.spacing_error
                * (noise.uniform(source::ENCODER + index, i as u64) - 0.5);
            pitch_rad * (i as f64 + 0.5 + shift)
        };
        Self {
            boundaries_rad: (0..edges).map(boundary_rad).collect(),
            motor_turn_rad,
        }
    }

    /// The sensor at this wheel angle, its count at zero.
    #[must_use]
    pub fn start(&self, angle_rad: f64) -> State {
        let mut index =
            libm::floor(angle_rad / self.motor_turn_rad) as i64 * self.boundaries_rad.len() as i64;
        while self.boundary_rad(index) <= angle_rad {
            index += 1;
        }
        State {
            count: index,
            below_rad: self.boundary_rad(index - 1),
            above_rad: self.boundary_rad(index),
        }
    }

    /// Level of the output.
    #[must_use]
    pub fn level(&self, state: &State) -> bool {
        state.count % 2 == 0
    }

    /// Moves the wheel from one angle to another at constant speed and reports the edges in the order of time. In most steps
    /// there is none: a call would cost more than that.
    #[inline(always)]
    pub fn turn(&self, state: &mut State, from_rad: f64, to_rad: f64, mut each: impl FnMut(Edge)) {
        while to_rad >= state.above_rad {
            let fraction = (state.above_rad - from_rad) / (to_rad - from_rad);
            let level = self.pass(state, true);
            each(Edge { fraction, level });
        }
        while to_rad < state.below_rad {
            let fraction = (state.below_rad - from_rad) / (to_rad - from_rad);
            let level = self.pass(state, false);
            each(Edge { fraction, level });
        }
    }

    /// Passes the next boundary in a direction; the level after it.
    pub(crate) fn pass(&self, state: &mut State, forward: bool) -> bool {
        if forward {
            state.count += 1;
            state.below_rad = state.above_rad;
            state.above_rad = self.boundary_rad(state.count);
        } else {
            state.count -= 1;
            state.above_rad = state.below_rad;
            state.below_rad = self.boundary_rad(state.count - 1);
        }
        self.level(state)
    }

    fn boundary_rad(&self, index: i64) -> f64 {
        let edges = self.boundaries_rad.len() as i64;
        let turn = index.div_euclid(edges) as f64;
        turn * self.motor_turn_rad + self.boundaries_rad[index.rem_euclid(edges) as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nominal() -> Encoder {
        Encoder::new(&Params::default(), &Noise::new(1, 0), 0)
    }

    #[test]
    fn a_wheel_turn_gives_384_edges_alternating_in_level() {
        let encoder = nominal();
        let mut state = encoder.start(0.3);
        let (mut edges, mut level) = (0, encoder.level(&state));
        for i in 0..1000 {
            let at = |i: i32| 0.3 + TURN_RAD * f64::from(i) / 1000.0;
            encoder.turn(&mut state, at(i), at(i + 1), |edge| {
                assert_ne!(edge.level, level);
                assert!((0.0..=1.0).contains(&edge.fraction));
                level = edge.level;
                edges += 1;
            });
        }
        assert_eq!(edges, 384);
    }

    #[test]
    fn turning_back_passes_the_same_boundaries_at_the_same_places() {
        let encoder = nominal();
        let mut state = encoder.start(-0.05);
        let (mut there, mut back) = (Vec::new(), Vec::new());
        encoder.turn(&mut state, -0.05, 0.15, |edge| there.push(edge.fraction));
        encoder.turn(&mut state, 0.15, -0.05, |edge| {
            back.push(1.0 - edge.fraction)
        });
        back.reverse();
        assert_eq!(there.len(), back.len());
        assert!(there.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-9));
        assert_eq!(state, encoder.start(-0.05));
    }

    #[test]
    fn the_poles_are_uneven_within_5_percent_and_repeat_each_motor_turn() {
        let encoder = nominal();
        let mut state = encoder.start(0.0);
        let mut places = Vec::new();
        encoder.turn(&mut state, 0.0, 2.0 * encoder.motor_turn_rad, |edge| {
            places.push(edge.fraction * 16.0)
        });
        let gaps: Vec<f64> = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(
            gaps.iter().all(|gap| (0.95..1.05).contains(gap)),
            "{gaps:?}"
        );
        assert!(gaps.iter().any(|gap| (gap - 1.0).abs() > 0.01));
        assert!((0..7).all(|i| (gaps[i] - gaps[i + 8]).abs() < 1e-9));
    }
}
