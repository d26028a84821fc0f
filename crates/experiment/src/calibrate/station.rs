//! The station's end of the link during a calibration: commands until they are acknowledged, heartbeats, telemetry.

use super::error::CalibrateError;
use super::link::Link;
use super::sample::Sample;
use rumbo_control::params::ParamId;
use rumbo_control::{Range, SIDES, Wheels};
use rumbo_wire::{
    Command, Decoder, EventKind, FrameMessage, FromRobot, GUEST_SESSION, Received, RobotTime,
    Telemetry, ToRobot,
};

/// Time between two polls of the link [us].
const LOOK_US: u64 = 5_000;
/// Time between heartbeats [us].
const HEARTBEAT_US: u64 = 100_000;
/// Time after which an unanswered command is repeated [us].
const REPEAT_US: u64 = 200_000;
/// Repetitions without an answer after which the robot is given up.
const TRIES: u32 = 15;
/// Longest line of the original's telemetry.
const LINE: usize = 160;

/// The station's end.
pub(super) struct Station {
    link: Link,
    number: u16,
    seq: u8,
    heartbeat_due_us: u64,
    decoder: Decoder<LINE>,
    buffer: Vec<u8>,
    t_ms: Option<u16>,
    /// The newest robot time received.
    seen: Option<RobotTime>,
    fault: Option<rumbo_control::Fault>,
    /// The mode has reached its reference since the last command.
    pub(super) reached: bool,
    answer: Option<(u16, Result<f32, rumbo_wire::Refusal>)>,
    /// All telemetry.
    pub(super) samples: Vec<Sample>,
}

impl Station {
    pub(super) fn new(link: Link) -> Self {
        Self {
            link,
            number: 0,
            seq: 0,
            heartbeat_due_us: 0,
            decoder: Decoder::default(),
            buffer: Vec::new(),
            t_ms: None,
            seen: None,
            fault: None,
            reached: false,
            answer: None,
            samples: Vec::new(),
        }
    }

    /// Time on this side [s].
    pub(super) fn now_s(&self) -> f64 {
        self.link.now_us() as f64 * 1e-6
    }

    /// The last sample.
    pub(super) fn last(&self) -> Result<Sample, CalibrateError> {
        self.samples.last().copied().ok_or(CalibrateError::NoAnswer)
    }

    /// Sends a command until it is acknowledged; returns the value in force.
    pub(super) async fn command(&mut self, command: Command) -> Result<f32, CalibrateError> {
        self.number = self.number.wrapping_add(1);
        self.reached = false;
        let until_us = self.link.now_us() + u64::from(TRIES) * REPEAT_US;
        while self.seen.is_none() && self.link.now_us() < until_us {
            self.look().await;
        }
        // It is issued now; repetitions carry the same time.
        let seen = self.seen.unwrap_or_default();
        for _ in 0..TRIES {
            self.send(&ToRobot::Command {
                session: GUEST_SESSION,
                number: self.number,
                command,
                seen,
            });
            let until_us = self.link.now_us() + REPEAT_US;
            while self.link.now_us() < until_us {
                self.look().await;
                match self.answer.take() {
                    Some((number, Ok(value))) if number == self.number => return Ok(value),
                    Some((number, Err(refusal))) if number == self.number => {
                        return Err(CalibrateError::Refused(command, refusal));
                    }
                    _ => {}
                }
            }
        }
        Err(CalibrateError::NoAnswer)
    }

    /// A parameter of the robot.
    pub(super) async fn parameter(&mut self, id: ParamId) -> Result<f64, CalibrateError> {
        self.command(Command::GetParam { id: id as u8 })
            .await
            .map(f64::from)
    }

    /// Sets a parameter of the robot.
    pub(super) async fn set_parameter(
        &mut self,
        id: ParamId,
        value: f64,
    ) -> Result<(), CalibrateError> {
        let value = value as f32;
        self.command(Command::SetParam {
            id: id as u8,
            value,
        })
        .await?;
        Ok(())
    }

