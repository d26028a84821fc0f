//! Random surroundings and a random operator for the robot, plausible enough that modes go through their states.

use rumbo_control::mode::waypoints::Waypoint;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};
use rumbo_control::params::ParamId;
use rumbo_control::{Echo, Edges, Inputs, Micros, Outputs, SonarId, TICK_US, Velocity, Wheels};
use rumbo_wire::{Command, FrameMessage, RobotTime, ToRobot};
use std::collections::VecDeque;

/// Ticks of one mode.
const EPISODE: u32 = 1_500;
/// Bytes that a link of 9600 baud brings in a tick.
const BYTES_PER_TICK: usize = 9;

/// xorshift64 (Marsaglia, 2003).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub(crate) fn below(&mut self, bound: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 32) as u32 % bound
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.below(10_001) as f32 / 10_000.0
    }

    fn chance(&mut self, one_in: u32) -> bool {
        self.below(one_in) == 0
    }
}

/// A wheel that follows its PWM, and its encoder.
#[derive(Default)]
struct Wheel {
    rad_s: f64,
    edges_due: f64,
    poles: [u32; 8],
    edges: Edges,
}

impl Wheel {
    /// A period at this duty; in one of so many its edges are disturbed.
    fn turn(&mut self, duty: i16, now: Micros, random: &mut Random, disturbed_in: u32) {
        self.rad_s += (f64::from(duty) / 255.0 * 30.0 - self.rad_s) * 0.1;
        let new = self.rad_s.abs() * 0.01 * 384.0 / std::f64::consts::TAU;
        let tick_us = f64::from(TICK_US);
        let of_disc = (1..).map(|n| (f64::from(n) - self.edges_due) / new * tick_us);
        let mut after_us: Vec<u32> = of_disc
            .take_while(|us| *us <= tick_us)
            .map(|us| us as u32)
            .collect();
        self.edges_due = (self.edges_due + new).fract();
        if random.chance(disturbed_in) {
            after_us.extend((0..random.below(5)).map(|_| random.below(TICK_US)));
            after_us.sort_unstable();
        }
        for after_us in after_us {
            let at = Micros(now.0.wrapping_sub(TICK_US).wrapping_add(after_us));
            self.edges.count = self.edges.count.wrapping_add(1);
            let pole = &mut self.poles[usize::from(self.edges.count) % 8];
            if self.edges.count > 8 {
                self.edges.turn_us = at.0.wrapping_sub(*pole);
            }
            *pole = at.0;
            self.edges.last = at;
        }
    }
}

/// World and operator.
pub(crate) struct World {
    random: Random,
    start: Micros,
    wheels: Wheels<Wheel>,
    range_m: f64,
    ping: Option<(SonarId, u32)>,
    mode: ModeId,
    number: u16,
    seq: u8,
    talk: VecDeque<u8>,
    tick: u32,
    /// The link carries lines of text.
    in_text: bool,
}

