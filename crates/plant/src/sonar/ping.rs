//! Pings of other robots, as a sonar receives them.
//!
//! A burst comes on the straight way, where two sonars look at each other: it is far stronger than an echo, and always ends
//! the pulse. Or, as among the sonars of one robot, now and then by way of what the other's echo comes from.

use libm::{cos, hypot, sincos, sqrt};

use super::{Burst, Line, Sonar, SonarId, State, View, micros};
use crate::cone;
use crate::outline::{Point, add, dot, scale, sub};
use crate::world::World;

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
    /// A ping of another robot could end its pulse.
    pub(crate) fn listens(&self) -> bool {
        self.line != Line::Low
    }

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

/// A ping on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InAir {
    pub(crate) ping: Ping,
    /// The direction in which its sonar looked.
    ahead: Point,
    /// Where its echo came from.
    echo_at: Option<Point>,
}

impl InAir {
    pub(crate) fn new(ping: &Ping) -> Self {
        let ahead = ahead(ping.axis_rad);
        let echo_at = |range_m| add(ping.at, scale(ahead, range_m));
        Self {
            ping: *ping,
            ahead,
            echo_at: ping.range_m.map(echo_at),
        }
    }
}

impl Sonar {
    /// Lets pings of other robots end the pulse of a sonar where they arrive first: on the straight way, where the two
    /// look at each other, or by way of what the other's echo comes from. What moves is not in their way.
    pub(crate) fn overhear_pings<'a>(
        &self,
        state: &mut State,
        id: SonarId,
        now_us: u64,
        world: &World,
        view: &View,
        pings: impl Iterator<Item = &'a InAir>,
    ) {
        let (own_ahead, edge) = (ahead(view.axis_rad), cos(self.params.beam_half_angle_rad));
        let looks_at = |from: Point, ahead: Point, to: Point| {
            let way = sub(to, from);
            dot(way, ahead) >= sqrt(dot(way, way)) * edge
        };
        let away_m = |point: Point| hypot(point[0] - view.at[0], point[1] - view.at[1]);
        let faces = |point: Point| looks_at(view.at, own_ahead, point);
        for InAir {
            ping,
            ahead,
            echo_at,
        } in pings
        {
            let (listens_us, fall_us) = match state.line {
                Line::Low => return,
                Line::Rising { rise_us, fall_us } => (rise_us, fall_us),
                Line::High { fall_us } => (now_us, fall_us),
            };
            let (speaker, echo_at) = (faces(ping.at), echo_at.filter(|point| faces(*point)));
            // Few are left: the sonar looks at little of the world.
            if !speaker && echo_at.is_none() {
                continue;
            }
            let direct = speaker
                && looks_at(ping.at, *ahead, view.at)
                && cone::is_clear(world, view.at, ping.at);
            let received = |point: Point| {
                let alike = cos(ping.axis_rad - view.axis_rad).max(0.0);
                let key = (state.pings << 32) ^ ping.number ^ (u64::from(ping.speaker) << 56);
                cone::is_clear(world, view.at, point)
                    && self
                        .draw(id.index(), 9)
                        .chance(key, self.params.crosstalk * alike)
            };
            let way_m = match (direct, echo_at, ping.range_m) {
                (true, ..) => away_m(ping.at),
                (false, Some(point), Some(range_m)) if received(point) => range_m + away_m(point),
                _ => continue,
            };
            let at_us = ping.rise_us + micros(way_m / self.sound_m_s);
            if at_us <= listens_us || at_us >= fall_us {
                continue;
            }
            match &mut state.line {
                Line::Low => {}
                Line::Rising { fall_us, .. } | Line::High { fall_us } => *fall_us = at_us,
            }
        }
    }
}

/// The unit vector in this direction.
fn ahead(axis_rad: f64) -> Point {
    let (s, c) = sincos(axis_rad);
    [c, s]
}
