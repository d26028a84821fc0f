//! The subscribers of a session: pages, the log, the terminal. Each gets every event and uses what it needs.

use crate::board::SharedBoard;
use crate::echo::Echo;
use crate::log_file::Problem;
use crate::recorder::Recorder;
use rumbo_log::Entry;
use rumbo_session::Event;
use std::sync::Arc;

/// The subscribers of one session.
pub(crate) struct Subscribers {
    pub(crate) board: Arc<SharedBoard>,
    /// Prints warnings and faults on the terminal too.
    pub(crate) echo: Option<Echo>,
    pub(crate) recorder: Option<Recorder>,
}

impl Subscribers {
    /// Passes an event on to all.
    pub(crate) fn publish(&mut self, event: Event) {
        self.board.take(&event);
        let Event::Entry(entry) = event else {
            return;
        };
        if let (Some(echo), Entry::Event(event)) = (&self.echo, &*entry) {
            echo.event(event);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.record(entry);
        }
    }

    /// Records everything from now on; the log before is complete.
    pub(crate) fn record(&mut self, recorder: Recorder) {
        self.recorder = Some(recorder);
    }

    /// What has gone wrong with the recording since the last call.
    pub(crate) fn recording_trouble(&self) -> Option<Problem> {
        self.recorder.as_ref().and_then(Recorder::trouble)
    }
}
