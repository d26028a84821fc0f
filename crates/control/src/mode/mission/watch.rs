//! Whether the sonars can be trusted: detects readings that are missing, never change, contradict each other, or miss a
//! face that must answer.
//!
//! Two consecutive readings along the same beam are a pair. A healthy sonar repeats its range, corrected for the way
//! rolled; a pair that differs is wild. Wild pairs slow the robot first, then stop it, as in mode 1
//! ([`crate::unrest`]). Any other reading is an echo or a silence: [`Landmarks`] judge the silences of the front sonar.

use super::echoes::Beam;
use super::gaze::SWEEP_RAD;
use super::landmarks::Landmarks;
use crate::estimate::Estimate;
use crate::math::{abs, min, sin_cos};
use crate::types::{Fault, Range, Reading, SonarId, TICK_S};
use core::f32::consts::FRAC_PI_2;

/// Impossible answers in a row that make a sonar faulty.
const FAULTY_AFTER: u8 = 3;
/// Consecutive equal readings that make it stuck. A healthy one repeats to the microsecond in at most one of ten
/// readings, beside a parallel wall: seven in a row are one in ten million.
const STUCK_AFTER: u8 = 7;
/// Answers this near to each other are equal: a microsecond is 0.17 mm [m].
const SAME_M: f32 = 0.000_05;
/// Motion between readings below which equal ones are plausible [m, rad].
const MOVED_M: f32 = 0.002;
const MOVED_RAD: f32 = 0.02;
/// Two answers along beams whose axes differ by less are a pair [rad].
const BESIDE_RAD: f32 = 0.12;
/// Ranges of a pair differ by at most this and a share of the range [m].
const ALIKE_M: f32 = 0.05;
const ALIKE_SHARE: f32 = 0.1;
/// Added to a sonar's outlier score by a wild range, and subtracted by a repeated one.
const WILD: u8 = 10;
const CALM: u8 = 2;
/// An outlier score that slows the robot.
const UNEASY: u8 = 20;
/// An outlier score of a sonar that is faulty.
const WILD_LIMIT: u8 = 60;
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
/// Farthest wall that is taken for one [m].
const WALL_M: f32 = 0.5;

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
    same: u8,
    outliers: u8,
    /// The last reading was that nothing is in reach.
    silent: bool,
    /// Answers so far along about the same beam.
    looks: u8,
    /// The last three ranges of these that differ, as they would be from here, the newer one first; 0: none [m].
    known_m: [f32; 3],
    /// The last range that it gave, whatever came after it [m].
    last_m: f32,
    /// Direction of the last answer's beam, seen from the robot at present [rad].
    axis_rad: f32,
    age_s: f32,
    /// Way rolled and angle turned since the last answer [m, rad].
    rolled_m: f32,
    turned_rad: f32,
}

