//! Brings wheels that only coast down to rest at a goal: the speed on the way, and the moment of release.
//!
//! ```text
//! speed = sqrt(2 a (left - speed measured * lag))          released when   left <= speed^2 / (2 a_coast) + speed * delay
//! ```
//!
//! `a` is a deceleration that friction gives on any floor; `lag` is the lag of the speed loops behind a falling
//! reference. The end is left to friction alone; a remainder beyond the tolerance is driven once more, a few times at
//! most. The unit is that of the goal: m along a line, rad in a turn.

use crate::math::{max, sqrt};
use crate::params::{ParamId, Params};

/// Delay between the request to release and the bridge's release, in which the wheel rolls on at its speed: the latch
/// of the inputs, a tick in which the mode decides, 3 ms to the outputs, and half a pole of the encoder at creeping
/// speed [s].
const RELEASE_DELAY_S: f32 = 0.025;

/// Configuration of a stop; per second and second squared of the goal's unit.
#[derive(Clone, Copy, Debug)]
pub struct Stop<'a> {
    params: &'a Params,
    /// Planned deceleration.
    brake: ParamId,
    /// Deceleration of the released wheels at creeping speed.
    coast: ParamId,
    /// Tolerance at the end.
    tolerance: ParamId,
    /// Attempts before the remainder is accepted.
    most_tries: u8,
}

/// State of a stop; the default is the start of a drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopState {
    coasting: bool,
    tries: u8,
}

/// What to do now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopping {
    /// Drive on.
    Drive,
    /// The wheels are released.
    Coast,
    /// The wheels stand, near enough or after the last try.
    Done,
}

impl<'a> Stop<'a> {
    /// At the end of a line [m].
    pub fn on_the_way(params: &'a Params) -> Self {
        Self {
            params,
            brake: ParamId::LineBrake,
            coast: ParamId::LineCoast,
            tolerance: ParamId::LineTolerance,
            most_tries: 3,
        }
    }

    /// At the end of a turn [rad].
    pub fn of_a_turn(params: &'a Params) -> Self {
        Self {
            params,
            brake: ParamId::TurnBrake,
            coast: ParamId::TurnCoast,
            tolerance: ParamId::TurnTolerance,
            most_tries: 4,
        }
    }

    /// Planned deceleration.
    pub fn brake(&self) -> f32 {
        self.params.get(self.brake)
    }

    /// Lag of the wheels [s].
    pub fn lag_s(&self) -> f32 {
        self.params.get(ParamId::SpeedLag)
    }

    /// The speed from which the robot can still stop at the goal.
    pub fn speed(&self, left: f32, measured: f32) -> f32 {
        sqrt(2.0 * self.brake() * (left - self.lag_s() * max(measured, 0.0)))
    }

    /// One tick: `left` is the distance left (negative beyond the goal), `measured` the speed towards it, `standing`
    /// whether both wheels stand.
    pub fn step(
        &self,
        state: &mut StopState,
        left: f32,
        measured: f32,
        standing: bool,
    ) -> Stopping {
        let tolerance = self.params.get(self.tolerance);
        if state.coasting && standing {
            if left <= tolerance || state.tries >= self.most_tries {
                return Stopping::Done;
            }
            state.coasting = false;
        }
        let speed = max(measured, 0.0);
        let coast = speed * speed / (2.0 * self.params.get(self.coast)) + speed * RELEASE_DELAY_S;
        if !state.coasting && left <= max(coast, 0.5 * tolerance) {
            state.coasting = true;
            state.tries = state.tries.saturating_add(1);
        }
        if state.coasting {
            Stopping::Coast
        } else {
            Stopping::Drive
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_can_be_braked_before_the_goal_even_when_the_loops_follow_late() {
        let params = Params::default();
        let stop = Stop::on_the_way(&params);
        for millimetres in 1..1_000u16 {
            let left = f32::from(millimetres) * 1e-3;
            let speed = stop.speed(left, 0.3);
            assert!(speed * speed / (2.0 * stop.brake()) <= max(left - 0.03, 0.0) * 1.000_1);
        }
    }

    #[test]
    fn the_wheels_are_released_when_they_would_coast_there_and_not_before() {
        let params = Params::default();
        let stop = Stop::on_the_way(&params);
        let coast = 0.04 / (2.0 * params.get(stop.coast)) + 0.2 * RELEASE_DELAY_S;
        let mut state = StopState::default();
        let mut at = |left| stop.step(&mut state, left, 0.2, false);
        assert_eq!(at(coast + 0.001), Stopping::Drive);
        assert_eq!(at(coast - 0.001), Stopping::Coast);
    }

    #[test]
    fn what_is_missing_is_driven_once_more_but_not_for_ever() {
        let params = Params::default();
        let stop = Stop::on_the_way(&params);
        let mut state = StopState::default();
        for _ in 0..stop.most_tries {
            assert_eq!(stop.step(&mut state, 0.02, 0.0, true), Stopping::Drive);
            assert_eq!(stop.step(&mut state, 0.001, 0.03, false), Stopping::Coast);
        }
        // Pushed back each time: the remainder is accepted.
        assert_eq!(stop.step(&mut state, 0.02, 0.0, true), Stopping::Done);
    }

    #[test]
    fn a_goal_that_was_passed_is_done_when_the_wheels_stand() {
        let params = Params::default();
        let stop = Stop::on_the_way(&params);
        let mut state = StopState::default();
        assert_eq!(stop.step(&mut state, -0.01, 0.1, false), Stopping::Coast);
        assert_eq!(stop.step(&mut state, -0.02, 0.0, true), Stopping::Done);
    }
}
