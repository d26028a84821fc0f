//! Frames: `COBS( kind:4|seq:4, payload, CRC-16/MCRF4XX ) 0x00`.
//!
//! COBS (Cheshire & Baker, 1999) removes every 0x00 from the bytes, so that 0x00 marks the end of a frame and
//! nothing else: after a cut, the next frame is found at the next 0x00. The CRC also covers a schema byte that is
//! not sent, [`PROTOCOL_VERSION`]: a frame of another version fails the CRC instead of being misread. HELLO frames
//! always use 0 there, so that the two ends can exchange their versions.
//!
//! Both algorithms are a few lines of our own: a table for the CRC would take 512 bytes of SRAM on the AVR, and
//! nothing here may panic. The tests compare them with the crates `cobs` and `crc`.

use crate::message::PROTOCOL_VERSION;

/// Most bytes of a payload: telemetry.
pub const MAX_PAYLOAD: usize = 25;
/// Bytes that a frame adds to its payload: header, CRC (2), COBS, 0x00.
pub const OVERHEAD: usize = 5;
/// Most bytes of a frame on the wire.
pub const MAX_FRAME: usize = MAX_PAYLOAD + OVERHEAD;
/// Header, payload and CRC of the longest frame.
const MAX_BODY: usize = MAX_PAYLOAD + 3;

rumbo_control::numbered! {
    /// What a frame carries. The directions use different numbers: an echo is not mistaken for an answer.
    pub enum Kind {
        /// [`crate::FromRobot::Hello`].
        RobotHello = 1,
        /// [`crate::FromRobot::Telemetry`].
        Telemetry = 2,
        /// [`crate::FromRobot::Status`].
        Status = 3,
        /// [`crate::FromRobot::Event`].
        Event = 4,
        /// [`crate::FromRobot::Ack`].
        Ack = 5,
        /// [`crate::FromRobot::HeadingRef`].
        HeadingRef = 6,
        /// [`crate::ToRobot::Hello`].
        StationHello = 8,
        /// [`crate::ToRobot::Heartbeat`].
        Heartbeat = 9,
        /// [`crate::ToRobot::Command`].
        Command = 10,
        /// [`crate::ToRobot::Velocity`].
        Velocity = 11,
    }
}

impl Kind {
    /// The byte mixed into the CRC in this version of the protocol.
    const fn schema(self, protocol: u8) -> u8 {
        match self {
            Kind::RobotHello | Kind::StationHello => 0,
            _ => protocol,
        }
    }
}

/// A frame as it goes on the wire, 0x00 included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    bytes: [u8; MAX_FRAME],
    len: usize,
}

impl Frame {
    /// A frame of `payload`, of which at most [`MAX_PAYLOAD`] bytes are taken; `seq` counts the frames of a
    /// direction, modulo 16.
    pub fn new(kind: Kind, seq: u8, payload: &[u8]) -> Frame {
        let header = (kind as u8) << 4 | (seq & 0xF);
        let payload = payload.get(..MAX_PAYLOAD).unwrap_or(payload);
        let mut check = crc(crc(CRC_START, kind.schema(PROTOCOL_VERSION)), header);
        let mut stuffing = Stuffing::new();
        stuffing.put(header);
        for byte in payload {
            check = crc(check, *byte);
            stuffing.put(*byte);
        }
        let [low, high] = check.to_le_bytes();
        stuffing.put(low);
        stuffing.put(high);
        stuffing.finish()
    }

    /// The bytes for the wire.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&self.bytes)
    }
}

/// What was in a frame that passed the CRC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameBody {
    /// What the payload is.
    pub kind: Kind,
    /// Number of the frame in its direction, 0..=15.
    pub seq: u8,
    bytes: [u8; MAX_BODY],
    len: usize,
}

impl FrameBody {
    /// The content of a frame, given without its 0x00; `None` if anything is wrong with it.
    pub fn parse(stuffed: &[u8]) -> Option<FrameBody> {
        let mut bytes = [0; MAX_BODY];
        let len = unstuff(stuffed, &mut bytes)?;
        let (checked, check) = bytes.get(..len)?.split_last_chunk::<2>()?;
        let header = *checked.first()?;
        let kind = Kind::from_number(header >> 4)?;
        let sum = checked.iter().fold(
            crc(CRC_START, kind.schema(PROTOCOL_VERSION)),
            |sum, byte| crc(sum, *byte),
        );
        (sum == u16::from_le_bytes(*check)).then_some(FrameBody {
            kind,
            seq: header & 0xF,
            bytes,
            len: len - 2,
        })
    }