impl World {
    /// The microseconds wrap 50 s after the start.
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            random: Random::new(seed),
            start: Micros(0u32.wrapping_sub(50_000_000)),
            wheels: Wheels::default(),
            range_m: 1.0,
            ping: None,
            mode: ModeId::default(),
            number: 0,
            seq: 0,
            talk: VecDeque::new(),
            tick: 0,
            in_text: false,
        }
    }

    /// The same, with the original text protocol.
    pub(crate) fn in_text(seed: u64) -> Self {
        Self {
            in_text: true,
            ..Self::new(seed)
        }
    }

    /// The last mode requested.
    pub(crate) fn mode(&self) -> ModeId {
        self.mode
    }

    /// The sensors at a tick, after the last outputs.
    pub(crate) fn inputs(&mut self, tick: u32, last: &Outputs) -> Inputs {
        let now = self.start.after(tick * TICK_US);
        // A text has no command that clears a fault before the next mode.
        let disturbed_in = if self.in_text { 4_000 } else { 200 };
        let (drive, random) = (last.drive, &mut self.random);
        let Wheels { left, right } = &mut self.wheels;
        left.turn(drive.left.counts(), now, random, disturbed_in);
        right.turn(drive.right.counts(), now, random, disturbed_in);
        let forward_m_s = (self.wheels.left.rad_s + self.wheels.right.rad_s) * 0.5 * 0.0325;
        self.range_m = (self.range_m - 0.01 * forward_m_s).clamp(0.03, 2.4);
        if self.random.chance(300) {
            self.range_m = f64::from(self.random.between(0.05, 2.0));
        }
        if let Some(sonar) = last.ping {
            self.ping = Some((sonar, tick));
        }
        let answered = self.ping.take_if(|(_, at)| tick - *at >= 2);
        Inputs {
            now,
            encoders: Wheels {
                left: self.wheels.left.edges,
                right: self.wheels.right.edges,
            },
            echo: answered.map(|(sonar, _)| (sonar, self.echo())),
            battery_v: None,
        }
    }

    fn echo(&mut self) -> Echo {
        match self.random.below(60) {
            0 => Echo::Clear,
            1 => Echo::Silent,
            2 => Echo::Pulse(self.random.below(30_000)),
            _ => Echo::Pulse((self.range_m * 5_800.0) as u32 + self.random.below(30)),
        }
    }

    /// The bytes that arrive until the next tick.
    pub(crate) fn bytes(&mut self, tick: u32) -> Vec<u8> {
        self.tick = tick;
        if self.talk.is_empty() {
            match tick % EPISODE {
                7 => self.begin(),
                300 | 600 | 900 => self.set_going(),
                later if later > 300 && later.is_multiple_of(97) => self.arm(),
                other if other % 20 == 10 && !self.in_text => self.send(&ToRobot::Heartbeat),
                later
                    if self.mode == ModeId::Twist
                        && !self.in_text
                        && later % 300 < 150
                        && later % 7 == 0 =>
                {
                    self.velocity();
                }
                _ => {}
            }
        }
        let count = self.talk.len().min(BYTES_PER_TICK);
        self.talk.drain(..count).collect()
    }

    fn send(&mut self, message: &ToRobot) {
        self.talk.extend(message.frame(self.seq).bytes());
        self.seq = (self.seq + 1) & 0xF;
    }

    /// The newest robot time that a station has; one in forty is too old for anything, or from before the start.
    fn seen(&mut self) -> RobotTime {
        let late_ms = if self.random.chance(40) { 2_500 } else { 0 };
        RobotTime {
            start: u8::from(self.random.chance(200)),
            ms: (self.tick * (TICK_US / 1_000)).saturating_sub(100 + late_ms),
        }
    }

    /// One in twenty is faster than any robot.
    fn velocity(&mut self) {
        let scale = if self.random.chance(20) { 40.0 } else { 1.0 };
        let velocity = Velocity {
            forward_m_s: scale * self.random.between(-0.8, 0.8),
            yaw_rad_s: scale * self.random.between(-8.0, 8.0),
        };
        let seen = self.seen();
        self.send(&ToRobot::Velocity { velocity, seen });
    }

    fn command(&mut self, command: Command) {
        self.number = self.number.wrapping_add(1);
        let seen = self.seen();
        self.send(&ToRobot::Command {
            session: 1,
            number: self.number,
            command,
            seen,
        });
    }

    fn line(&mut self, line: &str) {
        self.talk.extend(line.bytes().chain(*b"\r\n"));
    }

    fn arm(&mut self) {
        if self.in_text {
            return self.line("ON");
        }
        self.command(Command::ClearFault);
        self.command(Command::Arm);
    }

    /// Another mode, mostly with the sonars that it needs.
    fn begin(&mut self) {
        // Mode 9 drives nowhere without a network: a recorded run leads through it.
        let modes = ModeId::ALL.map(|mode| (mode != ModeId::Policy).then_some(mode));
        let count = modes.iter().flatten().count() as u32;
        let chosen = self.random.below(count) as usize;
        self.mode = modes.into_iter().flatten().nth(chosen).unwrap();
        if self.in_text {
            self.line("OFF");
            let number = self.mode as u8;
            return self.line(&format!("MODE {number}"));
        }
        let rig = match self.mode {
            ModeId::FrontDistance => 0.0,
            ModeId::FrontAlign => 1.0,
            ModeId::WallHold | ModeId::WallFollow => 2.0 + self.random.below(2) as f32,
            _ => 4.0,
        };
        let rig = if self.random.chance(3) { 4.0 } else { rig };
        self.command(Command::Disarm);
        self.command(Command::ClearFault);
        self.command(Command::SetParam {
            id: ParamId::Rig as u8,
            value: rig,
        });
        self.command(Command::Mode(self.mode));
    }

    /// A reference for the mode, and off.
    fn set_going(&mut self) {
        if self.in_text {
            self.set_going_in_text();
            return self.arm();
        }
        match self.mode {
            ModeId::Manual => {
                let movement =
                    Movement::ALL[self.random.below(Movement::ALL.len() as u32) as usize];
                let level = if self.random.chance(2) {
                    MovementLevel::Duty(self.random.between(0.0, 1.0))
                } else {
                    MovementLevel::Speed(self.random.between(0.0, 12.0))
                };
                self.command(Command::Move { movement, level });
            }
            ModeId::FrontDistance | ModeId::FrontAlign | ModeId::WallFollow => {
                let distance_m = self.random.between(0.2, 1.5);
                self.command(Command::Reference(distance_m));
            }
            ModeId::WheelSpeed => {
                let (left, right) = (
                    self.random.between(-14.0, 14.0),
                    self.random.between(-14.0, 14.0),
                );
                self.command(Command::WheelReference(Wheels { left, right }));
            }
            ModeId::StraightLine => {
                let rad_s = self.random.between(-10.0, 10.0);
                self.command(Command::Reference(rad_s));
            }
            ModeId::Waypoints => {
                let (repeat, relative) = (self.random.chance(2), self.random.chance(2));
                self.command(Command::Route { repeat, relative });
                for _ in 0..3 {
                    let heading = self.random.chance(2);
                    let waypoint = Waypoint {
                        x_m: self.random.between(-1.0, 1.0),
                        y_m: self.random.between(-1.0, 1.0),
                        heading_rad: heading.then(|| self.random.between(-3.0, 3.0)),
                    };
                    self.command(Command::Waypoint(waypoint));
                }
            }
            ModeId::Mission if self.random.chance(2) => self.command(Command::Lane),
            ModeId::Mission | ModeId::Policy => {
                let (x_m, y_m) = (
                    self.random.between(-2.0, 3.0),
                    self.random.between(-2.0, 2.0),
                );
                self.command(Command::Goal { x_m, y_m });
            }
            ModeId::WallHold | ModeId::Twist => {}
        }
        self.arm();
    }

    /// The same as a line, now and then an invalid one.
    fn set_going_in_text(&mut self) {
        let (one, other) = (
            self.random.between(-1.0, 2.0),
            self.random.between(-1.0, 2.0),
        );
        let (cm, rpm) = (
            self.random.between(20.0, 150.0),
            self.random.between(-130.0, 130.0),
        );
        let line = match (self.mode, self.random.below(6)) {
            (_, 0) => format!("REF {rpm} {cm}"),
            (_, 1) => format!("PID {} {one:.2} 0.5 0", if other > 0.5 { "A" } else { "B" }),
            (ModeId::Mission | ModeId::Policy, _) => format!("GOAL {one:.2} {other:.2}"),
            (ModeId::WheelSpeed, 2) => format!("REF A {rpm:.1}"),
            (ModeId::WheelSpeed, 3) => format!("REF B {rpm:.1}"),
            (ModeId::WheelSpeed | ModeId::StraightLine | ModeId::Manual, _) => {
                format!("REF {rpm:.1}")
            }
            _ => format!("REF {cm:.0}"),
        };
        self.line(&line);
    }
}
