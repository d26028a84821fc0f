//! Whether the sonars can be believed: a cut one is silent, a stuck one says the same wherever it looks.

use crate::estimate::Estimate;
use crate::math::abs;
use crate::types::{Fault, Range, TICK_S};

/// Impossible answers in a row that make a sonar faulty.
const FAULTY_AFTER: u8 = 3;
/// Equal answers in a row, while the robot moves, that make it stuck.
const STUCK_AFTER: u8 = 25;
/// Answers this equal are the same: the pulse is timed to 1 us, 0.17 mm [m].
const SAME_M: f32 = 0.000_3;
/// Way from answer to answer below which a standing robot hears the same [m].
const MOVED_M: f32 = 0.002;

/// Memory of the watch, by `SonarId` number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Watch {
    faulty: [u8; 3],
    same: [u8; 3],
    last_m: [f32; 3],
    age_s: [f32; 3],
    /// Way rolled since the last answer of each [m].
    rolled_m: [f32; 3],
}

impl Watch {
    /// One tick.
    ///
    /// # Errors
    /// What is wrong with a sonar.
    pub(super) fn step(&mut self, estimate: &Estimate, stale_s: f32) -> Result<(), Fault> {
        for age_s in &mut self.age_s {
            *age_s += TICK_S;
            if *age_s > stale_s {
                return Err(Fault::SonarStale);
            }
        }
        for rolled_m in &mut self.rolled_m {
            *rolled_m += abs(estimate.rolled_m);
        }
        let Some(reading) = estimate.reading else {
            return Ok(());
        };
        let number = reading.sonar as usize;
        let slots = (
            self.faulty.get_mut(number),
            self.same.get_mut(number),
            self.last_m.get_mut(number),
            self.age_s.get_mut(number),
            self.rolled_m.get_mut(number),
        );
        let (Some(faulty), Some(same), Some(last_m), Some(age_s), Some(rolled_m)) = slots else {
            return Ok(());
        };
        *age_s = 0.0;
        let way_m = core::mem::take(rolled_m);
        match reading.range {
            Range::Faulty => *faulty = faulty.saturating_add(1),
            Range::Clear => {
                *faulty = 0;
                *same = 0;
            }
            Range::Valid(range_m) => {
                *faulty = 0;
                if abs(range_m - *last_m) > SAME_M {
                    *same = 0;
                } else if way_m > MOVED_M {
                    *same = same.saturating_add(1);
                }
                *last_m = range_m;
            }
        }
        if *faulty >= FAULTY_AFTER || *same >= STUCK_AFTER {
            return Err(Fault::SonarFaulty);
        }
        Ok(())
    }
}
