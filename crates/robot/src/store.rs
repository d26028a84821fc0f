//! Persistent parameters: two copies in the EEPROM, of which a save overwrites the inactive one.
//!
//! | byte of a copy | what |
//! |---|---|
//! | 0 | [`LAYOUT`] once all the rest is there; 0xFF before |
//! | 1 | number of the save, wrapping: of two good copies the later one counts |
//! | 2..6 | hash of the parameter table |
//! | 6.. | the values, `f32` in the order of their numbers |
//! | last 2 | CRC-16/MCRF4XX of all from byte 1 on |
//!
//! A save first marks its copy as unfinished, then writes it, and marks it as complete with the last byte; the other
//! copy is not touched. So whenever power fails, either the old or the new parameters are there. The EEPROM driver
//! takes a byte from here when the previous one is done; nothing waits for it.

use rumbo_control::params::{COUNT, ParamId, Params, SCHEMA};
use rumbo_wire::{Recalled, crc16};

/// Byte 0 of a whole copy: the version of this layout.
const LAYOUT: u8 = 1;
/// Byte 0 of an erased copy, and of one that is being written.
const UNFINISHED: u8 = 0xFF;
/// Where the values begin in a copy.
const VALUES: u16 = 6;
/// Where its CRC begins.
const CHECK: u16 = VALUES + 4 * COUNT as u16;
/// Bytes of a copy.
const LEN: u16 = CHECK + 2;
/// Where the copies begin. Not at 0, the address after a reset: a spurious write by a failing supply goes there.
const PLACES: [u16; 2] = [16, 2_064];
/// Address of the robot's start counter, which separates its times from those of other starts; maintained by the HAL.
pub const START_AT: u16 = 8;
const _: () = assert!(START_AT < PLACES[0]);
const _: () = assert!(PLACES[0] + LEN <= PLACES[1] && PLACES[1] + LEN <= 4_096 && COUNT < 256);
const CRC_START: u16 = 0xFFFF;

/// A byte for the EEPROM.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// Where, 0..4096.
    pub address: u16,
    /// What.
    pub value: u8,
}

/// State of a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Found {
    /// Never written, or its save was cut off.
    None,
    /// Damaged, or of another table of parameters.
    Bad,
    /// Valid, with its number.
    Good(u8),
}

/// Which copy is active, and the progress of a save.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Store {
    /// The second copy is active.
    second: bool,
    /// Its number.
    number: u8,
    /// Progress of a save: bytes handed out plus one; 0 without a save.
    step: u16,
    crc: u16,
}

impl Store {
    /// Reads the copies with `read` and loads the values of the active one into `params`. Returns which one it was;
    /// `None` if nothing has ever been saved.
    pub(crate) fn recall(
        &mut self,
        params: &mut Params,
        mut read: impl FnMut(u16) -> u8,
    ) -> Option<Recalled> {
        let [first, second] = PLACES;
        let found = [check(first, &mut read), check(second, &mut read)];
        let recalled = match found {
            [Found::None, Found::None] => return None,
            [Found::Good(first), Found::Good(second)] => {
                match second.wrapping_sub(first).cast_signed() > 0 {
                    true => Recalled::Second,
                    false => Recalled::First,
                }
            }
            [Found::Good(_), Found::None] => Recalled::First,
            [Found::None, Found::Good(_)] => Recalled::Second,
            [Found::Good(_), Found::Bad] => Recalled::FirstAlone,
            [Found::Bad, Found::Good(_)] => Recalled::SecondAlone,
            [Found::Bad | Found::None, Found::Bad | Found::None] => Recalled::Neither,
        };
        self.second = matches!(recalled, Recalled::Second | Recalled::SecondAlone);
        let [first, second] = found;
        if let Found::Good(number) = if self.second { second } else { first } {
            self.number = number;
            let mut at = PLACES[usize::from(self.second)] + VALUES;
            for number in 0..COUNT {
                let bytes = [read(at), read(at + 1), read(at + 2), read(at + 3)];
                at += 4;
                // The table is the same, so the value is within its limits; if it were not, the default would stay.
                if let Some(id) = ParamId::from_number(number as u8) {
                    let _ = params.set(id, f32::from_le_bytes(bytes));
                }
            }
        }
        Some(recalled)
    }

