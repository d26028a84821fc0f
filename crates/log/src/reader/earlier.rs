//! Logs of the protocol before this one: the frames in them become those of today, so that no reader of the bytes need
//! know.

use crate::entry::Burst;
use rumbo_wire::earlier::{EARLIER_VERSION, renewed};
use rumbo_wire::{Decoder, FromRobot, Hello, Message, Received};

/// Longest line of text from a robot that is put together.
const LINE: usize = 160;

/// How the robot first named itself in frames.
pub(super) fn hello(link: &[Burst]) -> Option<Hello> {
    let from_robot = link.iter().filter(|burst| !burst.to_robot);
    let mut decoder = Decoder::<LINE>::default();
    from_robot
        .flat_map(|burst| &burst.bytes)
        .find_map(|byte| match decoder.push(*byte) {
            Some(Received::Frame(body)) => match FromRobot::from_body(&body) {
                Ok(FromRobot::Hello(hello)) => Some(hello),
                _ => None,
            },
            _ => None,
        })
}

/// Puts the frames of today in place of earlier ones. A frame moves to where its end was.
pub(super) fn renew(link: &mut [Burst]) {
    if hello(link).is_none_or(|hello| hello.protocol != EARLIER_VERSION) {
        return;
    }
    let mut pieces: [Vec<u8>; 2] = Default::default();
    for burst in link {
        let piece = &mut pieces[usize::from(burst.to_robot)];
        let mut bytes = Vec::with_capacity(burst.bytes.len());
        for byte in burst.bytes.drain(..) {
            piece.push(byte);
            if byte == 0 {
                match renewed(&piece[..piece.len() - 1]) {
                    Some(frame) => bytes.extend_from_slice(frame.bytes()),
                    None => bytes.extend_from_slice(piece),
                }
                piece.clear();
            }
        }
        burst.bytes = bytes;
    }
}
