//! Pings of other robots, as a sonar receives them.
//!
//! A burst comes on the straight way, where two sonars look at each other: it is far stronger than an echo, and always ends
//! the pulse. Or, as among the sonars of one robot, now and then by way of what the other's echo comes from.

use libm::{cos, hypot, sin, sqrt};

use super::{Burst, Line, Sonar, SonarId, State, View, micros};
use crate::cone;
use crate::world::{World, dot, sub};

/// A ping of a sonar, as those of other robots receive it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ping {
    /// A number for its sonar, other than those of all others.
    pub speaker: u32,
    /// Which ping of that sonar.
    pub number: u64,
    /// When the burst left.
    pub rise_us: u64,
    /// From where.
    pub at: [f64; 2],
    /// Where the sonar looked.
    pub axis_rad: f64,
    /// How far away its echo was; `None` without one.
    pub range_m: Option<f64>,
}

impl State {
    /// Pings so far.
    #[must_use]
    pub const fn pings(&self) -> u64 {
        self.pings
    }

    /// The last ping, from a sonar with this number.
    #[must_use]
    pub fn last_ping(&self, speaker: u32) -> Ping {
        let Burst {
            axis_rad,
            at,
            rise_us,
            range_m,
            ..
        } = self.burst;
        Ping {
            speaker,
            number: self.pings,
            rise_us,
            at,
            axis_rad,
            range_m,
        }
    }
}

impl Sonar {
    /// Lets the ping of another robot end the pulse of a sonar if it arrives first: on the straight way, where the two
    /// look at each other, or by way of what the other's echo comes from. What moves is not in its way.
    pub fn overhear_ping(
        &self,
        state: &mut State,
        id: SonarId,
        now_us: u64,
        world: &World,
        view: &View,
        ping: &Ping,
    ) {
        let (listens_us, fall_us) = match state.line {
            Line::Low => return,
            Line::Rising { rise_us, fall_us } => (rise_us, fall_us),
            Line::High { fall_us } => (now_us, fall_us),
        };
        let looks_at = |from: [f64; 2], axis_rad: f64, to: [f64; 2]| {
            let way = sub(to, from);
            let ahead = dot(way, [cos(axis_rad), sin(axis_rad)]);
            ahead >= sqrt(dot(way, way)) * cos(self.params.beam_half_angle_rad)
        };
        let seen = |point: [f64; 2]| {
            looks_at(view.at, view.axis_rad, point) && cone::is_clear(world, view.at, point)
        };
        let away_m = |point: [f64; 2]| hypot(point[0] - view.at[0], point[1] - view.at[1]);
        let direct = looks_at(ping.at, ping.axis_rad, view.at) && seen(ping.at);
        let by_echo = ping.range_m.and_then(|range_m| {
            let (x, y) = (cos(ping.axis_rad), sin(ping.axis_rad));
            let point = [ping.at[0] + range_m * x, ping.at[1] + range_m * y];
            let alike = cos(ping.axis_rad - view.axis_rad).max(0.0);
            let key = (state.pings << 32) ^ ping.number ^ (u64::from(ping.speaker) << 56);
            let received = seen(point)
                && self
                    .draw(id.index(), 9)
                    .chance(key, self.params.crosstalk * alike);
            received.then(|| range_m + away_m(point))
        });
        let way_m = if direct {
            Some(away_m(ping.at))
        } else {
            by_echo
        };
        let Some(way_m) = way_m else {
            return;
        };
        let at_us = ping.rise_us + micros(way_m / self.sound_m_s);
        if at_us <= listens_us || at_us >= fall_us {
            return;
        }
        match &mut state.line {
            Line::Low => {}
            Line::Rising { fall_us, .. } | Line::High { fall_us } => *fall_us = at_us,
        }
    }
}
