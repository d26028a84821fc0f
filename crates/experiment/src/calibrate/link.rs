//! A robot behind a link, in time: all that a calibration needs to know of whom it calibrates.

use rumbo_sim::Sim;

/// A robot that hears and sends bytes while time goes by: a simulated one, or one on a serial port.
pub trait Linked {
    /// Time on this side of the link [us].
    fn now_us(&self) -> u64;
    /// Puts bytes for the robot on the line.
    fn send(&mut self, bytes: &[u8]);
    /// Appends the bytes that have arrived from the robot.
    fn receive(&mut self, into: &mut Vec<u8>);
    /// Lets time go by until this instant [us].
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
