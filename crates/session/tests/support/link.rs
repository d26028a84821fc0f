//! Frames and commands over a link that loses, flips, repeats, cuts and delays; used by a test and by the campaign.

use super::support::Toy;
use rumbo_control::{AgedRange, Pose, Range};
use rumbo_session::Target;
use rumbo_session::client::{KnownTable, LinkEvent, RobotClient};
use rumbo_session::commands::Fate;
use rumbo_session::fault::{Faults, Faulty, FaultyLine};
use rumbo_wire::{Command, Decoder, FrameBody, FrameMessage, FromRobot, Received, Telemetry};
use std::collections::VecDeque;
use std::fmt;

/// Outcome of many frames.
#[derive(Debug, Default)]
pub(crate) struct Frames {
    /// Sent.
    pub(crate) sent: u64,
    /// Hit by a fault.
    pub(crate) hit: u64,
    /// Accepted though no such frame was sent.
    pub(crate) wrong: u64,
    /// Whole, after a whole one, and not accepted.
    pub(crate) missed: u64,
}

impl Frames {
    /// Wrong frames that the CRC's 16 bits let through: with four times the expectation and three more, one in a
    /// million campaigns fails by chance.
    pub(crate) fn odds(&self) -> u64 {
        3 + 4 * self.hit / 65_536
    }

    pub(crate) fn good(&self) -> bool {
        self.wrong <= self.odds() && self.missed == 0 && self.hit > 0
    }
}

impl fmt::Display for Frames {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            sent,
            hit,
            wrong,
            missed,
        } = self;
        let odds = self.odds();
        write!(
            f,
            "{sent} frames, {hit} hit: {wrong} wrong ones accepted (at most {odds}), {missed} whole ones not found after a whole one (none)"
        )
    }
}

/// Faults of every kind: two frames in five are hit.
fn faults() -> Faults {
    Faults {
        lose: 0.004,
        flip: 0.008,
        duplicate: 0.02,
        cut: 0.02,
        ..Faults::default()
    }
}

/// A telemetry frame that differs from all others nearby in all its bytes.
fn telemetry(number: u64) -> Telemetry {
    let spread = |turns: u64| (number.wrapping_mul(turns) % 2_000) as f32 / 100.0 - 10.0;
    Telemetry {
        t_ms: (number * 40) as u16,
        pose: Pose {
            x_m: spread(7),
            y_m: spread(11),
            heading_rad: spread(13) / 4.0,
        },
        state: (number % 16) as u8,
        ranges: [AgedRange {
            range: Range::Valid(0.2 + spread(17).abs() / 10.0),
            age_ticks: 0,
        }; 3],
        ..Telemetry::default()
    }
}

/// Sends so many frames.
pub(crate) fn frames(count: u64, seed: u64) -> Frames {
    let mut line = FaultyLine::new(faults(), seed);
    let mut decoder = Decoder::<128>::default();
    let mut outcome = Frames::default();
    // What is accepted may combine parts of a frame and the one before it; no more.
    let mut recent: VecDeque<FrameBody> = VecDeque::new();
    let (mut bytes, mut whole_before) = (Vec::new(), true);
    for number in 0..count {
        let frame = FromRobot::Telemetry(telemetry(number)).frame((number % 16) as u8);
        let mut alone = Decoder::<128>::default();
        let body = frame
            .bytes()
            .iter()
            .find_map(|byte| match alone.push(*byte) {
                Some(Received::Frame(body)) => Some(body),
                _ => None,
            });
        recent.extend(body);
        if recent.len() > 3 {
            recent.pop_front();
        }
        let whole = line.send(frame.bytes(), 0);
        bytes.clear();
        line.receive(0, &mut bytes);
        let mut found = false;
        for byte in &bytes {
            if let Some(Received::Frame(body)) = decoder.push(*byte) {
                found |= Some(body) == recent.back().copied();
                outcome.wrong += u64::from(!recent.contains(&body));
            }
        }
        outcome.sent += 1;
        outcome.hit += u64::from(!whole);
        outcome.missed += u64::from(whole && whole_before && !found);
        whole_before = whole;
    }
    outcome
}

