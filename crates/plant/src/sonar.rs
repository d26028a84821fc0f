//! HC-SR04 rangers: from a trigger to the two edges of the echo line.
//!
//! ```text
//! trigger ──450 us──► line rises, burst leaves ──round trip──► line falls          (38 ms without an echo)
//! ```
//!
//! While the line is high, or about to rise, a trigger is ignored: a sonar without an echo blocks itself, and only
//! itself. The echo in the cone comes from [`crate::cone`]. Errors, as the recorded runs show them:
//! - *Cycles*: the receiver times a zero crossing of the 40 kHz burst. A weak echo is timed whole cycles (4.3 mm)
//!   early or late.
//! - *Jitter*: a fraction of a millimetre in every reading.
//! - *Outliers*: now and then something short of the obstacle is timed. *Losses*: no echo at all. Both are rare until
//!   the echo is weak.
//! - *Crosstalk*: an echo of another sonar that arrives while this one listens may end its pulse: the other's first
//!   echo, or its second one, obstacle - body - obstacle. With two paired sonars fired one right after the other, the
//!   second reads a few centimetres short in one of a dozen pings for that reason, and is noisier in the others.
//!
//! - *Crosstalk of other robots* ([`Ping`]): a burst that comes straight from the sonar of a robot that
//!   looks here, or now and then its echo.
//!
//! *Weakness* is the one measure of an echo that drives these: 1 in motion at about half a metre, growing with the
//! range up to about a metre, less at rest, more while another burst is in the air.

mod ping;

pub(crate) use ping::InAir;
pub use ping::Ping;

use libm::{cos, floor, pow};

use crate::cone::{self, Cone, Hearing};
use crate::noise::{Noise, source};
use crate::params;
use crate::world::World;

/// From here on a body counts as moving; below, its share of the noise in motion is proportional.
const MOVING_M_S: f64 = 0.02;

/// Which sonar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SonarId {
    /// Left, or the left one of a pair.
    Left,
    /// Right, or the right one of a pair.
    Right,
    /// In front.
    Front,
    /// One of those with names of their own, by its number.
    Other(u8),
}

impl SonarId {
    /// Most sonars with names of their own.
    pub const OTHERS: usize = 5;

    /// All of them, in the order of [`SonarId::index`].
    pub const ALL: [Self; 3 + Self::OTHERS] = [
        Self::Left,
        Self::Right,
        Self::Front,
        Self::Other(0),
        Self::Other(1),
        Self::Other(2),
        Self::Other(3),
        Self::Other(4),
    ];

    /// Index of this sonar in arrays.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::Left => 0,
            Self::Right => 1,
            Self::Front => 2,
            Self::Other(number) => 3 + number as usize,
        }
    }
}

/// The echo lines of all sonars, by [`SonarId::index`].
pub(crate) type States = [State; SonarId::ALL.len()];

/// The echo line and the burst in the air.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// The line: low, waiting to rise, or high. Times of the edges that are still to come.
    line: Line,
    /// Pings so far: the step of this sonar's noise.
    pings: u64,
    burst: Burst,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Line {
    #[default]
    Low,
    Rising {
        rise_us: u64,
        fall_us: u64,
    },
    High {
        fall_us: u64,
    },
}

/// When other sonars can receive this one's burst: its first and its second echo.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Burst {
    echo_us: [u64; 2],
    axis_rad: f64,
    /// Where and when it left, and how far away its first echo is.
    at: [f64; 2],
    rise_us: u64,
    range_m: Option<f64>,
}

/// An edge of the echo line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EchoEdge {
    /// When.
    pub at_us: u64,
    /// Level after the edge.
    pub level: bool,
}

/// A transducer at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position in the world.
    pub at: [f64; 2],
    /// Where it looks.
    pub axis_rad: f64,
    /// Its speed over the ground.
    pub speed_m_s: f64,
}

/// Rangers with these parameters; one value serves all sonars of a robot.
#[derive(Clone, Copy, Debug)]
pub struct Sonar {
    params: params::Sonar,
    sound_m_s: f64,
    cycle_m: f64,
    /// Weakness of an echo from `noise_full_m` and beyond, in motion and undisturbed, and the growth of faults there: most
    /// echoes are such ones, and powers cost much.
    far: [f64; 2],
    noise: Noise,
}

