//! Whether a sonar is stuck: its answers stay the same although it moves.
//!
//! The same echo is not the same number: a board's stamps differ by a microsecond, and now and then by more. So an
//! answer repeats another if it is as long within a microsecond, and one that differs takes repetitions away instead of
//! all of them.

use crate::math::{abs, clamp};

/// Answers this near to each other are the same: a microsecond is 0.17 mm [m].
const SAME_M: f32 = 0.000_2;
/// Repetitions of a sonar that is stuck, and what one answer that differs takes away. Beside a parallel wall a healthy
/// one repeats itself in at most three of ten readings: so many come about once in ten million.
const REPEATED: u8 = 14;
const DIFFERS: u8 = 2;
/// Repetitions that suffice once the robot has come this much nearer to the target [m].
const SOON: (u8, f32) = (3, 0.04);

/// The answers of one sonar.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stuck {
    /// The answer that is repeated [m].
    range_m: f32,
    repeated: u8,
    /// How much nearer the sonar has come since [m].
    closer_m: f32,
}

impl Stuck {
    /// Takes an answer; since the last one the sonar `moved`, and came `closer_m` nearer to the target. Returns whether it is
    /// stuck.
    pub fn ingest(&mut self, range_m: f32, moved: bool, closer_m: f32) -> bool {
        self.closer_m = clamp(self.closer_m + closer_m, -1.0, 1.0);
        if abs(range_m - self.range_m) > SAME_M {
            if self.repeated == 0 {
                (self.range_m, self.closer_m) = (range_m, 0.0);
            }
            self.repeated = self.repeated.saturating_sub(DIFFERS);
        } else if moved && self.repeated < REPEATED {
            self.repeated += 1;
        }
        let (soon, closer_m) = SOON;
        self.repeated >= REPEATED || (self.repeated >= soon && abs(self.closer_m) >= closer_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After how many answers it is stuck.
    fn stuck_after(answer: impl Fn(u32) -> f32, moved: bool, closer_m: f32) -> Option<u32> {
        let mut stuck = Stuck::default();
        (0..10_000).find(|step| stuck.ingest(answer(*step), moved, closer_m))
    }

    #[test]
    fn the_same_answer_is_stuck_if_the_robot_moves_and_a_wall_if_it_stands() {
        assert_eq!(stuck_after(|_| 0.8, true, 0.0), Some(14));
        assert_eq!(stuck_after(|_| 0.8, true, 0.02), Some(3));
        assert_eq!(stuck_after(|_| 0.8, false, 0.0), None);
    }

    #[test]
    fn stamps_that_differ_delay_little() {
        // Between two microseconds, and with a late stamp in every eighth answer.
        let answer = |step: u32| 0.8 + 0.000_17 * f32::from(u8::from(step.is_multiple_of(2)));
        assert_eq!(stuck_after(answer, true, 0.0), Some(14));
        let late = |step: u32| answer(step) + if step % 8 == 7 { 0.004 } else { 0.0 };
        assert!(stuck_after(late, true, 0.0).is_some_and(|step| step < 26));
        assert!(stuck_after(late, true, 0.02).is_some_and(|step| step < 8));
    }

    #[test]
    fn a_wall_that_comes_nearer_and_noise_beside_one_are_no_stuck_sonar() {
        let nearer = |step: u32| 1.0 - 0.000_3 * (step % 3_000) as f32;
        assert_eq!(stuck_after(nearer, true, 0.000_3), None);
        // One in four repeats.
        let noise =
            |step: u32| 0.3 + 0.000_5 * ((step.wrapping_mul(2_654_435_761) >> 28) % 4) as f32;
        assert_eq!(stuck_after(noise, true, 0.0), None);
    }
}
