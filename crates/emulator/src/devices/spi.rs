//! The serial peripheral interface with nothing connected (DS40002549, section 21).
//!
//! As master a transfer takes eight periods of its clock and reads the level of MISO; as slave nothing clocks it. Its edges on SCK and
//! MOSI are not made: the pins rest at the clock's idle level and at the last bit.

use super::Core;
use super::interrupts::vector;
use super::ports::{Force, Pin};
use super::schedule::Source;

const SPCR: u16 = 0x4C;
const SPSR: u16 = 0x4D;
const SPDR: u16 = 0x4E;

const SPIE: u8 = 0x80;
const SPE: u8 = 0x40;
const DORD: u8 = 0x20;
const MSTR: u8 = 0x10;
const CPOL: u8 = 0x08;
const SPIF: u8 = 0x80;
const WCOL: u8 = 0x40;
const SPI2X: u8 = 0x01;

const PORT_B: usize = 1;
pub(super) const SELECT: Pin = Pin::at(PORT_B, 0);
const CLOCK: Pin = Pin::at(PORT_B, 1);
const OUT: Pin = Pin::at(PORT_B, 2);
const IN: Pin = Pin::at(PORT_B, 3);

/// The interface.
#[derive(Clone, Debug, Default)]
pub(super) struct Spi {
    control: u8,
    /// SPI2X.
    double: u8,
    flags: u8,
    /// Flags that were up when SPSR was read: an access to SPDR clears them.
    seen: u8,
    received: u8,
    sent: u8,
    /// When the byte that goes out is through.
    transfer: Option<u64>,
    /// The cycle in which it lost its clock.
    stopped: Option<u64>,
}

impl Spi {
    pub(super) fn read(&mut self, core: &mut Core, address: u16) -> u8 {
        match address {
            SPCR => self.control,
            SPSR => {
                self.seen = self.flags;
                self.flags | self.double
            }
            SPDR => {
                self.clear_seen(core);
                self.received
            }
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, core: &mut Core, address: u16, value: u8, cycle: u64) {
        match address {
            SPCR => {
                self.control = value;
                if value & SPE == 0 {
                    self.transfer = None;
                }
                self.look_at_select(core, cycle);
            }
            SPSR => self.double = value & SPI2X,
            SPDR => {
                self.clear_seen(core);
                if self.transfer.is_some() {
                    self.flags |= WCOL;
                } else if self.control & (SPE | MSTR) == SPE | MSTR {
                    self.sent = value;
                    self.transfer = Some(cycle + 8 * self.period());
                }
            }
            _ => {}
        }
        self.drive_pins(core, cycle);
        self.reschedule(core);
    }

    fn clear_seen(&mut self, core: &mut Core) {
        self.flags &= !std::mem::take(&mut self.seen);
        self.reschedule(core);
    }

    /// Cycles of a bit.
    fn period(&self) -> u64 {
        let divisor = [4, 16, 64, 128][usize::from(self.control & 3)];
        if self.double != 0 {
            divisor / 2
        } else {
            divisor
        }
    }

    fn drive_pins(&self, core: &mut Core, cycle: u64) {
        let master = self.control & (SPE | MSTR) == SPE | MSTR;
        let last = if self.control & DORD != 0 { 0x80 } else { 1 };
        let last = self.sent & last != 0;
        let clock = self.control & CPOL != 0;
        let force = if master { Force::Input } else { Force::None };
        for change in [
            core.ports.force(IN, force, cycle),
            core.ports
                .override_output(CLOCK, master.then_some(clock), cycle),
            core.ports
                .override_output(OUT, master.then_some(last), cycle),
        ] {
            core.note(change, cycle);
        }
    }

    /// A master that is selected by somebody else becomes a slave (section 21.3.2).
    pub(super) fn look_at_select(&mut self, core: &mut Core, cycle: u64) {
        let ports = &core.ports;
        let selected =
            ports.is_driven_outside(SELECT) && !ports.level(SELECT) && !ports.is_output(SELECT);
        if selected && self.control & (SPE | MSTR) == SPE | MSTR {
            self.control &= !MSTR;
            self.flags |= SPIF;
            self.transfer = None;
            self.drive_pins(core, cycle);
            self.reschedule(core);
        }
    }

    /// The transfer is through.
    pub(super) fn happen(&mut self, core: &mut Core) {
        self.transfer = None;
        self.received = if core.ports.level(IN) { 0xFF } else { 0 };
        self.flags |= SPIF;
        self.reschedule(core);
    }

    fn reschedule(&self, core: &mut Core) {
        let running = self.transfer.filter(|_| self.stopped.is_none());
        core.schedule.set(Source::Spi, running);
        let requested = self.flags & SPIF != 0 && self.control & SPIE != 0;
        core.interrupts.set(vector::SPI, requested);
    }

    /// It has a clock from now on, or has none.
    pub(super) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        match self.stopped {
            None if !runs => self.stopped = Some(cycle),
            Some(stopped) if runs => {
                self.stopped = None;
                if let Some(end) = &mut self.transfer {
                    *end += cycle - stopped;
                }
            }
            _ => return,
        }
        self.reschedule(core);
    }

    /// Its routine is entered.
    pub(super) fn acknowledge(&mut self, core: &mut Core) {
        self.flags &= !SPIF;
        self.reschedule(core);
    }

    pub(super) fn reset(&mut self, core: &mut Core) {
        *self = Spi::default();
        self.reschedule(core);
    }
}
