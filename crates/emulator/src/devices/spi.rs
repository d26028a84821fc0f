//! The serial peripheral interface (2549Q, section 21): master and slave, with the edges on its pins.
//!
//! A transfer is sixteen steps of half a clock period, at each of which SCK has an edge. CPHA selects which of the two
//! in a bit takes the level of the data line, and which puts out the next bit; without CPHA the first bit is out before
//! the first edge. As a master the steps are the interface's own, as a slave those of the pin.

use super::Core;
use super::ports::{Force, Pin};
use super::schedule::Source;
use crate::registers::{SPCR, SPDR, SPSR};

const SPIE: u8 = 0x80;
const SPE: u8 = 0x40;
const DORD: u8 = 0x20;
const MSTR: u8 = 0x10;
const CPOL: u8 = 0x08;
const CPHA: u8 = 0x04;
const SPIF: u8 = 0x80;
const WCOL: u8 = 0x40;
const SPI2X: u8 = 0x01;

/// Edges of SCK in a transfer.
const STEPS: u32 = 16;

/// What the interface is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Off,
    Master,
    Slave,
}

/// When a master's edges are.
#[derive(Clone, Copy, Debug)]
struct Transfer {
    start: u64,
    /// Cycles of half a period.
    half: u64,
}

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
    /// The byte that goes out, what has come in of the other one, and the edges of this transfer.
    sent: u8,
    taken: u8,
    steps: u32,
    /// The level of the line that goes out.
    level: bool,
    transfer: Option<Transfer>,
    /// The bus is the other master's: SS of a slave is low.
    selected: bool,
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

    /// A register reads the same until something happens, and a read changes nothing.
    pub(super) fn is_steady(&self, address: u16) -> bool {
        address != SPDR && self.seen == self.flags
    }

    pub(super) fn write(&mut self, core: &mut Core, address: u16, value: u8, cycle: u64) {
        match address {
            SPCR => {
                let before = self.role();
                self.control = value;
                if self.role() != before {
                    self.start_over();
                }
                self.look_at_select(core, cycle);
            }
            SPSR => self.double = value & SPI2X,
            SPDR => {
                self.clear_seen(core);
                self.write_data(value, cycle);
            }
            _ => {}
        }
        self.drive_pins(core, cycle);
        self.reschedule(core);
    }

    fn write_data(&mut self, value: u8, cycle: u64) {
        if self.transfer.is_some() || self.steps > 0 {
            self.flags |= WCOL;
        } else if self.role() != Role::Off {
            self.sent = value;
            if self.role() == Role::Master {
                let half = self.half_period();
                self.transfer = Some(Transfer { start: cycle, half });
            }
            self.show_first();
        }
    }

    fn role(&self) -> Role {
        match (self.control & SPE != 0, self.control & MSTR != 0) {
            (false, _) => Role::Off,
            (true, true) => Role::Master,
            (true, false) => Role::Slave,
        }
    }

    /// What was on its way is lost.
    fn start_over(&mut self) {
        self.transfer = None;
        self.steps = 0;
        self.taken = 0;
    }

    fn clear_seen(&mut self, core: &mut Core) {
        self.flags &= !std::mem::take(&mut self.seen);
        self.reschedule(core);
    }

    /// Cycles of half a bit.
    fn half_period(&self) -> u64 {
        let half = [2, 8, 32, 64][usize::from(self.control & 3)];
        if self.double != 0 { half / 2 } else { half }
    }

    fn is_set(&self, bit: u8) -> bool {
        self.control & bit != 0
    }

    /// Puts a bit of the byte out.
    fn show(&mut self, bit: u32) {
        let place = if self.is_set(DORD) { bit } else { 7 - bit };
        self.level = self.sent >> (place & 7) & 1 != 0;
    }

    /// Without CPHA the first bit is out before the first edge.
    fn show_first(&mut self) {
        if !self.is_set(CPHA) {
            self.show(0);
        }
    }

    /// The level of SCK.
    fn clock(&self) -> bool {
        self.steps.is_multiple_of(2) == self.is_set(CPOL)
    }

    /// Overrides its pins per table 21-1: directions of inputs always; those of outputs are the program's.
    fn drive_pins(&self, core: &mut Core, cycle: u64) {
        let input = |is_input: bool| if is_input { Force::Input } else { Force::None };
        let (master, slave) = (self.role() == Role::Master, self.role() == Role::Slave);
        let out = slave && self.selected;
        let [select, clock, mosi, miso] = core.model.spi;
        for change in [
            core.ports
                .force(miso, input(master || slave && !out), cycle),
            core.ports.force(mosi, input(slave), cycle),
            core.ports.force(clock, input(slave), cycle),
            core.ports.force(select, input(slave), cycle),
            core.ports
                .override_output(clock, master.then(|| self.clock()), cycle),
            core.ports
                .override_output(mosi, master.then_some(self.level), cycle),
            core.ports
                .override_output(miso, out.then_some(self.level), cycle),
        ] {
            core.note(change, cycle);
        }
    }

    /// A pin has changed: SS or SCK, if it is one of them.
    pub(super) fn pin_changed(&mut self, core: &mut Core, pin: Pin, cycle: u64) {
        let [select, clock, mosi, _] = core.model.spi;
        if pin == select {
            self.look_at_select(core, cycle);
        } else if pin == clock && self.selected && self.stopped.is_none() {
            // One that was active when the slave was selected has a trailing edge first, which is none of a byte.
            let leading = core.ports.level(clock) != self.is_set(CPOL);
            if leading == self.steps.is_multiple_of(2) {
                self.step(core, mosi);
                self.drive_pins(core, cycle);
                self.reschedule(core);
            }
        }
    }

    /// A master selected by another master becomes a slave (section 21.3.2); a deselected slave drops a partial byte.
    fn look_at_select(&mut self, core: &mut Core, cycle: u64) {
        let ports = &core.ports;
        let [select, ..] = core.model.spi;
        let low = ports.is_driven_outside(select) && !ports.level(select);
        if self.role() == Role::Master && low && !ports.is_output(select) {
            self.control &= !MSTR;
            self.flags |= SPIF;
            self.start_over();
        }
        let selected = self.role() == Role::Slave && low;
        if selected != self.selected {
            self.selected = selected;
            self.start_over();
            self.show_first();
        }
        self.drive_pins(core, cycle);
        self.reschedule(core);
    }

    /// An edge of the clock: takes a bit from `input`, or puts out the next one.
    fn step(&mut self, core: &Core, input: Pin) {
        self.steps += 1;
        let leading = !self.steps.is_multiple_of(2);
        if leading != self.is_set(CPHA) {
            let level = u8::from(core.ports.level(input));
            self.taken = if self.is_set(DORD) {
                self.taken >> 1 | level << 7
            } else {
                self.taken << 1 | level
            };
        } else if self.steps < STEPS {
            self.show(self.steps / 2);
        }
        if self.steps == STEPS {
            self.finish();
        }
    }

    /// A byte has been exchanged: what came in is in the shift register, and a slave that is not given another sends it back.
    fn finish(&mut self) {
        self.received = self.taken;
        self.sent = self.taken;
        self.flags |= SPIF;
        self.start_over();
        if self.selected {
            self.show_first();
        }
    }

    /// An edge of its own clock is due.
    pub(super) fn happen(&mut self, core: &mut Core, cycle: u64) {
        if self.transfer.is_some() {
            let [.., miso] = core.model.spi;
            self.step(core, miso);
            self.drive_pins(core, cycle);
        }
        self.reschedule(core);
    }

    fn reschedule(&self, core: &mut Core) {
        let running = self.transfer.filter(|_| self.stopped.is_none());
        let next = running.map(|transfer| {
            let Transfer { start, half } = transfer;
            start + u64::from(self.steps + 1) * half
        });
        core.schedule.set(Source::Spi, next);
        let requested = self.flags & SPIF != 0 && self.control & SPIE != 0;
        core.interrupts.set(core.model.numbers.spi, requested);
    }

    /// It has a clock from now on, or has none.
    pub(super) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        match self.stopped {
            None if !runs => self.stopped = Some(cycle),
            Some(stopped) if runs => {
                self.stopped = None;
                if let Some(transfer) = &mut self.transfer {
                    transfer.start += cycle - stopped;
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
