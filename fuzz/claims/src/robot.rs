//! Any input from the link and the sensors, at any times: the robot keeps running, its output is well formed, and it
//! drives no wheel unless it is armed.

use arbitrary::Arbitrary;
use rumbo_control::{Echo, Edges, Inputs, Micros, SonarId, Wheels};
use rumbo_robot::{Robot, RobotConfig};
use rumbo_wire::{Decoder, Frame, FrameMessage, FromRobot, Kind, Received, ResetCause};

/// Ticks that a run may have.
const TICKS: u32 = 2_000;
/// Between ticks [us].
const TICK_US: u32 = 10_000;

/// What the robot is given.
#[derive(Debug, Arbitrary)]
pub enum Step {
    /// Bytes on the link.
    Bytes(Vec<u8>),
    /// A frame with a CRC that is right, of whatever kind and content.
    Frame {
        /// Any kind, of as many as there are.
        kind: u8,
        /// Its number.
        seq: u8,
        /// Its content.
        payload: Vec<u8>,
    },
    /// Ticks of the sensors.
    Ticks(Ticks),
}

/// Ticks that are alike.
#[derive(Debug, Arbitrary)]
pub struct Ticks {
    count: u8,
    /// Late by so many microseconds each.
    late_us: u16,
    /// Edges of each wheel in a tick.
    edges: [u8; 2],
    echo: Option<(u8, u16)>,
    battery_v: Option<f32>,
}

struct Bench {
    robot: Robot,
    said: Decoder<128>,
    now: Micros,
    edges: Wheels<Edges>,
    ticks: u32,
}

impl Bench {
    fn step(&mut self, step: Step) {
        match step {
            Step::Bytes(bytes) => bytes.iter().for_each(|byte| self.robot.receive(*byte)),
            Step::Frame { kind, seq, payload } => {
                let kind = Kind::ALL[usize::from(kind) % Kind::ALL.len()];
                let frame = Frame::new(kind, seq, &payload);
                frame
                    .bytes()
                    .iter()
                    .for_each(|byte| self.robot.receive(*byte));
            }
            Step::Ticks(ticks) => (0..ticks.count).for_each(|_| self.tick(&ticks)),
        }
    }

    fn tick(&mut self, like: &Ticks) {
        if self.ticks >= TICKS {
            return;
        }
        self.ticks += 1;
        let step_us = TICK_US + u32::from(like.late_us);
        self.now = self.now.after(step_us);
        let [left, right] = like.edges;
        for (edges, new) in [(&mut self.edges.left, left), (&mut self.edges.right, right)] {
            if new > 0 {
                edges.count = edges.count.wrapping_add(new.into());
                edges.last = self.now;
                edges.turn_us = 8 * step_us / u32::from(new);
            }
        }
        let inputs = Inputs {
            now: self.now,
            encoders: self.edges,
            echo: like.echo.map(|(sonar, us)| {
                let sonar = SonarId::ALL[usize::from(sonar) % SonarId::ALL.len()];
                let echo = match us {
                    0 => Echo::Silent,
                    u16::MAX => Echo::Clear,
                    _ => Echo::Pulse(us.into()),
                };
                (sonar, echo)
            }),
            battery_v: like.battery_v,
        };
        let outputs = self.robot.tick(&inputs);
        if self.robot.mode_state().is_none() {
            assert_eq!(outputs.drive, Wheels::default(), "driven, not armed");
        }
        self.robot.report();
        while let Some(byte) = self.robot.transmit() {
            if let Some(Received::Frame(body)) = self.said.push(byte) {
                assert!(FromRobot::from_body(&body).is_ok(), "{body:?}");
            }
        }
        while self.robot.store().is_some() {}
    }
}

/// Panics if the claim does not hold.
pub fn check(steps: Vec<Step>) {
    let mut bench = Bench {
        robot: Robot::new(RobotConfig {
            image: 0,
            reset: ResetCause::PowerOn,
            start: 0,
        }),
        said: Decoder::default(),
        now: Micros(u32::MAX - 3_000_000),
        edges: Wheels::default(),
        ticks: 0,
    };
    for step in steps {
        bench.step(step);
    }
    assert_eq!(bench.said.crc_errors(), 0);
}
