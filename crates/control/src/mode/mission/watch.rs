//! Whether the sonars can be trusted: detects readings that are missing, never change, contradict each other, or miss a
//! face that must answer.
//!
//! Two consecutive readings along the same beam are a pair. A healthy sonar repeats its range, corrected for the way
//! rolled; a pair that differs is an outlier. Outliers slow the robot first, then it stands: before things that move, or
//! other robots that ping, ranges agree again after a while. If they do not, the sonar is faulty. Any other reading is
//! an echo or a silence: [`Landmarks`] judge the silences of the front sonar.

use super::SWEEP_RAD;
use super::beam::Beam;
use super::landmarks::Landmarks;
use super::moving::{Approach, Since, Track};
use super::place::Place;
use super::still::Still;
use crate::estimate::Estimate;
use crate::math::{abs, min, sin_cos};
use crate::stuck::Stuck;
use crate::types::{Fault, Range, SonarId, SonarReading, TICK_S};
use core::f32::consts::FRAC_PI_2;

/// Impossible answers in a row that make a sonar faulty.
const FAULTY_AFTER: u8 = 3;
/// Motion between readings below which equal ones are plausible [m, rad].
const MOVED_M: f32 = 0.002;
const MOVED_RAD: f32 = 0.02;
/// Two answers along beams whose axes differ by less are a pair [rad].
const BESIDE_RAD: f32 = 0.12;
/// Ranges of a pair differ by at most this and a share of the range [m].
const ALIKE_M: f32 = 0.05;
const ALIKE_SHARE: f32 = 0.1;
/// Added to a sonar's outlier score by an outlier, and subtracted by a repeated range.
const WILD: u8 = 10;
const CALM: u8 = 2;
/// An outlier score that slows the robot.
const UNEASY: u8 = 20;
/// The score at which the robot stands, and that of a faulty sonar.
const WILD_LIMIT: u8 = 60;
const FAULTY_LIMIT: u8 = 120;
/// Ranges beyond this are not judged: there corners and the noise of weak echoes make them change [m].
const JUDGED_M: f32 = 1.2;

/// Way of the front sonar between two looks aside, and after one that was not answered [m].
const ASIDE_M: f32 = 0.12;
const AGAIN_M: f32 = 0.05;
/// How far ahead of the axis it sits, about: a turn moves it too [m].
const ARM_M: f32 = 0.1;
/// Looks aside at a wall that were not answered, after which it must be tested.
const WALLS_SILENT: u8 = 2;
/// The servo looks aside beyond this [rad].
const LOOKS_ASIDE_RAD: f32 = 1.4;
/// Farthest wall beside the robot that tests the front sonar first [m].
const WALL_M: f32 = 0.5;
/// Farthest one that tests it where nothing else can [m].
const FAR_WALL_M: f32 = 2.0;

/// Something beside the robot is near within this [m].
const NEAR_M: f32 = 0.35;
/// Way with something near beside the robot and no echo of the front sonar, which looks there now and then, after which
/// it must be tested [m].
const BLIND_M: f32 = 0.35;

/// Way since the front sonar's last echo after which it must be tested. In the worlds of docs/theory/mission.md a
/// healthy one is silent for at most 0.8 m between two echoes [m].
const SILENT_M: f32 = 1.3;

/// The verdict on a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Worth {
    /// The first along its beam.
    First,
    /// It repeats the one before.
    Sure,
    /// It differs from the one before.
    Wild,
}

/// State of one sonar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct SonarState {
    faulty: u8,
    stuck: Stuck,
    is_stuck: bool,
    outliers: u8,
    /// The last reading was that nothing is in reach.
    silent: bool,
    /// Answers so far along about the same beam.
    looks: u8,
    /// The last three ranges of these that differ, as they would be from here, the newer one first; 0: none [m].
    known_m: [f32; 3],
    /// Direction of the last answer's beam, seen from the robot at present [rad].
    axis_rad: f32,
    age_s: f32,
    /// Way rolled and angle turned since the last answer [m, rad].
    rolled_m: f32,
    turned_rad: f32,
    /// What it has seen along one beam, and while it stood.
    track: Track,
    still: Still,
}

