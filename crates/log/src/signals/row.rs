//! A sample as it is shown and recorded: one number per signal, small enough to keep an hour of them.

use super::{SIGNALS, Sample};
use crate::scene::{MapPose, Truth};
use serde::Serialize;

/// One value of a row as the page gets it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum RowValue {
    /// Its value.
    Number(f64),
    /// A range in which there is nothing: no gap in the measurement, but no number either.
    Word(&'static str),
    /// Not known (null).
    Unknown(Option<()>),
}

impl RowValue {
    /// Of a value that is not a number where unknown, infinite where a range is clear.
    pub(crate) fn of(value: f64) -> Self {
        match value {
            value if value.is_finite() => Self::Number(value),
            value if value.is_nan() => Self::Unknown(None),
            _ => Self::Word("clear"),
        }
    }
}

/// The signals at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Session time \[ms\].
    pub t_ms: i64,
    /// In the order of [`Row::names`]: not a number where unknown, infinite where a range is clear. The first is for
    /// `t_ms`.
    values: [f32; SIGNALS.len()],
}

impl Row {
    /// A row in which nothing is known yet.
    #[must_use]
    pub fn unknown(t_ms: i64) -> Self {
        Self {
            t_ms,
            values: [f32::NAN; SIGNALS.len()],
        }
    }

    pub(crate) fn new(t_ms: i64, values: [f32; SIGNALS.len()]) -> Self {
        Self { t_ms, values }
    }

    /// The names of the signals, units last; the first is the time.
    pub fn names() -> impl Iterator<Item = &'static str> {
        SIGNALS.iter().map(|signal| signal.name)
    }

    /// The names of the measured ranges, which may be clear.
    pub fn ranges() -> impl Iterator<Item = &'static str> {
        Self::names().filter(|name| name.starts_with("range_"))
    }

    /// The column of a signal.
    #[must_use]
    pub fn column(name: &str) -> Option<usize> {
        SIGNALS.iter().position(|signal| signal.name == name)
    }

    /// A signal by its column: `None` where unknown, infinite where a range is clear.
    #[must_use]
    pub fn get(&self, column: usize) -> Option<f64> {
        match column {
            0 => Some(self.t_ms as f64 / 1e3),
            _ => self
                .values
                .get(column)
                .filter(|value| !value.is_nan())
                .map(|value| tidy(*value)),
        }
    }

    /// A signal by its name.
    #[must_use]
    pub fn signal(&self, name: &str) -> Option<f64> {
        self.get(Self::column(name)?)
    }

    /// Sets a signal; a name that is none is not kept.
    pub fn set(&mut self, name: &str, value: f64) {
        if let Some(column) = Self::column(name) {
            self.values[column] = value as f32;
        }
    }

    /// A pose among the signals: the robot's own estimate (`""`), or the one of this prefix (`origin_`, `true_`,
    /// `ghost_`).
    #[must_use]
    pub fn pose(&self, whose: &str) -> Option<MapPose> {
        let part = |name: &str| self.signal(&format!("{whose}{name}"));
        Some(MapPose {
            x_m: part("x_m")?,
            y_m: part("y_m")?,
            heading_rad: part("heading_rad")?,
        })
    }

    /// Sets a pose; what is not a number is not known.
    pub fn set_pose(&mut self, whose: &str, pose: MapPose) {
        let parts = [
            ("x_m", pose.x_m),
            ("y_m", pose.y_m),
            ("heading_rad", pose.heading_rad),
        ];
        for (name, value) in parts {
            self.set(&format!("{whose}{name}"), value);
        }
    }

    /// Sets the ghost's signals; `None`: they are not known.
    pub fn set_ghost(&mut self, truth: Option<&Truth>) {
        let sample = Sample {
            ghost: truth.copied(),
            ..Sample::empty()
        };
        for (value, signal) in self.values.iter_mut().zip(SIGNALS) {
            if signal.name.starts_with("ghost_") {
                *value = (signal.value)(&sample);
            }
        }
    }

    /// Nothing is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let mut signals = self.values.iter().skip(1);
        signals.all(|value| value.is_nan())
    }

    /// As the page gets it.
    #[must_use]
    pub fn cells(&self) -> Vec<RowValue> {
        (0..SIGNALS.len())
            .map(|column| RowValue::of(self.get(column).unwrap_or(f64::NAN)))
            .collect()
    }
}

/// Four decimals: a tenth of a millimetre, less than any signal's own step.
pub(crate) fn tidy(value: f32) -> f64 {
    if value.is_finite() {
        (f64::from(value) * 1e4).round() / 1e4
    } else {
        value.into()
    }
}
