//! USART 0 to 3: registers, flags, interrupts and pins (2549Q, section 22).
//!
//! Bytes come in through [`line`] as levels of the RXD pin, which the [`receiver`] samples; the [`transmitter`] moves the TXD pin.
//! Each has a next event, and the USART is woken at the earliest.
//!
//! In synchronous modes and as master of SPI both run by the clock on XCK ([`clocked`]).

mod clocked;
mod format;
mod line;
mod rate;
mod receiver;
mod transmitter;

use super::ports::{Force, Pin};
use super::schedule::Source;
use super::{CLOCK_HZ, Core, Event};
use crate::io::Access;
use crate::model::usart::{UsartInstance, UsartRegister};
use clocked::Clocked;
use format::Format;
use line::Line;
use rate::Rate;
use receiver::Receiver;
use transmitter::{Step, Transmitter};

/// UCSRA.
const RXC: u8 = 0x80;
const TXC: u8 = 0x40;
const UDRE: u8 = 0x20;
const FE: u8 = 0x10;
const DOR: u8 = 0x08;
const UPE: u8 = 0x04;
const U2X: u8 = 0x02;
const MPCM: u8 = 0x01;
/// UCSRB: the interrupt enables stand where UCSRA has their flags.
const RXEN: u8 = 0x10;
const TXEN: u8 = 0x08;
const UCSZ2: u8 = 0x04;
const RXB8: u8 = 0x02;
const TXB8: u8 = 0x01;

/// One USART.
#[derive(Clone, Debug)]
pub(crate) struct Usart {
    place: &'static UsartInstance,
    /// U2X and MPCM.
    settings: u8,
    control_b: u8,
    control_c: u8,
    divisor: u16,
    rate: Rate,
    format: Format,
    transmitter: Transmitter,
    receiver: Receiver,
    line: Line,
    clocked: Clocked,
    /// It gives XCK its level.
    drives_clock: bool,
    /// The cycle in which it lost its clock.
    stopped: Option<u64>,
    /// The first instruction that wrote a byte to be sent while the transmitter was off [words].
    unsent_at: Option<u32>,
}

/// After reset.
pub(crate) fn new(place: &'static UsartInstance) -> Usart {
    Usart {
        place,
        settings: 0,
        control_b: 0,
        // 8N1.
        control_c: 0x06,
        divisor: 0,
        rate: Rate {
            origin: 0,
            tick: 1,
            per_bit: 16,
        },
        format: Format::new(3, 0x06),
        transmitter: Transmitter::default(),
        receiver: Receiver::default(),
        line: Line::default(),
        clocked: Clocked::default(),
        drives_clock: false,
        stopped: None,
        unsent_at: None,
    }
}

impl Usart {
    /// The first instruction that wrote a byte to be sent while the transmitter was off [words].
    pub(crate) fn unsent_at(&self) -> Option<u32> {
        self.unsent_at
    }

    /// Resets; the sender outside continues.
    pub(crate) fn reset(&mut self, core: &mut Core) {
        let line = std::mem::take(&mut self.line);
        *self = Usart {
            line,
            unsent_at: self.unsent_at,
            ..new(self.place)
        };
        self.reschedule(core);
    }

    /// Whether this is one of its interrupt vectors.
    pub(crate) fn has_vector(&self, vector: u8) -> bool {
        (self.place.vector..self.place.vector + 3).contains(&vector)
    }

    /// The rate that it is set to \[baud\].
    fn baud(&self, core: &Core) -> f64 {
        CLOCK_HZ as f64 / (self.rate.bit() * core.clock.divisor()) as f64
    }

    /// The rate at which it receives, if it does \[baud\].
    pub(crate) fn receiving_baud(&self, core: &Core) -> Option<f64> {
        self.listens().then(|| self.baud(core))
    }

    fn listens(&self) -> bool {
        self.control_b & RXEN != 0
    }

    /// A frame comes in from outside.
    pub(crate) fn receive(&mut self, core: &mut Core, bits: u16, count: u8, baud: u32, cycle: u64) {
        let pin = self.place.receive;
        // Nothing is connected until something drives the line; a sender was idle before.
        if !core.ports.is_driven_outside(pin) {
            let change = core.ports.set_outside(pin, Some(true), cycle);
            core.note(Some(change), cycle);
        }
        self.line.send(bits, count, baud, core.clock.time(cycle));
        self.reschedule(core);
    }

    /// Its event is due.
    pub(crate) fn happen(&mut self, core: &mut Core, cycle: u64) {
        if self.line_due(core).is_some_and(|due| due <= cycle) {
            let level = self.line.step();
            let change = core
                .ports
                .set_outside(self.place.receive, Some(level), cycle);
            core.note(Some(change), cycle);
        } else {
            self.catch_up(core, cycle);
        }
        self.reschedule(core);
    }

