//! The image on the emulated Mega at the pins of the simulated robot, and a station that drives it into failures.

use crate::board::image_path;
use rumbo_control::Fault;
use rumbo_control::params::ParamId;
use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_sim::{Config, Sim};
use rumbo_wire::{
    Command, Decoder, EventKind, FrameMessage, FromRobot, Hello, Received, Refusal, RobotTime,
    StatusReport, ToRobot,
};

/// Time between two polls of the robot [us].
const STEP_US: u64 = 5_000;
/// Time between heartbeats [us].
const HEARTBEAT_US: u64 = 100_000;
/// A wheel slower than this stands [rad/s].
const STANDSTILL_RAD_S: f64 = 0.05;

/// Towards a wall, along one, straight on, and around boxes; and when each is well under way [s].
const DRIVES: [(&str, f64); 4] = [
    ("mode1-final", 1.4),
    ("mode4-final", 2.0),
    ("mode6", 3.0),
    ("mode8-obstacles", 2.0),
];

/// The driving robot.
pub(crate) struct Drive {
    pub(crate) sim: Sim,
    /// Messages received from it, and when [s].
    pub(crate) received: Vec<(f64, FromRobot)>,
    /// Whether the station is alive.
    pub(crate) heartbeats: bool,
    /// The last status, also after a test clears `received`.
    pub(crate) last_status: Option<StatusReport>,
    decoder: Decoder<128>,
    number: u16,
    seq: u8,
    heartbeat_us: u64,
    /// The newest robot time received.
    seen: Option<RobotTime>,
}

/// A scenario with the image; `None` where that has not been built.
pub(crate) fn setup(scenario: &str, changes: impl FnOnce(&mut Setup)) -> Option<Setup> {
    setup_of("memoria", scenario, changes)
}

/// The same with another robot.
pub(crate) fn setup_of(
    robot: &str,
    scenario: &str,
    changes: impl FnOnce(&mut Setup),
) -> Option<Setup> {
    let overrides = Overrides {
        firmware: Some(image_path()?),
        robot: Some(robot.to_owned()),
        ..Overrides::default()
    };
    let mut setup = Library::new().setup(scenario, &overrides).unwrap();
    changes(&mut setup);
    Some(setup)
}

/// The robot under way in modes 1, 4, 6 and 8, one after the other; none where the image has not been built.
pub(crate) fn under_way_in_each() -> impl Iterator<Item = Drive> {
    DRIVES.into_iter().filter_map(|(scenario, at_s)| {
        println!("{scenario}");
        Some(Drive::under_way(&setup(scenario, |_| {})?, at_s))
    })
}

impl Drive {
    /// A robot just switched on.
    pub(crate) fn new(setup: &Setup) -> Drive {
        Drive::with_eeprom(setup, &[])
    }

    /// The same with this in its EEPROM.
    pub(crate) fn with_eeprom(setup: &Setup, eeprom: &[u8]) -> Drive {
        Drive {
            sim: Sim::new(Config {
                memory: eeprom.to_vec(),
                ..setup.config(1).unwrap()
            })
            .unwrap(),
            received: Vec::new(),
            heartbeats: true,
            last_status: None,
            decoder: Decoder::default(),
            number: 0,
            seq: 0,
            heartbeat_us: 0,
            seen: None,
        }
    }

    /// A robot that has been driving as its scenario says until this time.
    pub(crate) fn under_way(setup: &Setup, until_s: f64) -> Drive {
        let mut drive = Drive::new(setup);
        drive.wait_s(0.3);
        drive.command(Command::Mode(setup.scenario.mode)).unwrap();
        drive.follow(setup, until_s);
        assert!(
            drive.status().armed && drive.speed_rad_s() > 1.0,
            "it drives"
        );
        drive
    }

    /// Sends the scenario's commands until this time.
    pub(crate) fn follow(&mut self, setup: &Setup, until_s: f64) {
        let due = |at_s: &f64| *at_s < until_s;
        for timed in setup
            .scenario
            .commands
            .iter()
            .filter(|timed| due(&timed.at_s))
        {
            while self.now_s() < timed.at_s {
                self.step();
            }
            self.command(timed.command).unwrap();
        }
        while self.now_s() < until_s {
            self.step();
        }
    }

    pub(crate) fn now_s(&self) -> f64 {
        self.sim.now_us() as f64 * 1e-6
    }

    pub(crate) fn wait_s(&mut self, seconds: f64) {
        let until_s = self.now_s() + seconds;
        while self.now_s() < until_s {
            self.step();
        }
    }

