//! The decoder in noise: cuts, flipped bits, garbage, and text and frames in one stream.

use crate::common;
use common::*;
use proptest::prelude::*;
use rumbo_wire::message::{MovementLevel, Waypoint};
use rumbo_wire::{
    Command, Decoder, FrameMessage, FromRobot, Kind, Received, RobotTime, Telemetry, ToRobot,
};

/// What came out of a stream: frames as (kind, payload), lines as text.
#[derive(Debug, PartialEq)]
enum Out {
    Frame(u8, Vec<u8>),
    Line(String),
}

fn out(received: Received) -> Out {
    match received {
        Received::Frame(body) => Out::Frame(body.kind as u8, body.payload().to_vec()),
        Received::Line(line) => Out::Line(String::from_utf8_lossy(line).into_owned()),
    }
}

fn decode<const N: usize>(decoder: &mut Decoder<N>, bytes: &[u8]) -> Vec<Out> {
    bytes
        .iter()
        .filter_map(|byte| decoder.push(*byte).map(out))
        .collect()
}

fn frames<const N: usize>(decoder: &mut Decoder<N>, bytes: &[u8]) -> Vec<Out> {
    decode(decoder, bytes)
        .into_iter()
        .filter(|out| matches!(out, Out::Frame(..)))
        .collect()
}

fn lines(bytes: &[u8]) -> Vec<Out> {
    decode(&mut Decoder::<48>::default(), bytes)
}

proptest! {
    #[test]
    fn any_bytes_are_taken_without_panic(bytes in prop::collection::vec(any::<u8>(), 0..2_000)) {
        decode(&mut Decoder::<48>::default(), &bytes);
        decode(&mut Decoder::<8>::default(), &bytes);
        decode(&mut Decoder::<0>::default(), &bytes);
    }

    #[test]
    fn a_stream_cut_anywhere_resynchronises_at_the_next_frame(first in frame(), second in frame(), cut in 0usize..30) {
        let mut stream = first.bytes().get(cut..).unwrap_or(&[]).to_vec();
        stream.extend(second.bytes());
        let found = frames(&mut Decoder::<48>::default(), &stream);
        let last = frames(&mut Decoder::<48>::default(), second.bytes());
        prop_assert_eq!(found.last(), last.last());
    }

    #[test]
    fn a_frame_is_found_after_any_noise_that_ends_in_0x00(noise in prop::collection::vec(any::<u8>(), 0..200), frame in frame()) {
        let mut decoder = Decoder::<48>::default();
        decode(&mut decoder, &noise);
        decoder.push(0);
        prop_assert_eq!(frames(&mut decoder, frame.bytes()).len(), 1);
    }

    #[test]
    fn a_frame_is_found_after_any_lines(texts in prop::collection::vec("[ -~]{1,40}", 0..6), frame in frame()) {
        let mut decoder = Decoder::<48>::default();
        for text in &texts {
            prop_assert_eq!(decode(&mut decoder, format!("{text}\n").as_bytes()), [Out::Line(text.clone())]);
        }
        prop_assert_eq!(frames(&mut decoder, frame.bytes()).len(), 1);
        prop_assert_eq!(decoder.crc_errors(), 0);
    }

    #[test]
    fn a_line_is_found_after_frames(frame in frame(), text in "[ -~]{1,40}") {
        let mut decoder = Decoder::<48>::default();
        prop_assert_eq!(frames(&mut decoder, frame.bytes()).len(), 1);
        prop_assert_eq!(decode(&mut decoder, format!("{text}\r\n").as_bytes()), [Out::Line(text)]);
    }

    #[test]
    fn one_flipped_bit_is_never_accepted(frame in frame()) {
        // Followed by a second frame: the flipped bit may be in the 0x00 between them.
        let next = ToRobot::Heartbeat.frame(0);
        let whole: Vec<u8> = [frame.bytes(), next.bytes()].concat();
        for bit in 0..frame.bytes().len() * 8 {
            let mut stream = whole.clone();
            stream[bit / 8] ^= 1 << (bit % 8);
            let found = messages(&stream);
            prop_assert!(found.is_empty() || found == [Kind::Heartbeat], "bit {} accepted: {:?}", bit, found);
        }
    }
}

