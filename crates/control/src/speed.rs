//! Wheel speed from the edges of one Hall sensor. Derivation: docs/theory/wheel_speed.md.
//!
//! Two measurements are fused. The time of the last eight edges, one turn of the motor, is free of the disc's uneven
//! poles, but lags by half a motor turn. The edges of the last tick over their time (M/T method) are fresh, but carry
//! the poles' error. A difference that the poles can explain is attributed to them: the first counts; beyond that it is
//! a real change, and the second counts. When edges stop coming, the speed is bounded by one edge over the time since.
//!
//! What neither poles nor motors can explain is reported too: missing or spurious edges.

use crate::math::{from_u32, max, min, round};
use crate::types::{Edges, Micros, TICK_S};

/// Wheel angle of one edge [rad]: 8 edges per motor turn, 48 motor turns per wheel turn.
pub const EDGE_RAD: f32 = core::f32::consts::TAU / (8.0 * 48.0);
/// The same, for division by a time in microseconds [rad us/s].
const EDGE: f32 = EDGE_RAD * 1e6;
/// Edges of one motor turn.
const EDGES_PER_TURN: u16 = 8;
/// A gap between edges is at most this much wider than the mean: poles +-5 % each, doubled for both ends and for safety.
const UNEVENNESS: f32 = 0.12;
/// Largest lag of a motor turn's mean behind an accelerating wheel, relative.
const LAG: f32 = 0.02;
/// A tick's edges are checked while a motor turn takes less than this [us], above 3.3 rad/s: a slower wheel may change
/// its speed considerably in one turn.
const BRISK_US: u32 = 40_000;
/// A wheel slows down by at most this [rad/s^2]: twice the steepest of sound robots in all scenarios, 28 rad/s^2.
const STEEPEST_RAD_S2: f32 = 60.0;
/// A turning wheel speeds up by less than this in a tick [rad/s]: none did by 1.5 in 12 million ticks of sound robots, on
/// ice and with 5 kg too; with poles displaced by up to 22 % of their pitch, 38 of 2 million seemed to, and none by 2.
const STEEPEST_RISE_RAD_S: f32 = 2.0;
/// The first overdue edge may be late: it comes a gap after the last one, and poles are uneven.
const LATE_EDGES: f32 = 1.0 + 2.0 * UNEVENNESS;
/// Without an edge for this long the wheel counts as standing [us]: it turns below 4 rpm.
const STANDING_US: u32 = 40_000;

/// State of one wheel's estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedEstimator {
    count: u16,
    last: Micros,
    /// Edges since the wheel last stood, at most [`EDGES_PER_TURN`] + 1: before that, `turn_us` spans the standing.
    run: u16,
    standing: bool,
    started: bool,
    speed_rad_s: f32,
    /// Speed when the last edge came [rad/s].
    last_rad_s: f32,
    /// As in [`WheelMotion`] [rad/s].
    believed_rad_s: f32,
    /// Speed by the motor turn before the last edge [rad/s]; 0 after a standstill.
    turn_rad_s: f32,
    /// Edges were overdue at the last tick.
    owes: bool,
}

/// Whether the edges of a tick are those of a turning disc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Evenness {
    /// None came, or the wheel is too slow or has turned too little to say.
    #[default]
    Unknown,
    /// They came as the motor's last turn predicts.
    Even,
    /// Edges are missing or spurious.
    Uneven,
}

/// A wheel's motion measured from its edges, without sign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelMotion {
    /// Speed [rad/s], 0 or more.
    pub speed_rad_s: f32,
    /// The same for a speed loop, 0 or more: it falls no faster than a wheel can, and not while edges are overdue,
    /// since a wheel must not be driven harder because of lost edges [rad/s].
    pub believed_rad_s: f32,
    /// Edges since the last tick.
    pub edges: u16,
    /// No edge for long enough that the wheel may be driven the other way.
    pub standing: bool,
    /// Whether these edges are those of a turning disc.
    pub evenness: Evenness,
    /// Number of overdue edges, even at the steepest deceleration.
    pub overdue: u8,
}

impl SpeedEstimator {
    /// One tick.
    pub fn step(&mut self, edges: &Edges, now: Micros) -> WheelMotion {
        if !self.started {
            *self = Self {
                count: edges.count,
                last: edges.last,
                standing: true,
                started: true,
                ..Self::default()
            };
        }
        let new = edges.count.wrapping_sub(self.count);
        let (mut evenness, mut overdue) = (Evenness::Unknown, 0);
        if new > 0 {
            let (turning, before_rad_s) = (self.run > EDGES_PER_TURN, self.speed_rad_s);
            evenness = self.ingest(new, edges);
            self.last_rad_s = self.speed_rad_s;
            // What comes after all, or as if the wheel had jumped: those before it are missing, or it is noise.
            if turning && (self.owes || self.speed_rad_s - before_rad_s > STEEPEST_RISE_RAD_S) {
                evenness = Evenness::Uneven;
            }
        } else if !self.standing {
            overdue = self.overdue(now);
            let silent_us = now.since(edges.last);
            if silent_us >= STANDING_US {
                self.standing = true;
                self.run = 0;
                self.turn_rad_s = 0.0;
                self.speed_rad_s = 0.0;
            } else {
                const WIDEST_GAP: f32 = EDGE * (1.0 + UNEVENNESS);
                self.speed_rad_s = min(
                    self.speed_rad_s,
                    WIDEST_GAP / max(from_u32(silent_us), 1_000.0),
                );
            }
        }
        self.owes = overdue > 0;
        // From rest the first edges carry little information.
        if self.run <= EDGES_PER_TURN {
            self.believed_rad_s = self.speed_rad_s;
        } else if overdue == 0 {
            const SLOWER_RAD_S: f32 = STEEPEST_RAD_S2 * TICK_S;
            self.believed_rad_s = max(self.speed_rad_s, self.believed_rad_s - SLOWER_RAD_S);
        }
        WheelMotion {
            speed_rad_s: self.speed_rad_s,
            believed_rad_s: self.believed_rad_s,
            edges: new,
            standing: self.standing,
            evenness,
            overdue,
        }
    }

