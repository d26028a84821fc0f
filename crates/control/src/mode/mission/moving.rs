//! What moves: ranges that fall faster than the robot comes nearer by itself, and how the robot gives way to it.
//!
//! ```text
//! looks of a sonar along one beam: each range, and how much nearer the robot's own motion may have brought it at most
//!     -> what is left is the thing's own -> it approaches, if that is more than noise and about the same in each step
//! ```
//!
//! The bound is that of the point in the cone that the sonar nears fastest: a corner that stands never exceeds it. A face
//! does whose normal lies outside the cone, as they come beside a robot that goes around an obstacle; there more is asked
//! for. A single jump is another face in the beam. Something ahead is waited for; before what comes from the side near by
//! the robot drives on, if the way is free, since it may stand in its way, or else backs off. Nobody is sure to stop for
//! the robot, and two that wait for each other do not wait for equally long.
//!
//! What only passes or recedes is seen by a robot at rest ([`super::still`]), as before each detour. Where an echo is new,
//! the robot slows down and looks there.

use super::{Drive, Mission, Phase, SWEEP_RAD, State};
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, round, sin_cos};
use crate::types::{Range, SonarReading, TICK_S};
use core::f32::consts::PI;

/// Looks along beams whose axes differ by less are of one thing [rad].
const BESIDE_RAD: f32 = 0.12;
/// From look to look the robot turns by less: in a turn on the spot other faces come into the beams [rad].
const TURNED_RAD: f32 = 0.05;
/// Half of a beam, of what its axis may have turned, and of a slanted face that still answers [rad].
const HALF_RAD: f32 = 0.55;
/// Farthest range that is judged [m].
const JUDGED_M: f32 = 1.2;
/// What noise may shorten a range by: at once, and more with the cube of the range [m].
const NOISE_M: f32 = 0.012;
const NOISE_CUBED: f32 = 0.04;
/// From look to look the range of one thing changes by less [m].
const JUMP_M: f32 = 0.08;
/// What a beam that turns over a slanted face shortens its range by [1/rad].
const SLANT: f32 = 0.6;
/// Fewest looks; the largest share of one step; and the least last step: nothing below 0.06 m/s approaches [m].
const LOOKS: u8 = 3;
const LARGEST_STEP: f32 = 0.7;
const LAST_STEP_M: f32 = 0.003_6;
/// Longest time between the first look and the last [s].
const LONG_S: f32 = 1.0;
/// A sonar is no farther from the middle of the axis [m].
const ARM_M: f32 = 0.13;
/// Shares of the noise: from here on the front sonar looks again, and the robot is slow beside an obstacle.
const LOOK_AGAIN: f32 = 0.4;
/// From here on it approaches.
const CERTAIN: f32 = 1.5;
/// From here on the robot may drive out of its way.
const SURE: f32 = 3.0;
/// A face seen by the edge of a beam nears by this share of the robot's way at most.
const FACE: f32 = 1.2;

