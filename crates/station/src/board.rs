//! The session's board, shared with the pages: the session writes, each page's connection reads on from where it was.

use rumbo_session::{Cursor, Event, News};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};
use tokio::sync::watch;

/// What is to be shown.
#[derive(Debug, Default)]
pub(crate) struct Board {
    board: Mutex<rumbo_session::Board>,
    changed: watch::Sender<()>,
}

impl Board {
    /// A poisoned lock holds whole values all the same: each is written in one move.
    fn lock(&self) -> MutexGuard<'_, rumbo_session::Board> {
        self.board.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Wakes its holder when something new is on the board.
    pub(crate) fn subscribe(&self) -> watch::Receiver<()> {
        self.changed.subscribe()
    }

    /// Takes an event.
    pub(crate) fn take(&self, event: &Event) {
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let wall_ms = since.map_or(0.0, |since| since.as_secs_f64() * 1e3);
        if self.lock().take(event, wall_ms) {
            self.changed.send_replace(());
        }
    }

    /// What is new since `cursor`, which moves on.
    pub(crate) fn news(&self, cursor: &mut Cursor) -> News {
        self.lock().news(cursor)
    }
}
