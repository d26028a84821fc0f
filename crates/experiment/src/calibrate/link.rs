//! A robot behind a link, and its time: all that a calibration needs.

use rumbo_sim::Sim;

/// A robot that receives and sends bytes as time passes: a simulated one, or one on a serial port.
pub trait Linked {
    /// Time on this side of the link [us].
    fn now_us(&self) -> u64;
    /// Sends bytes to the robot.
    fn send(&mut self, bytes: &[u8]);
    /// Appends the bytes that have arrived from the robot.
    fn receive(&mut self, into: &mut Vec<u8>);
    /// Waits, or simulates, until this instant [us].
    fn wait_until(&mut self, us: u64);
}

impl Linked for Sim {
    fn now_us(&self) -> u64 {
        Sim::now_us(self)
    }

    fn send(&mut self, bytes: &[u8]) {
        Sim::send(self, bytes);
    }

    fn receive(&mut self, into: &mut Vec<u8>) {
        Sim::receive(self, into);
    }

    fn wait_until(&mut self, us: u64) {
        self.advance(us);
    }
}
