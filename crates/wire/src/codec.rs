//! Messages to frames and back. All numbers little-endian; `docs/protocol.md` lists every byte.
//!
//! Decoding checks lengths and numbers of enumerations, never plausibility: a non-finite value is passed on, and the
//! robot refuses it with a reason.

mod command;

use command::{command, mode, put_command};
use rumbo_control::math::{is_finite, round};
use rumbo_control::mode::Reference;
use rumbo_control::rig::Rig;
use rumbo_control::{AgedRange, Duty, Fault, Pose, Range, Velocity, Wheels};

use crate::bytes::{Reader, Writer};
use crate::frame::{Frame, FrameBody, Kind};
use crate::malformed::Malformed;
use crate::message::*;
use crate::quantise::{from_i12, from_i16, from_turn, limited, to_i12, to_i16, to_turn};

/// What travels in frames in one direction.
pub trait FrameMessage: Sized {
    /// The frame for this message, number `seq` of its direction (modulo 16).
    fn frame(&self, seq: u8) -> Frame;

    /// The message in a frame.
    ///
    /// # Errors
    /// If the frame holds no message of this direction.
    fn from_body(body: &FrameBody) -> Result<Self, Malformed>;
}

impl FrameMessage for FromRobot {
    fn frame(&self, seq: u8) -> Frame {
        let mut to = Writer::default();
        let kind = match self {
            FromRobot::Hello(hello) => put_hello(&mut to, hello),
            FromRobot::Telemetry(telemetry) => put_telemetry(&mut to, telemetry),
            FromRobot::Status(status) => put_status(&mut to, status),
            FromRobot::Event(event) => put_event(&mut to, event),
            FromRobot::Ack(ack) => put_ack(&mut to, ack),
            FromRobot::HeadingRef(heading_rad) => {
                to.put(to_turn(*heading_rad).to_le_bytes());
                Kind::HeadingRef
            }
        };
        Frame::new(kind, seq, to.payload())
    }

    fn from_body(body: &FrameBody) -> Result<Self, Malformed> {
        let mut from = Reader::new(body.payload());
        let message = match body.kind {
            Kind::RobotHello => FromRobot::Hello(hello(&mut from)?),
            Kind::Telemetry => FromRobot::Telemetry(telemetry(&mut from)),
            Kind::Status => FromRobot::Status(status(&mut from)?),
            Kind::Event => FromRobot::Event(event(&mut from)?),
            Kind::Ack => FromRobot::Ack(ack(&mut from)?),
            Kind::HeadingRef => FromRobot::HeadingRef(from_turn(from.u16())),
            Kind::StationHello | Kind::Heartbeat | Kind::Command | Kind::Velocity => {
                return Err(Malformed::Direction);
            }
        };
        from.finish()?;
        Ok(message)
    }
}

impl FrameMessage for ToRobot {
    fn frame(&self, seq: u8) -> Frame {
        let mut to = Writer::default();
        let kind = match self {
            ToRobot::Hello => Kind::StationHello,
            ToRobot::Heartbeat => Kind::Heartbeat,
            ToRobot::Command {
                session,
                number,
                command,
                seen,
            } => {
                to.put([*session]).put(number.to_le_bytes());
                put_command(&mut to, command);
                if command.is_timed() {
                    put_time(&mut to, seen);
                }
                Kind::Command
            }
            ToRobot::Velocity { velocity, seen } => {
                to.put(to_i16(velocity.forward_m_s, VELOCITY_PER_UNIT).to_le_bytes())
                    .put(to_i16(velocity.yaw_rad_s, VELOCITY_PER_UNIT).to_le_bytes());
                put_time(&mut to, seen);
                Kind::Velocity
            }
        };
        Frame::new(kind, seq, to.payload())
    }

