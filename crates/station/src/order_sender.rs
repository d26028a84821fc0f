//! The way of orders to the session, from pages and from other clients.

use crate::session::Orders;
use rumbo_session::Order;
use rumbo_wire::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};

/// Orders that may wait for the session, which takes them every few milliseconds.
const WAITING: usize = 256;
/// What is said of an order that finds the queue full.
pub(crate) const TOO_MANY: &str = "too many orders at once";

/// The sending side. The session ends when it is gone.
#[derive(Debug)]
pub(crate) struct OrderSender {
    queue: SyncSender<Order>,
    /// Orders passed on.
    sent: Mutex<u64>,
    /// Those of all robots in the world: STOP stops each.
    stops: Vec<Arc<AtomicBool>>,
}

/// The queue is full, or the session is over.
#[derive(Debug)]
pub(crate) struct NotTaken;

impl OrderSender {
    /// Both sides, for so many robots in one world.
    pub(crate) fn of(robots: usize) -> Vec<(Self, Orders)> {
        let stops: Vec<Arc<AtomicBool>> = (0..robots).map(|_| Arc::default()).collect();
        let sides = stops.iter().map(|stop| {
            let (sender, queue) = sync_channel(WAITING);
            let orders = Orders {
                queue,
                stop: Arc::clone(stop),
            };
            let sender = Self {
                queue: sender,
                sent: Mutex::default(),
                stops: stops.clone(),
            };
            (sender, orders)
        });
        sides.collect()
    }

    /// Passes an order on, without waiting. STOP has its own flags, also those of the other robots in the world: a full
    /// queue does not keep it out, and wakes the session anyway. Returns the order's number, from 1 on.
    pub(crate) fn send(&self, order: Order) -> Result<u64, NotTaken> {
        if order == Order::Robot(Command::Stop) {
            for stop in &self.stops {
                stop.store(true, Ordering::SeqCst);
            }
        }
        let mut sent = self.sent.lock().unwrap_or_else(PoisonError::into_inner);
        self.queue.try_send(order).map_err(|_| NotTaken)?;
        *sent += 1;
        Ok(*sent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stop_for_one_is_set_for_all_even_behind_a_full_queue() {
        let sides = OrderSender::of(3);
        let is_set =
            |(_, orders): &(OrderSender, Orders)| orders.stop.swap(false, Ordering::SeqCst);
        let (second, _) = &sides[1];
        let arm = || Order::Robot(Command::Arm);
        while second.send(arm()).is_ok() {}
        assert_eq!(sides.iter().filter(|side| is_set(side)).count(), 0);
        for (sender, _) in &sides {
            // What finds no room in the queue is there all the same.
            let _ = sender.send(Order::Robot(Command::Stop));
            assert_eq!(sides.iter().filter(|side| is_set(side)).count(), 3);
        }
        // Other orders are that robot's alone.
        let waiting = sides.iter().map(|(_, orders)| orders.queue.try_iter());
        let arms = waiting.map(|orders| orders.filter(|order| *order == arm()).count());
        assert_eq!(arms.collect::<Vec<_>>(), [0, WAITING, 0]);
    }
}
