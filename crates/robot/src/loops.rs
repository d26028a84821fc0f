//! What the loops of a tick add up.

use rumbo_control::drive::WheelTerms;
use rumbo_control::mode::ModeTerms;
use rumbo_control::{Drive, Wheels};

/// What the control loops add up, for people to see: on this machine only, since the link has no room for it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loops {
    /// Of the wheels' speeds; `None` for a wheel that is released or driven open loop.
    pub wheels: Wheels<Option<WheelTerms>>,
    /// What the mode's loops ask of the wheels, from the next tick on.
    pub request: Drive,
    /// Of the mode's own loops; `None` where it has none, or drives no wheel.
    pub mode: Option<ModeTerms>,
}