    fn from_body(body: &FrameBody) -> Result<Self, Malformed> {
        let mut from = Reader::new(body.payload());
        let message = match body.kind {
            // A later version may append to its HELLO: it is still one.
            Kind::StationHello => return Ok(ToRobot::Hello),
            Kind::Heartbeat => ToRobot::Heartbeat,
            Kind::Command => {
                let (session, number) = (from.u8(), from.u16());
                let command = command(&mut from)?;
                ToRobot::Command {
                    session,
                    number,
                    command,
                    seen: if command.is_timed() {
                        time(&mut from)
                    } else {
                        RobotTime::default()
                    },
                }
            }
            Kind::Velocity => ToRobot::Velocity {
                velocity: Velocity {
                    forward_m_s: from_i16(from.i16(), VELOCITY_PER_UNIT),
                    yaw_rad_s: from_i16(from.i16(), VELOCITY_PER_UNIT),
                },
                seen: time(&mut from),
            },
            _ => return Err(Malformed::Direction),
        };
        from.finish()?;
        Ok(message)
    }
}

fn put_hello(to: &mut Writer, hello: &Hello) -> Kind {
    to.put([hello.protocol])
        .put(hello.schema.to_le_bytes())
        .put(hello.image.to_le_bytes())
        .put([hello.reset as u8]);
    Kind::RobotHello
}

fn hello(from: &mut Reader) -> Result<Hello, Malformed> {
    Ok(Hello {
        protocol: from.u8(),
        schema: from.u32(),
        image: from.u32(),
        reset: ResetCause::from_number(from.u8()).ok_or(from.wrong())?,
    })
}

/// Positions are sent in millimetres.
const POSITION_PER_M: f32 = 1_000.0;
/// Velocities are sent in mm/s and mrad/s.
const VELOCITY_PER_UNIT: f32 = 1_000.0;
/// Wheel speeds and their references are sent in 0.02 rad/s: up to 40.9 rad/s, 391 rpm.
const SPEED_PER_RAD_S: f32 = 50.0;
/// Ranges are sent in 2.5 mm: up to 2.5525 m.
const RANGE_PER_M: f32 = 400.0;
/// Ten bits, of which the two highest codes are special.
const RANGE_MAX: i16 = 1_021;
const RANGE_CLEAR: u32 = 1_022;
const RANGE_FAULTY: u32 = 1_023;

fn put_telemetry(to: &mut Writer, telemetry: &Telemetry) -> Kind {
    let Telemetry {
        t_ms,
        pose,
        wheel_rad_s,
        wheel_ref_rad_s,
        duty,
        state,
        armed,
        faulted,
        servo_rad,
        ranges,
    } = telemetry;
    to.put(t_ms.to_le_bytes());
    // One marked value makes the whole pose unknown.
    let known = is_finite(pose.x_m) && is_finite(pose.y_m) && is_finite(pose.heading_rad);
    let pose = if known {
        *pose
    } else {
        Pose {
            x_m: f32::NAN,
            y_m: f32::NAN,
            heading_rad: 0.0,
        }
    };
    to.put(to_i16(pose.x_m, POSITION_PER_M).to_le_bytes());
    to.put(to_i16(pose.y_m, POSITION_PER_M).to_le_bytes());
    to.put(to_turn(pose.heading_rad).to_le_bytes());
    let [earlier_rad_s, now_rad_s] = wheel_rad_s;
    for sample in &[earlier_rad_s, now_rad_s, wheel_ref_rad_s] {
        let [left_low, left_high] = to_i12(sample.left, SPEED_PER_RAD_S).to_le_bytes();
        let right = to_i12(sample.right, SPEED_PER_RAD_S);
        let [right_low, right_high] = (right << 4).to_le_bytes();
        to.put([left_low, left_high | right_low, right_high]);
    }
    let counts = |duty: Duty| u32::from(duty.counts().cast_unsigned() & 0x1FF);
    let bits = counts(duty.left)
        | counts(duty.right) << 9
        | u32::from(state & 0xF) << 18
        | u32::from(*armed) << 22
        | u32::from(*faulted) << 23;
    let [low, middle, high, _] = bits.to_le_bytes();
    to.put([low, middle, high]);
    let servo = if is_finite(*servo_rad) {
        limited(servo_rad * SERVO_PER_RAD, 127)
    } else {
        0
    };
    to.put((servo as i8).to_le_bytes());
    let [left, right, front] = ranges;
    let codes =
        range_code(left.range) | range_code(right.range) << 10 | range_code(front.range) << 20;
    to.put(codes.to_le_bytes());
    Kind::Telemetry
}

