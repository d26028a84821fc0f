//! Why a simulation cannot be made.

use crate::boards::Board;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_wire::Refusal;
use thiserror::Error;

/// Values of a configuration that do not fit together.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SimError {
    /// The robot refuses a parameter.
    #[error("parameter {} = {value}: {}", .id.name(), .refusal.explanation())]
    Parameter {
        /// Which.
        id: ParamId,
        /// The value.
        value: f32,
        /// Why.
        refusal: Refusal,
    },
    /// The report has no program for this mode with these sonars.
    #[error(
        "the report's program does not do mode {} on rig {rig}; leave out the program baseline or choose another \
         scenario",
        .mode.name()
    )]
    NoBaseline {
        /// The mode.
        mode: ModeId,
        /// Name of the rig.
        rig: String,
    },
    /// A wiring's link has the pins of a USART, exchanged.
    #[error(
        "wiring {wiring}: link_rx and link_tx are exchanged: the {} receives on one and sends on the other; write \
         {}",
        .board.title, right_way(.board, *.usart)
    )]
    LinkExchanged {
        /// Name of the wiring.
        wiring: String,
        /// The board it is on.
        board: &'static Board,
        /// Number of the USART.
        usart: u8,
    },
}

/// The pins of a USART as a wiring names them.
fn right_way(board: &Board, usart: u8) -> String {
    let [receive, transmit] = board.usart_pins(usart);
    format!("link_rx = {receive}, link_tx = {transmit}")
}
