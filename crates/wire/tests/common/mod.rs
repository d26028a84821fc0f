//! Any message, for property tests.
#![allow(dead_code, reason = "each test file uses some of it")]

use proptest::prelude::*;
use rumbo_control::mode::{ModeId, Movement, Reference};
use rumbo_control::rig::Rig;
use rumbo_control::{AgedRange, Duty, Fault, Pose, Range, Velocity, Wheels};
use rumbo_wire::message::Waypoint;
use rumbo_wire::*;

pub(crate) fn wheels<T: core::fmt::Debug + Clone>(
    value: impl Strategy<Value = T> + Clone,
) -> impl Strategy<Value = Wheels<T>> {
    (value.clone(), value).prop_map(|(left, right)| Wheels { left, right })
}

fn fault() -> impl Strategy<Value = Fault> {
    prop::sample::select(Fault::ALL.to_vec())
}

fn mode() -> impl Strategy<Value = ModeId> {
    prop::sample::select(ModeId::ALL.to_vec())
}

fn range() -> impl Strategy<Value = AgedRange> {
    prop_oneof![
        (0.0f32..2.55).prop_map(Range::Valid),
        Just(Range::Clear),
        Just(Range::Faulty)
    ]
    .prop_map(AgedRange::fresh)
}

prop_compose! {
    pub(crate) fn telemetry()(
        t_ms: u16,
        (x_m, y_m, heading_rad) in (-32.0f32..32.0, -32.0f32..32.0, -3.1f32..3.1),
        samples in (wheels(-40.0f32..40.0), wheels(-40.0f32..40.0)),
        wheel_ref_rad_s in wheels(-32.0f32..32.0),
        duty in wheels((-255i16..=255).prop_map(Duty::new)),
        state in 0u8..16,
        (armed, faulted) in any::<(bool, bool)>(),
        servo_rad in -1.6f32..1.6,
        ranges in [range(), range(), range()],
    ) -> Telemetry {
        let pose = Pose { x_m, y_m, heading_rad };
        Telemetry { t_ms, pose, wheel_rad_s: [samples.0, samples.1], wheel_ref_rad_s, duty, state, armed, faulted, servo_rad, ranges }
    }
}

pub(crate) fn time() -> impl Strategy<Value = RobotTime> {
    any::<(u8, u32)>().prop_map(|(start, ms)| RobotTime { start, ms })
}

prop_compose! {
    pub(crate) fn status()(
        (mode, armed, fault) in (mode(), any::<bool>(), prop::option::of(fault())),
        battery_v in prop::option::of(0.0f32..20.0),
        numbers in [-200.0f32..200.0, -200.0f32..200.0],
        (crc_errors, dropped, overruns) in any::<(u8, u8, u8)>(),
        rig in prop::sample::select(Rig::ALL.to_vec()),
        at in time(),
    ) -> StatusReport {
        let reference = Reference::new(mode.reference_kind(), numbers);
        StatusReport { mode, armed, fault, battery_v, reference, crc_errors, dropped, overruns, rig, at }
    }
}

/// Everything but telemetry, status, headings and the values of acknowledgements comes back exactly.
pub(crate) fn from_robot() -> impl Strategy<Value = FromRobot> {
    let hello = (
        any::<(u8, u32, u32)>(),
        prop::sample::select(ResetCause::ALL.to_vec()),
    )
        .prop_map(|((protocol, schema, image), reset)| {
            FromRobot::Hello(Hello {
                protocol,
                schema,
                image,
                reset,
            })
        });
    let kind = prop_oneof![
        Just(EventKind::Armed),
        Just(EventKind::Disarmed),
        fault().prop_map(EventKind::Faulted),
        fault().prop_map(EventKind::Cleared),
        mode().prop_map(EventKind::ModeChanged),
        Just(EventKind::Reached),
        Just(EventKind::Unreachable),
        any::<u16>().prop_map(|after_s| EventKind::GaveUp { after_s }),
        prop::sample::select(Recalled::ALL.to_vec()).prop_map(EventKind::Recalled),
        Just(EventKind::Saved),
    ];
    let event =
        (any::<u16>(), kind).prop_map(|(t_ms, kind)| FromRobot::Event(Event { t_ms, kind }));
    let result = prop_oneof![
        (-1e6f32..1e6).prop_map(Ok),
        prop::sample::select(Refusal::ALL.to_vec()).prop_map(Err),
    ];
    let ack = (any::<(u8, u16)>(), result).prop_map(|((session, number), result)| {
        FromRobot::Ack(Ack {
            session,
            number,
            result,
        })
    });
    prop_oneof![
        hello,
        telemetry().prop_map(FromRobot::Telemetry),
        status().prop_map(FromRobot::Status),
        event,
        ack,
        (-3.1f32..3.1).prop_map(FromRobot::HeadingRef)
    ]
}

