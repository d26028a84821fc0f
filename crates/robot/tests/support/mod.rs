//! A bench for the robot: a link at 9600 baud, wheels that follow the duty with a lag, a wall in front.
#![allow(dead_code, reason = "each test file uses some of it")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "test helpers")]

use std::collections::VecDeque;

use rumbo_control::{Echo, Edges, Inputs, Micros, Outputs, SIDES, SonarId, TICK_US, Wheels};
use rumbo_robot::{Robot, RobotConfig};
use rumbo_wire::{
    Ack, Command, Decoder, EventKind, Frame, FrameMessage, FromRobot, Received, Refusal,
    ResetCause, RobotTime, StatusReport, Telemetry, ToRobot,
};

/// Bytes that 9600 baud carry in 100 ticks.
const BYTES_PER_100_TICKS: u32 = 960;
/// Speed of the bench's wheels at full duty [rad/s].
const FULL_SPEED_RAD_S: f32 = 20.0;
/// Share of the way to the speed of their duty that the wheels make in a tick: a time constant of 0.25 s.
const LAG: f32 = 0.04;
/// Width of an edge [rad].
const EDGE_RAD: f32 = core::f32::consts::TAU / 384.0;
/// Speed of the session, if none is given.
pub(crate) const SESSION: u8 = 0x51;

/// One wheel and its encoder.
#[derive(Clone, Copy, Default)]
struct Wheel {
    speed_rad_s: f32,
    angle_rad: f32,
    edges: Edges,
    times: [u32; 8],
}

impl Wheel {
    fn turn(&mut self, duty: f32, from_us: u32) {
        self.speed_rad_s += (duty * FULL_SPEED_RAD_S - self.speed_rad_s) * LAG;
        let step_rad = self.speed_rad_s.abs() * 0.001;
        for ms in 0..TICK_US / 1_000 {
            self.angle_rad += step_rad;
            while self.angle_rad >= EDGE_RAD {
                self.angle_rad -= EDGE_RAD;
                let since_us = 1_000.0 * (1.0 - self.angle_rad / step_rad);
                let at_us = from_us.wrapping_add(ms * 1_000 + since_us as u32);
                let slot = usize::from(self.edges.count) % 8;
                if self.edges.count >= 8 {
                    self.edges.turn_us = at_us.wrapping_sub(self.times[slot]);
                }
                self.times[slot] = at_us;
                self.edges.count = self.edges.count.wrapping_add(1);
                self.edges.last = Micros(at_us);
            }
        }
    }
}

/// The robot on its bench.
pub(crate) struct Bench {
    pub(crate) robot: Robot,
    pub(crate) now: Micros,
    pub(crate) outputs: Outputs,
    /// All messages received from the robot, in order.
    pub(crate) received: Vec<FromRobot>,
    /// Lines of text received from it.
    pub(crate) lines: Vec<String>,
    /// Bytes it sent.
    pub(crate) bytes: usize,
    /// The link takes bytes from the robot.
    pub(crate) link_up: bool,
    /// A heartbeat goes out every 200 ms.
    pub(crate) heartbeats: bool,
    /// Distance of the wall, by `SonarId` number; `None`: the sonar is cut.
    pub(crate) wall_us: [Option<u32>; 3],
    /// The wheels are held.
    pub(crate) held: bool,
    pub(crate) battery_v: Option<f32>,
    wheels: Wheels<Wheel>,
    pending: VecDeque<(u32, SonarId)>,
    decoder: Decoder<128>,
    credit: u32,
    tick: u32,
    number: u16,
    seq: u8,
    /// The robot's time in its last status.
    pub(crate) seen: RobotTime,
}

impl Bench {
    /// A robot just started, its clock at `start`.
    pub(crate) fn at(start: Micros) -> Bench {
        Bench {
            robot: Robot::new(RobotConfig {
                image: 0,
                reset: ResetCause::PowerOn,
                start: 0,
            }),
            now: start,
            outputs: Outputs::default(),
            received: Vec::new(),
            lines: Vec::new(),
            bytes: 0,
            link_up: true,
            heartbeats: true,
            wall_us: [Some(5_824); 3],
            held: false,
            battery_v: None,
            wheels: Wheels::default(),
            pending: VecDeque::new(),
            decoder: Decoder::default(),
            credit: 0,
            tick: 0,
            number: 0,
            seq: 0,
            seen: RobotTime::default(),
        }
    }

    /// A robot just started.
    pub(crate) fn new() -> Bench {
        Bench::at(Micros(0))
    }

    /// A robot that has run for half a second, with a live link.
    pub(crate) fn alive() -> Bench {
        let mut bench = Bench::new();
        bench.ticks(50);
        bench
    }

    /// The robot's time: that of its last tick.
    pub(crate) fn time(&self) -> RobotTime {
        RobotTime {
            start: 0,
            ms: (self.tick - 1) * (TICK_US / 1_000),
        }
    }