    /// Number of edges that should have come since the last one, but have not.
    fn overdue(&self, now: Micros) -> u8 {
        if self.run <= EDGES_PER_TURN {
            return 0;
        }
        // Below 40 ms, else the wheel stands.
        let silent_s = 1e-6 * from_u32(now.since(self.last));
        let slowing_s = min(silent_s, self.last_rad_s * (1.0 / STEEPEST_RAD_S2));
        let least_rad = (self.last_rad_s - 0.5 * STEEPEST_RAD_S2 * slowing_s) * slowing_s;
        let edges = least_rad * (1.0 / EDGE_RAD) - LATE_EDGES;
        u8::try_from(round(max(edges, 0.0))).unwrap_or(u8::MAX)
    }

    /// Ingests new edges; returns whether they are even.
    fn ingest(&mut self, new: u16, edges: &Edges) -> Evenness {
        let span_us = edges.last.since(self.last);
        let fresh = if self.standing || span_us == 0 {
            // From rest the time of the first gap is unknown; the tick bounds it.
            f32::from(new) * (EDGE_RAD / TICK_S)
        } else {
            f32::from(new) * EDGE / from_u32(span_us)
        };
        self.run = core::cmp::min(self.run.saturating_add(new), EDGES_PER_TURN + 1);
        let whole_turn = self.run > EDGES_PER_TURN && edges.turn_us > 0;
        let mut evenness = Evenness::Unknown;
        self.speed_rad_s = if whole_turn {
            const TURN: f32 = EDGES_PER_TURN as f32 * EDGE;
            let turn = TURN / from_u32(edges.turn_us);
            // A lost edge lengthens the turn by an eighth: no wheel slows down like that.
            let slower_rad_s = self.turn_rad_s - turn;
            let brakes_rad_s = 1e-6 * STEEPEST_RAD_S2 * from_u32(span_us);
            evenness = if self.turn_rad_s > 0.0 && slower_rad_s > brakes_rad_s {
                Evenness::Uneven
            } else {
                evenness_of(new, span_us, edges.turn_us)
            };
            self.turn_rad_s = turn;
            fuse(turn, fresh, new)
        } else {
            fresh
        };
        self.count = edges.count;
        self.last = edges.last;
        self.standing = false;
        evenness
    }
}

/// Speed of a turning wheel from the mean of the last motor turn and that of the newest edges [rad/s], so many of them.
#[must_use]
pub fn fuse(turn_rad_s: f32, fresh_rad_s: f32, new: u16) -> f32 {
    let explained_rad_s = turn_rad_s * explained(new);
    if fresh_rad_s > turn_rad_s + explained_rad_s {
        fresh_rad_s - explained_rad_s
    } else if fresh_rad_s < turn_rad_s - explained_rad_s {
        fresh_rad_s + explained_rad_s
    } else {
        turn_rad_s
    }
}

/// Uneven is a number of edges in this time that is half an edge off the prediction from the motor's last turn.
///
/// A disc whose pulses are longer than its pauses shifts an odd number of edges, so those may be off by three quarters.
fn evenness_of(new: u16, span_us: u32, turn_us: u32) -> Evenness {
    if turn_us >= BRISK_US {
        return Evenness::Unknown;
    }
    // All below 65 ms, else the wheel has stood.
    let edge_us = (turn_us / u32::from(EDGES_PER_TURN)) as u16;
    let off_us = (span_us as u16).abs_diff(new.wrapping_mul(edge_us));
    let half_us = edge_us / 2;
    let allowed_us = if new.is_multiple_of(2) {
        half_us
    } else {
        half_us + half_us / 2
    };
    if off_us > allowed_us {
        Evenness::Uneven
    } else {
        Evenness::Even
    }
}

/// The part of the difference of both measurements that uneven poles and the lag of a turn's mean explain, relative,
/// with this many new edges.
fn explained(new: u16) -> f32 {
    /// For few edges without a division.
    const OF_FEW: [f32; 9] = {
        let mut table = [0.0; 9];
        let mut new = 1;
        while new < table.len() {
            table[new] = UNEVENNESS / new as f32 + LAG;
            new += 1;
        }
        table
    };
    match OF_FEW.get(usize::from(new)) {
        Some(explained) => *explained,
        None => UNEVENNESS / f32::from(new) + LAG,
    }
}

#[cfg(test)]
mod tests;