/// Where something has approached within 20 s, anything may have gone elsewhere; within 2 s it may be gone at once; for
/// 0.3 s it is evaded. For 1 s the robot is slow beside what may approach [ticks].
const LIVELY_TICKS: u16 = 2_000;
const PASSING_TICKS: u16 = 200;
const FRESH_TICKS: u16 = 30;
const CAREFUL_TICKS: u8 = 100;
/// What moved before a robot that stood is in mind for so long [ticks].
const KNOWN_TICKS: u16 = 6_000;
/// Something new is looked at for so long, and ahead; and how fast the robot drives meanwhile [ticks, m/s].
const WONDER_TICKS: u8 = 120;
pub(super) const UNKNOWN_M_S: f32 = 0.1;
/// Shortest pause before a detour, and each of up to seven steps that the robot's place adds; the same where things move
/// [ticks].
const PAUSE_TICKS: (u8, u8) = (30, 15);
const LONG_PAUSE_TICKS: (u8, u8) = (60, 27);
/// What moves begins it anew until then, and it has an end [ticks].
const ANEW_TICKS: u16 = 400;
const MOST_TICKS: u16 = 600;
/// Speed where things move, and around an obstacle, which may be one of them [m/s].
pub(super) const WARY_M_S: f32 = 0.2;
pub(super) const BESIDE_M_S: f32 = 0.06;
/// Beyond this off the heading something is beside the robot, and beyond this abeam: what a beam sees that looks farther
/// ahead crosses the way out [rad].
const ASIDE_RAD: f32 = 1.1;
const ABEAM_RAD: f32 = 1.4;
/// There it counts within this, if it would be here so soon [m, s].
const ASIDE_M: f32 = 0.9;
const SOON_S: f32 = 2.0;
/// Shortest wait after the last approach, and each of up to seven steps that the robot's place adds [ticks].
const WAIT_TICKS: u8 = 100;
const STEP_TICKS: u8 = 15;
/// While it waits or something is new, the servo looks this far to both sides of ahead at least [rad].
const AROUND_RAD: f32 = 0.38;
/// What is nearer is evaded, by so much at most, and so fast [m, m, m/s].
const EVADE_M: f32 = 0.6;
const MOST_BACK_M: f32 = 0.5;
const BACK_M_S: f32 = 0.25;
/// Way out of the way of something beside the robot, how fast, what must be free ahead before it, and where it ends [m,
/// m/s, m, m].
const OUT_M: f32 = 0.45;
const OUT_M_S: f32 = 0.6;
const FREE_M: f32 = 0.7;
const STOP_M: f32 = 0.3;
/// No way out leads ahead where something has approached from there within this [ticks].
const AHEAD_TICKS: u8 = 150;

/// The looks of one sonar along one beam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Track {
    /// The first range, and the last one [m].
    first_m: f32,
    last_m: f32,
    /// How much nearer what it sees has come by itself, at least: in all, and in the largest step [m].
    own_m: f32,
    largest_m: f32,
    /// Time since the first look [s].
    age_s: f32,
    /// 0: nothing is followed.
    looks: u8,
    /// It may approach: more looks say whether.
    pub(super) may_approach: bool,
}

/// The robot's motion from one look of a sonar to the next, and what its beam has turned.
pub(super) struct Since {
    pub age_s: f32,
    pub rolled_m: f32,
    pub turned_rad: f32,
    pub aside_rad: f32,
}

/// Something that approaches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Approach {
    /// Where it is seen from the robot's heading at that look; positive is left [rad].
    off_rad: f32,
    /// How near [m].
    pub range_m: f32,
    /// How fast the range falls [m/s].
    speed_m_s: f32,
    /// No corner that comes into a beam explains it.
    sure: bool,
}

/// What is known of things that move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MotionMemory {
    /// The last that approached, and how long that still counts.
    last: Approach,
    lively_ticks: u16,
    /// How long it still counts that something ahead approached.
    ahead_ticks: u8,
    /// The robot gives way until nothing has approached for so long; 0: it does not.
    wait_ticks: u8,
    /// What is left of its way out ahead [m]; none where it stands or backs off.
    out_m: f32,
    /// Its way back so far [m].
    back_m: f32,
    /// For so long the robot is slow beside what may approach.
    careful_ticks: u8,
    /// For so long it is slow since something moved while it stood.
    known_ticks: u16,
    /// For so long it looks at something new, which is there [rad].
    wonder_ticks: u8,
    wonder_rad: f32,
    /// What is left of a pause before a detour, and how long it has been.
    pause_ticks: u8,
    paused_ticks: u16,
}

impl Approach {
    /// It is beside the robot.
    pub(super) fn is_aside(&self) -> bool {
        abs(self.off_rad) > ASIDE_RAD
    }

    /// It nears a robot that rolls so far in a tick faster than a slanted face does which only the edge of a beam sees.
    pub(super) fn is_faster(&self, rolled_m: f32) -> bool {
        self.sure && self.speed_m_s * TICK_S > FACE * rolled_m
    }
}

