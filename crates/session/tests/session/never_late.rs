//! Whatever the link loses, holds back and delivers later, whatever goes and comes back: the robot is armed by an ON
//! of the last two seconds, given since its last start, or not at all.
//!
//! The station's end of the link and the robot's program, and between them a link that a script cuts, holds and lets
//! flow, while the robot restarts, the port disappears, and orders are given. Each protection is tested by itself,
//! since each hides what another one lets through: what the station sends, what it accepts, and how the robot reacts.
#![allow(clippy::unwrap_used, clippy::panic)]

use proptest::prelude::*;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};
use rumbo_control::{Duty, Inputs, Micros, TICK_US, Velocity, Wheels};
use rumbo_robot::{Robot, RobotConfig};
use rumbo_session::client::{KnownTable, LinkEvent, RobotClient};
use rumbo_wire::{Command, Decoder, FrameMessage, Received, ResetCause, ToRobot};

/// Oldest ON that may arm \[us\].
const LIFE_US: u64 = 2_000_000;
/// The robot's clock shows its last tick, and the order was given after the last time received.
const SLACK_US: u64 = 2 * TICK_US as u64;

/// What the link does with bytes of one direction.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    /// They arrive at once.
    Flows,
    /// They are kept, and arrive when it flows again.
    Holds,
    /// They get lost.
    Cut,
}

#[derive(Clone, Debug)]
enum Action {
    Pass(u32),
    Link(Way, Way),
    Order(Command),
    /// By the reset button; whether its messages then get lost.
    Restart,
    PortGone,
}

/// A script that is mostly about ON, and times around those that matter.
fn action() -> impl Strategy<Value = Action> {
    let way = || prop::sample::select(vec![Way::Flows, Way::Flows, Way::Holds, Way::Cut]);
    let forward = Command::Move {
        movement: Movement::Forward,
        level: MovementLevel::Duty(0.3),
    };
    let order = prop_oneof![
        5 => Just(Command::Arm),
        1 => prop::sample::select(vec![
            forward,
            Command::ClearFault,
            Command::SetParam { id: 0, value: 0.03 },
            Command::SaveParams,
            Command::Mode(ModeId::Manual),
            Command::Stop,
            Command::Disarm,
        ]),
    ];
    prop_oneof![
        4 => (0u32..60).prop_map(|ticks| Action::Pass(10 * ticks)),
        2 => (0u32..300).prop_map(|ticks| Action::Pass(10 * ticks)),
        1 => (0u32..6_000).prop_map(|ticks| Action::Pass(10 * ticks)),
        3 => (way(), way()).prop_map(|(up, down)| Action::Link(up, down)),
        2 => Just(Action::Link(Way::Flows, Way::Flows)),
        4 => order.prop_map(Action::Order),
        2 => Just(Action::Restart),
        1 => Just(Action::PortGone),
    ]
}

fn start(number: u8) -> Robot {
    Robot::new(RobotConfig {
        image: 0,
        reset: ResetCause::External,
        start: number,
    })
}

/// An ON that was given.
#[derive(Clone, Copy, Debug)]
struct On {
    at_us: u64,
    /// The robot's start in which it was given.
    start: u8,
    /// How often the robot or the port had been lost by then.
    losses: u32,
}

struct Bench {
    now_us: u64,
    client: RobotClient,
    robot: Robot,
    start: u8,
    started_us: u64,
    /// Held back on the way to the robot, and from it.
    held: [Vec<u8>; 2],
    ways: [Way; 2],
    ons: Vec<On>,
    losses: u32,
    armed: bool,
    /// A bridge is on.
    driven: bool,
    /// How often an ON armed it.
    arrivals: u32,
    sent: Decoder<128>,
}

