//! Faces that the front sonar must detect again: the proof that it still works.
//!
//! A sonar that always reports "nothing in reach" looks like free floor. So faces that have answered are stored apart
//! from the obstacles, and when the sonar has been silent for a while the servo turns to one that must answer: near
//! enough, and seen from about the same direction as before. Its silence raises doubt and slows the robot; too much
//! silence means a deaf sonar.
//!
//! | event | effect |
//! |---|---|
//! | two equal echoes in a row from a place | the landmark there is renewed, or the one silent for longest gives way; all silences are cleared |
//! | two silences in a row at a landmark | one more silence of that landmark; with [`SILENCES`] of them it is given up |
//! | [`DOUBT_AFTER`] silences at landmarks since the last echo | doubt: the robot is slow until the next echo |
//! | [`DOUBT_M`] of way in doubt, or [`DEAF_AFTER`] silences | it must be tested |
//! | [`LASTING`] silences, and nothing to test it by | doubt until the next echo |

use super::beam::{Beam, direction};
use super::place::{Place, fractions};
use crate::math::{abs, atan2, wrap_angle};
use crate::types::{Pose, TICK_S, Transform};

/// Most landmarks stored.
const CAPACITY: usize = 4;
/// Landmarks nearer to each other than this are one [mm].
const APART_MM: u16 = 250;
/// Farthest that a face must answer [mm]; the reach is 2.5 m.
const REACH_MM: i32 = 2_000;
/// A landmark must answer a beam whose axis passes it within this tangent, in 256ths: 0.15 rad, half a beam.
const BESIDE: i32 = 39;
/// It must answer from the directions between those from which it did, and from a little beyond, in 256ths of a turn:
/// 0.05 rad.
const BEYOND: i8 = 2;
/// Directions farther from the first than this start a new range, in 256ths of a turn: 1 rad.
const WIDEST: u8 = 40;
/// A silence counts only if the sonar had an echo within this time; after that the sonar must be tested [s].
const ALIVE_S: f32 = 0.6;
/// A sonar that has passed a proof is trusted for this long: time for a sweep [s].
const TRUST_S: f32 = 4.0;
/// A face nearer than this must answer a robot that turns to it [mm].
const NEAR_MM: u16 = 800;
/// A sweep takes longer [s].
const SWEPT_S: f32 = 1.2;
/// Farthest that the servo turns [rad].
const ASIDE_RAD: f32 = 1.5;
/// Silences of one landmark after which it is given up: what it stood for may be gone.
const SILENCES: u8 = 4;
/// Silences since the last echo that raise doubt.
const DOUBT_AFTER: u8 = 1;
/// Way in doubt [m].
const DOUBT_M: f32 = 0.5;
/// Silences since the last echo after which the doubt lasts until the next one.
const LASTING: u8 = 3;
/// Silences since the last echo after which the sonar is deaf.
const DEAF_AFTER: u8 = 4;

/// A face that answered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Landmark {
    at: Place,
    /// A beam's axis when it answered, in 256ths of a turn; and how far to the right and to the left of it others were.
    axis: i8,
    right: i8,
    left: i8,
    /// How often it has answered, at most [`SURE`]; 0: none.
    answers: u8,
    silences: u8,
}

/// A landmark counts once it has answered so often.
const SURE: u8 = 2;

/// The landmarks that the front sonar must detect, and whether it does.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Landmarks {
    seen: [Landmark; CAPACITY],
    /// Time since the last echo [s].
    silent_s: f32,
    /// How long its silence is still trusted after a passed proof [s].
    trusted_s: f32,
    /// Way since the last silence at a landmark [m].
    doubt_m: f32,
    silences: u8,
}

impl Landmarks {
    /// One tick.
    pub(super) fn step(&mut self, rolled_m: f32) {
        self.silent_s += TICK_S;
        self.trusted_s -= TICK_S;
        self.doubt_m += abs(rolled_m);
    }

    /// Two equal echoes in a row came from `at`.
    pub(super) fn answer(&mut self, beam: &Beam, at: Place) {
        self.silent_s = 0.0;
        self.silences = 0;
        let same =
            |landmark: &Landmark| landmark.answers > 0 && landmark.at.is_within(APART_MM, at);
        let known = self.seen.iter().position(same).unwrap_or(CAPACITY - 1);
        // The newest comes first.
        if let Some(newer) = self.seen.get_mut(..=known) {
            newer.rotate_right(1);
        }
        if let Some(first) = self.seen.first_mut() {
            let is_known = same(first);
            first.answer(beam, at, is_known);
        }
    }

