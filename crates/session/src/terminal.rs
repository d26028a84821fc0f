//! The link to a robot that speaks the original's text: commands become lines, rows of telemetry become frames.
//!
//! Lines are sent once and not acknowledged; their effect shows in the rows. No row says whether the robot is armed:
//! the last order is assumed. A robot with that program is silent until its first ON, and takes bytes of frames for the
//! beginning of a line, so a line that follows frames is sent after a line end.

use rumbo_control::Wheels;
use rumbo_control::mode::{ModeId, Reference};
use rumbo_wire::text::{self, RAD_PER_DEG, RAD_S_PER_RPM, RowKind, TextCommand, TextRow};
use rumbo_wire::{Command, Telemetry};

/// Longest line.
const LONGEST: usize = 256;
/// A row that its own clock dates more than this before its arrival was not late: the clock was stopped \[ms\].
const LATEST_MS: i64 = 300;

/// The contents of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ParsedRow {
    /// Time of the row, in the session's time \[ms\].
    pub(crate) t_ms: i64,
    pub(crate) telemetry: Telemetry,
    pub(crate) mode: Option<ModeId>,
    /// The mode's reference, where the row has it.
    pub(crate) reference: Option<Reference>,
    /// The mode's heading setpoint, where the row has it \[rad\].
    pub(crate) heading_ref_rad: Option<f32>,
    pub(crate) kind: RowKind,
}

/// The station's end of a link of text.
#[derive(Debug)]
pub(crate) struct Terminal {
    armed: bool,
    line: Vec<u8>,
    /// Session time of the last row \[ms\].
    last_ms: Option<i64>,
    /// Lines not sent yet.
    waiting: Vec<u8>,
    /// Frames were sent since the last line.
    frames_sent: bool,
    /// The wheels were given separate references, of which rows carry only one.
    apart: bool,
}

impl Terminal {
    pub(crate) fn new() -> Self {
        Self {
            armed: false,
            line: Vec::new(),
            last_ms: None,
            waiting: Vec::new(),
            frames_sent: false,
            apart: false,
        }
    }

    /// Frames went out on this link.
    pub(crate) fn frames_sent(&mut self) {
        self.frames_sent = true;
    }

    /// ON was the last order.
    pub(crate) fn armed(&self) -> bool {
        self.armed
    }

    /// Queues the command as text; false if text has no words for it.
    pub(crate) fn submit(&mut self, command: &Command, mode: ModeId) -> bool {
        let lines = text::lines_of(command, mode);
        for line in lines.iter().flatten() {
            self.obey(line);
            self.push(&format!("{line}\n"));
        }
        lines != [None; 2]
    }

    /// What a person typed, to be sent as it is.
    pub(crate) fn type_in(&mut self, text: &str) {
        if let Ok(command) = TextCommand::parse(text.trim_end()) {
            self.obey(&command);
        }
        self.push(text);
    }

    /// Notes what the robot will be like.
    fn obey(&mut self, command: &TextCommand) {
        match command {
            TextCommand::On => self.armed = true,
            TextCommand::Off => {
                self.armed = false;
                self.waiting.clear();
            }
            TextCommand::Reference(_) => self.apart = false,
            TextCommand::WheelReference(..) => self.apart = true,
            _ => {}
        }
    }

    fn push(&mut self, text: &str) {
        if std::mem::take(&mut self.frames_sent) {
            self.waiting.push(b'\n');
        }
        self.waiting.extend(text.bytes());
    }

    /// Discards the lines not sent yet.
    pub(crate) fn forget(&mut self) {
        self.waiting.clear();
    }

    /// Appends the bytes to be sent now.
    pub(crate) fn poll(&mut self, to_robot: &mut Vec<u8>) {
        to_robot.append(&mut self.waiting);
    }

    /// Takes a byte from the robot; returns the row that it completes.
    pub(crate) fn receive(&mut self, byte: u8, now_ms: i64) -> Option<ParsedRow> {
        if byte != b'\n' {
            if self.line.len() < LONGEST {
                self.line.push(byte);
            }
            return None;
        }
        let line = std::mem::take(&mut self.line);
        let row = TextRow::parse(str::from_utf8(&line).ok()?.trim()).ok()?;
        let t_ms = self.made_ms(row.dt_ms(), now_ms);
        let (reference, heading_ref_rad) = self.setpoints(&row);
        Some(ParsedRow {
            t_ms,
            telemetry: row.telemetry((t_ms & 0xffff) as u16, self.armed),
            mode: row.mode().and_then(ModeId::from_number).or(match row {
                TextRow::Waypoints(_) => Some(ModeId::Waypoints),
                TextRow::Mission(_) => Some(ModeId::Mission),
                TextRow::Distance(_) | TextRow::Speed(_) => None,
            }),
            reference,
            heading_ref_rad,
            kind: row.kind(),
        })
    }

    /// Time of a row, from its interval to the one before. The row with the shortest delay on the link sets the clock.
    fn made_ms(&mut self, dt_ms: u32, now_ms: i64) -> i64 {
        let row_ms = self.last_ms.map(|last_ms| last_ms + i64::from(dt_ms));
        let t_ms = row_ms
            .filter(|t_ms| (now_ms - LATEST_MS..=now_ms).contains(t_ms))
            .unwrap_or(now_ms);
        self.last_ms = Some(t_ms);
        t_ms
    }

