//! What the robot says, when, and in which language.
//!
//! In binary: telemetry of every fourth tick with the speeds of two ticks, the heading reference before every second one if
//! it changed, status twice a second and at once when it changes, events and acknowledgements as they come. In text: the
//! baseline's row for the mode whenever the link is free, at most ten a second. The answer is in the language in which the
//! robot was last addressed.

use rumbo_control::math::is_finite;
use rumbo_control::mode::ModeId;
use rumbo_control::{Micros, Wheels};
use rumbo_wire::text::{CM_PER_M, TextLine};
use rumbo_wire::{
    Ack, Event, EventKind, FrameMessage, FromRobot, Hello, Recalled, Refusal, StatusReport,
    Telemetry,
};

use crate::outbox::{Outbox, Priority};

/// A telemetry frame every so many ticks: 25 Hz.
const TELEMETRY_TICKS: u8 = 4;
/// The earlier of its two speed samples is so many ticks older: 20 ms.
const SAMPLE_TICKS: u8 = 2;
/// Busy ticks in a row for which a due frame waits: a late echo and that of the next ping.
const MOST_BUSY_TICKS: u8 = 2;
/// The heading reference with every so many telemetry frames at most: 12.5 Hz.
const HEADING_FRAMES: u8 = 2;
/// A status every so many ticks: 2 Hz.
const STATUS_TICKS: u8 = 50;
/// A text row every so many ticks at most: 10 Hz.
const ROW_TICKS: u8 = 10;

/// The language of the other end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Language {
    /// Frames.
    #[default]
    Binary,
    /// Lines.
    Text,
}

/// Values of a tick, for telemetry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Signals {
    /// All but the time, the earlier speeds and the flags of the status.
    pub(crate) telemetry: Telemetry,
    pub(crate) heading_ref_rad: f32,
}

impl Signals {
    fn wheel_rad_s(&self) -> Wheels<f32> {
        let [_, now_rad_s] = self.telemetry.wheel_rad_s;
        now_rad_s
    }
}

/// Fills the outbox.
#[derive(Clone, Debug)]
pub(crate) struct Reporter {
    hello: Hello,
    recalled: Option<Recalled>,
    language: Language,
    outbox: Outbox,
    seq: u8,
    hello_due: bool,
    status_due: bool,
    last_status: StatusReport,
    telemetry_in: u8,
    status_in: u8,
    /// Telemetry frames until the heading reference may be sent again.
    heading_in: u8,
    last_heading_ref_rad: f32,
    row_in: u8,
    last_row_at: Micros,
    earlier_rad_s: Wheels<f32>,
    /// Telemetry that is to be sent.
    sampled: Option<Signals>,
    /// Busy ticks for which what is due has waited.
    waited: u8,
    dropped: u8,
}

impl Reporter {
    /// A reporter that introduces itself with `hello` first.
    pub(crate) fn new(hello: Hello) -> Self {
        Self {
            hello,
            recalled: None,
            language: Language::Binary,
            outbox: Outbox::new(),
            seq: 0,
            hello_due: true,
            status_due: true,
            last_status: StatusReport::default(),
            telemetry_in: TELEMETRY_TICKS,
            status_in: STATUS_TICKS,
            heading_in: 0,
            last_heading_ref_rad: 0.0,
            row_in: ROW_TICKS,
            last_row_at: Micros(0),
            earlier_rad_s: Wheels::both(0.0),
            sampled: None,
            waited: 0,
            dropped: 0,
        }
    }

    /// The next byte for the link.
    #[inline(always)]
    pub(crate) fn transmit(&mut self) -> Option<u8> {
        self.outbox.pop()
    }

    /// The language in which the robot was last addressed.
    pub(crate) fn language(&self) -> Language {
        self.language
    }

    /// The robot was addressed in `language`.
    pub(crate) fn addressed_in(&mut self, language: Language) {
        self.language = language;
    }

    /// The parameters came from this copy; sent after each HELLO.
    pub(crate) fn recalled(&mut self, recalled: Option<Recalled>) {
        self.recalled = recalled;
    }

