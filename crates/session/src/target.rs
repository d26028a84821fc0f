//! What a session is with: a robot behind a byte link, simulated, emulated or real, or a log of one.
//!
//! A [`Target`] lives in its own time. Whoever drives the session lets it live for a while ([`Target::advance`]), hands
//! it the bytes for the robot and takes the bytes that came back. What it can do besides it says itself
//! ([`Target::abilities`]); what is known of a robot beyond those bytes goes to the eyes only: commands and
//! measurements take the link.

use rumbo_control::Fault;
use rumbo_control::mode::ModeId;
use rumbo_log::{Choice, Manifest, MapPose, Scene, Truth};
use rumbo_wire::Command;

/// What can be done with a target besides speaking to its robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abilities {
    /// Its time goes as fast as is asked for, or not at all; otherwise it is that of the wall clock.
    pub pace: bool,
    /// It starts again with another scenario, world, rig or seed ([`Target::reset`]).
    pub reset: bool,
    /// The robot's clock starts with the target's.
    pub clock: bool,
    /// The robot is at a port, where bytes are lost, make no sense or are too many: that is watched.
    pub port: bool,
    /// Lines can be typed to its USARTs ([`Target::type_in`]).
    pub typing: bool,
    /// The robot speaks the original's text, and is in this mode at first.
    pub text: Option<ModeId>,
}

impl Default for Abilities {
    /// Those of a robot at a port.
    fn default() -> Self {
        Self {
            pace: false,
            reset: false,
            clock: false,
            port: true,
            typing: false,
            text: None,
        }
    }
}

/// What a session is to know of its target, from its start or reset on.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// What can be done with it.
    pub abilities: Abilities,
    /// Speed of the link \[baud\].
    pub baud: u32,
    /// What a robot that has just started is sent first.
    pub first_commands: Vec<Command>,
    /// What surrounds the robot, or the ghost.
    pub scene: Option<Scene>,
}

impl About {
    /// What a target says of itself.
    pub fn of(target: &dyn Target) -> Self {
        Self {
            abilities: target.abilities(),
            baud: target.baud(),
            first_commands: target.first_commands(),
            scene: target.scene(),
        }
    }
}

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

    /// What can be done with it; constant between resets.
    fn abilities(&self) -> Abilities {
        Abilities::default()
    }

    /// What runs, for the log. When it began is put in by whoever records.
    fn manifest(&self) -> Manifest {
        Manifest::default()
    }

    /// What has happened to it since it was last asked, oldest first.
    fn news(&mut self) -> Option<LinkNews> {
        None
    }

    /// What is really the case now, where that is known.
    fn truth(&self) -> Option<Truth> {
        None
    }

    /// What surrounds the robot, or the ghost and so should surround the robot, and what could be chosen instead;
    /// constant between resets.
    fn scene(&self) -> Option<Scene> {
        None
    }

    /// What a robot that has just started is sent first: the mode and the setpoints of the experiment. Never to arm.
    fn first_commands(&self) -> Vec<Command> {
        Vec::new()
    }

    /// What the USARTs of an emulated chip have sent since the last call, with their numbers.
    fn consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        Vec::new()
    }

    /// Sends a line that a person typed to a USART.
    ///
    /// # Errors
    /// There is no such chip.
    fn type_in(&mut self, _usart: u8, _line: &str) -> Result<(), String> {
        Err("this robot takes no lines of text from here".into())
    }

    /// Starts again from time 0 with the choice given.
    ///
    /// # Errors
    /// When the choice names something unknown or unreadable; the target then goes on as before.
    fn reset(&mut self, _choice: &Choice) -> Result<(), String> {
        Err("this is a real robot".into())
    }

    /// Where a simulated robot is that got the same bytes, in the world of [`Target::scene`].
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
}

/// What happens to a target, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkNews {
    /// The port is gone; it is waited for.
    Lost(String),
    /// The port is back.
    Back(String),
    /// The ghost beside the robot has stopped by itself, and why.
    GhostFault(Fault),
    /// A program was held or let go from outside: by a debugger.
    Held(String),
    /// A program cannot go on, and why.
    Ended(String),
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
