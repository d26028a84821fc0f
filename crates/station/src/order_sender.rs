//! The way of orders to the session, from pages and from other clients.

use crate::session::Orders;
use rumbo_session::Order;
use rumbo_wire::Command;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};

/// Orders that may wait for the session, which takes them every few milliseconds.
const WAITING: usize = 256;
/// What is said of an order that finds the queue full.
pub(crate) const TOO_MANY: &str = "too many orders at once";

/// The sending side. The session ends when it is gone.
#[derive(Debug)]
pub(crate) struct OrderSender {
    queue: SyncSender<Order>,
    stop: Arc<AtomicBool>,
}

/// The queue is full, or the session is over.
#[derive(Debug)]
pub(crate) struct NotTaken;

impl OrderSender {
    /// Both sides.
    pub(crate) fn new() -> (Self, Orders) {
        let (sender, queue) = sync_channel(WAITING);
        let stop = Arc::<AtomicBool>::default();
        let orders = Orders {
            queue,
            stop: Arc::clone(&stop),
        };
        (
            Self {
                queue: sender,
                stop,
            },
            orders,
        )
    }

    /// Passes an order on, without waiting. STOP has its own flag: a full queue does not keep it out, and wakes the
    /// session anyway.
    pub(crate) fn send(&self, order: Order) -> Result<(), NotTaken> {
        if order == Order::Robot(Command::Stop) {
            self.stop.store(true, Ordering::SeqCst);
        }
        self.queue.try_send(order).map_err(|_| NotTaken)
    }
}
