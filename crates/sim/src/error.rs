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
    /// The pins of a wiring's link are those of no USART.
    LinkPins {
        /// Name of the wiring.
        wiring: String,
        /// The board it is on.
        board: &'static Board,
        /// Pin of `link_rx`.
        receive: Option<u8>,
        /// Pin of `link_tx`.
        transmit: Option<u8>,
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
            Self::LinkPins {
                wiring,
                board,
                receive,
                transmit,
            } => {
                let shown =
                    |pin: &Option<u8>| pin.map_or_else(|| "missing".into(), |pin| pin.to_string());
                write!(
                    f,
                    "wiring {wiring}: link_rx = {} and link_tx = {} are no USART of the {}; those are on {}",
                    shown(receive),
                    shown(transmit),
                    board.title,
                    board.usarts_in_words()
                )
            }
        }
    }
}

impl std::error::Error for SimError {}