impl Sonar {
    /// Rangers with these parameters.
    #[must_use]
    pub fn new(params: &params::Sonar, noise: Noise) -> Self {
        let sound_m_s = 331.3 + 0.606 * params.temperature_c;
        let far_weakness = pow(
            params.noise_full_m / params.noise_range_m,
            params.noise_growth,
        );
        let far = [far_weakness, pow(far_weakness, params.fault_growth)];
        Self {
            params: *params,
            sound_m_s,
            cycle_m: 0.5 * sound_m_s / params.carrier_hz,
            far,
            noise,
        }
    }

    /// Range from the transducer at an instant, without any noise; infinite when nothing returns an echo.
    #[must_use]
    pub fn true_range_m(&self, world: &World, now_us: u64, view: &View) -> f64 {
        let heard_m = self.heard_m(world, now_us, view, self.params.incidence_limit_rad);
        heard_m.unwrap_or(f64::INFINITY)
    }

    fn heard_m(
        &self,
        world: &World,
        now_us: u64,
        view: &View,
        incidence_limit_rad: f64,
    ) -> Option<f64> {
        let cone = Cone {
            apex: view.at,
            axis_rad: view.axis_rad,
            half_angle_rad: self.params.beam_half_angle_rad,
        };
        let hearing = Hearing {
            reach_m: self.params.reach_m,
            incidence_limit_rad,
            corner_reach_m: self.params.corner_reach_m,
        };
        cone::nearest_m(world, now_us, &cone, &hearing)
    }

    /// Triggers sonar `id` now. False if its line is not low: the trigger is then ignored.
    pub fn trigger(
        &self,
        states: &mut [State],
        id: SonarId,
        now_us: u64,
        world: &World,
        view: &View,
    ) -> bool {
        let own = id.index();
        if states[own].line != Line::Low {
            return false;
        }
        let ping = states[own].pings;
        let limit_rad = self.params.incidence_limit_rad
            + self.params.incidence_soft_rad * self.draw(own, 0).normal(ping);
        let heard_m = self.heard_m(world, now_us, view, limit_rad);
        let rise_us = now_us + micros(self.params.trigger_to_rise_s);
        let unsteady = self.unsteadiness(view.speed_m_s)
            * self.disturbance(states, own, rise_us, view.axis_rad);
        let reading_m = heard_m.and_then(|range_m| {
            self.reading_m(own, ping, range_m, self.weakness(range_m, unsteady))
        });
        let high_us = match reading_m {
            Some(reading_m) => self.round_trip_us(reading_m),
            None => micros(self.params.timeout_high_s),
        };
        let state = &mut states[own];
        state.pings += 1;
        state.line = Line::Rising {
            rise_us,
            fall_us: rise_us + high_us,
        };
        state.burst = self.burst(own, ping, rise_us, heard_m, view);
        for other in (0..states.len()).filter(|&other| other != own) {
            self.overhear(states, own, other);
            self.overhear(states, other, own);
        }
        true
    }

    /// Passes time up to `until_us` and reports the edges of one line.
    pub fn advance(state: &mut State, until_us: u64, mut each: impl FnMut(EchoEdge)) {
        if let Line::Rising { rise_us, fall_us } = state.line
            && rise_us <= until_us
        {
            each(EchoEdge {
                at_us: rise_us,
                level: true,
            });
            state.line = Line::High { fall_us };
        }
        if let Line::High { fall_us } = state.line
            && fall_us <= until_us
        {
            each(EchoEdge {
                at_us: fall_us,
                level: false,
            });
            state.line = Line::Low;
        }
    }

    /// The reading of an echo from `range_m`; `None` if it is missed.
    fn reading_m(&self, own: usize, ping: u64, range_m: f64, weakness: f64) -> Option<f64> {
        let p = &self.params;
        let growth = if weakness == self.far[0] {
            self.far[1]
        } else {
            pow(weakness, p.fault_growth)
        };
        if self.draw(own, 1).chance(ping, p.loss_rate * growth) {
            return None;
        }
        let noisy_m = range_m
            + p.jitter_m * self.draw(own, 2).normal(ping)
            + self.cycles_m(weakness, self.draw(own, 3).normal(ping));
        let short = if self.draw(own, 4).chance(ping, p.outlier_rate * growth) {
            p.outlier_span * self.draw(own, 5).uniform(ping)
        } else {
            0.0
        };
        Some((noisy_m * (1.0 - short)).max(p.min_range_m))
    }

    /// Factor of the weakness for the sonar's motion.
    fn unsteadiness(&self, speed_m_s: f64) -> f64 {
        let rest = self.params.rest_weakness;
        rest + (1.0 - rest) * (speed_m_s / MOVING_M_S).min(1.0)
    }

