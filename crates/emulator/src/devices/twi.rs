//! The two-wire interface as the master of a bus with pull-ups (2549Q, section 24), with the edges on its pins.
//!
//! Both lines are pulled down or released; a released line is high through the pull-ups of the board. What another
//! drives counts: an acknowledgement, bits read, a clock held low, arbitration lost. With nothing connected an address is
//! not acknowledged. A device beyond the chip need not follow the edges: it gets each byte as it begins
//! ([`Event::TwoWire`]), and its [`Reply`] is put on SDA bit by bit.
//!
//! # Theory of operation
//!
//! An action is a row of half periods of SCL ([`Action::moves`]); the interface makes one move at the beginning of each. A move that
//! lets SCL go waits until it is high. Between actions, while TWINT is up, SCL stays low.
//!
//! | action | moves at 0, 1, 2, ... half periods |
//! |---|---|
//! | start | SDA down at 1, SCL down at 2 |
//! | repeated start | SDA up at 0, SCL up at 1, SDA down at 2, SCL down at 3 |
//! | byte | bit n out at 2n, SCL up at 2n + 1, SCL down at 2n + 2; nine bits |
//! | stop | SDA down at 0, SCL up at 1, SDA up at 2 |
//!
//! It never answers as a slave: TWEA and TWAR alone do nothing, and a write to TWAR is reported as not modelled.

use super::Core;
use super::ports::{Force, Pin};
use super::schedule::Source;
use super::signal::{Event, Reply, Transfer};
use crate::registers::{TWAMR, TWAR, TWBR, TWCR, TWDR, TWSR};

const TWINT: u8 = 0x80;
const TWEA: u8 = 0x40;
const TWSTA: u8 = 0x20;
const TWSTO: u8 = 0x10;
const TWWC: u8 = 0x08;
const TWEN: u8 = 0x04;
const TWIE: u8 = 0x01;

/// Status codes (tables 24-2 and 24-3). Where there are two, the first is the one with an acknowledgement.
const START: u8 = 0x08;
const REPEATED_START: u8 = 0x10;
const WRITE_ADDRESS: [u8; 2] = [0x18, 0x20];
const WRITTEN: [u8; 2] = [0x28, 0x30];
const ARBITRATION_LOST: u8 = 0x38;
const READ_ADDRESS: [u8; 2] = [0x40, 0x48];
const READ: [u8; 2] = [0x50, 0x58];
const NOTHING: u8 = 0xF8;

/// Bits of a byte with its acknowledgement.
const BITS: u32 = 9;

/// What is on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Action {
    Start,
    RepeatedStart,
    Stop,
    /// A byte goes out; these are the statuses with and without an acknowledgement.
    Write([u8; 2]),
    /// A byte comes in.
    Read,
}

/// A move on the lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Move {
    Data(bool),
    ClockUp,
    /// SCL goes down; what SDA was is a bit, if there is one.
    ClockDown,
}

/// The interface.
#[derive(Clone, Debug)]
pub(super) struct Twi {
    rate: u8,
    prescaler: u8,
    status: u8,
    address: u8,
    mask: u8,
    data: u8,
    /// TWEA, TWSTA, TWSTO, TWEN, TWIE.
    control: u8,
    flag: bool,
    collision: bool,
    action: Option<Action>,
    /// Half periods of the action that have begun, and when the next one does; `None` while the bus is not free, or SCL held low.
    moves: u32,
    next: Option<u64>,
    /// The nine bits that came in, the first one highest.
    taken: u16,
    /// The lines are released, not pulled down.
    clock: bool,
    line: bool,
    /// What a device does with the byte on its way, and whether it pulls SDA down for it.
    reply: Option<Reply>,
    pulled: bool,
    /// The cycle in which it lost its clock.
    stopped: Option<u64>,
}

