//! The events a session publishes: each subscriber takes what it needs.

use crate::console::ConsoleText;
use crate::program::ShownSketch;
use crate::world::EditedWorld;
use rumbo_log::Entry;
use rumbo_wire::Command;
use serde_json::Value;
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
    /// Commands that the operator gave together, at this time of the target \[us\]; an end of a movement held by a key is
    /// one too.
    Commanded(u64, Vec<Command>),
    /// What a page asked of a world that it edits.
    World(EditedWorld),
    /// The source of a program that a page asked for.
    Sketch(ShownSketch),
    /// What the debugger of the program says, in the Debug Adapter Protocol.
    Debug(Value),
    /// The next samples arrived at this time of the session \[ms\].
    Received(i64),
}

impl From<Entry> for Event {
    fn from(entry: Entry) -> Self {
        Self::Entry(Arc::new(entry))
    }
}