impl SonarState {
    fn ingest(&mut self, reading: &Reading) -> Worth {
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
        self.repeats(
            reading.range,
            abs(rolled_m) > MOVED_M || aside_rad > MOVED_RAD,
        );
        self.axis_rad = axis_rad;
        if aside_rad > BESIDE_RAD {
            self.known_m = [0.0; 3];
            self.looks = 0;
        }
        let closer_m = rolled_m * sin_cos(axis_rad).1;
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

    /// Counts answers that are equal although the robot or the servo `moved`.
    fn repeats(&mut self, range: Range, moved: bool) {
        let Range::Valid(range_m) = range else {
            self.same = 0;
            return;
        };
        if abs(range_m - self.last_m) > SAME_M {
            self.same = 0;
        } else if moved {
            self.same = self.same.saturating_add(1);
        }
        self.last_m = range_m;
    }
}

/// Memory of the watch, by `SonarId` number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Watch {
    sonars: [SonarState; 3],
    /// Faces that the front sonar must detect.
    pub landmarks: Landmarks,
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

impl Watch {
    /// Ingests a reading and judges it. Unless `driving`, the robot waits, and silence does no harm.
    pub(super) fn ingest(
        &mut self,
        estimate: &Estimate,
        reading: &Reading,
        driving: bool,
    ) -> Worth {
        let Some(sonar) = self.sonars.get_mut(reading.sonar as usize) else {
            return Worth::Wild;
        };
        let worth = sonar.ingest(reading);
        let second = sonar.looks.is_multiple_of(2);
        if worth != Worth::Sure {
            return worth;
        }
        if reading.sonar != SonarId::Front {
            return worth;
        }
        let (beam, at) = Beam::of(&estimate.transform(), reading);
        if let Some(at) = at {
            self.unanswered = 0;
            self.walls_silent = 0;
            self.blind_m = 0.0;
            self.silent_m = Some(0.0);
            self.landmarks.answer(&beam, at);
        } else if driving {
            self.landmarks.silence(&beam);
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
    pub(super) fn step(
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
            if sonar.faulty >= FAULTY_AFTER
                || sonar.same >= STUCK_AFTER
                || sonar.outliers >= WILD_LIMIT
            {
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
        let heading_rad = estimate.pose.heading_rad;
        let left = |range_m| Some((heading_rad + FRAC_PI_2, range_m));
        let right = |range_m| Some((heading_rad - FRAC_PI_2, range_m));
        match walls_m(estimate, WALL_M) {
            [None, None] => {
                let newest_rad = self.landmarks.newest_rad(&estimate.pose)?;
                Some((newest_rad, WALL_M))
            }
            [Some(left_m), Some(right_m)] if right_m < left_m => right(right_m),
            [Some(left_m), _] => left(left_m),
            [None, Some(right_m)] => right(right_m),
        }
    }

    /// Whether some sonar may be wrong: the robot should be slow.
    pub(super) fn doubts(&self) -> bool {
        self.walls_silent > 0
            || self.landmarks.doubts()
            || self.sonars.iter().any(|sonar| sonar.outliers >= UNEASY)
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
mod tests {
    use super::*;
    use crate::rig::View;
    use crate::types::AgedRange;

    /// Answers of all three sonars in turn, while the robot rolls `rolled_m` per tick; the front one looks ahead.
    fn watched(
        answers: impl Fn(SonarId, u16) -> Range,
        ticks: u16,
        rolled_m: f32,
    ) -> Result<Watch, (u16, Fault)> {
        let mut watch = Watch::default();
        for tick in 0..ticks {
            let sonar = SonarId::ALL[usize::from(tick / 2 % 3)];
            let axis_rad = match sonar {
                SonarId::Left => FRAC_PI_2,
                SonarId::Right => -FRAC_PI_2,
                SonarId::Front => 0.0,
            };
            let mut estimate = Estimate {
                rolled_m,
                facing: (0.0, 1.0),
                ..Estimate::default()
            };
            estimate.pose.x_m = f32::from(tick) * rolled_m;
            let left = &mut estimate.ranges[SonarId::Left as usize];
            (left.range, left.age_ticks) = (answers(SonarId::Left, tick), 0);
            if tick % 2 == 0 {
                let reading = Reading {
                    sonar,
                    range: answers(sonar, tick),
                    view: View {
                        axis_rad,
                        ..View::default()
                    },
                    servo_rad: 0.0,
                };
                watch.ingest(&estimate, &reading, true);
            }
            watch
                .step(&estimate, 0.5, false)
                .map_err(|fault| (tick, fault))?;
        }
        Ok(watch)
    }

    /// A wall that the robot approaches by 2 mm per tick, measured with some noise.
    fn near(_: SonarId, tick: u16) -> Range {
        let noise_m = 1e-3 * f32::from(tick * 7 % 5);
        Range::Valid(1.1 - 2e-3 * f32::from(tick) + noise_m)
    }

    #[test]
    fn sonars_that_answer_are_believed() {
        let sides = |_, tick: u16| Range::Valid(0.4 + 1e-3 * f32::from(tick * 7 % 5));
        for (answers, rolled_m) in [(sides as fn(SonarId, u16) -> Range, 0.0), (near, 0.002)] {
            let front = |sonar, tick| match sonar {
                SonarId::Front => answers(sonar, tick),
                _ => sides(sonar, tick),
            };
            assert!(watched(front, 400, rolled_m).is_ok_and(|watch| !watch.doubts()));
        }
        assert!(
            watched(|_, _| Range::Clear, 500, 0.002).is_ok(),
            "free floor"
        );
    }

    #[test]
    fn a_silent_line_is_a_fault_after_three_answers_and_one_is_none() {
        let cut = watched(|_, _| Range::Faulty, 500, 0.002).map(|_| ());
        assert!(matches!(cut, Err((12, Fault::SonarFaulty))), "{cut:?}");
        let once = |sonar, tick: u16| {
            if tick.is_multiple_of(60) {
                Range::Faulty
            } else {
                near(sonar, 0)
            }
        };
        assert!(watched(once, 500, 0.0).is_ok());
    }

    #[test]
    fn an_answer_that_never_changes_while_the_robot_drives_is_a_fault_within_half_a_second() {
        let stuck = watched(|_, _| Range::Valid(0.8), 500, 0.002).map(|_| ());
        assert!(
            matches!(stuck, Err((tick, Fault::SonarFaulty)) if tick < 50),
            "{stuck:?}"
        );
    }

    #[test]
    fn random_ranges_slow_the_robot_and_then_stop_it_and_an_edge_that_flickers_does_neither() {
        const RANDOM_M: [f32; 10] = [1.3, 0.4, 2.2, 0.9, 0.2, 1.7, 0.6, 2.0, 1.1, 0.3];
        let wild = |sonar, tick: u16| match sonar {
            SonarId::Front => Range::Valid(RANDOM_M[usize::from(tick / 6) % RANDOM_M.len()]),
            _ => near(sonar, 0),
        };
        assert!(watched(wild, 34, 0.0).is_ok_and(|watch| watch.doubts()));
        let end = watched(wild, 400, 0.0).map(|_| ());
        assert!(matches!(end, Err((_, Fault::SonarFaulty))), "{end:?}");
        let edge = |_, tick: u16| match tick / 6 % 3 {
            0 => Range::Valid(0.4),
            1 => Range::Valid(0.9),
            _ => Range::Clear,
        };
        assert!(watched(edge, 400, 0.0).is_ok_and(|watch| !watch.doubts()));
    }

    #[test]
    fn a_face_ahead_that_falls_silent_raises_doubt_and_then_is_to_be_proven() {
        let deaf = |sonar, tick: u16| match sonar {
            SonarId::Front if tick < 100 => near(sonar, tick),
            _ => Range::Clear,
        };
        let after = |ticks| watched(deaf, ticks, 0.002).unwrap();
        assert!(after(120).doubts() && !after(120).suspects());
        assert!(after(160).suspects());
        let never = watched(|_, _| Range::Clear, 200, 0.002).unwrap();
        assert!(!never.doubts() && !never.suspects(), "free floor");
    }

    #[test]
    fn a_way_beside_a_wall_without_an_echo_is_to_be_proven_and_an_echo_ends_it() {
        let beside = |until: u16| {
            move |sonar, tick: u16| match sonar {
                SonarId::Left => Range::Valid(0.2 + 1e-3 * f32::from(tick * 7 % 5)),
                SonarId::Front if tick >= until => near(sonar, tick - until),
                _ => Range::Clear,
            }
        };
        let after = |ticks, until| watched(beside(until), ticks, 0.002).unwrap();
        assert!(!after(160, 500).suspects());
        assert!(after(200, 500).suspects());
        assert!(!after(240, 200).suspects());
    }

    #[test]
    fn a_wall_beside_the_robot_that_leaves_two_looks_unanswered_is_to_be_proven() {
        let aside = |watch: &mut Watch, range: Range, left: Range| {
            let mut estimate = Estimate {
                rolled_m: 0.06,
                facing: (0.0, 1.0),
                ..Estimate::default()
            };
            estimate.ranges[SonarId::Left as usize] = AgedRange::fresh(left);
            watch.step(&estimate, 0.5, false).unwrap();
            let view = View {
                axis_rad: SWEEP_RAD,
                ..View::default()
            };
            let reading = Reading {
                sonar: SonarId::Front,
                range,
                view,
                servo_rad: SWEEP_RAD,
            };
            (0..2).for_each(|_| _ = watch.ingest(&estimate, &reading, true));
        };
        let (wall, far) = (Range::Valid(0.2), Range::Clear);
        let mut watch = Watch::default();
        aside(&mut watch, Range::Clear, far);
        assert!(!watch.doubts(), "nothing must answer there");
        aside(&mut watch, Range::Clear, wall);
        assert!(watch.doubts() && !watch.suspects());
        let mut silent = watch;
        aside(&mut silent, Range::Clear, wall);
        assert!(silent.suspects());
        aside(&mut watch, Range::Valid(0.2), wall);
        assert!(!watch.doubts(), "it answers");
    }

    #[test]
    fn a_long_way_without_an_echo_is_to_be_proven_unless_there_never_was_one() {
        let until = |last: u16| {
            move |sonar, tick: u16| match sonar {
                SonarId::Left => Range::Valid(0.45 + 1e-3 * f32::from(tick * 7 % 5)),
                SonarId::Front if tick < last => near(sonar, tick),
                _ => Range::Clear,
            }
        };
        let after = |ticks, last| watched(until(last), ticks, 0.02).unwrap();
        assert!(
            !after(60, 20)
                .silent_m
                .is_some_and(|silent_m| silent_m > SILENT_M)
        );
        assert!(after(100, 20).suspects());
        assert!(!after(100, 0).suspects(), "free floor");
    }

    #[test]
    fn no_answer_at_all_is_stale() {
        let mut watch = Watch::default();
        let results: [_; 60] =
            core::array::from_fn(|_| watch.step(&Estimate::default(), 0.5, false));
        assert_eq!(results[40], Ok(()));
        assert_eq!(results[59], Err(Fault::SonarStale));
    }
}
