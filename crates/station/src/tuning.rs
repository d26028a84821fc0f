//! Tuning beside the session, which does not wait for it: a search in a thread of its own.
//!
//! There is one search at a time, of an hour at most; it ends when the page that asked for it is gone. What is searched
//! and how, a [`Tuner`] knows: the station knows no simulator.

use serde_json::Value;
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;
use tokio::sync::{Semaphore, oneshot, watch};
use tokio::time::timeout;

/// A search that was ended is gone within this time: it is asked before each run.
const LEAVES: Duration = Duration::from_secs(3);
/// Longest search.
const LONGEST: Duration = Duration::from_secs(3_600);

const BUSY: &str = "another page's search is running; it can be cancelled there";
const TOO_LONG: &str = "ended after an hour; ask for fewer runs";
const BROKEN: &str = "a fault of the program; please report it";

/// Why nothing was tuned, for a person.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct NotTuned(pub String);

/// What searches for parameters.
pub trait Tuner: fmt::Debug + Send + Sync {
    /// What a page can choose from.
    fn offers(&self) -> Value;

    /// What was found by a page's request, which is JSON. `progress` gets the share that is done; once `goes_on` denies,
    /// the search ends soon.
    ///
    /// # Errors
    /// The request is wrong, or the search ended before it was done.
    fn tune(
        &self,
        request: &str,
        progress: &(dyn Fn(f64) + Sync),
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Value, NotTuned>;
}

/// The tuner of a lab, which searches for one page at a time.
#[derive(Debug)]
pub(crate) struct Tuning {
    tuner: Arc<dyn Tuner>,
    free: Arc<Semaphore>,
}

/// A search; it ends soon after this is dropped.
pub(crate) struct Search {
    share: watch::Receiver<f64>,
    found: oneshot::Receiver<Result<Value, NotTuned>>,
    ended: Arc<AtomicBool>,
}

impl Tuning {
    pub(crate) fn new(tuner: Box<dyn Tuner>) -> Self {
        Self {
            tuner: tuner.into(),
            free: Arc::new(Semaphore::new(1)),
        }
    }

    /// What there is to choose from.
    pub(crate) fn offers(&self) -> Value {
        self.tuner.offers()
    }

    /// Begins a search by this request, unless another is running.
    pub(crate) async fn begin(&self, request: String) -> Result<Search, NotTuned> {
        let place = timeout(LEAVES, Arc::clone(&self.free).acquire_owned()).await;
        let Ok(Ok(place)) = place else {
            return Err(NotTuned(BUSY.into()));
        };
        let ended = Arc::new(AtomicBool::new(false));
        let (share_done, share) = watch::channel(0.0);
        let (done, found) = oneshot::channel();
        let (tuner, is_ended, begun) =
            (Arc::clone(&self.tuner), Arc::clone(&ended), Instant::now());
        let work = move || {
            // Until the search has left its threads.
            let _place = place;
            let is_late = || begun.elapsed() > LONGEST;
            let goes_on = || !is_ended.load(Ordering::Relaxed) && !is_late();
            let progress = |part| {
                share_done.send_replace(part);
            };
            let found = tuner.tune(&request, &progress, &goes_on);
            let found = found.map_err(|why| match is_late() {
                true => NotTuned(TOO_LONG.into()),
                false => why,
            });
            // The page may be gone.
            let _ = done.send(found);
        };
        let thread = std::thread::Builder::new().name("tuning".into());
        match thread.spawn(work) {
            Ok(_) => Ok(Search {
                share,
                found,
                ended,
            }),
            Err(error) => Err(NotTuned(error.to_string())),
        }
    }
}

impl Search {
    /// The share that is done.
    pub(crate) fn share(&self) -> f64 {
        *self.share.borrow()
    }

    /// Returns what was found.
    pub(crate) async fn found(&mut self) -> Result<Value, NotTuned> {
        let found = (&mut self.found).await;
        found.unwrap_or_else(|_| Err(NotTuned(BROKEN.into())))
    }
}

impl Drop for Search {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}
