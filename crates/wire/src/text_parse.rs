//! The rows of telemetry of the original's text protocol, from text.

use rumbo_control::Wheels;
use rumbo_control::math::round;

use crate::decimal;
use crate::text_error::TextError;
use crate::text_published;
use crate::text_row::{DistanceRow, MissionRow, RowKind, SpeedRow, TextRow, WaypointsRow};

impl TextRow {
    /// The row in a line, given without its end; its columns determine the kind. A row of the published sketches has no
    /// time: its `dt_ms` is 0.
    ///
    /// # Errors
    /// If the line has other columns than any row, or a value is no number.
    pub fn parse(line: &str) -> Result<TextRow, TextError> {
        if let Some(row) = text_published::row(line) {
            return Ok(row);
        }
        let kind = match line.split(',').count() {
            // The mode is the fifth column of both.
            7 => match Fields::new(line).nth_number(4)? {
                mode if (1.0..=4.0).contains(&mode) => RowKind::Distance,
                _ => RowKind::Speed,
            },
            10 => RowKind::Waypoints,
            13 => RowKind::Mission,
            _ => return Err(TextError::Columns),
        };
        TextRow::parse_as(kind, line)
    }

    /// The row in a line whose columns are known from the header of a file.
    ///
    /// # Errors
    /// If values are missing, too many, no numbers or out of range.
    pub fn parse_as(kind: RowKind, line: &str) -> Result<TextRow, TextError> {
        let mut from = Fields::new(line);
        let row = match kind {
            RowKind::Distance => TextRow::Distance(DistanceRow {
                dt_ms: from.milliseconds()?,
                left_cm: from.number()?,
                right_cm: from.number()?,
                reference_cm: from.number()?,
                mode: from.small()?,
                pwm: from.pwm()?,
            }),
            RowKind::Speed => TextRow::Speed(SpeedRow {
                dt_ms: from.milliseconds()?,
                wheel_rpm: from.wheels()?,
                reference_rpm: from.number()?,
                mode: from.small()?,
                pwm: from.pwm()?,
            }),
            RowKind::Waypoints => TextRow::Waypoints(WaypointsRow {
                dt_ms: from.milliseconds()?,
                wheel_rpm: from.wheels()?,
                reference_rpm: from.wheels()?,
                x_m: from.number()?,
                y_m: from.number()?,
                heading_deg: from.number()?,
                pwm: from.pwm()?,
            }),
            RowKind::Mission => TextRow::Mission(MissionRow {
                dt_ms: from.milliseconds()?,
                reference_rpm: from.wheels()?,
                heading_reference_deg: from.number()?,
                goal_x_m: from.number()?,
                goal_y_m: from.number()?,
                x_m: from.number()?,
                y_m: from.number()?,
                heading_deg: from.number()?,
                state: from.small()?,
                right_cm: from.number()?,
                left_cm: from.number()?,
                front_cm: from.number()?,
            }),
        };
        if from.rest.is_some() {
            Err(TextError::Extra)
        } else {
            Ok(row)
        }
    }
}

/// Reads columns separated by commas, in order.
struct Fields<'a> {
    rest: Option<&'a str>,
    /// Number of the value read last.
    at: u8,
}

impl<'a> Fields<'a> {
    fn new(line: &'a str) -> Self {
        Self {
            rest: Some(line),
            at: 0,
        }
    }

    fn number(&mut self) -> Result<f32, TextError> {
        let rest = self.rest.ok_or(TextError::Missing)?;
        let field = match rest.split_once(',') {
            Some((field, rest)) => {
                self.rest = Some(rest);
                field
            }
            None => {
                self.rest = None;
                rest
            }
        };
        self.at = self.at.saturating_add(1);
        decimal::parse(field.trim_ascii().as_bytes()).ok_or(TextError::NotANumber(self.at))
    }

    /// The number in the column after `skipped` others.
    fn nth_number(&mut self, skipped: u8) -> Result<f32, TextError> {
        for _ in 0..skipped {
            self.number()?;
        }
        self.number()
    }

    /// A number of `low..=high`, rounded to an integer.
    fn integer(&mut self, low: f32, high: f32) -> Result<i32, TextError> {
        let value = self.number()?;
        if (low..=high).contains(&value) {
            Ok(round(value))
        } else {
            Err(TextError::OutOfRange(self.at))
        }
    }

    /// Up to an hour: the original's longest silence is below a minute.
    fn milliseconds(&mut self) -> Result<u32, TextError> {
        Ok(self.integer(0.0, 3_600_000.0)?.cast_unsigned())
    }

    fn small(&mut self) -> Result<u8, TextError> {
        Ok(self.integer(0.0, 255.0)? as u8)
    }

    fn wheels(&mut self) -> Result<Wheels<f32>, TextError> {
        let right = self.number()?;
        let left = self.number()?;
        Ok(Wheels { left, right })
    }

    fn pwm(&mut self) -> Result<Wheels<i16>, TextError> {
        let right = self.integer(-255.0, 255.0)? as i16;
        let left = self.integer(-255.0, 255.0)? as i16;
        Ok(Wheels { left, right })
    }
}
