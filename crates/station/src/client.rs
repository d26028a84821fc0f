//! A program beside the pages, such as a node of ROS 2: it reads the same board and gives orders by the same rules.

use crate::board::Board;
use crate::lease::{Lease, Place};
use crate::order_sender::{OrderSender, TOO_MANY};
use rumbo_session::{Cursor, News, Order, View};
use std::sync::{Arc, Weak};

/// A client of a session. It does not keep the session going; dropping it releases control, if it had it.
#[derive(Debug)]
pub struct Client {
    board: Arc<Board>,
    cursor: Cursor,
    orders: Weak<OrderSender>,
    place: Place,
}

impl Client {
    /// One that may have control; `None`: too many are there.
    pub(crate) fn join(
        board: &Arc<Board>,
        orders: &Arc<OrderSender>,
        lease: &Lease,
    ) -> Option<Self> {
        Some(Self {
            board: Arc::clone(board),
            cursor: Cursor::default(),
            orders: Arc::downgrade(orders),
            place: lease.join(true)?,
        })
    }

    /// What is new since the last call; `None` when the session is over.
    pub fn news(&mut self) -> Option<News> {
        let news = self.board.news(&mut self.cursor);
        (self.orders.strong_count() > 0).then_some(news)
    }

    /// Gives an order, as a page does: STOP always, anything else if it has control or no other client has.
    ///
    /// # Errors
    /// Why it was not passed on, for a person.
    pub fn order(&self, order: Order) -> Result<(), &'static str> {
        self.place.admit(&order)?;
        let orders = self.orders.upgrade();
        let orders = orders.ok_or("refused: the session is over")?;
        orders.send(order).map_err(|_| TOO_MANY)
    }

    /// Its relation to control.
    #[must_use]
    pub fn view(&self) -> View {
        self.place.view()
    }
}
