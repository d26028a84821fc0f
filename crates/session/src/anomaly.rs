//! Watches the robot's messages for what no healthy robot does, whatever the link loses or delays: a clock that runs
//! back, jumps or runs at another speed, far too many frames, repeated frames, a way that is not what its sonar sees.
//!
//! A link only delays: two frames may arrive closer together than they were made, never with more of the robot's time
//! between them than the wait for the first one explains, and a link that is silent for a second is lost, with which
//! everything here begins again. A restart looks like a clock that ran back until the next status, so what is
//! suspicious is judged then. Each anomaly is reported again after `AGAIN_US` at the earliest.

use crate::ahead::Ahead;
use rumbo_wire::{RobotTime, Telemetry};
use std::collections::VecDeque;

/// The same anomaly is not reported again within this time \[us\].
const AGAIN_US: u64 = 30_000_000;
/// An anomaly is shown for this long after it was last seen \[us\].
const SHOWN_US: u64 = 10_000_000;
/// The robot's clock may get ahead of the arrivals by this much in one step: longer than a silence that ends the
/// connection \[ms\].
const JUMP_MS: i64 = 1_500;
/// Time stamps of telemetry that are remembered: ten seconds of them.
const REMEMBERED: usize = 256;
/// A link may repeat a frame or two.
const REPEATS: u32 = 5;
/// Speed and rate are judged over windows of this length \[ms\]: a delay that changes by 4 s changes the speed by a
/// fifth.
const WINDOW_MS: i64 = 20_000;
/// Most frames a second, twice what the robot sends: 25 of telemetry, 12.5 headings, 2 statuses and some events.
const FRAMES_S: i64 = 100;
/// Suspicions are judged after this long without a status \[us\].
const PATIENCE_US: u64 = 3_000_000;

/// What no healthy robot does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anomaly {
    /// Its clock ran back without a restart.
    ClockBack,
    /// Its clock jumped ahead.
    ClockJump,
    /// Its clock runs much faster or slower than the station's.
    ClockSpeed,
    /// It sends far too many frames.
    Flood,
    /// It repeats earlier frames.
    Repeats,
    /// It does not drive ahead, although its wheels count that it does.
    Backward,
}

impl Anomaly {
    /// All of them.
    pub const ALL: [Anomaly; 6] = [
        Anomaly::ClockBack,
        Anomaly::ClockJump,
        Anomaly::ClockSpeed,
        Anomaly::Flood,
        Anomaly::Repeats,
        Anomaly::Backward,
    ];

    /// What it is, and what to do.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::ClockBack => {
                "the robot's clock ran back without a restart: its times are wrong; switch it off, and flash it again"
            }
            Self::ClockJump => {
                "the robot's clock jumped ahead: its times are wrong; switch it off, and flash it again"
            }
            Self::ClockSpeed => {
                "the robot's clock runs at another speed than the station's: check that its program is built for its crystal"
            }
            Self::Flood => {
                "the robot sends far more than it should: switch it off, and flash it again"
            }
            Self::Repeats => {
                "the robot repeats earlier messages: what is shown may be old; switch it off, and check what is on the link"
            }
            Self::Backward => {
                "the wheels count a way ahead, but what is ahead moves away: a motor turns backward, unless something walks away from the robot; stop, and press Check the robot"
            }
        }
    }
}

/// A stretch over which speed and rate are measured.
#[derive(Clone, Copy, Debug)]
struct Window {
    began_ms: i64,
    robot_ms: i64,
    frames: i64,
}

/// Detects anomalies in the frames of one robot.
#[derive(Debug, Default)]
pub(crate) struct AnomalyDetector {
    /// The robot's time in milliseconds, going on where telemetry wraps, and when it arrived \[ms\].
    last: Option<(i64, i64)>,
    recent: VecDeque<u16>,
    last_status: Option<RobotTime>,
    ahead: Ahead,
    repeats: u32,
    suspected: Vec<Anomaly>,
    suspected_us: Option<u64>,
    window: Option<Window>,
    seen_us: [Option<u64>; Anomaly::ALL.len()],
    reported_us: [Option<u64>; Anomaly::ALL.len()],
    to_report: Vec<Anomaly>,
}

impl AnomalyDetector {
    /// The robot restarted, or was lost: its messages from now on do not follow from earlier ones.
    pub(crate) fn begin(&mut self) {
        *self = Self {
            seen_us: self.seen_us,
            reported_us: self.reported_us,
            to_report: std::mem::take(&mut self.to_report),
            ..Self::default()
        };
    }

    /// A frame arrived that is no answer.
    pub(crate) fn frame(&mut self, now_us: u64) {
        if let Some(window) = &mut self.window {
            window.frames += 1;
        }
        if self
            .suspected_us
            .is_some_and(|since_us| now_us >= since_us + PATIENCE_US)
        {
            self.judge(now_us);
        }
    }

