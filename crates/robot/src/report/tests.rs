extern crate std;
use super::*;
use rumbo_control::mode::Reference;
use rumbo_control::{AgedRange, Duty, Pose, Range};
use rumbo_wire::text::{RAD_PER_DEG, RAD_S_PER_RPM, TextRow};
use rumbo_wire::{Decoder, PROTOCOL_VERSION, Received, ResetCause};

#[test]
fn a_fault_with_two_digits_is_sent_whole_in_text() {
    let mut reporter = Reporter::new(Hello {
        protocol: PROTOCOL_VERSION,
        schema: 0,
        image: 0,
        reset: ResetCause::PowerOn,
    });
    reporter.addressed_in(Language::Text);
    for fault in [
        rumbo_control::Fault::LinkLost,
        rumbo_control::Fault::RightEncoderImplausible,
    ] {
        reporter.event(0, EventKind::Faulted(fault));
    }
    let said: std::vec::Vec<u8> = core::iter::from_fn(|| reporter.transmit()).collect();
    assert_eq!(said, b"\0FLT 1\r\nFLT 12\r\n");
}

#[test]
fn each_mode_has_the_columns_of_its_row_in_their_order() {
    let telemetry = Telemetry {
        pose: Pose {
            x_m: 1.0,
            y_m: 2.0,
            heading_rad: 3.0 * RAD_PER_DEG,
        },
        wheel_rad_s: [Wheels {
            left: 40.0 * RAD_S_PER_RPM,
            right: 50.0 * RAD_S_PER_RPM,
        }; 2],
        wheel_ref_rad_s: Wheels {
            left: 60.0 * RAD_S_PER_RPM,
            right: 70.0 * RAD_S_PER_RPM,
        },
        duty: Wheels {
            left: Duty::new(80),
            right: Duty::new(-90),
        },
        state: 9,
        ranges: [0.1, 0.2, 0.3].map(|range_m| AgedRange::fresh(Range::Valid(range_m))),
        ..Telemetry::default()
    };
    let signals = Signals {
        telemetry,
        heading_ref_rad: 4.0 * RAD_PER_DEG,
    };
    let row = |mode| {
        let status = StatusReport {
            mode,
            reference: Reference::Goal { x_m: 5.0, y_m: 6.0 },
            ..StatusReport::default()
        };
        let mut line = TextLine::new(12);
        write_row(&mut line, &status, &signals);
        line.end();
        let text = std::string::String::from_utf8(line.bytes().to_vec()).unwrap();
        assert!(TextRow::parse(text.strip_suffix("\r\n").unwrap()).is_ok());
        text
    };
    assert_eq!(row(ModeId::FrontDistance), "12,30,30,500,1,-90,80\r\n");
    assert_eq!(row(ModeId::WallFollow), "12,10,20,500,4,-90,80\r\n");
    assert_eq!(row(ModeId::WheelSpeed), "12,50,40,70,5,-90,80\r\n");
    assert_eq!(row(ModeId::Waypoints), "12,50,40,70,60,1,2,3,-90,80\r\n");
    assert_eq!(row(ModeId::Mission), "12,70,60,4,5,6,1,2,3,9,20,10,30\r\n");
}

#[test]
fn telemetry_carries_the_speeds_of_two_instants_20_ms_apart() {
    let hello = Hello {
        protocol: PROTOCOL_VERSION,
        schema: 0,
        image: 0,
        reset: ResetCause::PowerOn,
    };
    let mut reporter = Reporter::new(hello);
    let mut decoder = Decoder::<64>::default();
    let mut frames = 0;
    for tick in 0..200u16 {
        // Every third tick is a long one: what it would have sent leaves with the next.
        let busy = tick % 3 == 0;
        // A speed that shows its tick, in steps that telemetry resolves.
        let telemetry = Telemetry {
            wheel_rad_s: [Wheels::both(f32::from(tick) / 10.0); 2],
            ..Telemetry::default()
        };
        let signals = Signals {
            telemetry,
            ..Signals::default()
        };
        reporter.tick(Micros(0), tick * 10, busy, &StatusReport::default(), || {
            signals
        });
        while let Some(byte) = reporter.transmit() {
            let Some(Received::Frame(body)) = decoder.push(byte) else {
                continue;
            };
            let Ok(FromRobot::Telemetry(telemetry)) = FromRobot::from_body(&body) else {
                continue;
            };
            let ticks = telemetry
                .wheel_rad_s
                .map(|wheels| (wheels.left * 10.0).round() as u16);
            let sampled = telemetry.t_ms / 10;
            assert_eq!(ticks, [sampled - 2, sampled]);
            assert_eq!(telemetry.t_ms % 40, 30);
            let late = u16::from(telemetry.t_ms / 10 % 3 == 0);
            assert_eq!(telemetry.t_ms, (tick - late) * 10);
            frames += 1;
        }
    }
    assert_eq!(frames, 50);
}

/// What the station receives while the mode wants these headings, one per tick.
fn received_of(headings_rad: impl Iterator<Item = f32>) -> std::vec::Vec<FromRobot> {
    let mut reporter = Reporter::new(Hello {
        protocol: PROTOCOL_VERSION,
        schema: 0,
        image: 0,
        reset: ResetCause::PowerOn,
    });
    let mut decoder = Decoder::<64>::default();
    let mut received = std::vec::Vec::new();
    for heading_ref_rad in headings_rad {
        let signals = Signals {
            heading_ref_rad,
            ..Signals::default()
        };
        reporter.tick(Micros(0), 0, false, &StatusReport::default(), || signals);
        while let Some(byte) = reporter.transmit() {
            if let Some(Received::Frame(body)) = decoder.push(byte) {
                received.extend(FromRobot::from_body(&body));
            }
        }
    }
    received
}

#[test]
fn a_heading_reference_that_moves_is_sent_12_times_a_second_ahead_of_telemetry() {
    let received = received_of((0..1_000u16).map(|tick| f32::from(tick) * 1e-3));
    let places: std::vec::Vec<_> = (0..received.len())
        .filter(|place| matches!(received[*place], FromRobot::HeadingRef(_)))
        .collect();
    assert!((120..=126).contains(&places.len()), "{}", places.len());
    for place in places {
        assert!(matches!(received[place + 1], FromRobot::Telemetry(_)));
    }
}

#[test]
fn a_heading_reference_that_rests_is_sent_with_the_status_and_none_never() {
    let count = |heading_rad| {
        let received = received_of(core::iter::repeat_n(heading_rad, 1_000));
        let headings = received
            .iter()
            .filter(|message| matches!(message, FromRobot::HeadingRef(_)));
        headings.count()
    };
    assert!((19..=22).contains(&count(0.5)), "{}", count(0.5));
    assert_eq!(count(0.0), 0);
}