impl Bench {
    fn new() -> Self {
        Self {
            now_us: 0,
            client: RobotClient::new(3, false, KnownTable { schema: 0, len: 0 }),
            robot: start(0),
            start: 0,
            started_us: 0,
            held: Default::default(),
            ways: [Way::Flows; 2],
            ons: Vec::new(),
            losses: 0,
            armed: false,
            driven: false,
            arrivals: 0,
            sent: Decoder::default(),
        }
    }

    fn obey(&mut self, action: &Action) -> Result<(), TestCaseError> {
        match action {
            Action::Pass(ms) => {
                for _ in 0..ms / 10 {
                    self.tick()?;
                }
            }
            Action::Link(up, down) => self.ways = [*up, *down],
            Action::Order(command) => {
                let taken = self.client.submit(*command, self.now_us).is_ok();
                let may = self.client.connected() || *command == Command::Stop;
                prop_assert!(!taken || may, "{command:?} for a robot that is not there");
                if taken && *command == Command::Arm {
                    self.ons.push(On {
                        at_us: self.now_us,
                        start: self.start,
                        losses: self.losses,
                    });
                }
            }
            Action::Restart => {
                self.start = self.start.wrapping_add(1);
                self.robot = start(self.start);
                self.started_us = self.now_us;
                self.armed = false;
            }
            Action::PortGone => {
                self.client.port_is_gone();
                self.losses += 1;
                // What the computer had not sent yet is gone; what is in the air is not.
                self.ways[0] = Way::Flows;
            }
        }
        Ok(())
    }

    /// What arrives of these bytes.
    fn carry(&mut self, which: usize, bytes: Vec<u8>) -> Vec<u8> {
        let held = &mut self.held[which];
        match self.ways[which] {
            Way::Flows => {
                held.extend(bytes);
                std::mem::take(held)
            }
            Way::Holds => {
                held.extend(bytes);
                Vec::new()
            }
            Way::Cut => Vec::new(),
        }
    }

    fn tick(&mut self) -> Result<(), TestCaseError> {
        self.now_us += u64::from(TICK_US);
        let said = std::iter::from_fn(|| self.robot.transmit()).collect();
        let arrived = self.carry(1, said);
        let mut events = Vec::new();
        self.client.receive(&arrived, self.now_us, &mut events);
        let mut bytes = Vec::new();
        self.client.poll(self.now_us, &mut bytes, &mut events);
        let lost = |item: &&LinkEvent| matches!(item, LinkEvent::Lost | LinkEvent::Restarted(_));
        self.losses += events.iter().filter(lost).count() as u32;
        self.judge_sent(&bytes)?;
        for byte in self.carry(0, bytes) {
            self.robot.receive(byte);
        }
        let now = Micros((self.now_us - self.started_us) as u32);
        let outputs = self.robot.tick(&Inputs {
            now,
            ..Inputs::default()
        });
        self.driven = outputs.drive != Wheels::both(Duty::RELEASED);
        self.robot.report();
        self.judge_armed()
    }

    /// The station sends no ON that is too old, nor one of before a loss.
    fn judge_sent(&mut self, bytes: &[u8]) -> Result<(), TestCaseError> {
        for byte in bytes {
            if let Some(Received::Frame(body)) = self.sent.push(*byte)
                && let Ok(ToRobot::Command {
                    command: Command::Arm,
                    ..
                }) = ToRobot::from_body(&body)
            {
                let fresh = |on: &On| self.now_us < on.at_us + LIFE_US && on.losses == self.losses;
                let (now_us, ons) = (self.now_us, &self.ons);
                prop_assert!(ons.iter().any(fresh), "ON leaves at {now_us} us: {ons:?}");
            }
        }
        Ok(())
    }

    /// The robot is armed by an ON that was given a moment ago, since it started.
    fn judge_armed(&mut self) -> Result<(), TestCaseError> {
        let armed = self.robot.mode_state().is_some();
        if armed && !std::mem::replace(&mut self.armed, armed) {
            self.arrivals += 1;
            let (now_us, start) = (self.now_us, self.start);
            let fresh = |on: &On| now_us <= on.at_us + LIFE_US + SLACK_US && on.start == start;
            let ons = &self.ons;
            prop_assert!(
                ons.iter().any(fresh),
                "armed at {now_us} us in start {start}: {ons:?}"
            );
        }
        self.armed = armed;
        Ok(())
    }
}