impl SonarState {
    /// The robot's motion since the last answer, of which this reading is the next.
    fn since(&self, reading: &SonarReading) -> Since {
        Since {
            age_s: self.age_s,
            rolled_m: self.rolled_m,
            turned_rad: self.turned_rad,
            aside_rad: self.aside_rad(reading),
        }
    }

    /// What the beam of a reading is off that of the last answer [rad].
    fn aside_rad(&self, reading: &SonarReading) -> f32 {
        abs(reading.view.axis_rad - (self.axis_rad - self.turned_rad))
    }

    fn ingest(&mut self, reading: &SonarReading) -> Worth {
        let (rolled_m, turned_rad) = (self.rolled_m, self.turned_rad);
        (self.age_s, self.rolled_m, self.turned_rad) = (0.0, 0.0, 0.0);
        if reading.range == Range::Faulty {
            self.faulty = self.faulty.saturating_add(1);
            self.outliers = self.outliers.saturating_add(WILD);
            return Worth::Wild;
        }
        self.faulty = 0;
        let axis_rad = reading.view.axis_rad;
        let aside_rad = abs(axis_rad - (self.axis_rad - turned_rad));
        self.axis_rad = axis_rad;
        if aside_rad > BESIDE_RAD {
            self.known_m = [0.0; 3];
            self.looks = 0;
        }
        let closer_m = rolled_m * sin_cos(axis_rad).1;
        let moved = abs(rolled_m) > MOVED_M || aside_rad > MOVED_RAD;
        self.is_stuck = match reading.range {
            Range::Valid(range_m) => self.stuck.ingest(range_m, moved, closer_m),
            _ => false,
        };
        for known_m in self.known_m.iter_mut().filter(|known_m| **known_m > 0.0) {
            *known_m -= closer_m;
        }
        let silent = core::mem::replace(&mut self.silent, reading.range == Range::Clear);
        let first = self.looks == 0;
        self.looks = self.looks.saturating_add(1);
        let Range::Valid(range_m) = reading.range else {
            return match (first, silent) {
                (true, _) => Worth::First,
                (false, true) => Worth::Sure,
                (false, false) => Worth::Wild,
            };
        };
        let alike = |known_m: &f32| abs(range_m - *known_m) < ALIKE_M + ALIKE_SHARE * range_m;
        let [newest_m, newer_m, oldest_m] = self.known_m;
        let known = self.known_m.iter().any(alike);
        self.known_m = if alike(&newest_m) {
            [range_m, newer_m, oldest_m]
        } else if alike(&newer_m) {
            [range_m, newest_m, oldest_m]
        } else {
            [range_m, newest_m, newer_m]
        };
        if known {
            self.outliers = self.outliers.saturating_sub(CALM);
            Worth::Sure
        } else if newest_m == 0.0 {
            Worth::First
        } else {
            if min(range_m, newest_m) < JUDGED_M {
                self.outliers = self.outliers.saturating_add(WILD);
            }
            Worth::Wild
        }
    }
}

/// Memory of the watch, by `SonarId` number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::mode) struct Watch {
    sonars: [SonarState; 3],
    /// What the reading of this tick shows to approach.
    pub(super) approach: Option<Approach>,
    /// It shows that something moves before a robot that stands.
    pub(super) moves: bool,
    /// Faces that the front sonar must detect.
    pub(super) landmarks: Landmarks,
    /// Directions without an echo since the last call of `ask`; none after an echo.
    unanswered: u8,
    /// The front sonar's way since the last look aside [m].
    aside_m: f32,
    /// Looks aside since its last echo that a wall there did not answer.
    walls_silent: u8,
    /// Way with something near beside the robot since the front sonar's last echo [m].
    blind_m: f32,
    /// Way since the front sonar's last echo; none before the first, and where no known face must answer [m].
    silent_m: Option<f32>,
}

