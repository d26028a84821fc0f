//! Synchronous modes and master of SPI: a bit goes with each period of the clock on XCK (2549Q, sections 22.3.4 and 23).
//!
//! The clock has two steps to a bit. At the first the transmitter puts out its bit, at the second the receiver takes one:
//!
//! | mode | steps are | XCK between the first and the second, and between the second and the next first |
//! |---|---|---|
//! | synchronous, XCK an output | the generator's, as long as transmitter or receiver is on | high, low; UCPOL: low, high |
//! | synchronous, XCK an input | the pin's edges | rising begins a bit; UCPOL: falling |
//! | master of SPI, UCPHA = 0 | the generator's, while a byte goes out | idle, active |
//! | master of SPI, UCPHA = 1 | the same | active, idle |
//!
//! Idle is low, or high with UCPOL. As a master of SPI a byte comes in for each that goes out.

use super::format::Mode;
use super::transmitter::Step;
use super::{CLOCK_HZ, Event, RXEN, TXEN, Usart};
use crate::devices::Core;

/// Of UCSRC.
const UCPOL: u8 = 0x01;
const UCPHA: u8 = 0x02;

/// Where the clock of XCK stands.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Clocked {
    /// Steps up to this cycle are taken.
    taken: u64,
    /// The last one was the first of a bit.
    first: bool,
    /// The cycle in which the last bit began, and how long the one before was.
    began: u64,
    bit: u64,
}

impl Clocked {
    /// Nothing before this cycle counts.
    pub(super) fn set_time(&mut self, cycle: u64) {
        self.taken = self.taken.max(cycle);
    }

    /// The clock stood for some cycles.
    pub(super) fn delay(&mut self, cycles: u64) {
        self.taken += cycles;
        self.began += cycles;
    }
}

impl Usart {
    /// It runs by the clock on XCK, its own or another's.
    pub(super) fn is_clocked(&self) -> bool {
        self.format.mode != Mode::Asynchronous
    }

    /// The clock is its own: XCK is an output.
    fn is_master(&self, core: &Core) -> bool {
        core.ports.is_output(self.place.clock)
    }

    /// The cycle of the next step of its own clock, if that runs.
    pub(super) fn next_clock(&self, core: &Core) -> Option<u64> {
        if !self.is_clocked() || !self.is_master(core) {
            return None;
        }
        let next = self.rate.next_tick(self.clocked.taken + 1);
        if self.format.mode == Mode::Synchronous {
            return (self.control_b & (RXEN | TXEN) != 0 || self.transmitter.is_busy())
                .then_some(next);
        }
        self.transmitter
            .waits_until()
            .map(|start| next.max(start))
            .or_else(|| self.transmitter.is_busy().then_some(next))
    }

    /// Takes the steps of its own clock up to a cycle.
    pub(super) fn run_clock(&mut self, core: &mut Core, cycle: u64) {
        while let Some(at) = self.next_clock(core)
            && at <= cycle
        {
            self.clocked.taken = at;
            let first = self.rate.begins_bit(at);
            if first {
                self.begin_bit(core, at);
            } else {
                self.clock_bit(core);
            }
            self.clocked.first = first;
            self.drive_pins(core, at);
        }
    }

    /// XCK, driven from outside, has an edge.
    pub(super) fn clock_edge(&mut self, core: &mut Core, high: bool, cycle: u64) {
        if self.format.mode == Mode::Asynchronous || self.is_master(core) {
            return;
        }
        let inverted = self.control_c & UCPOL != 0;
        let leading = high != inverted;
        let first = match self.format.mode {
            Mode::SpiMaster => leading == (self.control_c & UCPHA != 0),
            _ => leading,
        };
        if first {
            self.begin_bit(core, cycle);
        } else {
            self.clock_bit(core);
        }
        self.drive_pins(core, cycle);
        self.request(core);
        self.reschedule(core);
    }

    /// The first step of a bit: the frame before it may be over, and what follows begins.
    fn begin_bit(&mut self, core: &mut Core, cycle: u64) {
        // Before a clock that is coming up runs, an edge from outside may be there already.
        self.clocked.bit = cycle.saturating_sub(self.clocked.began);
        self.clocked.began = cycle;
        if let Some(Step::Sent(byte)) = self.transmitter.shift(self.format, cycle) {
            let bit = if self.is_master(core) {
                self.rate.bit()
            } else {
                self.clocked.bit.max(1)
            };
            let event = Event::Byte {
                usart: self.place.number as u8,
                byte,
                baud: CLOCK_HZ as f64 / (bit * core.clock.divisor()) as f64,
            };
            core.emit(cycle, event);
        }
    }

    /// The second step: the receiver samples its pin.
    fn clock_bit(&mut self, core: &Core) {
        if !self.listens() {
            return;
        }
        if self.format.mode == Mode::SpiMaster {
            let level = core.ports.level(self.place.receive);
            self.receiver.clock_bare_bit(level, self.format);
        } else {
            let accept = self.acceptor();
            self.receiver
                .clock_bit(self.line_level(core), self.format, accept);
        }
    }

    /// The USART's level on XCK where that is an output; `None` where the port drives it.
    pub(super) fn clock_level(&self) -> Option<bool> {
        let on = self.control_b & (RXEN | TXEN) != 0 || self.transmitter.is_busy();
        if !on || !self.is_clocked() {
            return None;
        }
        let inverted = self.control_c & UCPOL != 0;
        let active = match self.format.mode {
            Mode::SpiMaster => {
                let shifts = self.transmitter.is_busy() && self.transmitter.waits_until().is_none();
                shifts && self.clocked.first == (self.control_c & UCPHA != 0)
            }
            _ => self.clocked.first,
        };
        Some(active != inverted)
    }
}
