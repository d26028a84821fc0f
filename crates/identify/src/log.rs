//! Recorded runs as identification needs them: duty in, speeds or distance out, on a millisecond grid.
//!
//! Reads the original program's CSV; the header tells which mode wrote it. What a row says holds from its time to the
//! next: the duty was applied then, the speeds are those of the latest completed 50 ms window. Where the applied
//! reference is zero (modes 5 to 7), the bridge was released whatever the PWM column says.

use crate::error::IdentifyError;
use crate::pair::SonarPair;
use crate::row::{LONGEST_MS, LogRow, Window};
use std::path::{Path, PathBuf};

/// Length of the windows in which the original counts encoder edges, ms.
pub(crate) const WINDOW_MS: usize = 50;
/// A log with more than one damaged row in so many is refused.
pub(crate) const DAMAGED_IN: usize = 10;
const RAD_S_PER_RPM: f64 = std::f64::consts::PI / 30.0;

/// What a run tells about the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seen {
    /// Both wheels' speeds (modes 5, 6 and 7).
    Speeds,
    /// The distance to a wall straight ahead (modes 1 and 2).
    FrontRange,
    /// Two distances to a wall beside the robot (modes 3 and 4).
    SidePair,
}

/// The program that the robot ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotProgram {
    /// The report's: a row each pass, speeds counted in windows of 50 ms.
    Original,
    /// Ours: a row each 40 ms, speeds from the times of edges.
    Rumbo,
    /// Somebody's: rows and speeds as they are.
    Another,
}

/// A recorded run.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveLog {
    /// File name without folder.
    pub name: String,
    /// The file that it is from, or is a stretch of: one robot, battery and floor.
    pub source: PathBuf,
    /// The program that was recorded.
    pub program: RobotProgram,
    /// Whether the wheels were on the floor; else they were in the air.
    pub on_floor: bool,
    /// Voltage of the idle battery and its standard deviation, V, where it was measured.
    pub battery_v: Option<(f64, f64)>,
    /// What it measured.
    pub seen: Seen,
    /// Rows in the order of time.
    pub rows: Vec<LogRow>,
    /// When counting windows end, modulo their length, if the log shows it.
    pub window_phase_ms: Option<usize>,
    /// What the run says about its two sonars, if it has two.
    pub pair: Option<SonarPair>,
    /// Rows that were left out, and why.
    pub damaged: Vec<IdentifyError>,
}

impl DriveLog {
    /// Reads a CSV of the original program.
    ///
    /// # Errors
    /// A file that cannot be read, a header of no mode with PWM, a row with a value that is no number.
    pub fn read(path: &Path) -> Result<Self, IdentifyError> {
        let file = std::fs::File::open(path).map_err(|cause| IdentifyError::read(path, cause))?;
        Self::parse(path, file)
    }

    /// Reads the same from any source; `path` is for messages and the name.
    ///
    /// # Errors
    /// As [`DriveLog::read`].
    pub fn parse(path: &Path, source: impl std::io::Read) -> Result<Self, IdentifyError> {
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(source);
        let bad = |error: csv::Error| IdentifyError::read(path, error);
        let header: Vec<String> = reader
            .headers()
            .map_err(bad)?
            .iter()
            .map(String::from)
            .collect();
        let columns = Columns::find(path, &header)?;
        let mut damaged = Vec::new();
        let (mut rows, is_front) = columns.rows(path, &header, &mut reader, &mut damaged)?;
        let seen = match columns.signals {
            Signals::Speeds { .. } => Seen::Speeds,
            Signals::Ranges { .. } if is_front => Seen::FrontRange,
            Signals::Ranges { .. } => Seen::SidePair,
        };
        let window_phase_ms = if seen == Seen::Speeds {
            window_phase_ms(&rows)
        } else {
            None
        };
        for row in &mut rows {
            let window = Window {
                end_ms: window_end_ms(row.at_ms, window_phase_ms),
                length_ms: WINDOW_MS,
            };
            row.window = [window; 2];
        }
        // Mode 1 has one sonar and writes its reading twice.
        let is_pair = rows.iter().any(|row| row.range_m[0] != row.range_m[1]);
        let pair = is_pair.then(|| SonarPair::of(&rows, seen == Seen::SidePair));
        Ok(Self {
            window_phase_ms,
            pair,
            damaged,
            ..Self::new(path, RobotProgram::Original, seen, rows)
        })
    }

