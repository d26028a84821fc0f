//! What is recorded, as it happens.

use crate::event::LoggedEvent;
use crate::manifest::Outcome;
use crate::parameters::ParameterState;
use crate::reading::Reading;
use crate::scene::Scene;
use crate::signals::Row;
use crate::state::State;

/// Something to record.
#[derive(Debug)]
pub enum Entry {
    /// What crossed the link.
    Burst(Burst),
    /// What crossed a USART of an emulated chip.
    Said(Said),
    /// Signals.
    Rows(Vec<Row>),
    /// Signals beside the telemetry.
    Readings(Vec<Reading>),
    /// What happened.
    Event(LoggedEvent),
    /// What surrounds the robot; `None` where that is not known.
    Scene(Option<Box<Scene>>),
    /// What changes slowly.
    State(Box<State>),
    /// The parameters, with their values as far as they are known.
    Parameters(Vec<ParameterState>),
    /// How the run ended.
    Outcome(Outcome),
}

/// Raw bytes that crossed the link together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Burst {
    /// When, in the target's time \[us\].
    pub t_us: u64,
    /// To the robot, or from it.
    pub to_robot: bool,
    /// What.
    pub bytes: Vec<u8>,
}

/// Bytes of a USART of an emulated chip.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Said {
    /// When, in the target's time \[us\].
    pub t_us: u64,
    /// Which USART.
    pub usart: u8,
    /// Typed by a person, or sent by the chip.
    pub to_chip: bool,
    /// What.
    pub bytes: Vec<u8>,
}