    /// Telemetry arrived.
    pub(crate) fn telemetry(&mut self, telemetry: &Telemetry, now_us: u64) {
        let t_ms = telemetry.t_ms;
        if self.recent.contains(&t_ms) {
            self.repeats += 1;
            return self.suspect_repeats(now_us);
        }
        let before = self.recent.back().copied();
        self.recent.push_back(t_ms);
        if self.recent.len() > REMEMBERED {
            self.recent.pop_front();
        }
        let step_ms = before.map_or(0, |before| t_ms.wrapping_sub(before).cast_signed());
        self.step(step_ms.into(), now_us);
        if self.ahead.contradicts(telemetry) {
            self.ahead = Ahead::default();
            self.found(Anomaly::Backward, now_us);
        }
    }

    /// A status with this time arrived, of the same start as the one before: what was suspicious was no restart.
    pub(crate) fn status(&mut self, at: RobotTime, now_us: u64) {
        match self.last_status.replace(at) {
            Some(before) if before == at => {
                self.repeats += 1;
                self.suspect_repeats(now_us);
            }
            Some(before) if at.since(before).is_none() => {
                self.suspect(Anomaly::ClockBack, now_us);
            }
            _ => {}
        }
        self.judge(now_us);
        self.measure(now_us);
    }

    fn step(&mut self, step_ms: i64, now_us: u64) {
        let now_ms = (now_us / 1_000) as i64;
        let (robot_ms, arrived_ms) = self.last.unwrap_or((0, now_ms));
        if step_ms < 0 {
            self.suspect(Anomaly::ClockBack, now_us);
        } else if step_ms > now_ms - arrived_ms + JUMP_MS {
            self.suspect(Anomaly::ClockJump, now_us);
        }
        self.last = Some((robot_ms + step_ms, now_ms));
    }

    fn suspect_repeats(&mut self, now_us: u64) {
        if self.repeats > REPEATS {
            self.repeats = 0;
            self.suspect(Anomaly::Repeats, now_us);
        }
    }

    fn suspect(&mut self, anomaly: Anomaly, now_us: u64) {
        if !self.suspected.contains(&anomaly) {
            self.suspected.push(anomaly);
        }
        self.suspected_us.get_or_insert(now_us);
        // A clock that was set says nothing about its speed.
        if anomaly != Anomaly::Repeats {
            self.window = None;
        }
    }

    fn judge(&mut self, now_us: u64) {
        self.suspected_us = None;
        for anomaly in std::mem::take(&mut self.suspected) {
            self.found(anomaly, now_us);
        }
    }

    /// Speed and rate, at the end of a window.
    fn measure(&mut self, now_us: u64) {
        let now_ms = (now_us / 1_000) as i64;
        let Some((robot_ms, _)) = self.last else {
            return;
        };
        let window = *self.window.get_or_insert(Window {
            began_ms: now_ms,
            robot_ms,
            frames: 0,
        });
        let passed_ms = now_ms - window.began_ms;
        let lived_ms = robot_ms - window.robot_ms;
        // Frames held back by a delay arrive at once: by the robot's time they are no more than usual.
        let longer_ms = passed_ms.max(lived_ms);
        if window.frames > FRAMES_S
            && window.frames * 1_000 > FRAMES_S * longer_ms + 5_000 * FRAMES_S
        {
            self.found(Anomaly::Flood, now_us);
            self.window = None;
        } else if passed_ms >= WINDOW_MS {
            if 5 * lived_ms > 6 * passed_ms || 5 * lived_ms < 4 * passed_ms {
                self.found(Anomaly::ClockSpeed, now_us);
            }
            self.window = None;
        }
    }

    fn found(&mut self, anomaly: Anomaly, now_us: u64) {
        let at = anomaly as usize;
        self.seen_us[at] = Some(now_us);
        if self.reported_us[at].is_none_or(|reported_us| now_us >= reported_us + AGAIN_US) {
            self.reported_us[at] = Some(now_us);
            self.to_report.push(anomaly);
        }
    }

    /// The anomalies to report now.
    pub(crate) fn drain(&mut self) -> impl Iterator<Item = Anomaly> + use<> {
        std::mem::take(&mut self.to_report).into_iter()
    }

    /// Anomalies seen recently.
    pub(crate) fn present(&self, now_us: u64) -> impl Iterator<Item = Anomaly> {
        let lately = move |at_us: u64| now_us < at_us + SHOWN_US;
        let seen = Anomaly::ALL.into_iter().zip(self.seen_us);
        seen.filter_map(move |(anomaly, at_us)| at_us.is_some_and(lately).then_some(anomaly))
    }
}