    /// Begins a save; restarts one in progress.
    pub(crate) fn save(&mut self) {
        self.step = 1;
    }

    /// A parameter has changed: restarts a save in progress, so that a save is consistent.
    pub(crate) fn changed(&mut self) {
        self.step = self.step.min(1);
    }

    /// The next byte of a save, once the previous one is done, or the end of the save.
    pub(crate) fn next(&mut self, params: &Params) -> (Option<Cell>, bool) {
        let at = match self.step {
            0 => return (None, false),
            step if step > LEN + 1 => {
                self.second = !self.second;
                self.number = self.number.wrapping_add(1);
                self.step = 0;
                return (None, true);
            }
            step => step - 1,
        };
        self.step += 1;
        let value = match at {
            0 => {
                self.crc = CRC_START;
                UNFINISHED
            }
            LEN => LAYOUT,
            _ => {
                let value = self.byte(at, params);
                self.crc = if at < CHECK {
                    crc16(self.crc, value)
                } else {
                    self.crc
                };
                value
            }
        };
        // The last step is byte 0 again.
        let offset = if at == LEN { 0 } else { at };
        let address = PLACES[usize::from(!self.second)] + offset;
        (Some(Cell { address, value }), false)
    }

    fn byte(&self, at: u16, params: &Params) -> u8 {
        let (bytes, index) = match at {
            ..2 => return self.number.wrapping_add(1),
            2..VALUES => (SCHEMA.to_le_bytes(), at - 2),
            VALUES..CHECK => {
                let number = (at - VALUES) / 4;
                let id = ParamId::from_number((number & 0xFF) as u8);
                let value = id.map_or(0.0, |id| params.get(id));
                (value.to_le_bytes(), (at - VALUES) % 4)
            }
            CHECK.. => {
                let [low, high] = self.crc.to_le_bytes();
                ([low, high, 0, 0], at - CHECK)
            }
        };
        bytes.get(usize::from(index)).copied().unwrap_or(0)
    }
}