/// Outcome of many commands.
#[derive(Debug, Default)]
pub(crate) struct Commands {
    /// Frames from the robot, telemetry and answers.
    pub(crate) frames: u64,
    pub(crate) asked: usize,
    /// Applied by the robot, repetitions included.
    pub(crate) applied: usize,
    /// In the order in which they were asked, each once at most.
    pub(crate) in_order: bool,
    /// Acknowledged, so applied.
    pub(crate) acknowledged: usize,
    /// Given up; they may or may not have been applied.
    pub(crate) given_up: usize,
    /// False alarms about the robot.
    pub(crate) alarms: usize,
}

impl Commands {
    pub(crate) fn good(&self) -> bool {
        // The last one may still be on its way.
        let ended = self.acknowledged + self.given_up + 1 >= self.asked;
        let known = (self.acknowledged..=self.asked).contains(&self.applied);
        let few = self.given_up * 20 <= self.asked;
        self.in_order && self.asked > 10 && ended && known && few && self.alarms == 0
    }
}

impl fmt::Display for Commands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            frames,
            asked,
            applied,
            in_order,
            acknowledged,
            given_up,
            alarms,
        } = self;
        let order = if *in_order {
            "each once at most, in order"
        } else {
            "NOT each once at most and in order"
        };
        write!(
            f,
            "{frames} frames, {asked} commands asked for, {applied} applied, {order}, {acknowledged} acknowledged, {given_up} given up, {alarms} false alarms"
        )
    }
}

/// Gives the robot commands, one after the other, until it has sent so many frames.
pub(crate) fn commands(frames: u64, seed: u64) -> Commands {
    const STEP_US: u64 = 5_000;
    // Twice a minute the link is silent for a second and a half.
    let silent_us = (0..frames / 25 / 30 + 1)
        .map(|each| (30 * each + 20) * 1_000_000)
        .map(|from_us| from_us..from_us + 1_500_000)
        .collect();
    let faults = Faults {
        delay_us: 40_000,
        silent_us,
        ..faults()
    };
    let mut robot = Faulty::new(Toy::default(), faults, seed);
    let table = KnownTable { schema: 0, len: 0 };
    let mut client = RobotClient::new(3, true, table);
    let (mut events, mut bytes, mut asked) = (Vec::new(), Vec::new(), Vec::new());
    let mut outcome = Commands {
        in_order: true,
        ..Commands::default()
    };
    let (mut matched, mut next) = (0, 0);
    while outcome.frames < frames {
        if client.link(robot.now_us()).unacknowledged == 0 && client.connected() {
            let command = Command::Reference(asked.len() as f32 * 0.001);
            client.submit(command, robot.now_us()).unwrap();
            asked.push(command);
        }
        robot.advance(STEP_US).unwrap();
        bytes.clear();
        robot.receive(&mut bytes);
        client.receive(&bytes, robot.now_us(), &mut events);
        bytes.clear();
        client.poll(robot.now_us(), &mut bytes, &mut events);
        robot.send(&bytes).unwrap();
        for item in events.drain(..) {
            match item {
                LinkEvent::Telemetry(..) | LinkEvent::Status(_) => outcome.frames += 1,
                LinkEvent::Ended(ended) => {
                    outcome.frames += 1;
                    let done = matches!(ended.fate, Fate::Applied(_));
                    outcome.acknowledged += usize::from(done);
                    outcome.given_up += usize::from(!done);
                }
                LinkEvent::Anomaly(_) | LinkEvent::StopUnconfirmed => outcome.alarms += 1,
                _ => {}
            }
        }
        for applied in robot.target.applied.drain(..) {
            let place = asked.iter().skip(next).position(|asked| *asked == applied);
            outcome.in_order &= place.is_some();
            next += place.map_or(0, |place| place + 1);
            matched += 1;
        }
    }
    Commands {
        asked: asked.len(),
        applied: matched,
        ..outcome
    }
}
