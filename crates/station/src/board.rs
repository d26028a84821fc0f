//! The session's board, shared with the pages: the session writes, each page's connection reads on from where it was.

use rumbo_log::Entry;
use rumbo_session::explain::{Cause, explain_news};
use rumbo_session::{Cursor, Event, News};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};
use tokio::sync::watch;

/// What is to be shown.
#[derive(Debug, Default)]
pub(crate) struct SharedBoard {
    board: Mutex<Shown>,
    /// Orders that the session has taken.
    taken: AtomicU64,
    changed: watch::Sender<()>,
}

#[derive(Debug, Default)]
struct Shown {
    board: rumbo_session::Board,
    /// Orders that it had taken when it published the state.
    taken: u64,
}

impl SharedBoard {
    /// A poisoned lock holds whole values all the same: each is written in one move.
    fn lock(&self) -> MutexGuard<'_, Shown> {
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
        let mut shown = self.lock();
        if matches!(event, Event::Entry(entry) if matches!(**entry, Entry::State(_))) {
            shown.taken = self.taken.load(Ordering::Relaxed);
        }
        if shown.board.take(event, wall_ms) {
            self.changed.send_replace(());
        }
    }

    /// The session, which calls this, has taken so many orders more.
    pub(crate) fn took(&self, orders: usize) {
        self.taken.fetch_add(orders as u64, Ordering::Relaxed);
    }

    /// What explains a stretch \[s\] of what pages see. The session does not wait for it.
    pub(crate) fn explain(&self, from_s: f64, to_s: f64) -> Vec<Cause> {
        let news = self.lock().board.news(&mut Cursor::default());
        explain_news(&news, from_s, to_s)
    }

    /// What is new since `cursor`, which moves on; orders that had been taken when the state was so.
    pub(crate) fn news(&self, cursor: &mut Cursor) -> (News, u64) {
        let shown = self.lock();
        (shown.board.news(cursor), shown.taken)
    }
}