    /// Factor of the weakness for bursts of other sonars, looking the same way, whose second echo is still to come.
    fn disturbance(&self, states: &[State], own: usize, rise_us: u64, axis_rad: f64) -> f64 {
        let share = |other: usize| {
            let burst = &states[other].burst;
            let pending = other != own && burst.echo_us[1] > rise_us;
            if pending {
                cos(burst.axis_rad - axis_rad).max(0.0)
            } else {
                0.0
            }
        };
        let most = (0..states.len()).map(share).fold(0.0, f64::max);
        1.0 + (self.params.disturbed_weakness - 1.0) * most
    }

    fn weakness(&self, range_m: f64, unsteady: f64) -> f64 {
        let p = &self.params;
        let growth = if range_m < p.noise_full_m {
            pow(range_m / p.noise_range_m, p.noise_growth)
        } else {
            self.far[0]
        };
        unsteady * growth
    }

    /// Error of timing a wrong cycle of the burst, for a standard normal draw.
    fn cycles_m(&self, weakness: f64, normal: f64) -> f64 {
        floor(normal * self.params.noise_m * weakness / self.cycle_m + 0.5) * self.cycle_m
    }

    /// When the echoes of a burst can reach the other sonars: 0 for never.
    fn burst(
        &self,
        own: usize,
        ping: u64,
        rise_us: u64,
        heard_m: Option<f64>,
        view: &View,
    ) -> Burst {
        let arrival_us = |range_m: f64| rise_us + self.round_trip_us(range_m);
        let second = heard_m
            .filter(|&range_m| range_m <= self.params.bounce_reach_m)
            .map(|range_m| 2.0 * range_m + self.params.bounce_behind_m)
            .filter(|&range_m| range_m <= self.params.reach_m)
            .map(|range_m| {
                range_m + self.cycles_m(self.weakness(range_m, 1.0), self.draw(own, 6).normal(ping))
            });
        Burst {
            echo_us: [heard_m, second].map(|range_m| range_m.map_or(0, arrival_us)),
            axis_rad: view.axis_rad,
            at: view.at,
            rise_us,
            range_m: heard_m,
        }
    }

    /// Lets an echo of `speaker` end the pulse of `listener` if it comes first.
    fn overhear(&self, states: &mut [State], listener: usize, speaker: usize) {
        let burst = states[speaker].burst;
        let aside_rad = burst.axis_rad - states[listener].burst.axis_rad;
        // One draw per pair of pings, whichever of them came first.
        let key = (states[listener].pings << 32) ^ states[speaker].pings;
        let (rise_us, fall_us) = match states[listener].line {
            Line::Low => return,
            Line::Rising { rise_us, fall_us } => (rise_us, fall_us),
            Line::High { fall_us } => (0, fall_us),
        };
        let chances = [self.params.crosstalk, self.params.crosstalk_bounce];
        let mut earliest_us = fall_us;
        for (index, (&at_us, chance)) in burst.echo_us.iter().zip(chances).enumerate() {
            let received = || {
                let alike = cos(aside_rad).max(0.0);
                self.draw(listener, 7 + index as u32)
                    .chance(key ^ (speaker as u64).rotate_right(2), chance * alike)
            };
            if at_us > rise_us && at_us < earliest_us && received() {
                earliest_us = at_us;
            }
        }
        match &mut states[listener].line {
            Line::Low => {}
            Line::Rising { fall_us, .. } | Line::High { fall_us } => *fall_us = earliest_us,
        }
    }

    fn round_trip_us(&self, range_m: f64) -> u64 {
        micros((2.0 * range_m / self.sound_m_s).max(0.0))
    }

    fn draw(&self, own: usize, what: u32) -> Draw<'_> {
        Draw {
            noise: &self.noise,
            source: source::SONAR + 10 * own as u32 + what,
        }
    }
}

/// One source of randomness of one sonar.
struct Draw<'a> {
    noise: &'a Noise,
    source: u32,
}

impl Draw<'_> {
    fn normal(&self, step: u64) -> f64 {
        self.noise.normal(self.source, step)
    }

    fn uniform(&self, step: u64) -> f64 {
        self.noise.uniform(self.source, step)
    }

    fn chance(&self, step: u64, probability: f64) -> bool {
        self.noise.chance(self.source, step, probability)
    }
}

/// Seconds, not negative, to the nearest microsecond.
fn micros(seconds: f64) -> u64 {
    floor(seconds * 1e6 + 0.5) as u64
}
