//! Every message survives the wire, and fits it.
#![allow(clippy::unwrap_used, reason = "a test helper")]

use crate::common;
use common::*;
use proptest::prelude::*;
use rumbo_control::{AgedRange, Duty, Pose, Range, Wheels};
use rumbo_wire::frame::MAX_FRAME;
use rumbo_wire::*;

/// A message as the receiver decodes it.
fn received<M: FrameMessage>(message: &M) -> M {
    let frame = message.frame(3);
    let (_, stuffed) = frame.bytes().split_last().unwrap();
    M::from_body(&FrameBody::parse(stuffed).unwrap()).unwrap()
}

fn close(a: f32, b: f32, step: f32) -> bool {
    (a - b).abs() <= step * 0.51
}

fn all_close(a: Wheels<f32>, b: Wheels<f32>, step: f32) -> bool {
    close(a.left, b.left, step) && close(a.right, b.right, step)
}

proptest! {
    #[test]
    fn telemetry_comes_back_within_its_quantisation_in_30_bytes(sent in telemetry()) {
        let message = FromRobot::Telemetry(sent);
        prop_assert_eq!(message.frame(0).bytes().len(), 30);
        let FromRobot::Telemetry(back) = received(&message) else { panic!("another message") };
        prop_assert!(close(back.pose.x_m, sent.pose.x_m, 0.001) && close(back.pose.y_m, sent.pose.y_m, 0.001));
        prop_assert!(close(back.pose.heading_rad, sent.pose.heading_rad, 1e-4));
        for (back, sent) in back.wheel_rad_s.into_iter().zip(sent.wheel_rad_s) {
            prop_assert!(all_close(back, sent, 0.02));
        }
        prop_assert!(all_close(back.wheel_ref_rad_s, sent.wheel_ref_rad_s, 0.02) && close(back.servo_rad, sent.servo_rad, 1f32.to_radians()));
        for (back, sent) in back.ranges.into_iter().zip(sent.ranges) {
            match (back.range, sent.range) {
                (Range::Valid(back_m), Range::Valid(sent_m)) => prop_assert!(close(back_m, sent_m, 0.0025)),
                (back, sent) => prop_assert_eq!(back, sent),
            }
        }
        let exact = |t: Telemetry| (t.t_ms, t.duty, t.state, t.armed, t.faulted);
        prop_assert_eq!(exact(back), exact(sent));
    }

    #[test]
    fn status_comes_back_within_its_quantisation(sent in status()) {
        let FromRobot::Status(back) = received(&FromRobot::Status(sent)) else { panic!("another message") };
        match (back.battery_v, sent.battery_v) {
            (Some(back_v), Some(sent_v)) => prop_assert!(close(back_v, sent_v, 0.001)),
            (back, sent) => prop_assert_eq!(back, sent),
        }
        prop_assert_eq!(StatusReport { battery_v: sent.battery_v, ..back }, sent);
    }

    #[test]
    fn what_the_robot_sends_arrives(sent in from_robot()) {
        let back = received(&sent);
        match sent {
            FromRobot::Telemetry(_) | FromRobot::Status(_) | FromRobot::HeadingRef(_) => {
                prop_assert_eq!(core::mem::discriminant(&back), core::mem::discriminant(&sent));
                // Quantised once, it changes no more.
                prop_assert_eq!(received(&back), back);
            }
            _ => prop_assert_eq!(back, sent),
        }
        prop_assert!(sent.frame(0).bytes().len() <= MAX_FRAME);
    }

    #[test]
    fn what_the_station_sends_arrives(sent in to_robot()) {
        prop_assert_eq!(received(&sent), sent);
        prop_assert!(sent.frame(0).bytes().len() <= MAX_FRAME);
    }

    #[test]
    fn any_payload_is_a_message_or_an_error(number in 0u8..16, payload in prop::collection::vec(any::<u8>(), 0..25)) {
        if let Some(kind) = Kind::from_number(number) {
            let frame = Frame::new(kind, 0, &payload);
            let body = FrameBody::parse(&frame.bytes()[..frame.bytes().len() - 1]).unwrap();
            if let (Ok(_), Ok(_)) = (FromRobot::from_body(&body), ToRobot::from_body(&body)) {
                panic!("{kind:?} has two directions");
            }
        }
    }
}

#[test]
fn a_value_that_is_not_finite_or_too_large_is_marked_or_saturated_and_never_wraps() {
    let valid = |range_m| AgedRange {
        range: Range::Valid(range_m),
        age_ticks: 0,
    };
    let sent = Telemetry {
        pose: Pose {
            x_m: 1.0,
            y_m: f32::NAN,
            heading_rad: 1.0,
        },
        wheel_rad_s: [
            Wheels {
                left: 1e9,
                right: -1e9,
            },
            Wheels {
                left: f32::NAN,
                right: f32::INFINITY,
            },
        ],
        wheel_ref_rad_s: Wheels {
            left: 1e9,
            right: -1e9,
        },
        duty: Wheels {
            left: Duty::new(-255),
            right: Duty::new(255),
        },
        ranges: [valid(9.0), valid(f32::NAN), valid(-1.0)],
        ..Telemetry::default()
    };
    let FromRobot::Telemetry(back) = received(&FromRobot::Telemetry(sent)) else {
        panic!("another message")
    };
    assert!(back.pose.x_m.is_nan() && back.pose.y_m.is_nan() && back.pose.heading_rad.is_nan());
    assert_eq!(
        back.wheel_rad_s[0],
        Wheels {
            left: 40.94,
            right: -40.94
        }
    );
    assert!(back.wheel_rad_s[1].left.is_nan() && back.wheel_rad_s[1].right.is_nan());
    assert_eq!(
        back.wheel_ref_rad_s,
        Wheels {
            left: 40.94,
            right: -40.94
        }
    );
    assert_eq!(back.duty, sent.duty);
    assert_eq!(
        back.ranges.map(|aged| aged.range),
        [Range::Valid(2.5525), Range::Faulty, Range::Valid(0.0)]
    );
}

#[test]
fn a_non_finite_value_in_a_command_arrives_as_such() {
    let sent = ToRobot::Command {
        session: 1,
        number: 2,
        command: Command::Reference(f32::NAN),
        seen: RobotTime::default(),
    };
    let ToRobot::Command {
        command: Command::Reference(value),
        ..
    } = received(&sent)
    else {
        panic!("another message")
    };
    assert!(value.is_nan());
}

#[test]
fn an_unknown_command_can_still_be_refused_by_its_number() {
    let frame = Frame::new(Kind::Command, 0, &[7, 0x34, 0x12, 99]);
    let body = FrameBody::parse(&frame.bytes()[..frame.bytes().len() - 1]).unwrap();
    assert_eq!(ToRobot::from_body(&body), Err(Malformed::Number));
    assert_eq!(codec::command_number(&body), Some((7, 0x1234)));
}

#[test]
fn the_link_at_9600_baud_carries_25_telemetry_frames_a_second_in_750_bytes() {
    let len = |message: FromRobot| message.frame(0).bytes().len();
    let telemetry = 25 * len(FromRobot::Telemetry(Telemetry::default()));
    assert_eq!(telemetry, 750);
    // With two statuses and the heading 12.5 times, room is left for an answer and an event.
    let status = 2 * len(FromRobot::Status(StatusReport::default()));
    let heading = 25 * len(FromRobot::HeadingRef(1.0)) / 2;
    assert_eq!((status, heading), (54, 87));
    assert!(telemetry + status + heading + 13 + 9 <= 960);
}
