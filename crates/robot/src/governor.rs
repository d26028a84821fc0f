//! The last check of the duty: whatever was decided above, what leaves here does no harm.
//!
//! | rule | reason |
//! |---|---|
//! | not armed: released | a slip in any mode must not turn a wheel |
//! | never from one direction into the other: a tick released in between | the current of a motor's winding dies first (L/R is 0.3 ms), and the bridge's halves never meet |

use rumbo_control::{Duty, SIDES, Wheels};

/// Keeps the last output.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Governor {
    last: Wheels<Duty>,
}

impl Governor {
    /// The part of `wanted` that may leave.
    pub(crate) fn pass(&mut self, wanted: Wheels<Duty>, armed: bool) -> Wheels<Duty> {
        let mut passed = Wheels::both(Duty::RELEASED);
        if armed {
            for &side in &SIDES {
                let (was, is) = (self.last[side].counts(), wanted[side].counts());
                if was == 0 || is == 0 || (was < 0) == (is < 0) {
                    passed[side] = wanted[side];
                }
            }
        }
        self.last = passed;
        passed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn both(counts: i16) -> Wheels<Duty> {
        Wheels::both(Duty::new(counts))
    }

    #[test]
    fn a_disarmed_robot_drives_no_wheel_whatever_is_wanted() {
        let mut governor = Governor::default();
        assert_eq!(governor.pass(both(200), false), both(0));
        assert_eq!(governor.pass(both(200), true), both(200));
        assert_eq!(governor.pass(both(-1), false), both(0));
    }

    #[test]
    fn a_wheel_is_released_for_a_tick_before_it_is_driven_the_other_way() {
        let mut governor = Governor::default();
        let passed = [100, 50, -50, -50, 1, 1].map(|counts| governor.pass(both(counts), true));
        assert_eq!(passed, [100, 50, 0, -50, 0, 1].map(both));
    }
}
