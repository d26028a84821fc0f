//! Why a frame is no message.

/// Why a frame that passed the CRC is no message: the other end uses another protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Malformed {
    /// A frame of the other direction.
    Direction,
    /// The payload is too short or too long for what it is.
    Length,
    /// A number without a meaning: mode, fault, command, refusal...
    Number,
}
