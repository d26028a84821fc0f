//! Readings as a log has them.

use crate::reading::{Names, Reading, ReadingSource};
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// Makes readings of messages; those in a row share their names.
#[derive(Default)]
pub(super) struct Readings {
    names: BTreeMap<ReadingSource, Names>,
}

#[derive(Deserialize)]
struct Printed {
    usart: u8,
    values: BTreeMap<String, Value>,
}

impl Readings {
    /// What the simulation shows: ground truth and pins, or terms of control loops.
    pub(super) fn shown(
        &mut self,
        t_ms: i64,
        source: ReadingSource,
        data: &[u8],
    ) -> serde_json::Result<Reading> {
        let values = serde_json::from_slice(data)?;
        Ok(self.reading(t_ms, source, values))
    }

    /// Numbers that a program printed.
    pub(super) fn printed(&mut self, t_ms: i64, data: &[u8]) -> serde_json::Result<Reading> {
        let Printed { usart, values } = serde_json::from_slice(data)?;
        Ok(self.reading(t_ms, ReadingSource::Usart(usart), values))
    }

    fn reading(
        &mut self,
        t_ms: i64,
        source: ReadingSource,
        values: BTreeMap<String, Value>,
    ) -> Reading {
        let signals = values.into_iter().filter_map(|(name, value)| {
            Some(match (value.as_f64(), name.strip_suffix("_clear")) {
                (Some(value), _) => (name, value),
                (None, Some(range)) => (range.to_owned(), f64::INFINITY),
                (None, None) => return None,
            })
        });
        let names = self.names.entry(source).or_default();
        names.reading(t_ms, source, signals.collect())
    }
}
