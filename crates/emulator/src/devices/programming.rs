//! Self-programming: SPM, the page buffer, fuses and signature as a program reads them (2549Q, section 29).
//!
//! SPM works from the boot section only, within four cycles after SPMCSR selected the operation. While a page outside
//! the last 8 KB is erased or written the program runs on, but cannot use that part of flash; for the last 8 KB the CPU
//! stalls.

use super::Core;
use super::schedule::Source;
use crate::io::{Access, Stored};
use crate::model::{Fuses, Model};

const SPMIE: u8 = 0x80;
const RWWSB: u8 = 0x40;
const SIGRD: u8 = 0x20;
const RWWSRE: u8 = 0x10;
const BLBSET: u8 = 0x08;
const PGWRT: u8 = 0x04;
const PGERS: u8 = 0x02;
const SPMEN: u8 = 0x01;

/// Cycles in which SPM must follow, and LPM that reads fuses or signature.
const OPEN_CYCLES: u64 = 4;
/// Erasing or writing a page: 4.5 ms (table 29-11) [cycles of the crystal].
const PAGE_CYCLES: u64 = 72_000;
/// Where the signature row has the calibration of the oscillator, and what it is there.
const CALIBRATION: (u32, u8) = (1, 0x8D);

/// Registers and buffer.
#[derive(Clone, Debug)]
pub(super) struct Programming {
    model: &'static Model,
    pub(super) fuses: Fuses,
    control: u8,
    /// Until when SPMCSR's selection holds for SPM and LPM.
    open_until: u64,
    /// A page is being erased or written, and it is done at this time.
    busy: Option<u64>,
    /// A page.
    buffer: Box<[Option<u16>]>,
}

impl Programming {
    pub(super) fn new(model: &'static Model) -> Programming {
        Programming {
            model,
            fuses: model.fuses,
            control: 0,
            open_until: 0,
            busy: None,
            buffer: vec![None; model.page_words].into(),
        }
    }

    /// Where the boot section starts [words].
    pub(super) fn boot_start(&self) -> u32 {
        self.model.boot_start(self.fuses)
    }

    /// Starts over; fuses stay.
    pub(super) fn reset(&mut self, core: &mut Core) {
        *self = Programming {
            fuses: self.fuses,
            ..Programming::new(self.model)
        };
        core.schedule.set(Source::Programming, None);
    }

    fn is_open(&self, cycle: u64) -> bool {
        self.busy.is_some() || self.control & SPMEN != 0 && cycle <= self.open_until
    }

    pub(super) fn read(&self, cycle: u64) -> u8 {
        let lasting = self.control & (SPMIE | RWWSB);
        if self.is_open(cycle) {
            self.control
        } else {
            lasting
        }
    }

    pub(super) fn write(&mut self, core: &mut Core, value: u8, cycle: u64) {
        if self.busy.is_some() {
            return;
        }
        self.control = value & !RWWSB | self.control & RWWSB;
        self.open_until = cycle + OPEN_CYCLES;
        self.request(core);
    }

    fn request(&self, core: &mut Core) {
        let ready = self.control & SPMIE != 0 && self.busy.is_none();
        core.interrupts.set(core.model.numbers.programmed, ready);
    }

    /// SPM at a byte address.
    pub(super) fn store(
        &mut self,
        core: &mut Core,
        address: u32,
        value: u16,
        at: Access,
    ) -> Stored {
        let from_boot = at.program_counter >= self.boot_start();
        if self.busy.is_some() || !from_boot || !self.is_open(at.cycle) {
            return Stored::Nothing;
        }
        let word = address / 2;
        let words = self.buffer.len();
        let page = word / words as u32 * words as u32;
        let command = self.control & (SIGRD | RWWSRE | BLBSET | PGWRT | PGERS | SPMEN);
        self.control &= !(SIGRD | RWWSRE | BLBSET | PGWRT | PGERS | SPMEN);
        match command {
            SPMEN => {
                // A word of the buffer is written once.
                let place = &mut self.buffer[word as usize % words];
                place.get_or_insert(value);
                Stored::Nothing
            }
            0x03 => {
                self.begin(core, command, page, at.cycle);
                Stored::Erased(page)
            }
            0x05 => {
                self.begin(core, command, page, at.cycle);
                let words = self.buffer.iter();
                let words = words.map(|word| word.unwrap_or(0xFFFF)).collect();
                self.buffer.fill(None);
                Stored::Written(page, words)
            }
            0x11 => {
                self.control &= !RWWSB;
                self.buffer.fill(None);
                Stored::Nothing
            }
            0x09 => {
                // Lock bits can only be programmed.
                self.fuses.lock &= value.to_le_bytes()[0] | 0xC3;
                Stored::Nothing
            }
            _ => Stored::Nothing,
        }
    }

    fn begin(&mut self, core: &mut Core, command: u8, page: u32, cycle: u64) {
        if page >= self.model.no_read_while_write {
            core.stall(core.clock.cycles(PAGE_CYCLES));
            return;
        }
        self.busy = Some(core.clock.time(cycle) + PAGE_CYCLES);
        self.control |= command | RWWSB;
        self.reschedule(core);
        self.request(core);
    }

    pub(super) fn reschedule(&self, core: &mut Core) {
        let due = self.busy.map(|end| core.clock.cycle(end));
        core.schedule.set(Source::Programming, due);
    }

    /// The page is done.
    pub(super) fn happen(&mut self, core: &mut Core) {
        self.busy = None;
        self.control &= SPMIE | RWWSB;
        self.reschedule(core);
        self.request(core);
    }

    /// What LPM reads at a byte address in place of the program.
    pub(super) fn load(&mut self, address: u32, cycle: u64) -> Option<u8> {
        let command = self.control & (SIGRD | BLBSET);
        if self.busy.is_none() && self.is_open(cycle) && command != 0 {
            self.control &= !(SIGRD | BLBSET | SPMEN);
            let index = address & 7;
            return Some(if command & BLBSET != 0 {
                let Fuses {
                    low,
                    high,
                    extended,
                    lock,
                } = self.fuses;
                [low, lock, extended, high][index as usize & 3]
            } else if index == CALIBRATION.0 {
                CALIBRATION.1
            } else {
                let byte = self.model.signature.get(index as usize / 2);
                byte.copied()
                    .filter(|_| index.is_multiple_of(2))
                    .unwrap_or(0xFF)
            });
        }
        let held = self.control & RWWSB != 0 && address / 2 < self.model.no_read_while_write;
        held.then_some(0xFF)
    }
}