impl Default for Watch {
    // Not derived: the default of an array is built on the stack first. Nor inlined, for the same reason.
    #[inline(never)]
    fn default() -> Self {
        Self {
            sonars: [SonarState::default(); 3],
            approach: None,
            moves: false,
            landmarks: Landmarks::default(),
            unanswered: 0,
            aside_m: 0.0,
            walls_silent: 0,
            blind_m: 0.0,
            silent_m: None,
        }
    }
}

impl Watch {
    /// Ingests a reading of a robot that drives.
    pub(in crate::mode) fn hear(&mut self, estimate: &Estimate, reading: &SonarReading) {
        let sight = Beam::of(&estimate.transform(), reading);
        self.ingest(estimate, reading, &sight, true);
    }

    /// Ingests a reading and judges it. Unless `driving`, the robot waits, and silence does no harm.
    pub(super) fn ingest(
        &mut self,
        estimate: &Estimate,
        reading: &SonarReading,
        (beam, at): &(Beam, Option<Place>),
        driving: bool,
    ) -> Worth {
        let Some(sonar) = self.sonars.get_mut(reading.sonar as usize) else {
            return Worth::Wild;
        };
        let since = sonar.since(reading);
        self.approach = sonar.track.ingest(reading, &since);
        self.moves = sonar.still.ingest(reading, &since);
        let worth = sonar.ingest(reading);
        let second = sonar.looks.is_multiple_of(2);
        if worth != Worth::Sure {
            return worth;
        }
        if reading.sonar != SonarId::Front {
            return worth;
        }
        if let Some(at) = *at {
            self.unanswered = 0;
            self.walls_silent = 0;
            self.blind_m = 0.0;
            self.silent_m = Some(0.0);
            self.landmarks.answer(beam, at);
        } else if driving {
            self.landmarks.silence(beam);
            self.unanswered = self.unanswered.saturating_add(u8::from(second));
            if abs(reading.servo_rad) >= LOOKS_ASIDE_RAD {
                let [left_m, right_m] = walls_m(estimate, NEAR_M);
                let left = reading.servo_rad > 0.0;
                let wall_m = if left { left_m } else { right_m };
                if wall_m.is_some() && self.aside_m > 0.0 {
                    self.walls_silent = self.walls_silent.saturating_add(1);
                }
                self.aside_m = 0.0;
            }
        }
        worth
    }

    /// What the front sonar sees where it looks may approach.
    pub(super) fn looks_again(&self) -> bool {
        let [_, _, front] = &self.sonars;
        front.track.may_approach
    }

    /// What a sonar at the side sees may approach.
    pub(super) fn nears_aside(&self) -> bool {
        let [left, right, _] = &self.sonars;
        left.track.may_approach || right.track.may_approach
    }

    /// The servo angle that tests the front sonar [rad]; none while it works, or where nothing must answer.
    pub(super) fn look(&self, estimate: &Estimate, front_m: f32) -> Option<f32> {
        if self.landmarks.is_alive() {
            return None;
        }
        let wait_m = if self.walls_silent > 0 {
            AGAIN_M
        } else {
            ASIDE_M
        };
        if self.aside_m > wait_m {
            match walls_m(estimate, NEAR_M) {
                [Some(left_m), Some(right_m)] if right_m < left_m => return Some(-SWEEP_RAD),
                [Some(_), _] => return Some(SWEEP_RAD),
                [None, Some(_)] => return Some(-SWEEP_RAD),
                [None, None] => {}
            }
        }
        self.landmarks.look(&estimate.transform(), front_m)
    }

