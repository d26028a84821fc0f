//! How rounds begin and end, and what the next ones begin with by that.

use super::{Alike, LANES, Lane, Lanes, REGISTERS, Ran};
use crate::cpu::uses::{N, S, V};
use std::ops::Range;

const FLAGS: Range<usize> = 0..6;

/// How rounds begin: what differs from round to round, and flags that are not as in the round that ran.
pub(super) struct Heads {
    /// And behind them C, Z, N, V, nothing for S, and H.
    pub(super) registers: Vec<(usize, Lane)>,
    pub(super) cells: Vec<(u16, Lane)>,
}

pub(super) fn find<K: PartialEq + Copy>(lanes: &[(K, Lane)], key: K) -> Option<&Lane> {
    let found = lanes.iter().find(|(other, _)| *other == key);
    found.map(|(_, values)| values)
}

fn series(start: u8, step: u8) -> Lane {
    let mut values = [start; LANES];
    for (lane, value) in values.iter_mut().enumerate() {
        *value = value.wrapping_add(step.wrapping_mul(lane as u8));
    }
    values
}

impl Heads {
    /// Each byte goes on as it did in the round that ran.
    pub(super) fn guess(ran: &Ran<'_>) -> Heads {
        let changed = (0..32).filter(|register| ran.change(*register) != 0);
        let registers = changed.map(|register| {
            let now = ran.cpu.registers()[register];
            (register, series(now, ran.change(register)))
        });
        let now = ran.cpu.status.bits();
        let flags = FLAGS.filter(|bit| (ran.changed_flags() & !S) >> bit & 1 != 0);
        let flags = flags.map(|bit| (REGISTERS + bit, [now >> bit & 1; LANES]));
        let stores = ran
            .stores
            .iter()
            .filter(|store| ran.change_of(**store) != 0);
        let cells = stores.map(|store| (store.0, series(ran.cell(store.0), ran.change_of(*store))));
        Heads {
            registers: registers.chain(flags).collect(),
            cells: cells.collect(),
        }
    }

    /// What matters of the last rounds' head.
    pub(super) fn last(&self, lanes: &Lanes) -> Alike {
        let lane = lanes.alike - 1;
        let registers = self.registers.iter();
        let registers = registers.filter(|(key, _)| lanes.matters(*key));
        let cells = self.cells.iter();
        let cells = cells.filter(|(address, _)| lanes.loaded.contains(address));
        Alike {
            rounds: lanes.alike as u64,
            registers: registers
                .map(|(key, values)| (*key, values[lane]))
                .collect(),
            cells: cells.map(|(key, values)| (*key, values[lane])).collect(),
        }
    }
}

/// Of each byte how the rounds began, and how they ended.
struct Ends {
    registers: Vec<(usize, Lane, Lane)>,
    cells: Vec<(u16, Lane, Lane)>,
}

impl Lanes {
    /// A register, or a flag behind them, was read before it was written. S is N and V.
    fn matters(&self, key: usize) -> bool {
        match key.checked_sub(REGISTERS) {
            None => self.read >> key & 1 != 0,
            Some(bit) => {
                let either = if self.tested & S != 0 { N | V } else { 0 };
                ((self.tested | either) & !S) >> bit & 1 != 0
            }
        }
    }

    /// Of all that matters how each round began, and how it ended.
    fn ends(&self, ran: &Ran<'_>, heads: &Heads) -> Ends {
        let register = |key: usize| {
            let bit = key.wrapping_sub(REGISTERS) as u8;
            let (now, end) = match ran.cpu.registers().get(key) {
                Some(now) if self.varying >> key & 1 != 0 => (*now, self.values[key]),
                Some(now) => (*now, [*now; LANES]),
                None => (
                    ran.cpu.status.bit(bit).into(),
                    self.flag(ran.cpu.status, bit),
                ),
            };
            let head = find(&heads.registers, key).copied();
            (key, head.unwrap_or([now; LANES]), end)
        };
        let cell = |address: &u16| {
            let now = [ran.cell(*address); LANES];
            let head = find(&heads.cells, *address).copied().unwrap_or(now);
            (*address, head, self.cell(*address).copied().unwrap_or(now))
        };
        let differs = |key: &usize| {
            let ends_so = match key.checked_sub(REGISTERS) {
                None => self.varying >> key & 1 != 0,
                Some(bit) => self.varying_flags() >> bit & 1 != 0,
            };
            self.matters(*key) && (ends_so || find(&heads.registers, *key).is_some())
        };
        let keys = 0..REGISTERS + FLAGS.end;
        Ends {
            registers: keys.filter(differs).map(register).collect(),
            cells: self.loaded.iter().map(cell).collect(),
        }
    }

    /// The heads if each round changes what it began with as it did here, or leaves what it left here.
    pub(super) fn summed(&self, ran: &Ran<'_>, heads: &Heads) -> Heads {
        let sum = |head: &Lane, end: &Lane, is_flag: bool| {
            let mut next = [head[0]; LANES];
            if is_flag || self.all(end, end[0]) {
                next[1..].copy_from_slice(&end[..LANES - 1]);
                return next;
            }
            for lane in 1..LANES {
                let change = end[lane - 1].wrapping_sub(head[lane - 1]);
                next[lane] = next[lane - 1].wrapping_add(change);
            }
            next
        };
        let ends = self.ends(ran, heads);
        let registers = ends.registers.iter();
        let cells = ends.cells.iter();
        Heads {
            registers: registers
                .map(|(key, head, end)| (*key, sum(head, end, *key >= REGISTERS)))
                .collect(),
            cells: cells
                .map(|(key, head, end)| (*key, sum(head, end, false)))
                .collect(),
        }
    }

    /// The heads of the rounds after the last.
    pub(super) fn next(&self, ran: &Ran<'_>, heads: &Heads) -> Heads {
        let ends = self.ends(ran, heads);
        let go_on = |end: &Lane| {
            let last = end[LANES - 1];
            series(last, last.wrapping_sub(end[LANES - 2]))
        };
        let registers = ends.registers.iter();
        let cells = ends.cells.iter();
        Heads {
            registers: registers.map(|(key, _, end)| (*key, go_on(end))).collect(),
            cells: cells.map(|(key, _, end)| (*key, go_on(end))).collect(),
        }
    }

    /// At its end a round must leave what the next one begins with, where that matters.
    pub(super) fn keep_those_that_go_on(&mut self, ran: &Ran<'_>, heads: &Heads) {
        let ends = self.ends(ran, heads);
        let registers = ends.registers.iter().map(|(_, head, end)| (head, end));
        let cells = ends.cells.iter().map(|(_, head, end)| (head, end));
        for (head, end) in registers.chain(cells) {
            self.keep(|_, lane| lane == 0 || head[lane] == end[lane - 1]);
        }
    }
}
