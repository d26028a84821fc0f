//! A toy robot for the tests of session and station: a point between the start and a wall, speaking the binary protocol
//! over a link of 9600 baud.
//!
//! It knows no physics and none of the real control; it answers, and it moves when armed.

use rumbo_control::mode::{ModeId, Reference};
use rumbo_control::params::{ParamId, Params, SCHEMA};
use rumbo_control::{AgedRange, Duty, Pose, Range, Velocity, Wheels};
use rumbo_log::{Choice, MapPose, ScenarioOffer, Scene, SceneObstacle, SonarMount, Truth};
use rumbo_session::{Abilities, Target, TargetError};
use rumbo_wire::{
    Ack, Command, Decoder, Event, EventKind, FrameMessage, FromRobot, Hello, PROTOCOL_VERSION,
    Received, Refusal, ResetCause, RobotTime, StatusReport, Telemetry, ToRobot,
};
use std::collections::VecDeque;

const TICK_US: u64 = 10_000;
const BYTE_US: u64 = 1_042;
const WALL_M: f32 = 1.2;
const WHEEL_RADIUS_M: f32 = 0.0325;

/// The toy.
pub(crate) struct Toy {
    now_us: u64,
    start: u8,
    started_us: u64,
    up: VecDeque<(u64, u8)>,
    down: VecDeque<(u64, u8)>,
    decoder: Decoder<64>,
    sequence: u8,
    last: Option<Ack>,
    mode: ModeId,
    armed: bool,
    reference: Wheels<f32>,
    wheel_rad_s: f32,
    before_rad_s: f32,
    x_m: f32,
    params: Params,
    choice: Choice,
    /// How often each command was applied.
    pub(crate) applied: Vec<Command>,
    /// The velocities that arrived.
    pub(crate) velocities: Vec<Velocity>,
}

impl Default for Toy {
    fn default() -> Self {
        Self {
            now_us: 0,
            start: 0,
            started_us: 0,
            up: VecDeque::new(),
            down: VecDeque::new(),
            decoder: Decoder::default(),
            sequence: 0,
            last: None,
            mode: ModeId::Manual,
            armed: false,
            reference: Wheels::both(0.3),
            wheel_rad_s: 0.0,
            before_rad_s: 0.0,
            x_m: 0.0,
            params: Params::default(),
            choice: Choice {
                scenario: "toy".into(),
                world: None,
                rig: None,
                seed: 1,
            },
            applied: Vec::new(),
            velocities: Vec::new(),
        }
    }
}

impl Toy {
    fn say(&mut self, message: FromRobot) {
        let frame = message.frame(self.sequence);
        self.sequence = self.sequence.wrapping_add(1);
        queue(&mut self.down, frame.bytes(), self.now_us);
    }

    fn event(&mut self, kind: EventKind) {
        let t_ms = self.t_ms();
        self.say(FromRobot::Event(Event { t_ms, kind }));
    }

    /// Starts again, as by its reset button, and says so; what was on its way to it still arrives.
    #[allow(dead_code, reason = "not every test has a robot that starts again")]
    pub(crate) fn restart(&mut self) {
        let Self { now_us, start, .. } = *self;
        *self = Self {
            now_us,
            start: start.wrapping_add(1),
            started_us: now_us,
            up: std::mem::take(&mut self.up),
            down: std::mem::take(&mut self.down),
            applied: std::mem::take(&mut self.applied),
            velocities: std::mem::take(&mut self.velocities),
            ..Self::default()
        };
        self.hello();
    }

    fn hello(&mut self) {
        self.say(FromRobot::Hello(Hello {
            protocol: PROTOCOL_VERSION,
            schema: SCHEMA,
            image: 0,
            reset: ResetCause::PowerOn,
        }));
        self.status();
    }

    fn status(&mut self) {
        let (mode, armed) = (self.mode, self.armed);
        let Wheels { left, right } = self.reference;
        let reference = Reference::new(mode.reference_kind(), [left, right]);
        let at = self.time();
        self.say(FromRobot::Status(StatusReport {
            mode,
            armed,
            reference,
            at,
            ..StatusReport::default()
        }));
    }