    /// Runs this many ticks.
    pub(crate) fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.one_tick();
        }
    }

    fn one_tick(&mut self) {
        if self.heartbeats && self.tick.is_multiple_of(20) {
            self.send(&ToRobot::Heartbeat);
        }
        let echo = match self.pending.front() {
            Some((due, sonar)) if *due <= self.tick => {
                let sonar = *sonar;
                self.pending.pop_front();
                Some((
                    sonar,
                    self.wall_us[sonar as usize].map_or(Echo::Silent, Echo::Pulse),
                ))
            }
            _ => None,
        };
        let encoders = self.wheels.map(|wheel| wheel.edges);
        let inputs = Inputs {
            now: self.now,
            encoders,
            echo,
            battery_v: self.battery_v,
        };
        self.outputs = self.robot.tick(&inputs);
        self.robot.report();
        if let Some(sonar) = self.outputs.ping {
            self.pending.push_back((self.tick + 2, sonar));
        }
        for side in SIDES {
            let duty = f32::from(self.outputs.drive[side].counts()) / 255.0;
            if !self.held {
                self.wheels[side].turn(duty, self.now.0);
            }
        }
        self.now = self.now.after(TICK_US);
        self.tick += 1;
        self.credit += BYTES_PER_100_TICKS;
        while self.credit >= 100 {
            self.credit -= 100;
            if self.link_up {
                self.receive_byte();
            }
        }
    }

    fn receive_byte(&mut self) {
        let Some(byte) = self.robot.transmit() else {
            return;
        };
        self.bytes += 1;
        match self.decoder.push(byte) {
            Some(Received::Frame(body)) => {
                let message = FromRobot::from_body(&body).unwrap();
                if let FromRobot::Status(status) = message {
                    self.seen = status.at;
                }
                self.received.push(message);
            }
            Some(Received::Line(line)) => {
                self.lines.push(String::from_utf8_lossy(line).into_owned())
            }
            None => {}
        }
    }

    /// Sends the robot a message.
    pub(crate) fn send(&mut self, message: &ToRobot) {
        let frame: Frame = message.frame(self.seq);
        self.seq = (self.seq + 1) % 16;
        self.bytes_in(frame.bytes());
    }

    /// Sends the robot bytes.
    pub(crate) fn bytes_in(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|byte| self.robot.receive(*byte));
    }

    /// Sends the robot a line of text.
    pub(crate) fn line(&mut self, line: &str) {
        self.bytes_in(format!("{line}\n").as_bytes());
    }

    /// Sends the next command of the session and waits for its answer.
    pub(crate) fn command(&mut self, command: Command) -> Result<f32, Refusal> {
        self.number = self.number.wrapping_add(1);
        self.numbered(SESSION, self.number, command)
    }

    /// Sends a command and waits for its answer.
    pub(crate) fn numbered(
        &mut self,
        session: u8,
        number: u16,
        command: Command,
    ) -> Result<f32, Refusal> {
        let before = self.acks().len();
        self.send(&ToRobot::Command {
            session,
            number,
            command,
            seen: self.seen,
        });
        self.ticks(20);
        let acks = self.acks();
        assert_eq!(acks.len(), before + 1, "one answer to {command:?}");
        let ack = acks.last().unwrap();
        assert_eq!((ack.session, ack.number), (session, number));
        ack.result
    }

    /// Selects mode 5 with both wheels at 5 rad/s, and arms.
    pub(crate) fn drive(&mut self) {
        use rumbo_control::mode::ModeId;
        self.command(Command::Mode(ModeId::WheelSpeed)).unwrap();
        self.command(Command::Reference(5.0)).unwrap();
        self.command(Command::Arm).unwrap();
        assert!(self.is_driven());
    }

    /// A bridge is on.
    pub(crate) fn is_driven(&self) -> bool {
        SIDES
            .into_iter()
            .any(|side| self.outputs.drive[side].counts() != 0)
    }

    /// All answers so far.
    pub(crate) fn acks(&self) -> Vec<Ack> {
        self.received
            .iter()
            .filter_map(|m| {
                if let FromRobot::Ack(ack) = m {
                    Some(*ack)
                } else {
                    None
                }
            })
            .collect()
    }

    /// All events so far.
    pub(crate) fn events(&self) -> Vec<EventKind> {
        self.received
            .iter()
            .filter_map(|m| {
                if let FromRobot::Event(event) = m {
                    Some(event.kind)
                } else {
                    None
                }
            })
            .collect()
    }

    /// All telemetry so far.
    pub(crate) fn telemetry(&self) -> Vec<Telemetry> {
        self.received
            .iter()
            .filter_map(|m| {
                if let FromRobot::Telemetry(t) = m {
                    Some(*t)
                } else {
                    None
                }
            })
            .collect()
    }

    /// The last status.
    pub(crate) fn status(&self) -> StatusReport {
        self.received
            .iter()
            .rev()
            .find_map(|m| {
                if let FromRobot::Status(s) = m {
                    Some(*s)
                } else {
                    None
                }
            })
            .unwrap()
    }
}
