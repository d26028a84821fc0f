//! A replay's thread: plays it by the wall clock, and connects it with the pages.

use crate::board::SharedBoard;
use crate::session::Orders;
use rumbo_session::Replay;
use std::sync::Arc;
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

/// Time between two moves of the playhead.
const WAKE: Duration = Duration::from_millis(20);
/// The same while paused.
const WAKE_PAUSED: Duration = Duration::from_millis(250);
/// Longest time spent on the ghost at once: orders wait no longer.
const FOLLOW: Duration = Duration::from_millis(12);

/// Runs until the sender of orders is gone.
pub(crate) fn run(mut replay: Replay, board: &Arc<SharedBoard>, orders: &Orders) {
    let began = Instant::now();
    loop {
        for event in replay.take_events() {
            board.take(&event);
        }
        let wait = match replay.speed() > 0.0 || replay.follows() {
            true => WAKE,
            false => WAKE_PAUSED,
        };
        match orders.queue.recv_timeout(wait) {
            Ok(order) => replay.obey(&order),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        while let Ok(order) = orders.queue.try_recv() {
            replay.obey(&order);
        }
        let now = Instant::now();
        replay.wall_passed(u64::try_from((now - began).as_micros()).unwrap_or(u64::MAX));
        while replay.follows() && now.elapsed() < FOLLOW {
            replay.follow();
        }
        replay.update();
    }
}
