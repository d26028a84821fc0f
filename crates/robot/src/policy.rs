//! The network of mode 9 beside the program: found at the start, and whole.

use rumbo_control::policy::NetworkShape;
use rumbo_wire::crc16;

/// Where it lies in the flash of a Mega: behind all that the program may take, `flash_bytes` of its robot file.
pub const NETWORK_AT: u32 = 0x2_8000;

const CRC_START: u16 = 0xFFFF;

/// The shape of the network whose bytes `read` gives; `None` where they are none, or damaged.
pub(crate) fn find(read: impl Fn(u16) -> u8) -> Option<NetworkShape> {
    let shape = NetworkShape::read(&read).ok()?;
    // The CRC of bytes with their CRC behind them is zero.
    let crc = (0..shape.bytes()).fold(CRC_START, |crc, at| crc16(crc, read(at)));
    (crc == 0).then_some(shape)
}
