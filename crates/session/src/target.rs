//! The other end of a session: a robot behind a byte link, simulated, emulated or real, or a log of one.
//!
//! A [`Target`] has its own time. The driver of the session advances it ([`Target::advance`]), hands it the bytes for
//! the robot and takes the bytes that came back. It reports its other abilities itself ([`Target::abilities`]). What is
//! known of a robot beyond those bytes is only displayed: commands and measurements take the link.

use crate::error::TargetError;
use crate::program::{GivenProgram, ShownSketch};
use crate::world::EditedWorld;
use rumbo_control::Fault;
use rumbo_control::mode::ModeId;
use rumbo_control::params::Params;
use rumbo_log::{
    Burst, Choice, ExperimentState, Level, Manifest, MapPose, ProgramState, ReadingSource, Scene,
    Truth,
};
use rumbo_wire::Command;
use serde_json::Value;

/// What can be done with a target besides speaking to its robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Abilities {
    /// Its time runs at the requested speed, or is paused; otherwise it is that of the wall clock.
    pub pace: bool,
    /// It can restart with another scenario, world, rig or seed ([`Target::reset`]).
    pub reset: bool,
    /// The robot's clock starts with the target's.
    pub clock: bool,
    /// The robot is at a port, where bytes may be lost, undecodable or too many: that is watched.
    pub port: bool,
    /// Lines can be typed to its USARTs ([`Target::type_in`]).
    pub typing: bool,
    /// Its program may ignore STOP, and the supply of its motors can be cut ([`Target::supply_motors`]).
    pub cut_off: bool,
    /// Its scenario can command it ([`Target::play`]).
    pub play: bool,
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
            cut_off: false,
            play: false,
            text: None,
        }
    }
}

/// The properties of a target, constant from its start or reset.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// What can be done with it.
    pub abilities: Abilities,
    /// Speed of the link \[baud\].
    pub baud: u32,
    /// Commands sent first to a robot that has just started.
    pub first_commands: Vec<Command>,
    /// What surrounds the robot, or the ghost.
    pub scene: Option<Scene>,
    /// The robot's parameters at its start, where the target tells them.
    pub parameters: Option<Params>,
}

impl About {
    /// The properties of this target.
    pub fn of(target: &(impl Target + ?Sized)) -> Self {
        Self {
            abilities: target.abilities(),
            baud: target.baud(),
            first_commands: target.first_commands(),
            scene: target.scene(),
            parameters: target.parameters(),
        }
    }
}

/// Signals by name, the unit last, and where they come from. Not a number: unknown; infinite: a sonar without an echo.
pub type Shown = (ReadingSource, Vec<(String, f64)>);

/// A robot at the other end of a byte link.
pub trait Target: Send {
    /// The target's time since its start or last reset \[us\].
    fn now_us(&self) -> u64;

    /// Advances the target by `dt_us`. A real port runs by itself and only updates its clock.
    ///
    /// # Errors
    /// When the target is gone for good.
    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError>;

    /// Queues bytes for the robot at the sending end of the link, in order.
    ///
    /// # Errors
    /// When the target is gone for good.
    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError>;

    /// Appends the bytes that arrived from the robot since the last call.
    fn receive(&mut self, into: &mut Vec<u8>);

    /// Speed of the link \[baud\], ten bits to a byte.
    fn baud(&self) -> u32;

    /// What can be done with it; constant between resets.
    fn abilities(&self) -> Abilities {
        Abilities::default()
    }

    /// What runs, for the log. The recorder adds the start time.
    fn manifest(&self) -> Manifest {
        Manifest::default()
    }

    /// What has happened to it since the last call, oldest first.
    fn news(&mut self) -> Option<LinkNews> {
        None
    }

    /// The ground truth now, where it is known.
    fn truth(&self) -> Option<Truth> {
        None
    }

    /// What is shown of the robot beside its telemetry, if a reading is due: ground truth and pins of an emulated one,
    /// terms of the control loops of our simulated one.
    fn shown(&mut self) -> Vec<Shown> {
        Vec::new()
    }

    /// The robot's surroundings (or those of its ghost, in which the robot should be), and the alternatives to choose
    /// from; constant between resets.
    fn scene(&self) -> Option<Scene> {
        None
    }

    /// Commands sent first to a robot that has just started: the mode and the setpoints of the experiment, never ON.
    fn first_commands(&self) -> Vec<Command> {
        Vec::new()
    }

    /// What the USARTs of an emulated chip have sent since the last call, with their numbers.
    fn consoles(&mut self) -> Vec<(u8, Vec<u8>)> {
        Vec::new()
    }

    /// The program of an emulated robot.
    fn program(&self) -> Option<ProgramState> {
        None
    }

    /// Sends to a USART what a person typed, with the end of its line.
    ///
    /// # Errors
    /// If there is no such chip.
    fn type_in(&mut self, _usart: u8, _text: &str) -> Result<(), TargetError> {
        Err(TargetError::NoTyping)
    }

