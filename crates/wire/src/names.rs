//! Texts for people: explanations with the remedy.

use rumbo_control::Fault;

use crate::message::{EventKind, Recalled, Refusal, ResetCause};
use core::fmt;

impl Refusal {
    /// Why the command was refused and what to do.
    pub const fn explanation(self) -> &'static str {
        match self {
            Refusal::NotFinite => "the value is not a finite number; send a number",
            Refusal::OutOfRange => {
                "the value is outside the allowed range; see the limits with `rumbo list`"
            }
            Refusal::UnknownParam => "no such parameter; see `rumbo list`",
            Refusal::NotInThisMode => {
                "the selected mode takes no such command; select the mode that does"
            }
            Refusal::Armed => "not while armed; disarm first",
            Refusal::Faulted => "a fault is latched; remove its cause and clear it first",
            Refusal::SonarNotReady => {
                "the sonar this mode needs gives no good reading; check its wiring"
            }
            Refusal::NoLink => "no heartbeat arrives at the robot; connect, then arm again",
            Refusal::Malformed => {
                "the robot did not understand the command; use the same version at both ends"
            }
            Refusal::BatteryLow => "the battery is low; charge it",
            Refusal::TooOld => {
                "it is too old: given more than 2 s ago, or before the robot started again; give the order again"
            }
            Refusal::NoWall => {
                "no wall within reach of the sonar this mode needs; put the robot within 2.5 m of one"
            }
            Refusal::NoPolicy => {
                "the robot has no policy, or a damaged one; give one with --policy, to `rumbo flash` for a real robot"
            }
            Refusal::WrongRig => {
                "the robot's sonars do not sit where this mode needs them; mount them so and set the parameter `rig`"
            }
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.explanation())
    }
}

impl ResetCause {
    /// Why the robot's program started.
    pub const fn explanation(self) -> &'static str {
        match self {
            ResetCause::PowerOn => "power on",
            ResetCause::External => "reset button or serial adapter",
            ResetCause::BrownOut => "the supply dipped; charge the battery, check the cables",
            ResetCause::Watchdog => "the watchdog: the program hung; please report it",
        }
    }
}

impl Recalled {
    /// What the robot started with, and what to do.
    pub const fn explanation(self) -> &'static str {
        match self {
            Recalled::First => "in force since the start, from the first copy",
            Recalled::Second => "in force since the start, from the second copy",
            Recalled::FirstAlone => {
                "in force since the start, from the first copy; the second is damaged or of another version: save again"
            }
            Recalled::SecondAlone => {
                "in force since the start, from the second copy; the first is damaged or of another version: save again"
            }
            Recalled::Neither => {
                "not used: both copies are damaged or of another version; the defaults are in force: set the parameters and save"
            }
        }
    }
}

impl EventKind {
    /// What happened, in a few words.
    pub const fn title(self) -> &'static str {
        match self {
            EventKind::Armed => "armed",
            EventKind::Disarmed => "disarmed",
            EventKind::Faulted(_) => "fault",
            EventKind::Cleared(_) => "fault cleared",
            EventKind::ModeChanged(_) => "mode changed",
            EventKind::Reached => "setpoint reached",
            EventKind::Unreachable => "goal unreachable",
            EventKind::GaveUp { .. } => "gave up",
            EventKind::Recalled(_) => "saved parameters",
            EventKind::Saved => "parameters saved on the robot",
        }
    }

    /// Its subject: the fault's explanation or the mode's name.
    pub const fn detail(self) -> Option<&'static str> {
        match self {
            EventKind::Faulted(fault) | EventKind::Cleared(fault) => {
                Some(Fault::explanation(fault))
            }
            EventKind::ModeChanged(mode) => Some(mode.name()),
            EventKind::Unreachable => {
                Some("every way round was tried; give another goal, or clear the way")
            }
            EventKind::GaveUp { .. } => {
                Some("no way was found in time; raise mission_give_up_s, or give another goal")
            }
            EventKind::Recalled(recalled) => Some(recalled.explanation()),
            EventKind::Armed | EventKind::Disarmed | EventKind::Reached | EventKind::Saved => None,
        }
    }
}