    /// Runs until `done`, called at each new sample, or the time is over; returns which. A fault is an error.
    pub(super) async fn until(
        &mut self,
        within_s: f64,
        mut done: impl FnMut(&Self, &Sample) -> bool,
    ) -> Result<bool, CalibrateError> {
        let end_us = self.link.now_us() + (within_s * 1e6) as u64;
        let mut seen = self.samples.len();
        while self.link.now_us() < end_us {
            self.look().await;
            if let Some(fault) = self.fault {
                return Err(CalibrateError::Faulted(fault));
            }
            while let Some(sample) = self.samples.get(seen).copied() {
                seen += 1;
                if done(self, &sample) {
                    return Ok(true);
                }
            }
        }
        Ok(false)
    }

    /// Runs for a while.
    pub(super) async fn wait(&mut self, seconds: f64) -> Result<(), CalibrateError> {
        self.until(seconds, |_, _| false).await.map(|_| ())
    }

    /// Stops the robot, in any state.
    pub(super) async fn stop(&mut self) {
        // A robot that no longer answers stops by itself, for lack of heartbeats.
        let _ = self.command(Command::Stop).await;
    }

    fn send(&mut self, message: &ToRobot) {
        self.link.send(message.frame(self.seq).bytes());
        self.seq = self.seq.wrapping_add(1);
    }

    /// One poll interval.
    async fn look(&mut self) {
        let now_us = self.link.now_us();
        if now_us >= self.heartbeat_due_us {
            self.send(&ToRobot::Heartbeat);
            self.heartbeat_due_us = now_us + HEARTBEAT_US;
        }
        self.link.wait_until(now_us + LOOK_US).await;
        let mut buffer = std::mem::take(&mut self.buffer);
        buffer.clear();
        self.link.receive(&mut buffer);
        for byte in &buffer {
            if let Some(Received::Frame(body)) = self.decoder.push(*byte)
                && let Ok(message) = FromRobot::from_body(&body)
            {
                self.handle(&message);
            }
        }
        self.buffer = buffer;
    }

    fn handle(&mut self, message: &FromRobot) {
        self.seen = RobotTime::after(self.seen, message);
        match message {
            FromRobot::Telemetry(telemetry) => self.ingest(telemetry),
            FromRobot::Ack(ack) if ack.session == GUEST_SESSION => {
                self.answer = Some((ack.number, ack.result));
            }
            FromRobot::Event(event) => match event.kind {
                EventKind::Faulted(fault) => self.fault = Some(fault),
                EventKind::Reached => self.reached = true,
                _ => {}
            },
            _ => {}
        }
    }

    fn ingest(&mut self, telemetry: &Telemetry) {
        let before = self.samples.last();
        let passed_ms = self
            .t_ms
            .map_or(0, |t_ms| telemetry.t_ms.wrapping_sub(t_ms));
        self.t_ms = Some(telemetry.t_ms);
        let wrapped_rad = f64::from(telemetry.pose.heading_rad);
        let heading_rad = before.map_or(wrapped_rad, |before| {
            let change = wrapped_rad - before.heading_rad;
            before.heading_rad + change
                - std::f64::consts::TAU * (change / std::f64::consts::TAU).round()
        });
        let mut duty = Wheels::both(0.0);
        for side in SIDES {
            duty[side] = f64::from(telemetry.duty[side].counts()) / 255.0;
        }
        self.samples.push(Sample {
            t_s: before.map_or(0.0, |before| before.t_s) + f64::from(passed_ms) * 1e-3,
            x_m: f64::from(telemetry.pose.x_m),
            y_m: f64::from(telemetry.pose.y_m),
            heading_rad,
            wheel_rad_s: telemetry.wheel_rad_s[1].map(f64::from),
            reference_rad_s: telemetry.wheel_ref_rad_s.map(f64::from),
            duty,
            range_m: telemetry.ranges.map(|range| match range.range {
                Range::Valid(range_m) => Some(f64::from(range_m)),
                Range::Clear | Range::Faulty => None,
            }),
            faulty: telemetry
                .ranges
                .map(|range| matches!(range.range, Range::Faulty)),
        });
    }
}