    /// Two silences in a row along this beam.
    pub(super) fn silence(&mut self, beam: &Beam) {
        let mut silent = false;
        for landmark in &mut self.seen {
            if landmark.must_answer(beam) {
                silent = true;
                landmark.silences += 1;
                if landmark.silences >= SILENCES {
                    landmark.answers = 0;
                }
            }
        }
        if silent {
            self.silences = self.silences.saturating_add(1);
            self.doubt_m = 0.0;
        }
    }

    /// Where the servo is to point to a face that must answer [rad], the front sonar being so far ahead.
    pub(super) fn look(&self, robot: &Transform, ahead_m: f32) -> Option<f32> {
        let (x_m, y_m) = robot.to_world(ahead_m, 0.0);
        let apex = Place::new(x_m, y_m);
        let sure = self.seen.iter().filter(|landmark| landmark.answers >= SURE);
        sure.filter_map(|landmark| {
            let (dx, dy) = landmark.at.from(apex);
            let bearing_rad = atan2(f32::from(dy), f32::from(dx));
            let servo_rad = wrap_angle(bearing_rad - robot.pose.heading_rad);
            let must = abs(servo_rad) <= ASIDE_RAD
                && landmark.must_answer(&Beam::along(apex, bearing_rad));
            must.then_some(servo_rad)
        })
        .next()
    }

    /// The sonar has passed a proof.
    pub(super) fn trust(&mut self) {
        self.trusted_s = TRUST_S;
    }

    /// It cannot be tested here: after many silences it stays in doubt until its next echo.
    pub(super) fn postpone(&mut self) {
        self.silences = if self.silences < LASTING { 0 } else { LASTING };
    }

    /// It did not answer, and what should have may be gone: it stays in doubt until its next echo.
    pub(super) fn distrust(&mut self) {
        self.silences = LASTING;
    }

    /// All around an obstacle was looked at: silence so long is one of a deaf sonar.
    pub(super) fn has_swept(&mut self) {
        if self.silent_s > SWEPT_S && !self.is_alive() {
            self.silences = DEAF_AFTER;
        }
    }

    /// Bearing of the face that answered last, if it is near and not behind the robot [rad].
    pub(super) fn newest_rad(&self, from: &Pose) -> Option<f32> {
        let newest = self.seen.first().filter(|landmark| landmark.answers > 0)?;
        let here = Place::new(from.x_m, from.y_m);
        let (dx, dy) = newest.at.from(here);
        let bearing_rad = atan2(f32::from(dy), f32::from(dx));
        let ahead = abs(wrap_angle(bearing_rad - from.heading_rad)) < ASIDE_RAD;
        (ahead && newest.at.is_within(NEAR_MM, here)).then_some(bearing_rad)
    }

    /// Whether the sonar has proven recently that it works, so that its silence counts.
    pub(super) fn is_alive(&self) -> bool {
        self.silent_s < ALIVE_S || self.trusted_s > 0.0
    }

    /// The sonar may be deaf: the robot should be slow.
    pub(super) fn doubts(&self) -> bool {
        self.silences >= DOUBT_AFTER
    }

    /// It must be tested: too many silences, or a long way in doubt.
    pub(super) fn is_deaf(&self) -> bool {
        let long = self.doubts() && self.silences < LASTING && self.doubt_m > DOUBT_M;
        long || self.silences >= DEAF_AFTER
    }

    /// The place at `origin` becomes the origin.
    pub(super) fn move_origin(&mut self, origin: &Pose, facing: (f32, f32)) {
        let (here, facing) = (Place::new(origin.x_m, origin.y_m), fractions(facing));
        let turned = direction(origin.heading_rad);
        for landmark in &mut self.seen {
            landmark.at = landmark.at.as_seen(here, &facing);
            landmark.axis = landmark.axis.wrapping_sub(turned);
        }
    }
}

impl Landmark {
    fn answer(&mut self, beam: &Beam, at: Place, known: bool) {
        let off = beam.axis.wrapping_sub(self.axis);
        if !known || off.unsigned_abs() > WIDEST {
            *self = Self {
                axis: beam.axis,
                ..Self::default()
            };
        } else {
            self.right = core::cmp::min(self.right, off);
            self.left = core::cmp::max(self.left, off);
        }
        self.at = at;
        self.answers = core::cmp::min(self.answers + 1, SURE);
        self.silences = 0;
    }

    fn must_answer(&self, beam: &Beam) -> bool {
        let off = beam.axis.wrapping_sub(self.axis);
        if self.answers < SURE || off < self.right - BEYOND || off > self.left + BEYOND {
            return false;
        }
        let (along, across) = self.at.seen(beam.apex, &beam.facing);
        along > 0 && along < REACH_MM && across.abs() * 256 < along * BESIDE
    }
}
