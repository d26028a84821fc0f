//! Any bytes on the link decode to messages or are rejected, at both ends; a message that is encoded again is the same.

use rumbo_wire::csv::recognise;
use rumbo_wire::frame::MAX_PAYLOAD;
use rumbo_wire::text::{TextCommand, TextRow};
use rumbo_wire::{Decoder, Frame, FrameBody, FrameMessage, FromRobot, Kind, Received, ToRobot};

/// What a frame holds.
fn body_of(frame: &Frame) -> FrameBody {
    let stuffed = frame.bytes().strip_suffix(&[0]);
    stuffed
        .and_then(FrameBody::parse)
        .expect("a frame of ours is whole")
}

/// The message in a frame, if it is one, sent on: numbers may be rounded once.
fn send_on<M: FrameMessage>(body: &FrameBody) {
    let Ok(message) = M::from_body(body) else {
        return;
    };
    let sent = message.frame(body.seq);
    let arrived = M::from_body(&body_of(&sent))
        .ok()
        .expect("a message of ours");
    assert_eq!(arrived.frame(body.seq), sent);
}

fn line(line: &[u8]) {
    let _ = TextCommand::parse(line);
    let Ok(text) = std::str::from_utf8(line) else {
        return;
    };
    let _ = recognise(text);
    if let Ok(row) = TextRow::parse(text) {
        let telemetry = FromRobot::Telemetry(row.telemetry(row.dt_ms() as u16, true));
        send_on::<FromRobot>(&body_of(&telemetry.frame(0)));
    }
}

fn received(received: Received<'_>) {
    match received {
        Received::Frame(body) => {
            send_on::<FromRobot>(&body);
            send_on::<ToRobot>(&body);
        }
        Received::Line(text) => line(text),
    }
}

/// Panics if the claim does not hold.
pub fn check(bytes: &[u8]) {
    // The robot's end and the station's.
    let (mut robot, mut station) = (Decoder::<48>::default(), Decoder::<128>::default());
    for byte in bytes {
        robot.push(*byte).map(received);
        station.push(*byte).map(received);
    }
    // The same as one frame, with a CRC that is right.
    if let Some((header, payload)) = bytes.split_first()
        && let Some(kind) = Kind::from_number(header >> 4)
    {
        let frame = Frame::new(kind, header & 0xF, payload);
        let body = body_of(&frame);
        assert_eq!(body.payload(), &payload[..payload.len().min(MAX_PAYLOAD)]);
        received(Received::Frame(body));
    }
}
