//! Why a calibration failed; the robot has been stopped.

use rumbo_control::Fault;
use rumbo_control::mode::ModeId;
use rumbo_wire::{Command, Refusal};
use std::fmt;

/// What went wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum CalibrateError {
    /// The robot does not answer.
    NoAnswer,
    /// It refused a command.
    Refused(Command, Refusal),
    /// A fault latched.
    Faulted(Fault),
    /// The robot carries another rig than the final one.
    WrongRig,
    /// No side sonar sees a wall at a fitting distance; the ranges of the left and the right one [m].
    NoWall([Option<f32>; 2]),
    /// A movement took too long.
    TooSlow(&'static str),
    /// There is not enough room along the wall; the free distance [m].
    TooShort(f64),
    /// The measurements do not determine this quantity.
    NotDetermined(&'static str),
}

impl fmt::Display for CalibrateError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAnswer => write!(f, "the robot does not answer; check the link"),
            Self::Refused(command, refusal) => {
                let what = command.in_words(ModeId::Manual);
                write!(f, "{what} was refused: {}", refusal.explanation())
            }
            Self::Faulted(fault) => write!(f, "the robot stopped: {}", fault.explanation()),
            Self::WrongRig => write!(
                f,
                "a calibration needs a sonar ahead and one on each side; mount the rig `final` and set the parameter rig"
            ),
            Self::NoWall(ranges) => {
                let word = |range: Option<f32>| {
                    range.map_or("nothing".to_owned(), |range_m| format!("{range_m:.2} m"))
                };
                write!(
                    f,
                    "no wall beside the robot (left {}, right {}); put it 0.3 to 0.5 m beside a wall, along it, with 2.5 m free ahead",
                    word(ranges[0]),
                    word(ranges[1])
                )
            }
            Self::TooSlow(what) => write!(
                f,
                "{what} took too long; is the robot held, or its battery empty?"
            ),
            Self::TooShort(way_m) => write!(
                f,
                "only {way_m:.2} m free along the wall; give it at least 1 m, better 2.5 m"
            ),
            Self::NotDetermined(what) => write!(
                f,
                "the measurements do not determine {what}; is the wall straight, is the robot free to move, and do both wheels turn forward? Check the robot tells"
            ),
        }
    }
}

impl std::error::Error for CalibrateError {}
