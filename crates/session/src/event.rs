//! The events a session publishes: each subscriber takes what it needs.

use crate::console::ConsoleText;
use rumbo_log::Entry;
use std::sync::Arc;

/// Something to show or to record.
#[derive(Clone, Debug)]
pub enum Event {
    /// A new run begins: what is shown of the one before is cleared, except its events.
    Run,
    /// Something that goes into a log.
    Entry(Arc<Entry>),
    /// Text from a robot; a log has its bytes.
    Console(ConsoleText),
    /// The next samples arrived at this time of the session \[ms\].
    Received(i64),
}

impl From<Entry> for Event {
    fn from(entry: Entry) -> Self {
        Self::Entry(Arc::new(entry))
    }
}
