//! What of a session goes into its log.

use super::Session;
use crate::pace::SLICE_US;
use crate::recorder::{Recorder, now_utc};
use rumbo_log::{Burst, Level, Manifest};

impl Session {
    /// Begins the log of a run; what was recorded before is complete.
    pub(super) fn record(&mut self) {
        let Some(recording) = &self.recording else {
            return;
        };
        let manifest = Manifest {
            version: env!("CARGO_PKG_VERSION").into(),
            baud: self.target.baud(),
            step_us: SLICE_US,
            started: Some(now_utc()),
            ..self.target.manifest()
        };
        match Recorder::in_folder(&recording.folder, &manifest) {
            Ok(recorder) => {
                let text = format!("recording to {}", recorder.path().display());
                self.board.record(recorder);
                self.note(Level::Info, text);
            }
            Err(error) => self.note(Level::Warning, format!("not recording: {error}")),
        }
    }

    /// Records the bytes at hand.
    pub(super) fn note_bytes(&self, to_robot: bool) {
        if !self.bytes.is_empty() {
            self.observer.link(Burst {
                t_us: self.target.now_us(),
                to_robot,
                bytes: self.bytes.clone(),
            });
        }
    }
}