    /// HELLO was asked for; the status that follows it carries the time.
    pub(crate) fn introduce(&mut self) {
        self.hello_due = true;
        self.status_due = true;
    }

    /// Telemetry frames that the link had no room for, wrapping.
    pub(crate) fn dropped(&self) -> u8 {
        self.dropped
    }

    /// Answers a command.
    pub(crate) fn acknowledge(&mut self, ack: Ack) {
        self.say(Priority::Answer, &FromRobot::Ack(ack));
    }

    /// Says in text that a line was refused; the original says nothing at all.
    pub(crate) fn refuse_line(&mut self, refusal: Refusal) {
        self.say_number(*b"ERR ", refusal as u8);
    }

    /// Sends what happened.
    pub(crate) fn event(&mut self, t_ms: u16, kind: EventKind) {
        match (self.language, kind) {
            (Language::Binary, _) => {
                self.say(Priority::Answer, &FromRobot::Event(Event { t_ms, kind }));
            }
            (Language::Text, EventKind::Faulted(fault)) => self.say_number(*b"FLT ", fault as u8),
            (Language::Text, _) => {}
        }
    }

    /// At the end of every tick: sends at most one of what is due. After a `busy` tick that waits.
    /// `signals` gives the values for telemetry.
    pub(crate) fn tick(
        &mut self,
        now: Micros,
        t_ms: u16,
        busy: bool,
        status: &StatusReport,
        signals: impl FnOnce() -> Signals,
    ) {
        match self.language {
            Language::Binary => self.tick_binary(t_ms, busy, status, signals),
            Language::Text => self.tick_text(now, busy, status, signals),
        }
    }

    fn tick_binary(
        &mut self,
        t_ms: u16,
        busy: bool,
        status: &StatusReport,
        signals: impl FnOnce() -> Signals,
    ) {
        self.status_in = self.status_in.saturating_sub(1);
        if self.status_in == 0 || is_news(status, &self.last_status) {
            self.status_due = true;
        }
        self.telemetry_in = self.telemetry_in.saturating_sub(1);
        match self.telemetry_in {
            0 => {
                self.telemetry_in = TELEMETRY_TICKS;
                let mut signals = signals();
                signals.telemetry.t_ms = t_ms;
                signals.telemetry.wheel_rad_s[0] = self.earlier_rad_s;
                signals.telemetry.armed = status.armed;
                signals.telemetry.faulted = status.fault.is_some();
                self.sampled = Some(signals);
            }
            SAMPLE_TICKS => self.earlier_rad_s = signals().wheel_rad_s(),
            _ => {}
        }
        let is_due = self.sampled.is_some() || self.hello_due || self.status_due;
        if busy && is_due && self.waited < MOST_BUSY_TICKS {
            self.waited += 1;
            return;
        }
        self.waited = 0;
        match self.sampled.take() {
            Some(signals) if self.say_heading_ref(signals.heading_ref_rad) => {
                // One frame a tick.
                self.sampled = Some(signals);
            }
            Some(signals) => self.say_telemetry(signals.telemetry),
            None => self.say_what_is_due(t_ms, status),
        }
    }

    /// HELLO or the status: on ticks that have no telemetry.
    fn say_what_is_due(&mut self, t_ms: u16, status: &StatusReport) {
        if self.hello_due && self.say(Priority::Answer, &FromRobot::Hello(self.hello)) {
            self.hello_due = false;
            if let Some(recalled) = self.recalled {
                self.event(t_ms, EventKind::Recalled(recalled));
            }
        } else if self.status_due && self.say(Priority::Status, &FromRobot::Status(*status)) {
            self.status_due = false;
            self.status_in = STATUS_TICKS;
            self.last_status = *status;
            // Should the last one have been lost: again, once there is one.
            if self.last_heading_ref_rad != 0.0 {
                self.last_heading_ref_rad = f32::NAN;
            }
        }
    }

    fn say_telemetry(&mut self, telemetry: Telemetry) {
        self.heading_in = self.heading_in.saturating_sub(1);
        if !self.say(Priority::Telemetry, &FromRobot::Telemetry(telemetry)) {
            self.dropped = self.dropped.wrapping_add(1);
        }
    }