/// State of the copy at `place`.
fn check(place: u16, read: &mut impl FnMut(u16) -> u8) -> Found {
    match read(place) {
        LAYOUT => {}
        UNFINISHED => return Found::None,
        _ => return Found::Bad,
    }
    let mut crc = CRC_START;
    let mut schema = [0; 4];
    for at in 1..CHECK {
        let byte = read(place + at);
        crc = crc16(crc, byte);
        if let Some(slot) = schema.get_mut(usize::from(at.wrapping_sub(2))) {
            *slot = byte;
        }
    }
    let stored = [read(place + CHECK), read(place + CHECK + 1)];
    if stored == crc.to_le_bytes() && schema == SCHEMA.to_le_bytes() {
        Found::Good(read(place + 1))
    } else {
        Found::Bad
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec;
    use std::vec::Vec;

    const EEPROM: usize = 4_096;

    fn recalled(memory: &[u8]) -> (Store, Params, Option<Recalled>) {
        let (mut store, mut params) = (Store::default(), Params::default());
        let recalled = store.recall(&mut params, |at| memory[usize::from(at)]);
        (store, params, recalled)
    }

    /// The bytes of a save, in their order.
    fn save(store: &mut Store, params: &Params) -> Vec<Cell> {
        store.save();
        let mut cells = Vec::new();
        loop {
            match store.next(params) {
                (Some(cell), _) => cells.push(cell),
                (None, done) => {
                    assert!(done);
                    return cells;
                }
            }
        }
    }

    fn write(memory: &mut [u8], cells: &[Cell]) {
        for cell in cells {
            memory[usize::from(cell.address)] = cell.value;
        }
    }

    fn with_base(base_m: f32) -> Params {
        let mut params = Params::default();
        params.set(ParamId::Base, base_m).unwrap();
        params
    }

    /// A memory after saves of these bases [m], one after the other.
    fn saved(bases_m: &[f32]) -> (Vec<u8>, Store) {
        let (mut memory, mut store) = (vec![0xFF; EEPROM], Store::default());
        for base_m in bases_m {
            let cells = save(&mut store, &with_base(*base_m));
            write(&mut memory, &cells);
        }
        (memory, store)
    }

    #[test]
    fn an_erased_memory_gives_the_defaults_and_is_no_news() {
        let (_, params, recalled) = recalled(&[0xFF; EEPROM]);
        assert_eq!((params, recalled), (Params::default(), None));
    }

    #[test]
    fn the_last_of_many_saves_counts_also_where_their_number_wraps() {
        for saves in [1, 2, 3, 255, 256, 257, 600] {
            let bases: Vec<f32> = (0..saves).map(|n| 0.1 + n as f32 * 1e-3).collect();
            let (_, params, recalled) = recalled(&saved(&bases).0);
            assert_eq!(params, with_base(bases[saves - 1]), "{saves}");
            let copy = if saves % 2 == 0 {
                Recalled::First
            } else {
                Recalled::Second
            };
            assert_eq!(recalled, Some(copy));
        }
    }

    #[test]
    fn a_power_cut_after_any_byte_of_a_save_leaves_the_values_of_before_or_of_after() {
        let (memory, mut store) = saved(&[0.11, 0.12]);
        let cells = save(&mut store, &with_base(0.13));
        for cut in 0..=cells.len() {
            // Whatever the byte held when power failed.
            for torn in [None, Some(0x00), Some(LAYOUT), Some(0x5A)] {
                let mut memory = memory.clone();
                write(&mut memory, &cells[..cut]);
                if let (Some(cell), Some(value)) = (cells.get(cut), torn) {
                    memory[usize::from(cell.address)] = value;
                }
                let (_, params, _) = recalled(&memory);
                let after = params == with_base(0.13);
                assert!(after || params == with_base(0.12), "{cut} {torn:?}");
                assert!(!after || cut + 1 >= cells.len());
            }
        }
    }

    #[test]
    fn a_copy_with_any_byte_flipped_is_not_used_and_that_is_reported() {
        let (memory, _) = saved(&[0.11, 0.12]);
        for at in 0..LEN {
            let mut memory = memory.clone();
            memory[usize::from(PLACES[0] + at)] ^= 0x10;
            let (_, params, recalled) = recalled(&memory);
            // The first copy is the newer one.
            assert_eq!(params, with_base(0.11), "{at}");
            assert_eq!(recalled, Some(Recalled::SecondAlone), "{at}");
        }
    }

    #[test]
    fn two_bad_copies_give_the_defaults_and_that_is_reported() {
        let (mut memory, _) = saved(&[0.11, 0.12]);
        memory[100] ^= 1;
        memory[2_148] ^= 1;
        let (_, params, recalled) = recalled(&memory);
        assert_eq!(
            (params, recalled),
            (Params::default(), Some(Recalled::Neither))
        );
    }

    #[test]
    fn a_value_that_changes_during_a_save_restarts_it() {
        let (mut memory, mut store) = saved(&[0.11]);
        store.save();
        for _ in 0..200 {
            let (cell, _) = store.next(&with_base(0.12));
            write(&mut memory, cell.as_slice());
        }
        store.changed();
        loop {
            let (cell, done) = store.next(&with_base(0.13));
            write(&mut memory, cell.as_slice());
            if done {
                break;
            }
        }
        let (_, params, _) = recalled(&memory);
        assert_eq!(params, with_base(0.13));
        // Without a save in progress there is nothing to restart.
        store.changed();
        assert_eq!(store.next(&params), (None, false));
    }
}