    fn time(&self) -> RobotTime {
        RobotTime {
            start: self.start,
            ms: ((self.now_us - self.started_us) / 1_000) as u32,
        }
    }

    fn t_ms(&self) -> u16 {
        (self.time().ms & 0xFFFF) as u16
    }

    fn range_m(&self) -> f32 {
        WALL_M - self.x_m
    }

    fn take(&mut self, byte: u8) {
        let Some(Received::Frame(body)) = self.decoder.push(byte) else {
            return;
        };
        match ToRobot::from_body(&body) {
            Ok(ToRobot::Hello) => self.hello(),
            Ok(ToRobot::Command {
                session,
                number,
                command,
                ..
            }) => {
                let known = self
                    .last
                    .filter(|last| last.session == session && last.number == number);
                let ack = known.unwrap_or_else(|| Ack {
                    session,
                    number,
                    result: self.apply(command),
                });
                self.last = Some(ack);
                self.say(FromRobot::Ack(ack));
            }
            Ok(ToRobot::Velocity { velocity, .. }) => self.velocities.push(velocity),
            Ok(ToRobot::Heartbeat) | Err(_) => {}
        }
    }

    fn apply(&mut self, command: Command) -> Result<f32, Refusal> {
        self.applied.push(command);
        match command {
            Command::Stop | Command::Disarm => {
                self.armed = false;
                self.event(EventKind::Disarmed);
            }
            Command::Arm => {
                self.armed = true;
                self.event(EventKind::Armed);
            }
            Command::Mode(_) if self.armed => return Err(Refusal::Armed),
            Command::Mode(mode) => {
                self.mode = mode;
                self.event(EventKind::ModeChanged(mode));
            }
            Command::Reference(value) => {
                self.reference = Wheels::both(value);
                return Ok(value);
            }
            Command::WheelReference(wheels) => self.reference = wheels,
            Command::GetParam { id } => {
                return ParamId::from_number(id)
                    .map(|id| self.params.get(id))
                    .ok_or(Refusal::UnknownParam);
            }
            Command::SetParam { id, value } => {
                let id = ParamId::from_number(id).ok_or(Refusal::UnknownParam)?;
                return Ok(self.params.set(id, value)?);
            }
            Command::ResetParams => self.params = Params::default(),
            _ => {}
        }
        Ok(0.0)
    }

    fn tick(&mut self) {
        let wanted_rad_s = match self.mode {
            _ if !self.armed => 0.0,
            ModeId::FrontDistance => {
                ((self.range_m() - self.reference.left) * 120.0).clamp(-10.0, 10.0)
            }
            ModeId::WheelSpeed => self.reference.left,
            _ => 3.0,
        };
        if self.now_us.is_multiple_of(2 * TICK_US) {
            self.before_rad_s = self.wheel_rad_s;
        }
        self.wheel_rad_s += (wanted_rad_s - self.wheel_rad_s) * 0.1;
        self.x_m = (self.x_m + self.wheel_rad_s * WHEEL_RADIUS_M * 0.01).clamp(-1.0, WALL_M - 0.02);
        if self.now_us.is_multiple_of(4 * TICK_US) {
            let range = AgedRange {
                range: Range::Valid(self.range_m()),
                age_ticks: 0,
            };
            let telemetry = Telemetry {
                t_ms: self.t_ms(),
                pose: Pose {
                    x_m: self.x_m,
                    y_m: 0.0,
                    heading_rad: 0.0,
                },
                wheel_rad_s: [
                    Wheels::both(self.before_rad_s),
                    Wheels::both(self.wheel_rad_s),
                ],
                wheel_ref_rad_s: Wheels::both(wanted_rad_s),
                duty: Wheels::both(Duty::new((self.wheel_rad_s * 10.0) as i16)),
                state: u8::from(self.armed),
                armed: self.armed,
                faulted: false,
                servo_rad: 0.0,
                ranges: [AgedRange::default(), AgedRange::default(), range],
            };
            self.say(FromRobot::Telemetry(telemetry));
        }
        if self.now_us.is_multiple_of(500_000) {
            self.status();
        }
    }
}