    fn step(&mut self) {
        if self.heartbeats && self.sim.now_us() >= self.heartbeat_us {
            self.send(&ToRobot::Heartbeat);
            self.heartbeat_us = self.sim.now_us() + HEARTBEAT_US;
        }
        self.sim.advance(self.sim.now_us() + STEP_US);
        let mut bytes = Vec::new();
        self.sim.receive(&mut bytes);
        for byte in bytes {
            if let Some(Received::Frame(body)) = self.decoder.push(byte)
                && let Ok(message) = FromRobot::from_body(&body)
            {
                self.seen = RobotTime::after(self.seen, &message);
                self.received.push((self.now_s(), message));
            }
        }
    }

    pub(crate) fn send(&mut self, message: &ToRobot) {
        self.sim.send(message.frame(self.seq).bytes());
        self.seq = self.seq.wrapping_add(1);
    }

    /// The next command as a frame, not sent.
    pub(crate) fn frame_of(&mut self, command: Command) -> Vec<u8> {
        self.number += 1;
        let message = ToRobot::Command {
            session: 7,
            number: self.number,
            command,
            seen: self.seen.unwrap_or_default(),
        };
        message.frame(self.seq).bytes().to_vec()
    }

    /// The answer to the last command.
    pub(crate) fn answer(&self) -> Option<Result<f32, Refusal>> {
        self.received.iter().find_map(|(_, message)| match message {
            FromRobot::Ack(ack) if ack.number == self.number => Some(ack.result),
            _ => None,
        })
    }

    /// Sends a command and waits for its answer.
    pub(crate) fn command(&mut self, command: Command) -> Result<f32, Refusal> {
        let frame = self.frame_of(command);
        self.sim.send(&frame);
        for _ in 0..100 {
            self.step();
            if let Some(answer) = self.answer() {
                return answer;
            }
        }
        panic!("{command:?} is not answered");
    }

    pub(crate) fn param(&mut self, id: ParamId) -> f32 {
        self.command(Command::GetParam { id: id as u8 }).unwrap()
    }

    /// The last status received.
    pub(crate) fn status(&self) -> StatusReport {
        let mut last = self.received.iter().rev();
        last.find_map(|(_, message)| match message {
            FromRobot::Status(status) => Some(*status),
            _ => None,
        })
        .unwrap()
    }

    /// The last HELLO received.
    pub(crate) fn hello(&self) -> Hello {
        let mut last = self.received.iter().rev();
        last.find_map(|(_, message)| match message {
            FromRobot::Hello(hello) => Some(*hello),
            _ => None,
        })
        .unwrap()
    }

    /// When the robot reported this event [s].
    pub(crate) fn event_s(&self, kind: EventKind) -> Option<f64> {
        self.received
            .iter()
            .find_map(|(t_s, message)| match message {
                FromRobot::Event(event) if event.kind == kind => Some(*t_s),
                _ => None,
            })
    }

    /// Frames that the station missed, modulo 65536.
    pub(crate) fn frames_lost(&self) -> u16 {
        self.decoder.frames_lost()
    }

    /// The faster wheel [rad/s].
    pub(crate) fn speed_rad_s(&self) -> f64 {
        let [left, right] = self.sim.truth().wheel_rad_s;
        left.abs().max(right.abs())
    }

    pub(crate) fn is_released(&self) -> bool {
        self.sim.duty() == Default::default()
    }

    /// Waits until the wheels are permanently released; returns the time since `from_s` [s]. After that the robot
    /// stands, and has touched nothing.
    pub(crate) fn released_after_s(&mut self, from_s: f64, at_most_s: f64) -> f64 {
        let mut driven_s = self.now_s();
        while self.now_s() < from_s + at_most_s + 2.0 {
            if !self.is_released() {
                driven_s = self.now_s();
            }
            self.step();
        }
        let took_s = driven_s - from_s;
        assert!(took_s <= at_most_s, "still driven after {took_s} s");
        assert!(self.speed_rad_s() < STANDSTILL_RAD_S, "it stands");
        self.touched_nothing();
        took_s
    }

    pub(crate) fn touched_nothing(&self) {
        assert_eq!(self.sim.worst_contact_m_s(), 0.0, "contact");
    }

    /// The fault is latched and reported: nothing arms before it is cleared.
    pub(crate) fn latched(&mut self, fault: Fault) {
        self.heartbeats = true;
        self.wait_s(0.7);
        assert_eq!(self.status().fault, Some(fault));
        assert!(!self.status().armed);
        assert_eq!(self.command(Command::Arm), Err(Refusal::Faulted));
        assert!(self.event_s(EventKind::Faulted(fault)).is_some());
    }
}