    /// Everything of transmitter and receiver that is due.
    fn catch_up(&mut self, core: &mut Core, cycle: u64) {
        if self.stopped.is_some() {
            return;
        }
        if self.is_clocked() {
            self.run_clock(core, cycle);
            self.clocked.set_time(cycle);
            self.request(core);
            return;
        }
        while let Some(at) = self.transmitter.next(self.rate)
            && at <= cycle
        {
            match self.transmitter.step(self.format, self.rate) {
                Some(Step::Sent(byte)) => {
                    let event = Event::Byte {
                        usart: self.place.number as u8,
                        byte,
                        baud: self.baud(core),
                    };
                    core.emit(at, event);
                    self.drive_pins(core, at);
                }
                Some(Step::Level(_)) => self.drive_pins(core, at),
                None => {}
            }
        }
        if self.listens() {
            let accept = self.acceptor();
            self.receiver
                .sample_before(cycle + 1, self.format, self.rate, accept);
        }
        self.request(core);
    }

    /// What a multi-processor receiver accepts: only addresses, that is frames whose ninth bit, or stop bit, is one.
    fn acceptor(&self) -> impl Fn(u16, bool) -> bool + use<> {
        let (selective, nine) = (self.settings & MPCM != 0, self.format.data == 9);
        move |data, stop| !selective || if nine { data & 0x100 != 0 } else { stop }
    }

    /// A pin has changed: RXD or XCK, if it is one of them.
    pub(crate) fn pin_changed(&mut self, core: &mut Core, pin: Pin, cycle: u64) {
        if self.stopped.is_some() {
            return;
        }
        if pin == self.place.clock && self.is_clocked() {
            let high = core.ports.level(pin);
            self.clock_edge(core, high, cycle);
        }
        if pin == self.place.receive && self.listens() && !self.is_clocked() {
            let (level, accept) = (self.line_level(core), self.acceptor());
            self.receiver
                .change(level, cycle, self.format, self.rate, accept);
            self.request(core);
            self.reschedule(core);
        }
    }

    /// The direction of a pin may have changed: an XCK that is an output has the clock of this USART.
    pub(crate) fn direction_changed(&mut self, core: &mut Core, cycle: u64) {
        if self.is_clocked() {
            self.catch_up(core, cycle);
            self.reschedule(core);
        }
    }