fn telemetry(from: &mut Reader) -> Telemetry {
    let t_ms = from.u16();
    let mut pose = Pose {
        x_m: from_i16(from.i16(), POSITION_PER_M),
        y_m: from_i16(from.i16(), POSITION_PER_M),
        heading_rad: from_turn(from.u16()),
    };
    if pose.x_m.is_nan() {
        pose.heading_rad = f32::NAN;
    }
    let mut speeds = [Wheels::both(0.0); 3];
    for sample in &mut speeds {
        let [low, middle, high] = from.take();
        sample.left = from_i12(u16::from_le_bytes([low, middle]) & 0xFFF, SPEED_PER_RAD_S);
        sample.right = from_i12(u16::from_le_bytes([middle, high]) >> 4, SPEED_PER_RAD_S);
    }
    let [earlier_rad_s, now_rad_s, wheel_ref_rad_s] = speeds;
    let [low, middle, high] = from.take();
    let bits = u32::from_le_bytes([low, middle, high, 0]);
    // Nine bits, signed.
    let counts = |bits: u32| Duty::new(((bits as u16) << 7).cast_signed() >> 7);
    let servo_rad = f32::from(i8::from_le_bytes(from.take())) / SERVO_PER_RAD;
    let ranges = from.u32();
    Telemetry {
        t_ms,
        pose,
        wheel_rad_s: [earlier_rad_s, now_rad_s],
        wheel_ref_rad_s,
        duty: Wheels {
            left: counts(bits),
            right: counts(bits >> 9),
        },
        state: (bits >> 18 & 0xF) as u8,
        armed: bits & 1 << 22 != 0,
        faulted: bits & 1 << 23 != 0,
        servo_rad,
        ranges: [ranges, ranges >> 10, ranges >> 20].map(|code| AgedRange {
            range: range(code & 0x3FF),
            age_ticks: 0,
        }),
    }
}

fn range_code(range: Range) -> u32 {
    match range {
        Range::Valid(range_m) if is_finite(range_m) => u32::from(
            limited(range_m * RANGE_PER_M, RANGE_MAX)
                .max(0)
                .unsigned_abs(),
        ),
        Range::Clear => RANGE_CLEAR,
        Range::Valid(_) | Range::Faulty => RANGE_FAULTY,
    }
}

fn range(code: u32) -> Range {
    match code {
        RANGE_CLEAR => Range::Clear,
        RANGE_FAULTY => Range::Faulty,
        _ => Range::Valid(f32::from(code as u16) / RANGE_PER_M),
    }
}

/// The battery is sent in millivolts; the highest code means that it is not measured.
const BATTERY_PER_V: f32 = 1_000.0;
const BATTERY_UNKNOWN: u16 = u16::MAX;
/// The servo's angle is sent in degrees.
const SERVO_PER_RAD: f32 = 180.0 / core::f32::consts::PI;

fn put_status(to: &mut Writer, status: &StatusReport) -> Kind {
    let battery = match status.battery_v {
        Some(volts) if is_finite(volts) => round(volts * BATTERY_PER_V).clamp(0, 65_534) as u16,
        _ => BATTERY_UNKNOWN,
    };
    to.put([
        status.mode as u8,
        u8::from(status.armed),
        status.fault.map_or(0, |fault| fault as u8),
    ]);
    to.put(battery.to_le_bytes());
    for number in status.reference.numbers() {
        to.put(number.to_le_bytes());
    }
    to.put([
        status.crc_errors,
        status.dropped,
        status.overruns,
        status.rig as u8,
    ]);
    put_time(to, &status.at);
    Kind::Status
}

