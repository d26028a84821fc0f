//! Why a calibration failed; the robot has been stopped.

use rumbo_control::Fault;
use rumbo_control::mode::ModeId;
use rumbo_wire::{Command, Refusal};
use thiserror::Error;

/// What went wrong.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CalibrateError {
    /// The robot does not answer.
    #[error("the robot does not answer; check the link")]
    NoAnswer,
    /// It refused a command.
    #[error("{what} was refused: {why}", what = .0.in_words(ModeId::Manual), why = .1.explanation())]
    Refused(Command, Refusal),
    /// A fault latched.
    #[error("the robot stopped: {why}", why = .0.explanation())]
    Faulted(Fault),
    /// The robot carries another rig than the final one.
    #[error(
        "a calibration needs a sonar ahead and one on each side; mount the rig `final` and set the parameter rig"
    )]
    WrongRig,
    /// No side sonar sees a wall at a fitting distance; the ranges of the left and the right one [m].
    #[error(
        "no wall beside the robot (left {left}, right {right}); put it 0.3 to 0.5 m beside a wall, along it, with \
         2.5 m free ahead",
        left = shown(.0[0]), right = shown(.0[1])
    )]
    NoWall([Option<f32>; 2]),
    /// A movement took too long.
    #[error("{0} took too long; is the robot held, or its battery empty?")]
    TooSlow(&'static str),
    /// There is not enough room along the wall; the free distance [m].
    #[error("only {0:.2} m free along the wall; give it at least 1 m, better 2.5 m")]
    TooShort(f64),
    /// The measurements do not determine this quantity.
    #[error(
        "the measurements do not determine {0}; is the wall straight, is the robot free to move, and do both \
         wheels turn forward? Check the robot tells"
    )]
    NotDetermined(&'static str),
}

fn shown(range: Option<f32>) -> String {
    range.map_or("nothing".to_owned(), |range_m| format!("{range_m:.2} m"))
}
