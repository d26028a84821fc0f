//! Rounds that need not run again: behind an event that a loop does not look at, such as an interrupt that counts
//! elsewhere or the caller's end, it waits on as before.
//!
//! Of a closed round ([`super::wait`]) is kept what it began with and what it read. Where the loop begins with the same
//! and would read the same, its next rounds are that one.

use super::Cpu;
use super::lanes::Step;
use crate::io::{Access, Io};

/// What the CPU itself holds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Held {
    registers: [u8; 32],
    status: u8,
    stack_pointer: u16,
    extended: [u8; 2],
}

impl Held {
    pub(super) fn by(cpu: &Cpu) -> Held {
        Held {
            registers: *cpu.registers(),
            status: cpu.status.bits(),
            stack_pointer: cpu.stack_pointer(),
            extended: [cpu.rampz, cpu.eind],
        }
    }

    /// The stack, and what only long jumps change, are the CPU's.
    pub(super) fn is_level(&self, cpu: &Cpu) -> bool {
        self.stack_pointer == cpu.stack_pointer() && self.extended == [cpu.rampz, cpu.eind]
    }
}

/// A closed round.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    period: u64,
    held: Held,
    stack_known: bool,
    /// SRAM that it reads before it writes it.
    reads: Vec<(u16, u8)>,
    /// SRAM that it writes, as it leaves it.
    stores: Vec<(u16, u8)>,
    /// Registers of peripherals that it reads.
    peripherals: Vec<(u16, u8)>,
}

impl Kept {
    /// Of a round that has just closed and stored to `stores`. `None` where a peripheral is about to read otherwise, and
    /// with interrupts off, where the next event may be hidden.
    pub(super) fn of<I: Io>(
        cpu: &Cpu,
        io: &mut I,
        steps: &[Step],
        stores: Vec<(u16, u8)>,
    ) -> Option<Kept> {
        let period = cpu.cycle - steps.first()?.cycle;
        let (mut reads, mut peripherals) = (Vec::new(), Vec::new());
        let mut written = Vec::new();
        for touch in steps.iter().filter_map(|step| step.touch) {
            for address in (touch.address..).take(usize::from(touch.bytes)) {
                match cpu.in_sram(address) {
                    Some(_) if touch.writes => written.push(address),
                    Some(byte) if !written.contains(&address) => reads.push((address, byte)),
                    None if !cpu.has_own(address) => {
                        peripherals.push((address, cpu.steady(io, address)?.0));
                    }
                    _ => {}
                }
            }
        }
        let is_fit = cpu.status.interrupts && !cpu.programming;
        is_fit.then_some(Kept {
            period,
            held: Held::by(cpu),
            stack_known: cpu.stack_known,
            reads,
            stores,
            peripherals,
        })
    }

    /// How many such rounds follow before `limit`; `None` if the next one may be another.
    fn rounds<I: Io>(&self, cpu: &Cpu, io: &mut I, mut limit: u64) -> Option<u64> {
        let is_same =
            self.held == Held::by(cpu) && self.stack_known == cpu.stack_known && !cpu.programming;
        let mut reads = self.reads.iter();
        if !is_same || reads.any(|&(address, byte)| cpu.in_sram(address) != Some(byte)) {
            return None;
        }
        for &(address, byte) in &self.peripherals {
            let (now, until) = cpu.steady(io, address)?;
            if now != byte {
                return None;
            }
            limit = limit.min(until);
        }
        Some(limit.saturating_sub(cpu.cycle) / self.period)
    }
}

impl Cpu {
    /// At a known loop: leaves out its rounds before `limit` if they are as the kept one; returns whether they are.
    pub(super) fn recall<I: Io>(&mut self, io: &mut I, limit: u64, kept: &Kept) -> bool {
        let Some(rounds) = kept.rounds(self, io, limit) else {
            return false;
        };
        if rounds > 0 {
            for &(address, byte) in &kept.stores {
                let index = usize::from(address.wrapping_sub(self.sram_start));
                if let Some(place) = self.sram.get_mut(index) {
                    *place = byte;
                }
            }
            self.leave_out(rounds * kept.period);
        }
        true
    }

    /// What a peripheral's register reads from now on, and before which cycle.
    fn steady<I: Io>(&self, io: &mut I, address: u16) -> Option<(u8, u64)> {
        let until = io.steady_until(address, self.cycle);
        let at = Access {
            cycle: self.cycle,
            program_counter: self.program_counter,
        };
        (until > self.cycle).then(|| (io.read(address, at), until))
    }
}