impl Track {
    /// Ingests a look; says whether something approaches.
    pub(super) fn ingest(&mut self, reading: &SonarReading, since: &Since) -> Option<Approach> {
        self.may_approach = false;
        let range_m = match reading.range {
            Range::Valid(range_m) if range_m < JUDGED_M => range_m,
            _ => {
                self.looks = 0;
                return None;
            }
        };
        let off_rad = reading.view.axis_rad;
        // Of all points in the cone, the one that the way brings nearest.
        let nearest_rad = if since.rolled_m > 0.0 {
            max(abs(off_rad) - HALF_RAD, 0.0)
        } else {
            min(abs(off_rad) + HALF_RAD, PI)
        };
        let nearer_m = since.rolled_m * sin_cos(nearest_rad).1
            + ARM_M * abs(since.turned_rad)
            + SLANT * range_m * since.aside_rad;
        let step_m = self.last_m - range_m - nearer_m;
        let other = since.aside_rad > BESIDE_RAD
            || abs(since.turned_rad) > TURNED_RAD
            || abs(range_m - self.last_m) > JUMP_M;
        self.last_m = range_m;
        self.own_m += step_m;
        self.age_s += since.age_s;
        // How much nearer it has come by itself, over what noise does.
        let share = self.own_m / (NOISE_M + NOISE_CUBED * range_m * range_m * range_m);
        if self.looks == 0 || other || share < -1.0 || self.age_s > LONG_S {
            self.first_m = range_m;
            (self.own_m, self.largest_m, self.age_s) = (0.0, 0.0, 0.0);
            self.looks = 1;
            return None;
        }
        self.looks = self.looks.saturating_add(1);
        self.may_approach = share > LOOK_AGAIN;
        self.largest_m = max(self.largest_m, step_m);
        let approaches = self.looks >= LOOKS
            && share > CERTAIN
            && self.largest_m < LARGEST_STEP * self.own_m
            && step_m > LAST_STEP_M;
        approaches.then_some(Approach {
            off_rad,
            range_m,
            speed_m_s: (self.first_m - range_m) / self.age_s,
            sure: share > SURE,
        })
    }
}

impl MotionMemory {
    /// One tick, in which something was seen to approach, or to move before a robot that stands, or not.
    pub(super) fn step(&mut self, approach: Option<&Approach>, moves: bool, turned_rad: f32) {
        self.lively_ticks = self.lively_ticks.saturating_sub(1);
        self.ahead_ticks = self.ahead_ticks.saturating_sub(1);
        self.careful_ticks = self.careful_ticks.saturating_sub(1);
        self.wonder_ticks = self.wonder_ticks.saturating_sub(1);
        self.known_ticks = if moves {
            KNOWN_TICKS
        } else {
            self.known_ticks.saturating_sub(1)
        };
        self.last.off_rad -= turned_rad;
        self.wonder_rad -= turned_rad;
        if let Some(approach) = approach {
            self.last = *approach;
            self.lively_ticks = LIVELY_TICKS;
            if !approach.is_aside() {
                self.ahead_ticks = AHEAD_TICKS;
            }
        }
    }

    /// The obstacle beside the robot may approach: another robot that goes around this one.
    pub(super) fn be_careful(&mut self) {
        self.careful_ticks = CAREFUL_TICKS;
    }

    /// The robot should be slow for that.
    pub(super) fn is_careful(&self) -> bool {
        self.careful_ticks > 0
    }

    /// Something new is in this direction, positive is left [rad].
    pub(super) fn wonder(&mut self, off_rad: f32) {
        (self.wonder_ticks, self.wonder_rad) = (WONDER_TICKS, off_rad);
    }

    /// The robot should be slow for that.
    pub(super) fn wonders(&self) -> bool {
        self.wonder_ticks > 0
    }

    /// Begins a pause before a detour: of two robots that meet, one goes on first, and the other sees it move.
    pub(super) fn pause(&mut self, x_m: f32) {
        self.paused_ticks = 0;
        self.begin_pause(x_m);
    }

    fn begin_pause(&mut self, x_m: f32) {
        let (least, step) = if self.is_known() {
            LONG_PAUSE_TICKS
        } else {
            PAUSE_TICKS
        };
        self.pause_ticks = least + step * dice(x_m);
    }

    /// One tick of the pause; whether it goes on.
    pub(super) fn pauses(&mut self, estimate: &Estimate) -> bool {
        if self.known_ticks == KNOWN_TICKS && self.paused_ticks < ANEW_TICKS {
            self.begin_pause(estimate.pose.x_m);
        }
        self.paused_ticks += 1;
        self.pause_ticks = self
            .pause_ticks
            .saturating_sub(u8::from(estimate.standing()));
        self.pause_ticks > 0 && self.paused_ticks < MOST_TICKS
    }