    /// One tick, `beside` something that is known; an answer may be `stale_s` old.
    ///
    /// # Errors
    /// The fault of a sonar.
    pub(in crate::mode) fn step(
        &mut self,
        estimate: &Estimate,
        stale_s: f32,
        beside: bool,
    ) -> Result<(), Fault> {
        self.landmarks.step(estimate.rolled_m);
        let rolled_m = abs(estimate.rolled_m);
        self.aside_m += rolled_m + ARM_M * abs(estimate.turned_rad);
        if let Some(silent_m) = &mut self.silent_m {
            *silent_m += rolled_m;
        }
        if beside || walls_m(estimate, NEAR_M) != [None, None] {
            self.blind_m += rolled_m;
        }
        for sonar in &mut self.sonars {
            sonar.age_s += TICK_S;
            sonar.rolled_m += estimate.rolled_m;
            sonar.turned_rad += estimate.turned_rad;
            if sonar.faulty >= FAULTY_AFTER || sonar.is_stuck || sonar.outliers >= FAULTY_LIMIT {
                return Err(Fault::SonarFaulty);
            }
            if sonar.age_s > stale_s {
                return Err(Fault::SonarStale);
            }
        }
        Ok(())
    }

    /// Whether the front sonar should have had an echo by now: it must be tested.
    pub(super) fn suspects(&self) -> bool {
        let silent = self.silent_m.is_some_and(|silent_m| silent_m > SILENT_M);
        silent
            || self.landmarks.is_deaf()
            || self.blind_m > BLIND_M
            || self.walls_silent >= WALLS_SILENT
    }

    /// A sweep before an obstacle is over: a working sonar has detected it.
    pub(super) fn has_swept(&mut self) {
        self.landmarks.has_swept();
    }

    /// No known face near the robot can test the front sonar.
    pub(super) fn postpone(&mut self) {
        self.landmarks.postpone();
        self.walls_silent = 0;
        self.blind_m = 0.0;
        self.silent_m = None;
    }

    /// Restarts the count of directions in which nothing answers.
    pub(super) fn ask(&mut self) {
        self.unanswered = 0;
    }

    /// Directions in which nothing answered since then.
    pub(super) fn unanswered(&self) -> u8 {
        self.unanswered
    }

    /// Where something is that must answer: the nearer wall beside the robot, and how near it is; or the face that
    /// answered last [rad, m].
    pub(super) fn towards(&self, estimate: &Estimate) -> Option<(f32, f32)> {
        wall_beside(estimate, WALL_M).or_else(|| {
            let newest_rad = self.landmarks.newest_rad(&estimate.pose)?;
            Some((newest_rad, WALL_M))
        })
    }

    /// Whether the ranges of some sonar contradict each other so often that the robot must not drive.
    pub(in crate::mode) fn is_wild(&self) -> bool {
        (self.sonars.iter()).any(|sonar| sonar.outliers >= WILD_LIMIT)
    }

    /// Whether some sonar may be wrong: the robot should be slow.
    pub(super) fn doubts(&self) -> bool {
        self.walls_silent > 0
            || self.landmarks.doubts()
            || self.sonars.iter().any(|sonar| sonar.outliers >= UNEASY)
    }
}

/// Direction and distance of a wall beside the robot that is farther, but must answer too [rad, m].
pub(super) fn far_wall(estimate: &Estimate) -> Option<(f32, f32)> {
    wall_beside(estimate, FAR_WALL_M)
}

/// Direction and distance of the nearer wall within a distance beside the robot [rad, m].
fn wall_beside(estimate: &Estimate, within_m: f32) -> Option<(f32, f32)> {
    let heading_rad = estimate.pose.heading_rad;
    match walls_m(estimate, within_m) {
        [Some(left_m), Some(right_m)] if right_m < left_m => {
            Some((heading_rad - FRAC_PI_2, right_m))
        }
        [Some(left_m), _] => Some((heading_rad + FRAC_PI_2, left_m)),
        [None, Some(right_m)] => Some((heading_rad - FRAC_PI_2, right_m)),
        [None, None] => None,
    }
}

/// Walls within a distance beside the robot, at the left and at the right, and how near they are [m].
fn walls_m(estimate: &Estimate, within_m: f32) -> [Option<f32>; 2] {
    [SonarId::Left, SonarId::Right].map(|sonar| match estimate.range(sonar).range {
        Range::Valid(range_m) if range_m < within_m => Some(range_m),
        _ => None,
    })
}

#[cfg(test)]
mod tests;
