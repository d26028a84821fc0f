//! Readings: signals beside the robot's telemetry, each with its name. Ground truth and pins of an emulated robot, which
//! there are whatever its program is; the terms of our simulated robot's control loops; the numbers that a program prints.

use crate::signals::{RowValue, tidy};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// Where a reading comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ReadingSource {
    /// The simulation: ground truth and pins.
    Truth,
    /// The control loops of our simulated robot: their terms.
    Loops,
    /// The simulation: where the other robots in the world are.
    Others,
    /// What the program printed to this USART.
    Usart(u8),
}

/// The values of some signals at one instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Session time \[ms\].
    pub t_ms: i64,
    /// Where it comes from.
    pub source: ReadingSource,
    /// The signals, shared by readings that have the same ones.
    pub names: Arc<[String]>,
    /// Their values, in the same order: not a number where unknown, infinite where a range is clear.
    pub values: Vec<f32>,
}

/// Names shared by readings in a row.
#[derive(Clone, Debug, Default)]
pub struct Names(Option<Arc<[String]>>);

impl Names {
    /// The same names as last time, or these from now on.
    pub fn share(&mut self, names: Vec<String>) -> Arc<[String]> {
        match &self.0 {
            Some(known) if **known == *names => Arc::clone(known),
            _ => Arc::clone(self.0.insert(names.into())),
        }
    }

    /// A reading of these signals.
    pub fn reading(
        &mut self,
        t_ms: i64,
        source: ReadingSource,
        signals: Vec<(String, f64)>,
    ) -> Reading {
        let (names, values): (Vec<_>, Vec<_>) = signals.into_iter().unzip();
        Reading {
            t_ms,
            source,
            names: self.share(names),
            values: values.into_iter().map(|value| value as f32).collect(),
        }
    }
}

impl Reading {
    /// A signal by its name, if it is known.
    #[must_use]
    pub fn signal(&self, name: &str) -> Option<f64> {
        let at = self.names.iter().position(|each| each == name)?;
        let value = *self.values.get(at)?;
        (!value.is_nan()).then(|| self.value(value))
    }

    /// The values as the page gets them.
    #[must_use]
    pub fn cells(&self) -> Vec<RowValue> {
        let values = self.values.iter().map(|value| self.value(*value));
        values.map(RowValue::of).collect()
    }

    /// What a program printed keeps all its digits.
    fn value(&self, value: f32) -> f64 {
        match self.source {
            ReadingSource::Truth | ReadingSource::Loops | ReadingSource::Others => tidy(value),
            // The shortest digits that give the same `f32`.
            ReadingSource::Usart(_) => value.to_string().parse().unwrap_or(f64::NAN),
        }
    }

    /// The signals as a message has them: unknown ones are left out, a clear range has a field of its own.
    pub(crate) fn json(&self) -> Value {
        let mut message = Map::new();
        for (name, value) in self.names.iter().zip(&self.values) {
            match self.value(*value) {
                value if value.is_finite() => drop(message.insert(name.clone(), json!(value))),
                value if value.is_nan() => {}
                _ => drop(message.insert(format!("{name}_clear"), json!(true))),
            }
        }
        match self.source {
            ReadingSource::Truth | ReadingSource::Loops | ReadingSource::Others => {
                Value::Object(message)
            }
            ReadingSource::Usart(usart) => json!({ "usart": usart, "values": message }),
        }
    }
}