    /// Starts again from time 0, commanded by its scenario; these are the parameters of the robot as it was. Bytes that are
    /// sent do not reach the robot until the scenario is over or [`Target::end_play`].
    ///
    /// # Errors
    /// Why it cannot; the target then continues as before.
    fn play(&mut self, _parameters: &[(u8, f32)]) -> Result<(), TargetError> {
        Err(TargetError::NoReset)
    }

    /// The scenario commands it no longer. To be called again and again.
    fn end_play(&mut self) {}

    /// The scenario that commands it, or has done so since its start.
    fn experiment(&self) -> Option<ExperimentState> {
        None
    }

    /// What the scenario has sent since the last call.
    fn scripted(&mut self) -> Vec<Burst> {
        Vec::new()
    }

    /// The robot's parameters at its start, where they are known without asking the robot.
    fn parameters(&self) -> Option<Params> {
        None
    }

    /// Cuts the supply of the motors, or gives it back; it is there at a start. Only where [`Abilities::cut_off`] says so.
    fn supply_motors(&mut self, _on: bool) {}

    /// Runs another program as soon as it is compiled.
    ///
    /// # Errors
    /// If this robot takes none.
    fn run_program(&mut self, _program: GivenProgram) -> Result<(), TargetError> {
        Err(TargetError::NoPrograms)
    }

    /// The source of its program, or of an example by its name.
    fn sketch(&mut self, _example: Option<&str>) -> ShownSketch {
        ShownSketch::default()
    }

    /// A request of the Debug Adapter Protocol to the debugger of its program; [`Target::take_debug`] has the response.
    ///
    /// # Errors
    /// If none holds the program, or the request is none of those that a page may give.
    fn ask_debugger(&mut self, _request: &Value) -> Result<(), TargetError> {
        Err(TargetError::NotDebugged)
    }

    /// What the debugger has said since the last call.
    fn take_debug(&mut self) -> Vec<Value> {
        Vec::new()
    }

    /// Counts the cycles of the program of an emulated chip from zero, or no longer; [`Target::program`] shows them.
    ///
    /// # Errors
    /// If there is no such chip.
    fn profile(&mut self, _on: bool) -> Result<(), TargetError> {
        Err(TargetError::NoChip)
    }

    /// Starts again from time 0 with the choice given.
    ///
    /// # Errors
    /// When the choice names something unknown or unreadable; the target then continues as before.
    fn reset(&mut self, _choice: &Choice) -> Result<(), TargetError> {
        Err(TargetError::NoReset)
    }

    /// The world in which it drives as one to edit, or the one given, checked.
    fn world(&mut self, _given: Option<&str>) -> EditedWorld {
        EditedWorld {
            problem: Some(TargetError::NoReset.to_string()),
            ..EditedWorld::default()
        }
    }

    /// Starts again from time 0 in the world given; returns what runs then.
    ///
    /// # Errors
    /// What is wrong with it; the target then continues as before.
    fn drive_in(&mut self, _world: &str) -> Result<Choice, TargetError> {
        Err(TargetError::NoReset)
    }

    /// Ground truth of a simulated robot that received the same bytes, in the world of [`Target::scene`].
    fn ghost(&self) -> Option<Truth> {
        None
    }

    /// Moves the ghost to the robot's pose, from where it continues by itself.
    ///
    /// # Errors
    /// If there is no ghost.
    fn restart_ghost(&mut self, _at: Standing) -> Result<(), TargetError> {
        Err(TargetError::NoGhost)
    }
}

/// What happens to a target, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LinkNews {
    /// The port is gone; it is reopened when it is back.
    Lost(String),
    /// The port is back.
    Back(String),
    /// The ghost beside the robot has stopped by itself, and why.
    GhostFault(Fault),
    /// A debugger halted or resumed a program.
    Held(String),
    /// A program cannot go on, and why.
    Ended(String),
    /// Something about its program.
    Program(Level, String),
    /// It has started again from time 0 with a changed program: a new run begins.
    Renewed,
}

/// A robot's pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Standing {
    /// In the world, as far as it is known.
    pub at: MapPose,
    /// Relative to its origin, as it estimates.
    pub estimated: MapPose,
}

/// The ghost of a log: a simulated robot that receives the bytes recorded for the robot.
pub trait Ghost: Send {
    /// Restarts at time 0.
    ///
    /// # Errors
    /// Why it cannot start.
    fn begin(&mut self) -> Result<(), TargetError>;

    /// Advances to this instant \[us\]; returns the ground truth there.
    ///
    /// # Errors
    /// Why it cannot go on.
    fn advance_to(&mut self, until_us: u64) -> Result<Truth, TargetError>;

    /// Moves it to this pose.
    fn place(&mut self, standing: Standing);
}