    /// Something is known to move here: the robot should be slow.
    pub(super) fn is_known(&self) -> bool {
        self.is_lively() || self.known_ticks > 0
    }

    /// Something has approached here: things may have gone elsewhere.
    pub(super) fn is_lively(&self) -> bool {
        self.lively_ticks > 0
    }

    /// Something has approached within this [ticks].
    fn is_within(&self, ticks: u16) -> bool {
        self.lively_ticks > LIVELY_TICKS - ticks
    }

    /// Something has just approached: silence where it was is none of a sonar that fails.
    pub(super) fn is_passing(&self) -> bool {
        self.is_within(PASSING_TICKS)
    }

    /// The robot gives way.
    pub(super) fn gives_way(&self) -> bool {
        self.wait_ticks > 0
    }

    /// It stands or backs off for that.
    pub(super) fn waits(&self) -> bool {
        self.gives_way() && self.out_m <= 0.0
    }

    /// Between which directions the servo swings [rad]. While the robot gives way: straight ahead on its way out, else
    /// what approached and ahead. Else, unless it goes `around` an obstacle, something new and ahead.
    pub(super) fn swing(&self, around: bool) -> Option<(f32, f32)> {
        let off_rad = if self.gives_way() {
            if !self.waits() {
                return Some((0.0, 0.0));
            }
            self.last.off_rad
        } else if self.wonders() && !around {
            self.wonder_rad
        } else {
            return None;
        };
        let off_rad = clamp(off_rad, -SWEEP_RAD, SWEEP_RAD);
        Some((min(off_rad, -AROUND_RAD), max(off_rad, AROUND_RAD)))
    }
}

impl Mission<'_> {
    /// Gives way to what approaches; none if the robot may drive.
    pub(super) fn give_way(&self, state: &mut State, estimate: &Estimate) -> Option<Drive> {
        let movement = &mut state.movement;
        let Approach {
            range_m, speed_m_s, ..
        } = movement.last;
        let fresh = movement.is_within(FRESH_TICKS);
        let aside = movement.last.is_aside();
        let soon = range_m < min(ASIDE_M, speed_m_s * SOON_S);
        if !movement.gives_way() {
            if !fresh || (aside && !soon) {
                return None;
            }
            movement.wait_ticks = WAIT_TICKS + STEP_TICKS * dice(estimate.pose.x_m);
            movement.back_m = 0.0;
        }
        let rolled_m = abs(estimate.rolled_m);
        if movement.out_m > 0.0 {
            movement.out_m -= rolled_m;
            if movement.out_m > 0.0 && state.gap_m > STOP_M {
                return Some(straight(OUT_M_S));
            }
            movement.wait_ticks = 0;
            return None;
        }
        // What comes from the side may run into a robot that stands: on, out of its way.
        let abeam = abs(movement.last.off_rad) > ABEAM_RAD;
        let free = state.gap_m > FREE_M && movement.ahead_ticks == 0;
        if fresh && abeam && soon && free && movement.last.sure && state.phase == Phase::GoToGoal {
            movement.out_m = OUT_M;
            state.gaze.turn_to(0.0);
            return Some(straight(OUT_M_S));
        }
        if !movement.is_within(u16::from(movement.wait_ticks)) {
            movement.wait_ticks = 0;
            return None;
        }
        // Around an obstacle another one may be behind.
        let blind = aside && state.detour.is_some() && !movement.last.sure;
        let evades = fresh && range_m < EVADE_M && !blind && movement.back_m < MOST_BACK_M;
        Some(if evades {
            movement.back_m += rolled_m;
            straight(-BACK_M_S)
        } else if estimate.standing() {
            Drive::Release
        } else {
            straight(0.0)
        })
    }
}

/// Straight on.
fn straight(forward_m_s: f32) -> Drive {
    Drive::Twist {
        forward_m_s,
        yaw_rad_s: 0.0,
    }
}

/// A number from 0 to 7 that the last digits of a place give: another one for each robot.
fn dice(x_m: f32) -> u8 {
    let [digits, ..] = round(x_m * 4_000.0).to_le_bytes();
    digits & 7
}

#[cfg(test)]
mod tests;