    /// It has a clock from now on, or has none.
    pub(crate) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        match self.stopped {
            None if !runs => {
                self.catch_up(core, cycle);
                self.stopped = Some(cycle);
            }
            Some(stopped) if runs => {
                self.stopped = None;
                let cycles = cycle - stopped;
                self.rate.origin += cycles;
                self.transmitter.delay(cycles);
                self.clocked.delay(cycles);
                self.receiver.delay(cycles, self.line_level(core));
            }
            _ => return,
        }
        self.reschedule(core);
    }

    /// The level that the receiver sees; a line that nothing drives counts as idle.
    fn line_level(&self, core: &Core) -> bool {
        let pin = self.place.receive;
        core.ports.level(pin) || !core.ports.is_driven_outside(pin)
    }

    /// The cycle in which the sender changes the line's level.
    fn line_due(&self, core: &Core) -> Option<u64> {
        self.line.next().map(|time| core.clock.cycle(time))
    }

    pub(crate) fn reschedule(&self, core: &mut Core) {
        let (transmitter, receiver) = match self.stopped {
            Some(_) => (None, None),
            None if self.is_clocked() => (self.next_clock(core), None),
            None => (
                self.transmitter.next(self.rate),
                self.receiver.next(self.format, self.rate),
            ),
        };
        let next = [self.line_due(core), transmitter, receiver];
        core.schedule.set(
            Source::Usart(self.place.number),
            next.into_iter().flatten().min(),
        );
    }

    fn flags(&self) -> u8 {
        let first = self.receiver.first();
        let when = |flag: u8, condition: bool| if condition { flag } else { 0 };
        when(RXC, first.is_some())
            | when(TXC, self.transmitter.complete)
            | when(UDRE, self.transmitter.is_ready())
            | first.map_or(0, |first| {
                when(FE, first.frame_error)
                    | when(DOR, first.overrun)
                    | when(UPE, first.parity_error)
            })
    }

    fn request(&self, core: &mut Core) {
        let requested = self.flags() & self.control_b;
        for (offset, flag) in [RXC, UDRE, TXC].into_iter().enumerate() {
            let vector = self.place.vector + offset as u8;
            core.interrupts.set(vector, requested & flag != 0);
        }
    }

    /// Transmitter and receiver override their pins in either direction.
    fn drive_pins(&mut self, core: &mut Core, cycle: u64) {
        let sends = self.control_b & TXEN != 0 || self.transmitter.is_busy();
        let force = |on: bool, force: Force| if on { force } else { Force::None };
        let transmit = force(sends, Force::Output(self.transmitter.level));
        let receive = force(self.listens(), Force::Input);
        for (pin, force) in [
            (self.place.transmit, transmit),
            (self.place.receive, receive),
        ] {
            let change = core.ports.force(pin, force, cycle);
            core.note(change, cycle);
        }
        if self.drives_clock || self.is_clocked() {
            let level = self.clock_level();
            self.drives_clock = level.is_some();
            let change = core.ports.override_output(self.place.clock, level, cycle);
            core.note(change, cycle);
        }
    }

    /// A register reads the same until something happens, and a read changes nothing.
    pub(crate) fn is_steady(&self, address: u16) -> bool {
        let data = matches!(self.place.register(address), Some(UsartRegister::Data));
        !data && !self.is_clocked()
    }

    pub(crate) fn read(&mut self, core: &mut Core, address: u16, at: Access) -> u8 {
        self.catch_up(core, at.cycle);
        let ninth = self
            .receiver
            .first()
            .is_some_and(|first| first.data >= 0x100);
        match self.place.register(address) {
            Some(UsartRegister::StatusA) => self.flags() | self.settings,
            Some(UsartRegister::ControlB) => self.control_b | if ninth { RXB8 } else { 0 },
            Some(UsartRegister::ControlC) => self.control_c,
            Some(UsartRegister::RateLow) => self.divisor.to_le_bytes()[0],
            Some(UsartRegister::RateHigh) => self.divisor.to_le_bytes()[1],
            Some(UsartRegister::Data) => {
                let received = self.receiver.take();
                self.request(core);
                received.data.to_le_bytes()[0]
            }
            None => 0,
        }
    }

    pub(crate) fn write(&mut self, core: &mut Core, address: u16, value: u8, at: Access) {
        self.catch_up(core, at.cycle);
        let [low, high] = self.divisor.to_le_bytes();
        match self.place.register(address) {
            Some(UsartRegister::StatusA) => {
                self.transmitter.complete &= value & TXC == 0;
                self.settings = value & (U2X | MPCM);
                self.set_rate(self.rate.origin, at.cycle);
            }
            Some(UsartRegister::ControlB) => self.set_control(core, value, at.cycle),
            Some(UsartRegister::ControlC) => {
                self.control_c = value;
                self.set_format();
                self.set_rate(self.rate.origin, at.cycle);
                self.drive_pins(core, at.cycle);
            }
            Some(UsartRegister::RateLow) => {
                self.divisor = u16::from_le_bytes([value, high]);
                self.set_rate(at.cycle, at.cycle);
            }
            Some(UsartRegister::RateHigh) => {
                self.divisor = u16::from_le_bytes([low, value & 0x0F]);
                self.set_rate(at.cycle, at.cycle);
            }
            Some(UsartRegister::Data) if self.control_b & TXEN != 0 => {
                let ninth = u8::from(self.control_b & TXB8 != 0);
                let data = u16::from_le_bytes([value, ninth]);
                self.transmitter
                    .write(data, self.format, self.rate, at.cycle);
            }
            Some(UsartRegister::Data) => {
                self.unsent_at.get_or_insert(at.program_counter);
            }
            None => {}
        }
        self.request(core);
        self.reschedule(core);
    }

    fn set_control(&mut self, core: &mut Core, value: u8, cycle: u64) {
        let listened = self.listens();
        self.control_b = value & !RXB8;
        self.set_format();
        self.drive_pins(core, cycle);
        if self.listens() && !listened {
            self.receiver = Receiver::start(self.line_level(core), cycle);
        } else if !self.listens() {
            // The buffer is flushed.
            self.receiver = Receiver::default();
        }
    }

    fn set_format(&mut self) {
        let size = self.control_c >> 1 & 3 | self.control_b & UCSZ2;
        self.format = Format::new(size, self.control_c);
    }

    /// Adopts rate and speed; frames in progress are disturbed if they differ.
    fn set_rate(&mut self, origin: u64, cycle: u64) {
        let ticks = u64::from(self.divisor) + 1;
        let rate = match (self.control_c >> 6, self.settings & U2X != 0) {
            (0, false) => Rate {
                origin,
                tick: ticks,
                per_bit: 16,
            },
            (0, true) => Rate {
                origin,
                tick: ticks,
                per_bit: 8,
            },
            _ => Rate {
                origin,
                tick: ticks,
                per_bit: 2,
            },
        };
        if rate != self.rate {
            if !self.is_clocked() {
                self.transmitter.change_rate(self.rate, rate, cycle);
            }
            self.clocked.set_time(cycle);
            self.receiver.give_up(cycle);
            self.rate = rate;
        }
    }

    /// One of its interrupts is entered: only the end of transmission is a flag that this clears.
    pub(crate) fn acknowledge(&mut self, core: &mut Core, vector: u8, cycle: u64) {
        self.catch_up(core, cycle);
        if vector == self.place.vector + 2 {
            self.transmitter.complete = false;
        }
        self.request(core);
    }
}