impl Default for Twi {
    fn default() -> Twi {
        Twi {
            rate: 0,
            prescaler: 0,
            status: NOTHING,
            address: 0xFE,
            mask: 0,
            data: 0xFF,
            control: 0,
            flag: false,
            collision: false,
            action: None,
            moves: 0,
            next: None,
            taken: 0,
            clock: true,
            line: true,
            reply: None,
            pulled: false,
            stopped: None,
        }
    }
}

/// The level of a line, which has a pull-up.
fn level(core: &Core, pin: Pin) -> bool {
    core.ports.level(pin) || !core.ports.is_driven_outside(pin) && !core.ports.is_output(pin)
}

fn clock(core: &Core) -> bool {
    level(core, core.model.twi[0])
}

fn line(core: &Core) -> bool {
    level(core, core.model.twi[1])
}

impl Twi {
    pub(super) fn read(&self, address: u16) -> u8 {
        match address {
            TWBR => self.rate,
            TWSR => self.status | self.prescaler,
            TWAR => self.address,
            TWDR => self.data,
            TWCR => {
                let flag = if self.flag { TWINT } else { 0 };
                self.control | flag | if self.collision { TWWC } else { 0 }
            }
            TWAMR => self.mask,
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, core: &mut Core, address: u16, value: u8, cycle: u64) {
        match address {
            TWBR => self.rate = value,
            TWSR => self.prescaler = value & 3,
            TWAR => self.address = value,
            TWAMR => self.mask = value & 0xFE,
            TWDR => {
                self.collision = !self.flag;
                if self.flag {
                    self.data = value;
                }
            }
            TWCR => self.command(core, value, cycle),
            _ => {}
        }
        self.reschedule(core);
    }

    /// Cycles of half a bit (section 24.5.2: 16 + 2 TWBR 4^TWPS for a whole one).
    fn half_period(&self) -> u64 {
        8 + u64::from(self.rate) * (1 << (2 * self.prescaler))
    }

    fn command(&mut self, core: &mut Core, value: u8, cycle: u64) {
        self.control = value & (TWEA | TWSTA | TWSTO | TWEN | TWIE);
        if value & TWEN == 0 {
            self.action = None;
            self.next = None;
            self.flag = false;
            self.status = NOTHING;
            (self.clock, self.line) = (true, true);
            self.reply = None;
            self.pull(core, cycle);
        } else if value & TWINT != 0 && self.action.is_none() {
            // The flag, cleared by a one, sets the next action going.
            self.flag = false;
            self.action = self.next_action();
            self.begin(core, cycle);
        } else if value & TWSTA != 0 && self.action.is_none() && !self.flag {
            self.action = Some(Action::Start);
            self.begin(core, cycle);
        }
        self.drive_pins(core, cycle);
    }

    /// What TWCR asks for; `None` where the bus is not ours.
    fn next_action(&self) -> Option<Action> {
        let ours = self.status != NOTHING && self.status != ARBITRATION_LOST;
        if self.control & TWSTO != 0 && ours {
            return Some(Action::Stop);
        }
        if self.control & TWSTA != 0 {
            return Some(if ours {
                Action::RepeatedStart
            } else {
                Action::Start
            });
        }
        Some(match self.status {
            START | REPEATED_START if self.data & 1 != 0 => Action::Write(READ_ADDRESS),
            START | REPEATED_START => Action::Write(WRITE_ADDRESS),
            status if WRITE_ADDRESS.contains(&status) || WRITTEN.contains(&status) => {
                Action::Write(WRITTEN)
            }
            status if READ_ADDRESS.contains(&status) || READ.contains(&status) => Action::Read,
            _ => return None,
        })
    }

    /// The action begins, unless the bus must be free first and is not.
    fn begin(&mut self, core: &mut Core, cycle: u64) {
        self.moves = 0;
        self.taken = 0;
        self.next = None;
        if self.action != Some(Action::Stop) {
            self.control &= !TWSTO;
        }
        match self.action {
            Some(Action::Start) if !(clock(core) && line(core)) => {}
            Some(Action::Start) => self.next = Some(cycle + self.half_period()),
            Some(action) => {
                self.announce(core, action, cycle);
                self.next = Some(cycle);
                self.happen(core, cycle);
            }
            None => {}
        }
    }

    /// Tells the devices on the bus of the byte that begins.
    fn announce(&mut self, core: &mut Core, action: Action, cycle: u64) {
        self.reply = None;
        if !core.bus_watched {
            return;
        }
        let transfer = match action {
            Action::Write(WRITTEN) => Transfer::Write(self.data),
            Action::Write(_) => Transfer::Address(self.data),
            Action::Read => Transfer::Read,
            Action::Stop => Transfer::End,
            Action::Start | Action::RepeatedStart => return,
        };
        core.emit(cycle, Event::TwoWire(transfer));
    }

    /// A device replies to the byte that has begun.
    pub(super) fn answer(&mut self, core: &mut Core, reply: Reply, cycle: u64) {
        if matches!(self.action, Some(Action::Write(_) | Action::Read)) {
            self.reply = Some(reply);
            self.pull(core, cycle);
        }
    }

    /// A device pulls SDA down for a zero of its own, or lets it go.
    fn pull(&mut self, core: &mut Core, cycle: u64) {
        let bit = self.moves.saturating_sub(1) / 2;
        let pulled = match self.reply {
            Some(Reply::Acknowledge) => bit == 8 && matches!(self.action, Some(Action::Write(_))),
            Some(Reply::Byte(byte)) => {
                bit < 8 && self.action == Some(Action::Read) && byte >> (7 - bit) & 1 == 0
            }
            None => false,
        };
        if pulled != self.pulled {
            self.pulled = pulled;
            let change = core
                .ports
                .set_outside(core.model.twi[1], Some(!pulled), cycle);
            core.note(Some(change), cycle);
        }
    }

    /// The moves of an action in its half period number `at`.
    fn at(&self, action: Action, at: u32) -> [Option<Move>; 2] {
        let one = |step| [Some(step), None];
        match (action, at) {
            (Action::Start, 0) => one(Move::Data(false)),
            (Action::Start, _) => one(Move::ClockDown),
            (Action::RepeatedStart, 0) => one(Move::Data(true)),
            (Action::RepeatedStart, 1) | (Action::Stop, 1) => one(Move::ClockUp),
            (Action::RepeatedStart, 2) | (Action::Stop, 0) => one(Move::Data(false)),
            (Action::RepeatedStart, _) => one(Move::ClockDown),
            (Action::Stop, _) => one(Move::Data(true)),
            (Action::Write(_) | Action::Read, at) if at % 2 != 0 => one(Move::ClockUp),
            (Action::Write(_) | Action::Read, at) => {
                let down = (at > 0).then_some(Move::ClockDown);
                let bit = (at / 2 < BITS).then(|| Move::Data(self.bit_out(action, at / 2)));
                [down, bit]
            }
        }
    }

    /// Bit `bit` of a byte as sent: ones while another device sends.
    fn bit_out(&self, action: Action, bit: u32) -> bool {
        match action {
            Action::Write(_) if bit < 8 => self.data >> (7 - bit) & 1 != 0,
            Action::Read if bit == 8 => self.control & TWEA == 0,
            _ => true,
        }
    }

    /// A half period begins.
    pub(super) fn happen(&mut self, core: &mut Core, cycle: u64) {
        let Some(action) = self.action else {
            return;
        };
        let mut last = false;
        for step in self.at(action, self.moves).into_iter().flatten() {
            match step {
                Move::Data(high) => {
                    self.line = high;
                    last |= action == Action::Stop && high;
                }
                Move::ClockUp => self.clock = true,
                Move::ClockDown => {
                    self.clock = false;
                    self.taken = self.taken << 1 | u16::from(line(core));
                    last |= match action {
                        Action::Write(_) | Action::Read => self.moves == 2 * BITS,
                        _ => true,
                    };
                }
            }
            self.drive_pins(core, cycle);
        }
        self.moves += 1;
        self.pull(core, cycle);
        let lost = self.has_lost(core, action);
        if last || lost {
            self.end(core, action, lost, cycle);
        } else {
            self.next = (!self.clock || clock(core)).then(|| cycle + self.half_period());
        }
        self.reschedule(core);
    }

    /// Somebody else pulls SDA down while SCL is up and this master has let it go: it is another master's bus.
    fn has_lost(&self, core: &Core, action: Action) -> bool {
        let ours = match action {
            Action::Write(_) => self.moves <= 16,
            Action::Read => self.moves > 16,
            Action::Start | Action::RepeatedStart | Action::Stop => false,
        };
        ours && self.moves.is_multiple_of(2) && self.line && !line(core)
    }

    /// The action is through.
    fn end(&mut self, core: &mut Core, action: Action, lost: bool, cycle: u64) {
        self.action = None;
        self.next = None;
        self.reply = None;
        self.pull(core, cycle);
        if lost {
            self.status = ARBITRATION_LOST;
            (self.clock, self.line) = (true, true);
            self.flag = true;
            self.drive_pins(core, cycle);
            return;
        }
        let refused = usize::from(self.taken & 1 != 0);
        self.status = match action {
            Action::Start => START,
            Action::RepeatedStart => REPEATED_START,
            Action::Stop => {
                self.control &= !TWSTO;
                self.status = NOTHING;
                if self.control & TWSTA != 0 {
                    self.action = Some(Action::Start);
                    self.begin(core, cycle);
                }
                return;
            }
            Action::Write(statuses) => statuses[refused],
            Action::Read => {
                [self.data, _] = (self.taken >> 1).to_le_bytes();
                READ[refused]
            }
        };
        self.flag = true;
    }

    /// A line has changed: SCL is no longer held low, or the bus is free.
    pub(super) fn pin_changed(&mut self, core: &mut Core, pin: Pin, cycle: u64) {
        if !core.model.twi.contains(&pin) || self.next.is_some() || self.stopped.is_some() {
            return;
        }
        match self.action {
            Some(Action::Start) if self.moves == 0 => self.begin(core, cycle),
            Some(_) if self.clock && clock(core) => {
                self.next = Some(cycle + self.half_period());
            }
            _ => return,
        }
        self.reschedule(core);
    }

    /// Released lines are inputs, with the pull-up that the port selects; the others are low outputs.
    fn drive_pins(&self, core: &mut Core, cycle: u64) {
        let on = self.control & TWEN != 0;
        for (pin, high) in core.model.twi.into_iter().zip([self.clock, self.line]) {
            let force = match (on, high) {
                (false, _) => Force::None,
                (true, true) => Force::Input,
                (true, false) => Force::Output(false),
            };
            let change = core.ports.force(pin, force, cycle);
            core.note(change, cycle);
        }
    }

    fn reschedule(&self, core: &mut Core) {
        let running = self.next.filter(|_| self.stopped.is_none());
        core.schedule.set(Source::Twi, running);
        let requested = self.flag && self.control & TWIE != 0;
        core.interrupts.set(core.model.numbers.twi, requested);
    }

    /// It has a clock from now on, or has none.
    pub(super) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        match self.stopped {
            None if !runs => self.stopped = Some(cycle),
            Some(stopped) if runs => {
                self.stopped = None;
                if let Some(next) = &mut self.next {
                    *next += cycle - stopped;
                }
            }
            _ => return,
        }
        self.reschedule(core);
    }

    pub(super) fn reset(&mut self, core: &mut Core, cycle: u64) {
        self.reply = None;
        self.pull(core, cycle);
        *self = Twi::default();
        self.reschedule(core);
    }
}