fn run(script: &[Action]) -> Result<Bench, TestCaseError> {
    let mut bench = Bench::new();
    bench.obey(&Action::Pass(1_000))?;
    for action in script {
        bench.obey(action)?;
    }
    bench.obey(&Action::Link(Way::Flows, Way::Flows))?;
    bench.obey(&Action::Pass(5_000))?;
    Ok(bench)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn the_robot_is_armed_by_a_fresh_on_or_not_at_all(script in prop::collection::vec(action(), 1..24)) {
        run(&script)?;
    }
}

#[test]
fn an_on_over_a_sound_link_arms() {
    let script = [Action::Order(Command::Arm), Action::Pass(300)];
    assert_eq!(run(&script).unwrap().arrivals, 1);
}

#[test]
fn an_on_that_a_module_holds_for_a_minute_is_refused_by_the_robot() {
    for held_ms in [2_100, 11_000, 60_000] {
        let script = [
            Action::Link(Way::Holds, Way::Flows),
            Action::Pass(300),
            Action::Order(Command::Arm),
            Action::Pass(held_ms),
        ];
        assert_eq!(run(&script).unwrap().arrivals, 0);
    }
}

#[test]
fn an_on_that_is_held_across_a_restart_is_refused_though_the_clock_shows_the_same() {
    for passed_ms in (0..3_000).step_by(50) {
        let script = [
            Action::Link(Way::Holds, Way::Flows),
            // With heartbeats before it: one that comes alone is refused anyway.
            Action::Pass(300),
            Action::Order(Command::Arm),
            Action::Pass(20),
            Action::Restart,
            Action::Pass(passed_ms),
        ];
        assert_eq!(run(&script).unwrap().arrivals, 0, "{passed_ms}");
    }
}

#[test]
fn an_on_that_is_repeated_until_it_expires_does_not_get_younger() {
    for lost_ms in (0..1_900).step_by(100) {
        let script = [
            Action::Link(Way::Cut, Way::Flows),
            Action::Order(Command::Arm),
            Action::Pass(lost_ms),
            Action::Link(Way::Holds, Way::Flows),
            Action::Pass(2_100 - lost_ms),
        ];
        assert_eq!(run(&script).unwrap().arrivals, 0, "{lost_ms}");
    }
}

#[test]
fn a_velocity_that_a_module_holds_back_moves_nothing_when_it_comes() {
    for (held_ms, moves) in [(0, true), (280, false)] {
        let mut bench = Bench::new();
        let pass = |bench: &mut Bench, ms| bench.obey(&Action::Pass(ms)).unwrap();
        let drive = |bench: &mut Bench, forward_m_s| {
            let velocity = Velocity {
                forward_m_s,
                yaw_rad_s: 0.0,
            };
            bench.client.submit_velocity(velocity).unwrap();
            bench.obey(&Action::Pass(40)).unwrap();
        };
        pass(&mut bench, 1_000);
        for command in [Command::Mode(ModeId::Twist), Command::Arm] {
            bench.obey(&Action::Order(command)).unwrap();
            pass(&mut bench, 200);
        }
        // A sign of life that moves nothing.
        drive(&mut bench, 0.0);
        bench.obey(&Action::Link(Way::Holds, Way::Flows)).unwrap();
        drive(&mut bench, 0.2);
        pass(&mut bench, held_ms);
        bench.obey(&Action::Link(Way::Flows, Way::Flows)).unwrap();
        pass(&mut bench, 30);
        assert!(bench.armed, "{:?}", bench.robot.fault());
        assert_eq!(bench.driven, moves, "{held_ms}");
    }
}
