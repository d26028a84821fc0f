//! The little that a test program needs around the CPU: a timer that counts cycles, and a line out.

use rumbo_emulator::io::{Access, Io, Stored};

pub(crate) const TCNT1L: u16 = 0x84;
pub(crate) const TCNT1H: u16 = 0x85;
pub(crate) const UCSR0A: u16 = 0xC0;
pub(crate) const UDR0: u16 = 0xC6;
const GPIOR0: u16 = 0x3E;

/// The peripherals of the test bench.
#[derive(Default)]
pub(crate) struct Bench {
    pub(crate) sent: Vec<u8>,
    gpior0: u8,
    timer_start: u64,
    timer_high: u8,
    /// An access to anything else.
    pub(crate) strange: Option<u16>,
}

impl Io for Bench {
    fn read(&mut self, address: u16, at: Access) -> u8 {
        match address {
            GPIOR0 => self.gpior0,
            UCSR0A => 0x20,
            TCNT1L => {
                let count = at.cycle.wrapping_sub(self.timer_start) as u16;
                self.timer_high = (count >> 8) as u8;
                count as u8
            }
            TCNT1H => self.timer_high,
            _ => {
                self.strange.get_or_insert(address);
                0
            }
        }
    }

    fn write(&mut self, address: u16, value: u8, at: Access) {
        match address {
            GPIOR0 => self.gpior0 = value,
            UDR0 => self.sent.push(value),
            TCNT1L => self.timer_start = at.cycle,
            // The timer's and the line's set-up: they run as they should already.
            TCNT1H | 0x53 | 0x80 | 0x81 | 0xC0..=0xC5 => {}
            _ => {
                self.strange.get_or_insert(address);
            }
        }
    }

    fn write_bit(&mut self, address: u16, mask: u8, set: bool, at: Access) {
        let before = self.read(address, at);
        self.write(
            address,
            if set { before | mask } else { before & !mask },
            at,
        );
    }

    fn advance(&mut self, _: u64) {}

    fn deadline(&self, _: bool) -> u64 {
        u64::MAX
    }

    fn pending(&self) -> Option<u8> {
        None
    }

    fn acknowledge(&mut self, _: u8, _: u64) {}

    fn vector_base(&self) -> u32 {
        0
    }

    fn sleep(&mut self, _: u64) -> bool {
        false
    }

    fn reset_watchdog(&mut self, _: u64) {}

    fn store_program(&mut self, _: u32, _: u16, _: Access) -> Stored {
        Stored::Nothing
    }
}
