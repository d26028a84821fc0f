//! Why a target or a calibration cannot do what was asked.

use std::fmt;

/// Why a target, or its ghost, cannot do what was asked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TargetError {
    /// The thread of the port at this address has ended: the robot is gone for good.
    PortEnded(String),
    /// The port is gone for now.
    PortGone,
    /// It has no USART for lines of text.
    NoTyping,
    /// Only an emulated chip takes lines of text.
    NoChip,
    /// It is a real robot, which only its own button resets.
    NoReset,
    /// The scenario or the world is none of those that the page was offered.
    NotOffered,
    /// The scenario cannot be set up, and why.
    Setup(String),
    /// The program of its chip does not compile.
    NotCompiled,
    /// There is no compiler for sketches.
    NoCompiler,
    /// It takes no program from a page.
    NoPrograms,
    /// Several robots share the world, and a program from a page is for one.
    Several,
    /// The name is not that of a program's file.
    NotAProgram,
    /// A debugger has its program.
    Debugged,
    /// No debugger holds its program, or a page may not ask that of it.
    NotDebugged,
    /// No ghost runs beside it.
    NoGhost,
    /// The log has no signals, so a ghost has nothing to follow.
    NoSignals,
    /// The log does not contain the robot's pose at that time.
    NoPose,
}

impl fmt::Display for TargetError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PortEnded(address) => {
                write!(
                    f,
                    "{address}: the thread of the port has ended; please report it"
                )
            }
            Self::PortGone => f.write_str("the port is gone"),
            Self::NoTyping => f.write_str("this robot takes no lines of text from here"),
            Self::NoChip => f.write_str("there is no emulated chip; start the lab with --firmware"),
            Self::NoReset => f.write_str("this is a real robot"),
            Self::NotOffered => {
                f.write_str("no such scenario or world here; choose one of the list")
            }
            Self::Setup(why) => f.write_str(why),
            Self::NotCompiled => f.write_str("the program does not compile; correct it and save"),
            Self::NoCompiler => f.write_str(
                "compiling a sketch needs rumbo on a computer; drop the .elf or .hex that a compiler made",
            ),
            Self::NoPrograms => f.write_str("this robot takes no program from a page"),
            Self::Several => f.write_str(
                "here are several robots, and a program from the page runs on one alone; set robots to 1, or choose a scenario with one",
            ),
            Self::NotAProgram => {
                f.write_str("only an .ino, .elf or .hex file is a program for the Mega")
            }
            Self::Debugged => f.write_str("a debugger has the program; end that first"),
            Self::NotDebugged => {
                f.write_str("the program is not being debugged, or a page may not ask that; begin with Debug")
            }
            Self::NoGhost => f.write_str("there is none; start with --ghost"),
            Self::NoSignals => f.write_str("the log has no signals"),
            Self::NoPose => f.write_str("the robot's pose at that time is not in the log"),
        }
    }
}

impl std::error::Error for TargetError {}

/// Why a calibration cannot start, or ended without a result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CalibrationError {
    /// The program around the session has no calibration.
    Missing,
    /// Another one drives the robot.
    Running,
    /// No robot answers.
    NoAnswer,
    /// The robot's table of parameters is another one.
    OtherParameters,
    /// The robot is armed.
    Armed,
    /// The operator stopped it.
    Stopped,
    /// The port is gone.
    PortGone,
    /// It gave up, and why.
    GivenUp(String),
}

impl fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str("this program has none"),
            Self::Running => f.write_str("one is running already"),
            Self::NoAnswer => f.write_str("no robot answers"),
            Self::OtherParameters => f.write_str("this robot has other parameters"),
            Self::Armed => f.write_str("the robot is armed: switch OFF first"),
            Self::Stopped => f.write_str("it was stopped"),
            Self::PortGone => f.write_str("the port is gone"),
            Self::GivenUp(why) => f.write_str(why),
        }
    }
}

impl std::error::Error for CalibrationError {}
