//! Whether the sonars can be believed: a cut one is silent, a stuck one gives the same answer while the robot drives.
//!
//! One that is stuck at "nothing in reach" looks like an empty floor. The front one then denies what it has heard before. Slanted faces do
//! that too, but not for long. (That a sonar at the side hears something where the front one looks is no proof: so it is at every corner.)

use crate::estimate::Estimate;
use crate::math::abs;
use crate::types::{Fault, Range, SonarId, TICK_S};

/// Impossible answers in a row that make a sonar faulty.
const FAULTY_AFTER: u8 = 3;
/// Equal answers in a row that make it stuck. A sound one repeats itself to the microsecond in one of ten answers at most, beside a
/// parallel wall: seven in a row are one in ten million.
const STUCK_AFTER: u8 = 7;
/// Answers this near to each other are equal: a microsecond is 0.17 mm [m].
const SAME_M: f32 = 0.000_05;
/// Way from answer to answer below which a robot may well hear the same [m].
const MOVED_M: f32 = 0.002;
/// Denials without an echo in between that make the front sonar deaf: in 1,000 random worlds, 5 hours of driving, a sound one came to 5.
const DEAF_AFTER: u8 = 7;
/// From here on the robot is careful.
const DOUBT_AFTER: u8 = 2;
/// Way without another denial after which it is not any more [m].
const DOUBT_M: f32 = 0.5;

/// What is remembered of one sonar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Ear {
    faulty: u8,
    same: u8,
    last_m: f32,
    age_s: f32,
    /// Way rolled since the last answer [m].
    rolled_m: f32,
}

impl Ear {
    fn hear(&mut self, range: Range) {
        self.age_s = 0.0;
        let moved = core::mem::take(&mut self.rolled_m) > MOVED_M;
        match range {
            Range::Faulty => {
                self.faulty = self.faulty.saturating_add(1);
                return;
            }
            Range::Clear => self.same = 0,
            Range::Valid(range_m) => {
                if abs(range_m - self.last_m) > SAME_M {
                    self.same = 0;
                } else if moved {
                    self.same = self.same.saturating_add(1);
                }
                self.last_m = range_m;
            }
        }
        self.faulty = 0;
    }
}

/// Memory of the watch, by `SonarId` number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Watch {
    ears: [Ear; 3],
    /// Denials since the front sonar last heard something.
    deaf: u8,
    /// Way since the last denial [m].
    denied_m: f32,
}

impl Default for Watch {
    #[inline]
    fn default() -> Self {
        Self {
            ears: [Ear::default(); 3],
            deaf: 0,
            denied_m: 0.0,
        }
    }
}

impl Watch {
    /// One tick; an answer may be `stale_s` old. The answer `denies` what has been heard before.
    ///
    /// # Errors
    /// What is wrong with a sonar.
    pub(super) fn step(
        &mut self,
        estimate: &Estimate,
        denies: bool,
        stale_s: f32,
    ) -> Result<(), Fault> {
        if let Some(reading) = &estimate.reading {
            if let Some(ear) = self.ears.get_mut(reading.sonar as usize) {
                ear.hear(reading.range);
            }
            match (reading.sonar, reading.range) {
                (SonarId::Front, Range::Clear) if denies => {
                    self.deaf = self.deaf.saturating_add(1);
                    self.denied_m = 0.0;
                }
                (SonarId::Front, Range::Clear) => {}
                (SonarId::Front, _) => self.deaf = 0,
                _ => {}
            }
        }
        self.denied_m += abs(estimate.rolled_m);
        if self.deaf >= DEAF_AFTER {
            return Err(Fault::SonarFaulty);
        }
        for ear in &mut self.ears {
            ear.age_s += TICK_S;
            ear.rolled_m += abs(estimate.rolled_m);
            if ear.faulty >= FAULTY_AFTER || ear.same >= STUCK_AFTER {
                return Err(Fault::SonarFaulty);
            }
            if ear.age_s > stale_s {
                return Err(Fault::SonarStale);
            }
        }
        Ok(())
    }

    /// The front sonar may be deaf: the robot should be slow.
    pub(super) fn doubts(&self) -> bool {
        self.deaf >= DOUBT_AFTER && self.denied_m < DOUBT_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rig::View;
    use crate::types::Reading;

    /// Answers of all three sonars in turn, while the robot rolls `rolled_m` per tick.
    fn watched(
        answers: impl Fn(u16) -> Range,
        ticks: u16,
        rolled_m: f32,
    ) -> Result<(), (u16, Fault)> {
        let mut watch = Watch::default();
        for tick in 0..ticks {
            let sonar = SonarId::ALL[usize::from(tick / 2 % 3)];
            let reading = (tick % 2 == 0).then(|| Reading {
                sonar,
                range: answers(tick),
                view: View::default(),
                servo_rad: 0.0,
            });
            let estimate = Estimate {
                reading,
                rolled_m,
                ..Estimate::default()
            };
            watch
                .step(&estimate, false, 0.5)
                .map_err(|fault| (tick, fault))?;
        }
        Ok(())
    }

    fn near(tick: u16) -> Range {
        Range::Valid(0.4 + 1e-3 * f32::from(tick))
    }

    #[test]
    fn sonars_that_answer_are_believed() {
        assert_eq!(watched(near, 500, 0.002), Ok(()));
        assert_eq!(watched(|_| Range::Clear, 500, 0.002), Ok(()));
        assert_eq!(watched(|_| Range::Valid(0.4), 500, 0.0), Ok(()), "at rest");
    }

    #[test]
    fn a_silent_line_is_a_fault_after_three_answers_and_one_is_none() {
        let cut = watched(|_| Range::Faulty, 500, 0.002);
        assert!(matches!(cut, Err((12, Fault::SonarFaulty))), "{cut:?}");
        let once = |tick| {
            if tick % 20 == 0 {
                Range::Faulty
            } else {
                near(tick)
            }
        };
        assert_eq!(watched(once, 500, 0.002), Ok(()));
    }

    #[test]
    fn an_answer_that_never_changes_while_the_robot_drives_is_a_fault_within_half_a_second() {
        let stuck = watched(|_| Range::Valid(0.8), 500, 0.002);
        assert!(
            matches!(stuck, Err((tick, Fault::SonarFaulty)) if tick < 50),
            "{stuck:?}"
        );
    }

    #[test]
    fn a_front_sonar_that_denies_what_it_has_heard_again_and_again_is_a_fault_and_one_echo_clears_it()
     {
        let fault_after = |every: u16| {
            let mut watch = Watch::default();
            (1..400).find_map(|tick: u16| {
                let reading = Some(Reading {
                    sonar: SonarId::ALL[usize::from(tick % 3)],
                    range: if tick.is_multiple_of(every) {
                        near(tick)
                    } else {
                        Range::Clear
                    },
                    view: View::default(),
                    servo_rad: 0.9,
                });
                let estimate = Estimate {
                    reading,
                    ..Estimate::default()
                };
                let step = watch.step(&estimate, true, 0.5);
                step.err().map(|fault| (tick, fault))
            })
        };
        assert_eq!(fault_after(500), Some((20, Fault::SonarFaulty)));
        assert_eq!(
            fault_after(2),
            None,
            "every second of its answers is an echo"
        );
    }

    #[test]
    fn no_answer_at_all_is_stale() {
        let mut watch = Watch::default();
        let results: [_; 60] =
            core::array::from_fn(|_| watch.step(&Estimate::default(), false, 0.5));
        assert_eq!(results[40], Ok(()));
        assert_eq!(results[59], Err(Fault::SonarStale));
    }
}