    /// The mode's reference and heading setpoint in the row.
    fn setpoints(&self, row: &TextRow) -> (Option<Reference>, Option<f32>) {
        let (reference, heading_rad) = match row {
            TextRow::Distance(row) => {
                (Reference::Distance(row.reference_cm / text::CM_PER_M), None)
            }
            TextRow::Speed(row) if !self.apart => {
                let both = Wheels::both(row.reference_rpm * RAD_S_PER_RPM);
                (Reference::Wheels(both), None)
            }
            TextRow::Mission(row) => {
                let (x_m, y_m) = (row.goal_x_m, row.goal_y_m);
                let heading_rad = row.heading_reference_deg * RAD_PER_DEG;
                (Reference::Goal { x_m, y_m }, Some(heading_rad))
            }
            TextRow::Speed(_) | TextRow::Waypoints(_) => return (None, None),
        };
        (Some(reference), heading_rad)
    }
}

/// Signals absent from a row of this kind.
pub(crate) fn absent_signals(kind: RowKind) -> impl Iterator<Item = &'static str> {
    const POSE: &[&str] = &[
        "x_m",
        "y_m",
        "heading_rad",
        "x_deviation_m",
        "y_deviation_m",
        "xy_correlation",
        "heading_deviation_rad",
    ];
    const ORIGIN: &[&str] = &["origin_x_m", "origin_y_m", "origin_heading_rad"];
    const SPEEDS: &[&str] = &[
        "left_before_rad_s",
        "right_before_rad_s",
        "left_rad_s",
        "right_rad_s",
    ];
    const SPEED_REFERENCES: &[&str] = &["left_ref_rad_s", "right_ref_rad_s"];
    const STATE: &[&str] = &["state"];
    const HEADING: &[&str] = &["heading_ref_rad"];
    const PWM: &[&str] = &["left_pwm", "right_pwm"];
    const ALWAYS: &[&str] = &["servo_rad", "faulted"];
    let groups: &[&[&str]] = match kind {
        RowKind::Distance => &[
            POSE,
            ORIGIN,
            SPEEDS,
            SPEED_REFERENCES,
            STATE,
            HEADING,
            ALWAYS,
        ],
        RowKind::Speed => &[POSE, ORIGIN, STATE, HEADING, ALWAYS],
        RowKind::Waypoints => &[STATE, HEADING, ALWAYS],
        RowKind::Mission => &[SPEEDS, PWM, ALWAYS],
    };
    groups.iter().copied().flatten().copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_log::Row as Signals;

    fn rows_in(terminal: &mut Terminal, bytes: &[u8], now_ms: i64) -> Vec<ParsedRow> {
        let rows = bytes.iter().map(|byte| terminal.receive(*byte, now_ms));
        rows.flatten().collect()
    }

    #[test]
    fn a_row_becomes_a_frame_with_its_mode_and_reference() {
        let mut terminal = Terminal::new();
        let bytes = b"garbage\r\n68, 106.16, 88.00, 30, 1, 115, -20\r\n";
        let [row] = rows_in(&mut terminal, bytes, 68)[..] else {
            panic!("not one row")
        };
        assert_eq!(row.mode, Some(ModeId::FrontDistance));
        assert_eq!(row.reference, Some(Reference::Distance(0.3)));
        assert_eq!(row.telemetry.duty.left.counts(), -20);
        let mission = b"90, 50, 50, -45, 1.5, 0.5, 0.2, 0, 3, 3, 88, 90, 106\n";
        let [row] = rows_in(&mut terminal, mission, 200)[..] else {
            panic!("not one row")
        };
        assert_eq!(row.mode, Some(ModeId::Mission));
        let goal = Reference::Goal { x_m: 1.5, y_m: 0.5 };
        assert_eq!(row.reference, Some(goal));
    }

    #[test]
    fn rows_that_arrive_together_keep_the_time_between_them() {
        let mut terminal = Terminal::new();
        let row = b"50, 20, 20, 40, 5, 115, 120\n";
        assert_eq!(rows_in(&mut terminal, row, 1_000)[0].t_ms, 1_000);
        let two = [&row[..], row].concat();
        let times: Vec<i64> = rows_in(&mut terminal, &two, 1_110)
            .iter()
            .map(|row| row.t_ms)
            .collect();
        assert_eq!(times, [1_050, 1_100]);
        // One that would lie in the future, and one after a pause that its interval does not include.
        assert_eq!(rows_in(&mut terminal, row, 1_120)[0].t_ms, 1_120);
        assert_eq!(rows_in(&mut terminal, row, 9_000)[0].t_ms, 9_000);
    }

    #[test]
    fn off_goes_out_before_anything_that_waits() {
        let mut terminal = Terminal::new();
        assert!(terminal.submit(&Command::Arm, ModeId::WheelSpeed));
        assert!(terminal.submit(&Command::Stop, ModeId::WheelSpeed));
        assert!(!terminal.submit(&Command::Lane, ModeId::Mission));
        let mut bytes = Vec::new();
        terminal.poll(&mut bytes);
        assert_eq!(bytes, b"OFF\n");
    }

    #[test]
    fn a_line_begun_by_frames_is_ended_before_the_first_command() {
        let mut terminal = Terminal::new();
        terminal.frames_sent();
        terminal.type_in("PID A 1 0.001 0\n");
        terminal.type_in("on\n");
        assert!(terminal.armed());
        let mut bytes = Vec::new();
        terminal.poll(&mut bytes);
        assert_eq!(bytes, b"\nPID A 1 0.001 0\non\n");
    }

    #[test]
    fn every_absent_signal_has_a_column() {
        for kind in RowKind::ALL {
            assert!(absent_signals(kind).all(|name| Signals::column(name).is_some()));
        }
    }
}