    /// A run on the floor of which nothing else is known.
    pub(crate) fn new(path: &Path, program: RobotProgram, seen: Seen, rows: Vec<LogRow>) -> Self {
        Self {
            name: name_of(path),
            source: path.into(),
            program,
            on_floor: true,
            battery_v: None,
            seen,
            rows,
            window_phase_ms: None,
            pair: None,
            damaged: Vec::new(),
        }
    }

    /// Length of the run, ms.
    #[must_use]
    pub fn duration_ms(&self) -> usize {
        let last = self.rows.last();
        last.map_or(0, |row| row.at_ms.max(row.measured_ms()))
    }
}

/// A file's name without its folder.
pub(crate) fn name_of(path: &Path) -> String {
    let name = path.file_name();
    name.map_or_else(|| "log".into(), |name| name.to_string_lossy().into_owned())
}

/// When the counting window ended whose speed a row shows, ms. Unknown phases count as half a window old.
fn window_end_ms(at_ms: usize, window_phase_ms: Option<usize>) -> usize {
    let age_ms = window_phase_ms.map_or(WINDOW_MS / 2, |phase_ms| {
        (at_ms + WINDOW_MS - phase_ms) % WINDOW_MS
    });
    at_ms.saturating_sub(age_ms)
}

/// The phase of the counting windows: rows within one window must show the same speeds. `None` if the rows are too
/// far apart to tell.
fn window_phase_ms(rows: &[LogRow]) -> Option<usize> {
    let contradictions = |phase_ms: usize| {
        let window = |row: &LogRow| (row.at_ms + WINDOW_MS - phase_ms) / WINDOW_MS;
        rows.windows(2)
            .filter(|pair| {
                window(&pair[0]) == window(&pair[1]) && pair[0].speed_rad_s != pair[1].speed_rad_s
            })
            .count()
    };
    let counts: Vec<usize> = (0..WINDOW_MS).map(contradictions).collect();
    let (least, most) = (*counts.iter().min()?, *counts.iter().max()?);
    // A phase shows if the wrong ones are refuted by many rows and the right one by few.
    if most < 20 || least * 4 > most {
        return None;
    }
    // Rows in step with the windows leave a stretch of phases; its middle is the best guess.
    let holds = |phase_ms: usize| counts[phase_ms % WINDOW_MS] == least;
    let first =
        (0..WINDOW_MS).find(|&phase_ms| holds(phase_ms) && !holds(phase_ms + WINDOW_MS - 1))?;
    let length = (first..first + WINDOW_MS)
        .take_while(|&phase_ms| holds(phase_ms))
        .count();
    Some((first + (length - 1) / 2) % WINDOW_MS)
}

/// Where the columns of a mode are.
struct Columns {
    dt: usize,
    mode: Option<usize>,
    /// Left and right; motor A of the report is the right one.
    pwm: [usize; 2],
    signals: Signals,
}

enum Signals {
    Speeds {
        speed: [usize; 2],
        reference: [usize; 2],
    },
    Ranges {
        range: [usize; 2],
        reference: usize,
    },
}

impl Columns {
    fn find(path: &Path, header: &[String]) -> Result<Self, IdentifyError> {
        let find = |name: &str| header.iter().position(|column| column == name);
        let pair = |left: &str, right: &str| Some([find(left)?, find(right)?]);
        let signals = || {
            if let Some(speed) = pair("speed_b_rpm", "speed_a_rpm") {
                let both = find("reference_rpm").map(|column| [column, column]);
                let reference = both.or_else(|| pair("reference_b_rpm", "reference_a_rpm"))?;
                return Some(Signals::Speeds { speed, reference });
            }
            Some(Signals::Ranges {
                range: pair("left_cm", "right_cm")?,
                reference: find("reference_cm")?,
            })
        };
        let columns = || {
            Some(Self {
                dt: find("dt_ms")?,
                mode: find("mode"),
                pwm: pair("pwm_b", "pwm_a")?,
                signals: signals()?,
            })
        };
        columns().ok_or_else(|| IdentifyError::Header {
            path: path.into(),
            found: header.join(","),
        })
    }

