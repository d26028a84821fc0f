//! What a session talks to: a robot behind a byte link, simulated, emulated or real.
//!
//! A [`Target`] lives in its own time. The session lets it live for a while ([`Target::advance`]), hands it the
//! bytes for the robot and takes the bytes that came back. Whatever is known of a simulated robot beyond those bytes comes
//! through [`Simulation`], and goes to the eyes only: commands and measurements take the link, as with a real robot.

use rumbo_control::Fault;
use rumbo_control::mode::ModeId;
use rumbo_log::{Choice, Manifest, MapPose, Scene, Truth};
use rumbo_wire::Command;

/// A robot at the other end of a byte link.
pub trait Target: Send {
    /// Time the target has lived since its start or last reset \[us\].
    fn now_us(&self) -> u64;

    /// Lets the target live for `dt_us` more. A real port has lived by itself and only updates its clock.
    ///
    /// # Errors
    /// When the target is gone for good; the message says what, where and the remedy.
    fn advance(&mut self, dt_us: u64) -> Result<(), String>;

    /// Hands over bytes for the robot. They are queued at the sending end of the link, in order.
    ///
    /// # Errors
    /// When the target is gone for good; the message says what, where and the remedy.
    fn send(&mut self, bytes: &[u8]) -> Result<(), String>;

    /// Appends the bytes that arrived from the robot since the last call.
    fn receive(&mut self, into: &mut Vec<u8>);

    /// Speed of the link \[baud\], ten bits to a byte.
    fn baud(&self) -> u32;

    /// What runs, for the log. When it began is put in by whoever records.
    fn manifest(&self) -> Manifest {
        Manifest::default()
    }

    /// What has become of the port since it was last asked, oldest first.
    fn news(&mut self) -> Option<LinkNews> {
        None
    }

    /// Where a simulated robot is that got the same bytes, in the world of [`Target::surroundings`].
    fn ghost(&self) -> Option<MapPose> {
        None
    }

    /// Puts the ghost where the robot is, from where it goes on by itself.
    ///
    /// # Errors
    /// There is no ghost.
    fn restart_ghost(&mut self, _at: Standing) -> Result<(), String> {
        Err("there is none; start with --ghost".into())
    }

    /// What surrounds the ghost, and so should surround the robot.
    fn surroundings(&mut self) -> Option<Scene> {
        None
    }

    /// What only a simulation can do and tell; `None` for a real robot.
    fn simulation(&mut self) -> Option<&mut dyn Simulation> {
        None
    }
}

/// What becomes of a port, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkNews {
    /// It is gone; it is waited for.
    Lost(String),
    /// It is back.
    Back(String),
    /// The ghost beside it has stopped by itself, and why.
    GhostFault(Fault),
}

/// The extras of a simulated robot, whose clock starts with [`Target::now_us`] at 0.
pub trait Simulation {
    /// What is really the case now.
    fn truth(&self) -> Truth;

    /// What surrounds the robot and what could be chosen instead; constant between resets.
    fn scene(&self) -> Scene;

    /// What a robot that has just started is told first: the mode and the setpoints of the experiment. Never to arm.
    fn first_commands(&self) -> Vec<Command> {
        Vec::new()
    }

    /// The mode of a robot that speaks the original's text on its link; `None` for one that speaks our frames.
    fn speaks_text(&self) -> Option<ModeId> {
        None
    }

    /// What the USARTs of an emulated chip have sent since the last call, with their numbers.
    fn consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        Vec::new()
    }

    /// Why the program of an emulated chip cannot go on, told once.
    fn ended(&mut self) -> Option<String> {
        None
    }

    /// What has happened to an emulated program from outside since the last call: a debugger that holds it, or lets it go.
    fn news(&mut self) -> Vec<String> {
        Vec::new()
    }

    /// Sends a line that a person typed to a USART of an emulated chip.
    ///
    /// # Errors
    /// There is no such chip.
    fn type_in(&mut self, _usart: u8, _line: &str) -> Result<(), String> {
        Err("there is no emulated chip; start the lab with --firmware".into())
    }

    /// Starts again from time 0 with the choice given.
    ///
    /// # Errors
    /// When the choice names something unknown or unreadable; the simulation then goes on as before.
    fn reset(&mut self, choice: &Choice) -> Result<(), String>;
}

/// Where a robot stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// In the world, as well as it is known.
    pub at: MapPose,
    /// From its origin, as it believes.
    pub told: MapPose,
}

/// The ghost of a log: a simulated robot that gets the bytes that went to the robot then.
pub trait Ghost: Send {
    /// A new one, at time 0.
    ///
    /// # Errors
    /// What keeps it from beginning.
    fn begin(&mut self) -> Result<(), String>;

    /// Lives on to this instant \[us\]; where it is then.
    ///
    /// # Errors
    /// What keeps it from living.
    fn live(&mut self, until_us: u64) -> Result<MapPose, String>;

    /// Stands here now.
    fn place(&mut self, standing: Standing);
}
