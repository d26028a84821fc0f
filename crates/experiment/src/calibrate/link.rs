//! The calibration's end of the link.

use std::cell::RefCell;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::Poll;

/// The calibration's end of the link, shared with its [`Calibrator`](super::Calibrator).
#[derive(Clone, Debug, Default)]
pub(super) struct Link(Rc<RefCell<Ends>>);

#[derive(Debug, Default)]
struct Ends {
    now_us: u64,
    due_us: u64,
    received: Vec<u8>,
    to_robot: Vec<u8>,
}

impl Link {
    /// Time on this side of the link [us].
    pub(super) fn now_us(&self) -> u64 {
        self.0.borrow().now_us
    }

    /// Sends bytes to the robot.
    pub(super) fn send(&self, bytes: &[u8]) {
        self.0.borrow_mut().to_robot.extend_from_slice(bytes);
    }

    /// Appends the bytes that have arrived from the robot.
    pub(super) fn receive(&self, into: &mut Vec<u8>) {
        into.append(&mut self.0.borrow_mut().received);
    }

    /// Waits until this instant [us].
    pub(super) async fn wait_until(&self, us: u64) {
        self.0.borrow_mut().due_us = us;
        poll_fn(|_| match self.now_us() >= us {
            true => Poll::Ready(()),
            false => Poll::Pending,
        })
        .await;
    }

    /// It is this instant \[us\], and these bytes have arrived from the robot.
    pub(super) fn arrive(&self, now_us: u64, received: &[u8]) {
        let mut ends = self.0.borrow_mut();
        ends.now_us = now_us;
        ends.received.extend_from_slice(received);
    }

    /// Appends the bytes to send.
    pub(super) fn take(&self, to_robot: &mut Vec<u8>) {
        to_robot.append(&mut self.0.borrow_mut().to_robot);
    }

    /// When its procedure goes on \[us\].
    pub(super) fn due_us(&self) -> u64 {
        self.0.borrow().due_us
    }
}