pub(crate) fn command() -> impl Strategy<Value = Command> {
    let value = -1e6f32..1e6;
    let level = prop_oneof![
        (0.0f32..1.0).prop_map(MovementLevel::Duty),
        (0.0f32..30.0).prop_map(MovementLevel::Speed)
    ];
    let movement = prop::sample::select(vec![
        Movement::Stop,
        Movement::Forward,
        Movement::TurnLeft,
        Movement::PivotRightBackward,
        Movement::ArcRightBackward,
    ]);
    prop_oneof![
        prop::sample::select(vec![
            Command::Stop,
            Command::Arm,
            Command::Disarm,
            Command::ClearFault,
            Command::ResetParams,
            Command::SaveParams,
            Command::ResetPose,
            Command::Lane,
        ]),
        mode().prop_map(Command::Mode),
        value.clone().prop_map(Command::Reference),
        wheels(value.clone()).prop_map(Command::WheelReference),
        (movement, level).prop_map(|(movement, level)| Command::Move { movement, level }),
        (any::<u8>(), value).prop_map(|(id, value)| Command::SetParam { id, value }),
        any::<u8>().prop_map(|id| Command::GetParam { id }),
        (-20.0f32..20.0, -20.0f32..20.0).prop_map(|(x_m, y_m)| Command::Goal { x_m, y_m }),
        any::<(bool, bool)>().prop_map(|(repeat, relative)| Command::Route { repeat, relative }),
        (
            -20.0f32..20.0,
            -20.0f32..20.0,
            prop::option::of(-3.1f32..3.1)
        )
            .prop_map(|(x_m, y_m, heading_rad)| Command::Waypoint(Waypoint {
                x_m,
                y_m,
                heading_rad
            })),
    ]
}

pub(crate) fn to_robot() -> impl Strategy<Value = ToRobot> {
    prop_oneof![
        Just(ToRobot::Hello),
        Just(ToRobot::Heartbeat),
        (-32_767i16..=32_767, -32_767i16..=32_767, time()).prop_map(
            |(forward_mm_s, yaw_mrad_s, seen)| ToRobot::Velocity {
                velocity: Velocity {
                    forward_m_s: f32::from(forward_mm_s) / 1_000.0,
                    yaw_rad_s: f32::from(yaw_mrad_s) / 1_000.0,
                },
                seen,
            }
        ),
        (any::<(u8, u16)>(), command(), time()).prop_map(|((session, number), command, seen)| {
            ToRobot::Command {
                session,
                number,
                command,
                // Commands that do not carry it are unconstrained.
                seen: if command.is_timed() {
                    seen
                } else {
                    RobotTime::default()
                },
            }
        }),
    ]
}

/// A message of either direction, as a frame.
pub(crate) fn frame() -> impl Strategy<Value = Frame> {
    let either = prop_oneof![
        (from_robot(), 0u8..16).prop_map(|(message, seq)| message.frame(seq)),
        (to_robot(), 0u8..16).prop_map(|(message, seq)| message.frame(seq)),
    ];
    either.boxed()
}