/// Kinds of the frames that are messages.
fn messages(bytes: &[u8]) -> Vec<Kind> {
    let mut decoder = Decoder::<48>::default();
    let mut kinds = Vec::new();
    for byte in bytes {
        if let Some(Received::Frame(body)) = decoder.push(*byte)
            && (FromRobot::from_body(&body).is_ok() || ToRobot::from_body(&body).is_ok())
        {
            kinds.push(body.kind);
        }
    }
    kinds
}

#[test]
fn lines_end_in_lf_or_cr_lf() {
    let on = || Out::Line("ON".into());
    assert_eq!(lines(b"ON\nON\r\n\n\r\n"), [on(), on()]);
}

#[test]
fn garbage_is_neither_frame_nor_line() {
    assert_eq!(lines(b"\x80ON\nO\x07N\n\xff\xff\x00\x03\x01\x00\tx\n"), []);
    assert_eq!(lines(b"\x80ON\nOFF\n"), [Out::Line("OFF".into())]);
}

#[test]
fn a_line_too_long_is_dropped_and_the_next_one_found() {
    assert_eq!(lines(&[[b'x'; 48].as_slice(), b"\nON\n"].concat()).len(), 2);
    assert_eq!(
        lines(&[[b'x'; 49].as_slice(), b"\nON\n"].concat()),
        [Out::Line("ON".into())]
    );
}

#[test]
fn a_lost_frame_is_counted() {
    let mut decoder = Decoder::<48>::default();
    for seq in [0u8, 1, 3, 4, 15, 0] {
        decode(
            &mut decoder,
            FromRobot::Telemetry(Telemetry::default())
                .frame(seq)
                .bytes(),
        );
    }
    assert_eq!((decoder.frames_lost(), decoder.crc_errors()), (11, 0));
}

#[test]
fn no_command_with_one_byte_changed_is_another_one() {
    let mut passed = Vec::new();
    for command in every_command() {
        for number in [0u16, 1, 0x0102, 0xFFFF] {
            let message = ToRobot::Command {
                session: 7,
                number,
                command,
                seen: RobotTime {
                    start: 3,
                    ms: 81_500,
                },
            };
            let whole = message.frame(3).bytes().to_vec();
            for at in 0..whole.len() {
                for mask in 1..=255u8 {
                    let mut decoder = Decoder::<48>::default();
                    let mut frame = whole.clone();
                    frame[at] ^= mask;
                    frame.push(0);
                    for byte in frame {
                        // With a 0 behind its CRC, which its end turned into, it has a right CRC and a wrong length.
                        if let Some(Received::Frame(body)) = decoder.push(byte)
                            && ToRobot::from_body(&body).is_ok()
                        {
                            passed.push((command, number, at, mask, body));
                        }
                    }
                }
            }
        }
    }
    assert!(passed.is_empty(), "{passed:x?}");
}

/// One of each.
fn every_command() -> Vec<Command> {
    let value = 0.7;
    let wheels = rumbo_control::Wheels::both(3.0);
    let movement = rumbo_control::mode::Movement::Forward;
    vec![
        Command::Stop,
        Command::Arm,
        Command::Disarm,
        Command::ClearFault,
        Command::Mode(rumbo_control::mode::ModeId::Mission),
        Command::Reference(value),
        Command::WheelReference(wheels),
        Command::Move {
            movement,
            level: MovementLevel::Duty(0.9),
        },
        Command::SetParam { id: 2, value },
        Command::GetParam { id: 2 },
        Command::ResetParams,
        Command::SaveParams,
        Command::ResetPose,
        Command::Goal {
            x_m: 1.0,
            y_m: -0.5,
        },
        Command::Lane,
        Command::Route {
            repeat: true,
            relative: false,
        },
        Command::Waypoint(Waypoint {
            x_m: 1.0,
            y_m: -0.5,
            heading_rad: Some(0.3),
        }),
    ]
}