    /// All rows that can be read, and whether the distances are to a wall ahead; the others go to `damaged`.
    fn rows(
        &self,
        path: &Path,
        header: &[String],
        reader: &mut csv::Reader<impl std::io::Read>,
        damaged: &mut Vec<IdentifyError>,
    ) -> Result<(Vec<LogRow>, bool), IdentifyError> {
        let (mut rows, mut is_front) = (Vec::new(), false);
        let (mut at_ms, mut lasted_ms) = (0_usize, 0);
        for record in reader.records() {
            let record = match record {
                Ok(record) => record,
                Err(error) if error.position().is_some() => {
                    damaged.push(IdentifyError::read(path, error));
                    continue;
                }
                Err(error) => return Err(IdentifyError::read(path, error)),
            };
            let fields = Fields {
                path,
                header,
                record: &record,
            };
            let duration = fields.duration_ms(self.dt);
            // A row whose own time is damaged lasted about as long as the one before.
            lasted_ms = *duration.as_ref().unwrap_or(&lasted_ms);
            at_ms += lasted_ms;
            if at_ms > LONGEST_MS {
                return Err(IdentifyError::too_long(path));
            }
            let row = duration.and_then(|_| self.row(&fields, at_ms));
            match row {
                Ok((row, front)) => {
                    rows.push(row);
                    is_front = front;
                }
                Err(error) => damaged.push(error),
            }
        }
        if damaged.len() > rows.len() / DAMAGED_IN {
            return Err(damaged.swap_remove(0));
        }
        if rows.len() < 2 {
            return Err(IdentifyError::read(path, "fewer than two rows"));
        }
        Ok((rows, is_front))
    }

    /// A row, and whether its distances are to a wall ahead: modes 1 and 2.
    fn row(&self, fields: &Fields<'_>, at_ms: usize) -> Result<(LogRow, bool), IdentifyError> {
        let pair =
            |columns: [usize; 2]| Ok([fields.number(columns[0])?, fields.number(columns[1])?]);
        let pwm = pair(self.pwm)?;
        let mode = self.mode.map_or(Ok(0.0), |column| fields.number(column))?;
        let is_front = mode == 1.0 || mode == 2.0;
        let mut row = LogRow {
            at_ms,
            duty: pwm.map(|pwm| (pwm / 255.0).clamp(-1.0, 1.0)),
            ..LogRow::default()
        };
        match self.signals {
            Signals::Speeds { speed, reference } => {
                row.speed_rad_s = pair(speed)?.map(|rpm| rpm * RAD_S_PER_RPM);
                row.reference_rad_s = pair(reference)?.map(|rpm| rpm * RAD_S_PER_RPM);
                for (duty, reference) in row.duty.iter_mut().zip(row.reference_rad_s) {
                    if reference == 0.0 {
                        *duty = 0.0;
                    }
                }
            }
            Signals::Ranges { range, reference } => {
                row.range_m = pair(range)?.map(|cm| cm / 100.0);
                // These modes log the PWM without its sign: too near a wall ahead is backward. Beside a wall they only
                // go forward.
                if is_front && row.mean_m() < fields.number(reference)? / 100.0 {
                    row.duty = row.duty.map(|duty| -duty);
                }
            }
        }
        Ok((row, is_front))
    }
}

/// One record with what a message about it needs.
struct Fields<'a> {
    path: &'a Path,
    header: &'a [String],
    record: &'a csv::StringRecord,
}

impl Fields<'_> {
    fn number(&self, column: usize) -> Result<f64, IdentifyError> {
        let text = self.record.get(column).unwrap_or_default();
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.error(column, "a number")),
        }
    }

    fn duration_ms(&self, column: usize) -> Result<usize, IdentifyError> {
        match self.number(column)? {
            value if (0.0..=600_000.0).contains(&value) => Ok(value.round() as usize),
            _ => Err(self.error(column, "0 to 600000 ms")),
        }
    }

    fn error(&self, column: usize, allowed: &'static str) -> IdentifyError {
        IdentifyError::Value {
            path: self.path.into(),
            line: self.record.position().map_or(0, csv::Position::line),
            column: self.header[column].clone(),
            value: self.record.get(column).unwrap_or_default().into(),
            allowed,
        }
    }
}
