//! What a session gives out, once: each subscriber takes what it needs.

use crate::console::ConsoleText;
use rumbo_log::Entry;
use std::sync::Arc;

/// Something to show or to record.
#[derive(Clone, Debug)]
pub enum Event {
    /// A new run begins: what is shown of the one before is over, but for its events.
    Run,
    /// Something that goes into a log.
    Entry(Arc<Entry>),
    /// What a robot said in text; a log has its bytes.
    Console(ConsoleText),
    /// The samples that come next arrived at this time of the session \[ms\].
    Heard(i64),
}

impl From<Entry> for Event {
    fn from(entry: Entry) -> Self {
        Self::Entry(Arc::new(entry))
    }
}