fn put_time(to: &mut Writer, time: &RobotTime) {
    to.put([time.start]).put(time.ms.to_le_bytes());
}

fn time(from: &mut Reader) -> RobotTime {
    RobotTime {
        start: from.u8(),
        ms: from.u32(),
    }
}

fn status(from: &mut Reader) -> Result<StatusReport, Malformed> {
    let mode = mode(from)?;
    Ok(StatusReport {
        mode,
        armed: from.u8() & 1 != 0,
        fault: match from.u8() {
            0 => None,
            number => Some(Fault::from_number(number).ok_or(from.wrong())?),
        },
        battery_v: match from.u16() {
            BATTERY_UNKNOWN => None,
            code => Some(f32::from(code) / BATTERY_PER_V),
        },
        reference: Reference::new(mode.reference_kind(), [from.f32(), from.f32()]),
        crc_errors: from.u8(),
        dropped: from.u8(),
        overruns: from.u8(),
        rig: Rig::from_number(from.u8()).ok_or(from.wrong())?,
        at: time(from),
    })
}

fn fault(from: &mut Reader) -> Result<Fault, Malformed> {
    Fault::from_number(from.u8()).ok_or(from.wrong())
}

fn put_event(to: &mut Writer, event: &Event) -> Kind {
    to.put(event.t_ms.to_le_bytes());
    match event.kind {
        EventKind::Armed => to.put([1]),
        EventKind::Disarmed => to.put([2]),
        EventKind::Faulted(fault) => to.put([3, fault as u8]),
        EventKind::Cleared(fault) => to.put([4, fault as u8]),
        EventKind::ModeChanged(mode) => to.put([5, mode as u8]),
        EventKind::Reached => to.put([6]),
        EventKind::Unreachable => to.put([7]),
        EventKind::Recalled(recalled) => to.put([8, recalled as u8]),
        EventKind::Saved => to.put([9]),
        EventKind::GaveUp { after_s } => to.put([10]).put(after_s.to_le_bytes()),
    };
    Kind::Event
}

fn event(from: &mut Reader) -> Result<Event, Malformed> {
    let t_ms = from.u16();
    let kind = match from.u8() {
        1 => EventKind::Armed,
        2 => EventKind::Disarmed,
        3 => EventKind::Faulted(fault(from)?),
        4 => EventKind::Cleared(fault(from)?),
        5 => EventKind::ModeChanged(mode(from)?),
        6 => EventKind::Reached,
        7 => EventKind::Unreachable,
        8 => EventKind::Recalled(Recalled::from_number(from.u8()).ok_or(from.wrong())?),
        9 => EventKind::Saved,
        10 => EventKind::GaveUp {
            after_s: from.u16(),
        },
        _ => return Err(from.wrong()),
    };
    Ok(Event { t_ms, kind })
}

fn put_ack(to: &mut Writer, ack: &Ack) -> Kind {
    to.put([ack.session]).put(ack.number.to_le_bytes());
    match ack.result {
        Ok(value) => to.put([0]).put(value.to_le_bytes()),
        Err(refusal) => to.put([refusal as u8]),
    };
    Kind::Ack
}

fn ack(from: &mut Reader) -> Result<Ack, Malformed> {
    Ok(Ack {
        session: from.u8(),
        number: from.u16(),
        result: match from.u8() {
            0 => Ok(from.f32()),
            number => Err(Refusal::from_number(number).ok_or(from.wrong())?),
        },
    })
}

/// Session and number of a command frame, also of one whose command is not understood: it can still be refused.
pub fn command_number(body: &FrameBody) -> Option<(u8, u16)> {
    let mut from = Reader::new(body.payload());
    match body.kind {
        Kind::Command => {
            let number = (from.u8(), from.u16());
            (!from.is_short()).then_some(number)
        }
        _ => None,
    }
}