    /// The bytes of the message.
    pub fn payload(&self) -> &[u8] {
        self.bytes.get(1..self.len).unwrap_or(&[])
    }
}

const CRC_START: u16 = 0xFFFF;

/// Updates a CRC-16/MCRF4XX (reflected polynomial 0x1021, start 0xFFFF) with a byte, without a table; the form of
/// `_crc_ccitt_update` in avr-libc's `util/crc16.h`.
pub const fn crc(sum: u16, byte: u8) -> u16 {
    let [low, high] = sum.to_le_bytes();
    let mixed = byte ^ low;
    let mixed = mixed ^ (mixed << 4);
    (u16::from_le_bytes([high, mixed]) ^ (mixed >> 4) as u16) ^ ((mixed as u16) << 3)
}

/// COBS encoder of the bytes put in, with the closing 0x00. Runs are below 254 bytes here.
struct Stuffing {
    frame: Frame,
    /// Where the length of the present run will be.
    code_at: u8,
    /// The length of the present run, its code included.
    run: u8,
}

impl Stuffing {
    fn new() -> Self {
        Self {
            frame: Frame {
                bytes: [0; MAX_FRAME],
                len: 1,
            },
            code_at: 0,
            run: 1,
        }
    }

    fn put(&mut self, byte: u8) {
        if byte == 0 {
            self.close();
        } else {
            if let Some(slot) = self.frame.bytes.get_mut(self.frame.len) {
                *slot = byte;
            }
            self.run += 1;
        }
        self.frame.len += 1;
    }

    /// Ends a run: its code goes to its front, the next one begins.
    fn close(&mut self) {
        if let Some(slot) = self.frame.bytes.get_mut(usize::from(self.code_at)) {
            *slot = self.run;
        }
        self.code_at = self.frame.len as u8;
        self.run = 1;
    }

    /// The frame; the byte after the last run is 0x00 already.
    fn finish(mut self) -> Frame {
        self.close();
        self.frame.len += 1;
        self.frame
    }
}

/// Inverse of [`Stuffing`], of a frame without its 0x00; returns the length.
fn unstuff(stuffed: &[u8], out: &mut [u8; MAX_BODY]) -> Option<usize> {
    let mut rest = stuffed;
    let mut len = 0;
    while let Some((code, tail)) = rest.split_first() {
        let (run, next) = tail.split_at_checked(usize::from(*code).checked_sub(1)?)?;
        for byte in run {
            *out.get_mut(len)? = *byte;
            len += 1;
        }
        if !next.is_empty() {
            *out.get_mut(len)? = 0;
            len += 1;
        }
        rest = next;
    }
    Some(len)
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    fn payload() -> impl Strategy<Value = Vec<u8>> {
        // Zeros often: they are what COBS is about.
        prop::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 0..=MAX_PAYLOAD)
    }

    proptest! {
        #[test]
        fn frames_are_what_the_libraries_make(payload in payload(), seq in 0u8..16) {
            let library = crc::Crc::<u16>::new(&crc::CRC_16_MCRF4XX);
            let mut body = std::vec![PROTOCOL_VERSION, (Kind::Command as u8) << 4 | seq];
            body.extend(&payload);
            let check = library.checksum(&body);
            body.extend(check.to_le_bytes());
            let mut wire = cobs::encode_vec(&body[1..]);
            wire.push(0);
            let frame = Frame::new(Kind::Command, seq, &payload);
            prop_assert_eq!(frame.bytes(), &wire[..]);
        }

        #[test]
        fn a_frame_gives_back_its_payload(payload in payload(), seq in 0u8..16) {
            let frame = Frame::new(Kind::Status, seq, &payload);
            prop_assert_eq!(frame.bytes().len(), payload.len() + OVERHEAD);
            let body = FrameBody::parse(&frame.bytes()[..frame.len - 1]).unwrap();
            prop_assert_eq!((body.kind, body.seq, body.payload()), (Kind::Status, seq, &payload[..]));
        }

        #[test]
        fn any_bytes_are_parsed_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..64)) {
            let _ = FrameBody::parse(&bytes);
        }
    }

    #[test]
    fn a_frame_of_another_version_fails_the_crc_and_a_hello_does_not() {
        let header = (Kind::Heartbeat as u8) << 4;
        let other = crc(crc(CRC_START, PROTOCOL_VERSION + 1), header).to_le_bytes();
        assert_eq!(FrameBody::parse(&[4, header, other[0], other[1]]), None);
        assert!(FrameBody::parse(&Frame::new(Kind::Heartbeat, 0, &[]).bytes()[..4]).is_some());
        assert_eq!(Kind::StationHello.schema(PROTOCOL_VERSION), 0);
    }
}
