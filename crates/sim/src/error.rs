//! Why a simulation cannot be made.

use crate::boards::Board;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_wire::Refusal;
use std::fmt;

/// Values of a configuration that do not fit together.
#[derive(Clone, Debug, PartialEq)]
pub enum SimError {
    /// The robot refuses a parameter.
    Parameter {
        /// Which.
        id: ParamId,
        /// The value.
        value: f32,
        /// Why.
        refusal: Refusal,
    },
    /// The report has no program for this mode with these sonars.
    NoBaseline {
        /// The mode.
        mode: ModeId,
        /// Name of the rig.
        rig: String,
    },
    /// A wiring's link has the pins of a USART, exchanged.
    LinkExchanged {
        /// Name of the wiring.
        wiring: String,
        /// The board it is on.
        board: &'static Board,
        /// Number of the USART.
        usart: u8,
    },
}

impl fmt::Display for SimError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter { id, value, refusal } => {
                let (name, why) = (id.name(), refusal.explanation());
                write!(f, "parameter {name} = {value}: {why}")
            }
            Self::NoBaseline { mode, rig } => write!(
                f,
                "the report's program does not do mode {} on rig {rig}; leave out the program baseline or choose another scenario",
                mode.name()
            ),
            Self::LinkExchanged {
                wiring,
                board,
                usart,
            } => {
                let [receive, transmit] = board.usart_pins(*usart);
                write!(
                    f,
                    "wiring {wiring}: link_rx and link_tx are exchanged: the {} receives on one and sends on the other; \
                     write link_rx = {receive}, link_tx = {transmit}",
                    board.title
                )
            }
        }
    }
}

impl std::error::Error for SimError {}
