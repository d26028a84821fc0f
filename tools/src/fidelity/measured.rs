//! Wheel speeds as the program measured them, in the recorded run of mode 5 and in simulated ones: settling is judged by
//! the same coarse readings in both.

use rumbo_control::Wheels;
use rumbo_experiment::files::{FileError, Setup, TimedCommand};
use rumbo_experiment::run::RunResult;
use rumbo_wire::csv;
use rumbo_wire::text::{RAD_S_PER_RPM, RowKind, TextRow};
use rumbo_wire::{Command, FromRobot};
use std::path::Path;

/// One count of an edge in 50 ms, and a little.
const BAND_RPM: f64 = 3.2;
/// When the simulated robot is armed; its first reference was sent before.
const ARMED_S: f64 = 0.5;

/// A reference of both wheels and how long it was in force.
struct Step {
    reference_rpm: f64,
    from_s: f64,
    until_s: f64,
}

/// The recorded run.
pub(crate) struct Recorded {
    steps: Vec<Step>,
    rows: Vec<(f64, Wheels<f64>)>,
}

impl Recorded {
    /// Reads a recording of mode 5.
    pub(crate) fn read(path: &Path) -> Result<Self, FileError> {
        let wrong = |what: &str| FileError::Setting(format!("{}: {what}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| wrong(&error.to_string()))?;
        let (header, rows) = text.split_once('\n').unwrap_or_default();
        if csv::recognise(header) != Some(RowKind::Speed) {
            return Err(wrong("is no recording of mode 5; its header differs"));
        }
        let mut recorded = Self {
            steps: Vec::new(),
            rows: Vec::new(),
        };
        let mut now_s = ARMED_S;
        for line in rows.lines() {
            let Ok(TextRow::Speed(row)) = TextRow::parse_as(RowKind::Speed, line.trim()) else {
                return Err(wrong(&format!("`{line}` is no row of mode 5")));
            };
            now_s += f64::from(row.dt_ms) * 1e-3;
            let reference_rpm = f64::from(row.reference_rpm);
            match recorded.steps.last_mut() {
                Some(step) if step.reference_rpm == reference_rpm => step.until_s = now_s,
                _ => recorded.steps.push(Step {
                    reference_rpm,
                    from_s: now_s,
                    until_s: now_s,
                }),
            }
            recorded.rows.push((now_s, row.wheel_rpm.map(f64::from)));
        }
        Ok(recorded)
    }

    /// The scenario with the references of the recording at their times.
    pub(crate) fn steer(&self, setup: &mut Setup) {
        let commands = &mut setup.scenario.commands;
        commands.retain(|timed| matches!(timed.command, Command::Arm));
        let command = |(index, step): (usize, &Step)| TimedCommand {
            at_s: if index == 0 {
                ARMED_S - 0.1
            } else {
                step.from_s
            },
            command: Command::Reference((step.reference_rpm * f64::from(RAD_S_PER_RPM)) as f32),
            after_reached: false,
            goal_of_world: false,
        };
        commands.extend(self.steps.iter().enumerate().map(command));
        commands.sort_by(|one, other| one.at_s.total_cmp(&other.at_s));
        setup.scenario.duration_s = self.steps.last().map_or(0.0, |step| step.until_s);
    }

    /// Time of each step until both wheels stay within the band, s.
    pub(crate) fn settling_s(&self) -> Vec<f64> {
        self.settling_of(&self.rows)
    }

    /// The same of a simulated run under the same references.
    pub(crate) fn simulated_settling_s(&self, result: &RunResult) -> Vec<f64> {
        let rows = result
            .trace
            .messages
            .iter()
            .filter_map(|message| match message.what {
                FromRobot::Telemetry(telemetry) => {
                    let rpm =
                        telemetry.wheel_rad_s[0].map(|rad_s| f64::from(rad_s / RAD_S_PER_RPM));
                    Some((message.t_s, rpm))
                }
                _ => None,
            });
        self.settling_of(&rows.collect::<Vec<_>>())
    }

    fn settling_of(&self, rows: &[(f64, Wheels<f64>)]) -> Vec<f64> {
        let settling = |step: &Step| {
            let off = |rpm: f64| (rpm - step.reference_rpm).abs() > BAND_RPM;
            let during = |t_s: f64| t_s >= step.from_s && t_s <= step.until_s;
            let mut during = rows.iter().filter(|(t_s, _)| during(*t_s)).rev();
            let is_off = |(_, rpm): &&(f64, Wheels<f64>)| off(rpm.left) || off(rpm.right);
            match during.clone().next().filter(is_off) {
                // Not to the end of the step.
                Some(_) => step.until_s - step.from_s,
                None => during
                    .find(is_off)
                    .map_or(0.0, |(t_s, _)| t_s - step.from_s),
            }
        };
        self.steps.iter().map(settling).collect()
    }
}
