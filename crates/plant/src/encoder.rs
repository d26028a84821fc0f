//! Hall sensor on the motor shaft: which edges a motion passes, and when exactly.
//!
//! The poles of the disc are unevenly spaced, one pattern per wheel and seed. Edge `n` is the n-th boundary from angle
//! zero; the level is high after an even number of them. A boundary passed forward and back again gives two edges.
//!
//! A second sensor sits half way between two boundaries: its output B tells the direction. Turning forward B is high when A
//! rises. Then every second boundary is B's.

use crate::noise::{Noise, source};
use crate::params::Params;

const TURN_RAD: f64 = 2.0 * std::f64::consts::PI;

/// Which of the two outputs of an encoder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Channel {
    /// The only one of most.
    A,
    /// The one that tells the direction.
    B,
}

/// The disc of one wheel.
#[derive(Clone, Debug)]
pub struct Encoder {
    /// Boundaries within one turn of the disc, as angles of the wheel, ascending; at least one.
    boundaries_rad: Box<[f64]>,
    disc_turn_rad: f64,
    has_second: bool,
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
    /// Of which output.
    pub channel: Channel,
    /// Level after the edge.
    pub level: bool,
}

impl Encoder {
    /// The disc of wheel `index` (0 left, 1 right).
    #[must_use]
    pub fn new(params: &Params, noise: &Noise, index: u32) -> Self {
        // Whole numbers by the parameters' limits.
        let (edges, disc_turn_rad) = match params.encoder.slots as usize {
            0 => (
                (params.encoder.edges_per_motor_turn as usize).max(1),
                TURN_RAD / params.motor.gear_ratio,
            ),
            slots => (2 * slots, TURN_RAD),
        };
        let pitch_rad = disc_turn_rad / edges as f64;
        let boundary_rad = |i: usize| {
            let shift = params.encoder.spacing_error
                * (noise.uniform(source::ENCODER + index, i as u64) - 0.5);
            pitch_rad * (i as f64 + 0.5 + shift)
        };
        Self {
            boundaries_rad: (0..edges).map(boundary_rad).collect(),
            disc_turn_rad,
            has_second: false,
        }
    }

    /// The same with the output B.
    #[must_use]
    pub(crate) fn with_second(self) -> Self {
        let own = self.boundaries_rad.iter();
        let first = self.boundaries_rad[0] + self.disc_turn_rad;
        let next = self.boundaries_rad.iter().skip(1).chain([&first]);
        let both = own
            .zip(next)
            .flat_map(|(own, next)| [*own, 0.5 * (own + next)]);
        Self {
            boundaries_rad: both.collect(),
            has_second: true,
            ..self
        }
    }

    /// The sensor at this wheel angle, its count at zero.
    #[must_use]
    pub fn start(&self, angle_rad: f64) -> State {
        let mut index =
            libm::floor(angle_rad / self.disc_turn_rad) as i64 * self.boundaries_rad.len() as i64;
        while self.boundary_rad(index) <= angle_rad {
            index += 1;
        }
        State {
            count: index,
            below_rad: self.boundary_rad(index - 1),
            above_rad: self.boundary_rad(index),
        }
    }

    /// Level of an output; B is low where there is none.
    #[must_use]
    pub fn level(&self, state: &State, channel: Channel) -> bool {
        match (self.has_second, channel) {
            (false, Channel::A) => state.count % 2 == 0,
            (false, Channel::B) => false,
            (true, Channel::A) => (state.count + 1).div_euclid(2) % 2 == 0,
            (true, Channel::B) => state.count.div_euclid(2) % 2 != 0,
        }
    }

    /// Moves the wheel from one angle to another at constant speed and reports the edges in the order of time. In most steps
    /// there is none: a call would cost more than that.
    #[inline(always)]
    pub fn turn(&self, state: &mut State, from_rad: f64, to_rad: f64, mut each: impl FnMut(Edge)) {
        while to_rad >= state.above_rad {
            let fraction = (state.above_rad - from_rad) / (to_rad - from_rad);
            let (channel, level) = self.pass(state, true);
            each(Edge {
                fraction,
                channel,
                level,
            });
        }
        while to_rad < state.below_rad {
            let fraction = (state.below_rad - from_rad) / (to_rad - from_rad);
            let (channel, level) = self.pass(state, false);
            each(Edge {
                fraction,
                channel,
                level,
            });
        }
    }

    /// Passes the next boundary in a direction; whose it is, and the level after it.
    pub(crate) fn pass(&self, state: &mut State, forward: bool) -> (Channel, bool) {
        let passed = state.count - i64::from(!forward);
        let channel = match self.has_second && passed % 2 != 0 {
            true => Channel::B,
            false => Channel::A,
        };
        if forward {
            state.count += 1;
            state.below_rad = state.above_rad;
            state.above_rad = self.boundary_rad(state.count);
        } else {
            state.count -= 1;
            state.above_rad = state.below_rad;
            state.below_rad = self.boundary_rad(state.count - 1);
        }
        (channel, self.level(state, channel))
    }

    fn boundary_rad(&self, index: i64) -> f64 {
        let edges = self.boundaries_rad.len() as i64;
        let turn = index.div_euclid(edges) as f64;
        turn * self.disc_turn_rad + self.boundaries_rad[index.rem_euclid(edges) as usize]
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
        let (mut edges, mut level) = (0, encoder.level(&state, Channel::A));
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
        encoder.turn(&mut state, 0.0, 2.0 * encoder.disc_turn_rad, |edge| {
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

    #[test]
    fn a_disc_of_twenty_slots_gives_forty_edges_a_turn() {
        let mut params = Params::default();
        params.encoder.slots = 20.0;
        let encoder = Encoder::new(&params, &Noise::new(1, 0), 0);
        let mut state = encoder.start(0.0);
        let mut edges = 0;
        encoder.turn(&mut state, 0.0, TURN_RAD, |_| edges += 1);
        assert_eq!(edges, 40);
    }

    #[test]
    fn the_second_output_tells_the_direction_and_leaves_the_first_where_it_was() {
        let (one, two) = (nominal(), nominal().with_second());
        // What the usual interrupt on a rising A counts.
        let counted = |from_rad: f64, to_rad: f64| {
            let mut state = two.start(from_rad);
            let mut levels = [Channel::A, Channel::B].map(|channel| two.level(&state, channel));
            let (mut count, mut of_a) = (0, Vec::new());
            two.turn(&mut state, from_rad, to_rad, |edge| {
                let level = &mut levels[edge.channel as usize];
                assert_ne!(*level, edge.level);
                *level = edge.level;
                if edge.channel == Channel::A {
                    of_a.push(edge);
                    if edge.level {
                        count += if levels[1] { 1 } else { -1 };
                    }
                }
            });
            (count, of_a)
        };
        let (forward, edges) = counted(-TURN_RAD, TURN_RAD);
        assert_eq!(forward, 384);
        assert_eq!(counted(TURN_RAD, -TURN_RAD).0, -384);
        let mut alone = Vec::new();
        one.turn(&mut one.start(-TURN_RAD), -TURN_RAD, TURN_RAD, |edge| {
            alone.push(edge.fraction)
        });
        assert!(edges.iter().map(|edge| edge.fraction).eq(alone));
    }
}
