//! Who listens to a session: pages, the log, the terminal, a bridge. Each gets every event and takes what it needs.

use crate::board::Board;
use crate::echo::Echo;
use crate::log_file::Problem;
use crate::recorder::Recorder;
use rumbo_log::Entry;
use rumbo_session::Event;
use std::sync::Arc;

/// The subscribers of one session.
pub(crate) struct Subscribers {
    pub(crate) board: Arc<Board>,
    /// Shows what goes wrong on the terminal too.
    pub(crate) echo: Option<Echo>,
    /// Shows the same to viewers of another protocol.
    #[cfg(feature = "foxglove")]
    pub(crate) bridge: Option<crate::bridge::Bridge>,
    pub(crate) recorder: Option<Recorder>,
}

impl Subscribers {
    /// Passes an event on to all.
    pub(crate) fn take(&mut self, event: Event) {
        self.board.take(&event);
        let Event::Entry(entry) = event else {
            return;
        };
        if let (Some(echo), Entry::Event(event)) = (&self.echo, &*entry) {
            echo.event(event);
        }
        #[cfg(feature = "foxglove")]
        if let Some(bridge) = &self.bridge {
            bridge.take(&entry);
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.take(entry);
        }
    }

    /// From now on everything is recorded here. What was recorded before is complete.
    pub(crate) fn record(&mut self, recorder: Recorder) {
        self.recorder = Some(recorder);
    }

    /// What has gone wrong with the recording since it was last asked.
    pub(crate) fn recording_trouble(&self) -> Option<Problem> {
        self.recorder.as_ref().and_then(Recorder::trouble)
    }
}
