//! The EEPROM and its registers (2549Q, sections 8.3 and 9.2.1).
//!
//! A write is armed by EEMPE and begun by EEPE within four cycles. It proceeds while the program runs on; a byte read
//! takes none, but the CPU stands for four cycles.

use super::Core;
use super::schedule::Source;
use crate::model::Model;
use crate::registers::{EEARH, EEARL, EECR, EEDR};

const EERE: u8 = 0x01;
const EEPE: u8 = 0x02;
const EEMPE: u8 = 0x04;
const EERIE: u8 = 0x08;
const EEPM: u8 = 0x30;

/// Cycles for which EEMPE arms.
const ARMED_CYCLES: u64 = 4;
/// Cycles for which the CPU stands after a read and after the start of a write.
const READ_STALL: u64 = 4;
const WRITE_STALL: u64 = 2;
/// Table 8-1: 3.4 ms to erase and write, 1.8 ms for either alone [cycles of the crystal].
const ERASE_AND_WRITE_CYCLES: u64 = 54_400;
const HALF_CYCLES: u64 = 28_800;

/// A write on its way.
#[derive(Clone, Copy, Debug)]
struct Write {
    address: usize,
    value: u8,
    /// The time when it is done.
    end: u64,
}

/// The memory with its registers.
#[derive(Clone, Debug, Default)]
pub(super) struct Eeprom {
    pub(super) bytes: Box<[u8]>,
    address: u16,
    data: u8,
    /// EERIE and EEPM.
    control: u8,
    armed_until: Option<u64>,
    write: Option<Write>,
}

impl Eeprom {
    /// Erased.
    pub(super) fn new(model: &Model) -> Eeprom {
        Eeprom {
            bytes: vec![0xFF; model.eeprom_bytes].into(),
            ..Eeprom::default()
        }
    }

    /// The registers start over; what is in the cells stays, and a write that has begun is finished.
    pub(super) fn reset(&mut self) {
        self.finish();
        *self = Eeprom {
            bytes: std::mem::take(&mut self.bytes),
            ..Eeprom::default()
        };
    }

    /// The write is over.
    fn finish(&mut self) {
        if let Some(Write { address, value, .. }) = self.write.take() {
            self.bytes[address] = value;
        }
    }

    /// The last address.
    fn last(&self) -> u16 {
        (self.bytes.len() - 1) as u16
    }

    /// A write is on its way.
    pub(super) fn is_busy(&self) -> bool {
        self.write.is_some()
    }

    fn armed(&self, cycle: u64) -> bool {
        self.armed_until.is_some_and(|until| cycle <= until)
    }

    /// EECR reads the same from `cycle` on until something happens.
    pub(super) fn is_steady(&self, cycle: u64) -> bool {
        !self.armed(cycle)
    }

    pub(super) fn read(&self, address: u16, cycle: u64) -> u8 {
        let [low, high] = self.address.to_le_bytes();
        match address {
            EECR => {
                let armed = if self.armed(cycle) { EEMPE } else { 0 };
                let busy = if self.is_busy() { EEPE } else { 0 };
                self.control | armed | busy
            }
            EEDR => self.data,
            EEARL => low,
            EEARH => high,
            _ => 0,
        }
    }

    pub(super) fn write(&mut self, core: &mut Core, address: u16, value: u8, cycle: u64) {
        let [low, high] = self.address.to_le_bytes();
        match address {
            EECR => self.command(core, value, cycle),
            EEDR => self.data = value,
            // During a write the address is held.
            EEARL if !self.is_busy() => self.address = u16::from_le_bytes([value, high]),
            EEARH if !self.is_busy() => {
                self.address = u16::from_le_bytes([low, value]) & self.last()
            }
            _ => {}
        }
    }

    fn command(&mut self, core: &mut Core, value: u8, cycle: u64) {
        let armed = self.armed(cycle);
        let modes = if self.is_busy() { self.control } else { value } & EEPM;
        self.control = value & EERIE | modes;
        if value & EERE != 0 && !self.is_busy() {
            self.data = self.bytes[usize::from(self.address)];
            core.stall(READ_STALL);
        }
        if value & EEPE != 0 && armed && !self.is_busy() {
            self.begin(core, cycle);
        } else if value & EEMPE != 0 && !armed {
            self.armed_until = Some(cycle + ARMED_CYCLES);
        }
        self.request(core);
    }

    fn begin(&mut self, core: &mut Core, cycle: u64) {
        let address = usize::from(self.address);
        let (value, cycles) = match self.control & EEPM {
            0x10 => (0xFF, HALF_CYCLES),
            // Without erasing, a write can only clear bits.
            0x20 => (self.bytes[address] & self.data, HALF_CYCLES),
            _ => (self.data, ERASE_AND_WRITE_CYCLES),
        };
        self.write = Some(Write {
            address,
            value,
            end: core.clock.time(cycle) + cycles,
        });
        self.armed_until = None;
        self.reschedule(core);
        core.stall(WRITE_STALL);
    }

    pub(super) fn reschedule(&self, core: &mut Core) {
        let due = self.write.map(|write| core.clock.cycle(write.end));
        core.schedule.set(Source::Eeprom, due);
    }

    /// The write's end is due.
    pub(super) fn happen(&mut self, core: &mut Core) {
        self.finish();
        self.reschedule(core);
        self.request(core);
    }

    fn request(&self, core: &mut Core) {
        let requested = self.control & EERIE != 0 && !self.is_busy();
        core.interrupts
            .set(core.model.numbers.eeprom_ready, requested);
    }
}
