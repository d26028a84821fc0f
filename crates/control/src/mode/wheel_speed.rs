//! Mode 5: each wheel at a commanded speed, both directions, through zero (memoria 4.1).
//!
//! The mode hands its references to the wheel-speed loops of [`crate::drive`]; ramp, feedforward, PID and the passage
//! through zero are there, since every other mode uses them too.
//!
//! | state | when |
//! |---|---|
//! | 0 at rest | both references are zero: wheels released |
//! | 1 turning | otherwise |
//!
//! The report's controller is an equilibrium PWM of 50 plus a PI on a speed counted in 50 ms, in steps of 3.1 rpm. Ours knows
//! each wheel's friction (feedforward), times the edges, and acts every 10 ms: docs/theory/drive.md, docs/theory/wheel_speed.md. Worst of 20 simulated robots against the real one: 0 -> 60 rpm
//! in 0.32 s instead of 3.7, 0 -> -100 rpm in 0.44 s instead of 5.3 (`rumbo run mode5 --runs 20`).

use super::{Action, Mode, Situation};
use crate::types::{Drive, Fault, Wheels};

/// Names of the states.
#[cfg(feature = "names")]
pub const STATE_NAMES: [&str; 2] = ["at rest", "turning"];

/// Configuration of mode 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelSpeed {
    /// Speed references [rad/s].
    pub references: Wheels<f32>,
}

impl Mode for WheelSpeed {
    type State = ();

    fn act(&self, _: &mut (), _: &Situation, action: &mut Action) -> Result<(), Fault> {
        let turning = self.references != Wheels::both(0.0);
        if turning {
            action.drive = Drive::WheelSpeed(self.references);
        }
        action.state = u8::from(turning);
        Ok(())
    }
}
