//! Why a target or a calibration cannot do what was asked.

use thiserror::Error;

/// Why a target, or its ghost, cannot do what was asked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TargetError {
    /// The thread of the port at this address has ended: the robot is gone for good.
    #[error("{0}: the thread of the port has ended; please report it")]
    PortEnded(String),
    /// The port is gone for now.
    #[error("the port is gone")]
    PortGone,
    /// It has no USART for lines of text.
    #[error("this robot takes no lines of text from here")]
    NoTyping,
    /// Only an emulated chip takes lines of text.
    #[error("there is no emulated chip; start the lab with --firmware")]
    NoChip,
    /// It is a real robot, which only its own button resets.
    #[error("this is a real robot")]
    NoReset,
    /// The scenario or the world is none of those that the page was offered.
    #[error("no such scenario or world here; choose one of the list")]
    NotOffered,
    /// The scenario cannot be set up, and why.
    #[error("{0}")]
    Setup(String),
    /// The program of its chip does not compile.
    #[error("the program does not compile; correct it and save")]
    NotCompiled,
    /// There is no compiler for sketches.
    #[error(
        "compiling a sketch needs rumbo on a computer; drop the .elf or .hex that a compiler made"
    )]
    NoCompiler,
    /// It takes no program from a page.
    #[error("this robot takes no program from a page")]
    NoPrograms,
    /// Several robots share the world, and a program from a page is for one.
    #[error(
        "here are several robots, and a program from the page runs on one alone; set robots to 1, or choose a \
         scenario with one"
    )]
    Several,
    /// The name is not that of a program's file.
    #[error("only an .ino, .elf or .hex file is a program for the Mega")]
    NotAProgram,
    /// A debugger has its program.
    #[error("a debugger has the program; end that first")]
    Debugged,
    /// No debugger holds its program, or a page may not ask that of it.
    #[error("the program is not being debugged, or a page may not ask that; begin with Debug")]
    NotDebugged,
    /// No ghost runs beside it.
    #[error("there is none; start with --ghost")]
    NoGhost,
    /// The log has no signals, so a ghost has nothing to follow.
    #[error("the log has no signals")]
    NoSignals,
    /// The log does not contain the robot's pose at that time.
    #[error("the robot's pose at that time is not in the log")]
    NoPose,
}

/// Why a calibration cannot start, or ended without a result.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CalibrationError {
    /// The program around the session has no calibration.
    #[error("this program has none")]
    Missing,
    /// Another one drives the robot.
    #[error("one is running already")]
    Running,
    /// No robot answers.
    #[error("no robot answers")]
    NoAnswer,
    /// The robot's table of parameters is another one.
    #[error("this robot has other parameters")]
    OtherParameters,
    /// The robot is armed.
    #[error("the robot is armed: switch OFF first")]
    Armed,
    /// The operator stopped it.
    #[error("it was stopped")]
    Stopped,
    /// The port is gone.
    #[error("the port is gone")]
    PortGone,
    /// It gave up, and why.
    #[error("{0}")]
    GivenUp(String),
}
