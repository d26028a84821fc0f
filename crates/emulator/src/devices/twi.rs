//! The two-wire interface on a bus with pull-ups and nobody else (DS40002549, section 24).
//!
//! A start condition succeeds, addresses and data are not acknowledged, what is read is ones. The lines rest high: their edges
//! are not made.

use super::Core;
use super::interrupts::vector;
use super::ports::{Force, Pin};
use super::schedule::Source;

const TWBR: u16 = 0xB8;
const TWSR: u16 = 0xB9;
const TWAR: u16 = 0xBA;
const TWDR: u16 = 0xBB;
const TWCR: u16 = 0xBC;
const TWAMR: u16 = 0xBD;

const TWINT: u8 = 0x80;
const TWEA: u8 = 0x40;
const TWSTA: u8 = 0x20;
const TWSTO: u8 = 0x10;
const TWWC: u8 = 0x08;
const TWEN: u8 = 0x04;
const TWIE: u8 = 0x01;

/// Status codes (tables 24-2 and 24-3).
const START: u8 = 0x08;
const REPEATED_START: u8 = 0x10;
const WRITE_ADDRESS_REFUSED: u8 = 0x20;
const DATA_REFUSED: u8 = 0x30;
const READ_ADDRESS_REFUSED: u8 = 0x48;
const READ_ACKNOWLEDGED: u8 = 0x50;
const READ_REFUSED: u8 = 0x58;
const NOTHING: u8 = 0xF8;

const LINES: [Pin; 2] = [Pin::at(3, 0), Pin::at(3, 1)];

/// What is on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Action {
    Start,
    Stop { then_start: bool },
    Byte { then: u8 },
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
    action: Option<(Action, u64)>,
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
            stopped: None,
        }
    }
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

    /// Cycles of a bit.
    fn period(&self) -> u64 {
        16 + 2 * u64::from(self.rate) * (1 << (2 * self.prescaler))
    }

    fn command(&mut self, core: &mut Core, value: u8, cycle: u64) {
        let was_on = self.control & TWEN != 0;
        self.control = value & (TWEA | TWSTA | TWSTO | TWEN | TWIE);
        let on = value & TWEN != 0;
        if on != was_on {
            let force = if on { Force::Input } else { Force::None };
            for pin in LINES {
                let change = core.ports.force(pin, force, cycle);
                core.note(change, cycle);
            }
        }
        if !on {
            self.action = None;
            self.flag = false;
            self.status = NOTHING;
            return;
        }
        // The flag, cleared by a one, sets the next action going.
        if value & TWINT == 0 {
            return;
        }
        self.flag = false;
        let bit = self.period();
        self.action = if value & TWSTO != 0 {
            let then_start = value & TWSTA != 0;
            Some((Action::Stop { then_start }, cycle + bit))
        } else if value & TWSTA != 0 {
            Some((Action::Start, cycle + bit))
        } else {
            self.next_byte()
                .map(|then| (Action::Byte { then }, cycle + 9 * bit))
        };
    }

    /// The status after a byte that follows the present one; `None` if the bus is not ours.
    fn next_byte(&self) -> Option<u8> {
        Some(match self.status {
            START | REPEATED_START if self.data & 1 != 0 => READ_ADDRESS_REFUSED,
            START | REPEATED_START => WRITE_ADDRESS_REFUSED,
            WRITE_ADDRESS_REFUSED | DATA_REFUSED => DATA_REFUSED,
            READ_ADDRESS_REFUSED | READ_ACKNOWLEDGED | READ_REFUSED => {
                if self.control & TWEA != 0 {
                    READ_ACKNOWLEDGED
                } else {
                    READ_REFUSED
                }
            }
            _ => return None,
        })
    }

    /// What was on its way is done.
    pub(super) fn happen(&mut self, core: &mut Core, cycle: u64) {
        match self.action.take().map(|(action, _)| action) {
            Some(Action::Stop { then_start }) => {
                self.status = NOTHING;
                self.control &= !TWSTO;
                if then_start {
                    self.action = Some((Action::Start, cycle + self.period()));
                }
            }
            Some(Action::Start) => {
                self.status = if self.status == NOTHING {
                    START
                } else {
                    REPEATED_START
                };
                self.flag = true;
            }
            Some(Action::Byte { then }) => {
                if matches!(then, READ_ACKNOWLEDGED | READ_REFUSED) {
                    self.data = 0xFF;
                }
                self.status = then;
                self.flag = true;
            }
            None => {}
        }
        self.reschedule(core);
    }

    fn reschedule(&self, core: &mut Core) {
        let running = self.action.filter(|_| self.stopped.is_none());
        core.schedule.set(Source::Twi, running.map(|(_, end)| end));
        let requested = self.flag && self.control & TWIE != 0;
        core.interrupts.set(vector::TWI, requested);
    }

    /// It has a clock from now on, or has none.
    pub(super) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        match self.stopped {
            None if !runs => self.stopped = Some(cycle),
            Some(stopped) if runs => {
                self.stopped = None;
                if let Some((_, end)) = &mut self.action {
                    *end += cycle - stopped;
                }
            }
            _ => return,
        }
        self.reschedule(core);
    }

    pub(super) fn reset(&mut self, core: &mut Core) {
        *self = Twi::default();
        self.reschedule(core);
    }
}
