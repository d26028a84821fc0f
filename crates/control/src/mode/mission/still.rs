//! What moves before a sonar that stands: a range that was repeated, and drifts away from that.
//!
//! A robot that drives sees only what approaches ([`super::moving`]); one that stands also sees what passes or recedes.

use super::moving::Since;
use crate::math::abs;
use crate::types::{Range, SonarReading};

/// A beam stands if its axis turns by less from look to look [rad].
const STANDS_RAD: f32 = 0.02;
/// Ranges of one thing that stands differ by less, and from look to look those of one that moves [m].
const ALIKE_M: f32 = 0.03;
const JUMP_M: f32 = 0.06;
/// Farthest range that is judged [m].
const JUDGED_M: f32 = 1.2;
/// Looks that agree on a range, and looks in a row that then do not.
const AGREE: u8 = 2;
const DIFFER: u8 = 2;

/// The looks of one sonar while it stands. A silence is none: at a slanted face it comes and goes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Still {
    /// The range that is repeated, and the last one [m].
    range_m: f32,
    last_m: f32,
    /// Looks that agreed on that range, and looks in a row since then that did not.
    agree: u8,
    differ: u8,
}

impl Still {
    /// Ingests a look; says whether something moves.
    pub(super) fn ingest(&mut self, reading: &SonarReading, since: &Since) -> bool {
        let stands =
            since.rolled_m == 0.0 && since.turned_rad == 0.0 && since.aside_rad < STANDS_RAD;
        if !stands {
            self.agree = 0;
        }
        let Range::Valid(range_m) = reading.range else {
            return false;
        };
        let jumps = abs(range_m - self.last_m) > JUMP_M;
        self.last_m = range_m;
        if self.agree == 0 || jumps {
            (self.range_m, self.agree, self.differ) = (range_m, 1, 0);
            return false;
        }
        if abs(range_m - self.range_m) < ALIKE_M {
            self.agree = self.agree.saturating_add(1);
            self.differ = 0;
            return false;
        }
        self.differ += 1;
        if self.differ < DIFFER {
            return false;
        }
        let moves = self.agree >= AGREE && self.range_m < JUDGED_M;
        (self.range_m, self.agree, self.differ) = (range_m, 1, 0);
        moves
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::{SonarId, SonarView};

    /// Whether something moves at the last of these looks, between which the robot rolls so far; below 0: silence.
    fn moves(rolled_m: f32, ranges_m: &[f32]) -> bool {
        let mut still = Still::default();
        let mut moves = false;
        for range_m in ranges_m {
            let range = if *range_m < 0.0 {
                Range::Clear
            } else {
                Range::Valid(*range_m)
            };
            let reading = SonarReading {
                sonar: SonarId::Front,
                range,
                view: SonarView::default(),
                servo_rad: 0.0,
            };
            let since = Since {
                age_s: 0.06,
                rolled_m,
                turned_rad: 0.0,
                aside_rad: 0.0,
            };
            moves = still.ingest(&reading, &since);
        }
        moves
    }

    #[test]
    fn what_comes_or_goes_moves() {
        assert!(moves(0.0, &[0.8, 0.8, 0.76, 0.72]));
        assert!(moves(0.0, &[0.8, 0.81, 0.85, 0.9]));
        assert!(moves(0.0, &[0.8, 0.8, 0.76, -1.0, 0.72]));
        // 0.06 m/s.
        let slowly: [f32; 12] = core::array::from_fn(|look| 0.6 - 0.003_6 * look as f32);
        assert!((0..12).any(|looks| moves(0.0, &slowly[..looks])));
    }

    #[test]
    fn noise_silence_two_faces_and_what_was_never_seen_twice_do_not() {
        assert!(!moves(0.0, &[0.8, 0.82, 0.79, 0.81]));
        assert!(!moves(0.0, &[0.8, 0.8, -1.0, -1.0]));
        assert!(!moves(0.0, &[0.23, 0.23, 0.145, 0.145]));
        assert!(!moves(0.0, &[0.8, 0.75, 0.7, 0.65]));
        assert!(!moves(0.0, &[1.5, 1.5, 1.46, 1.42]), "too far to be judged");
    }

    #[test]
    fn a_robot_that_rolls_sees_nothing_move() {
        assert!(!moves(0.001, &[0.8, 0.8, 0.76, 0.72]));
    }
}