/// The bytes leave one after the other.
fn queue(link: &mut VecDeque<(u64, u8)>, bytes: &[u8], now_us: u64) {
    for byte in bytes {
        let free_us = link
            .back()
            .map_or(now_us, |(arrives_us, _)| *arrives_us)
            .max(now_us);
        link.push_back((free_us + BYTE_US, *byte));
    }
}

fn arrived(link: &mut VecDeque<(u64, u8)>, now_us: u64) -> Option<u8> {
    link.front()
        .filter(|(arrives_us, _)| *arrives_us <= now_us)?;
    link.pop_front().map(|(_, byte)| byte)
}

impl Target for Toy {
    fn now_us(&self) -> u64 {
        self.now_us
    }

    fn advance(&mut self, dt_us: u64) -> Result<(), TargetError> {
        let until_us = self.now_us + dt_us;
        while self.now_us < until_us {
            self.now_us += 1_000;
            while let Some(byte) = arrived(&mut self.up, self.now_us) {
                self.take(byte);
            }
            if self.now_us.is_multiple_of(TICK_US) {
                self.tick();
            }
        }
        Ok(())
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), TargetError> {
        queue(&mut self.up, bytes, self.now_us);
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        while let Some(byte) = arrived(&mut self.down, self.now_us) {
            into.push(byte);
        }
    }

    fn baud(&self) -> u32 {
        9_600
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            pace: true,
            reset: true,
            clock: true,
            port: false,
            ..Abilities::default()
        }
    }

    fn truth(&self) -> Option<Truth> {
        Some(Truth {
            pose: MapPose {
                x_m: f64::from(self.x_m),
                y_m: 0.0,
                heading_rad: 0.0,
            },
            wheel_rad_s: Wheels::both(f64::from(self.wheel_rad_s)),
            range_m: [None, None, Some(f64::from(self.range_m()))],
            servo_rad: 0.0,
            contact: false,
            battery_v: 7.4,
        })
    }

    fn scene(&self) -> Option<Scene> {
        let front = MapPose {
            x_m: 0.1,
            y_m: 0.0,
            heading_rad: 0.0,
        };
        Some(Scene {
            choice: self.choice.clone(),
            experiments: vec![ScenarioOffer {
                name: "toy".into(),
                ..ScenarioOffer::default()
            }],
            worlds: vec!["wall".into()],
            world_titles: std::collections::BTreeMap::new(),
            rigs: vec!["final".into()],
            rig: "final".into(),
            goals: vec![[1.0, 0.5]],
            routes: Vec::new(),
            robot: "toy".into(),
            start: MapPose::default(),
            lamps: Vec::new(),
            obstacles: vec![SceneObstacle {
                corners_m: vec![[1.3, -1.0], [1.3, 1.0]],
                closed: false,
            }],
            lines: Vec::new(),
            movers: Vec::new(),
            others: Vec::new(),
            footprint_m: vec![[0.1, 0.075], [-0.1, 0.075], [-0.1, -0.075], [0.1, -0.075]],
            base_m: 0.1,
            wheel_radius_m: 0.0325,
            sonars: vec![SonarMount {
                id: 2,
                at: front,
                half_angle_rad: 0.26,
                reach_m: 2.5,
                on_servo: true,
            }],
            other_sonars: Vec::new(),
            of_ghost: false,
        })
    }

    fn reset(&mut self, choice: &Choice) -> Result<(), TargetError> {
        if choice.scenario != "toy" {
            let why = format!("there is no scenario {}; there is: toy", choice.scenario);
            return Err(TargetError::Setup(why));
        }
        *self = Toy {
            choice: choice.clone(),
            ..Toy::default()
        };
        Ok(())
    }
}