    /// If it changed, a tick ahead of the telemetry of the same instant; says whether.
    fn say_heading_ref(&mut self, heading_rad: f32) -> bool {
        let sent = self.heading_in == 0
            && is_finite(heading_rad)
            && heading_rad != self.last_heading_ref_rad
            && self.say(Priority::Telemetry, &FromRobot::HeadingRef(heading_rad));
        if sent {
            self.heading_in = HEADING_FRAMES;
            self.last_heading_ref_rad = heading_rad;
        }
        sent
    }

    fn tick_text(
        &mut self,
        now: Micros,
        busy: bool,
        status: &StatusReport,
        signals: impl FnOnce() -> Signals,
    ) {
        self.row_in = self.row_in.saturating_sub(1);
        if busy || self.row_in > 0 || !self.outbox.is_empty() {
            return;
        }
        self.row_in = ROW_TICKS;
        let dt_ms = now.since(self.last_row_at) / 1_000;
        self.last_row_at = now;
        self.say_row(dt_ms, status, &signals());
    }

    fn say_row(&mut self, dt_ms: u32, status: &StatusReport, signals: &Signals) {
        let mut line = TextLine::new(dt_ms);
        write_row(&mut line, status, signals);
        line.end();
        self.outbox.push(Priority::Answer, line.bytes());
    }

    /// Sends a message, or says that it did not fit. Only what is sent takes a number: a gap is the link's loss.
    fn say(&mut self, priority: Priority, message: &FromRobot) -> bool {
        let sent = self.outbox.push(priority, message.frame(self.seq).bytes());
        if sent {
            self.seq = self.seq.wrapping_add(1) & 0xF;
        }
        sent
    }

    fn say_number(&mut self, word: [u8; 4], number: u8) {
        let [a, b, c, d] = word;
        let (tens, ones) = (b'0' + number / 10 % 10, b'0' + number % 10);
        let line = [a, b, c, d, tens, ones, b'\r', b'\n'];
        let short = [a, b, c, d, ones, b'\r', b'\n'];
        let line = if number < 10 {
            short.as_slice()
        } else {
            line.as_slice()
        };
        self.outbox.push(Priority::Answer, line);
    }
}

/// The counters and the battery alone are no news.
fn is_news(status: &StatusReport, before: &StatusReport) -> bool {
    (status.mode, status.armed, status.fault) != (before.mode, before.armed, before.fault)
        || status.reference != before.reference
}

/// The columns of the original's row for the mode, after the time.
fn write_row(line: &mut TextLine, status: &StatusReport, signals: &Signals) {
    let telemetry = &signals.telemetry;
    let [left, right, front] = &telemetry.ranges;
    let [first, second] = status.reference.numbers();
    match status.mode {
        ModeId::FrontDistance | ModeId::FrontAlign | ModeId::WallHold | ModeId::WallFollow => {
            // One sonar in front the original sends twice.
            let (left, right) = match status.mode {
                ModeId::FrontDistance => (front, front),
                _ => (left, right),
            };
            line.range(left.range);
            line.range(right.range);
            line.number(first * CM_PER_M);
        }
        ModeId::Waypoints => {
            line.speeds(&signals.wheel_rad_s());
            line.speeds(&telemetry.wheel_ref_rad_s);
            line.pose(&telemetry.pose);
            line.pwm(&telemetry.duty);
            return;
        }
        ModeId::Mission | ModeId::Policy => {
            line.speeds(&telemetry.wheel_ref_rad_s);
            line.angle(signals.heading_ref_rad);
            line.number(first);
            line.number(second);
            line.pose(&telemetry.pose);
            line.integer(i16::from(telemetry.state));
            line.range(right.range);
            line.range(left.range);
            line.range(front.range);
            return;
        }
        ModeId::Manual | ModeId::WheelSpeed | ModeId::StraightLine | ModeId::Twist => {
            line.speeds(&signals.wheel_rad_s());
            line.speed(telemetry.wheel_ref_rad_s.right);
        }
    }
    line.integer(i16::from(status.mode as u8));
    line.pwm(&telemetry.duty);
}

#[cfg(test)]
mod tests;
