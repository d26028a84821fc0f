//! The next rounds of a loop that counts or reads a running counter, all at once.
//!
//! Such rounds go the same way, with some bytes different in each. So one that has run is done again for many at a time:
//! what it read and every round finds the same, stays as it was; of the rest there is one value for each round, a lane.
//! How the rounds begin is a guess: each byte goes on as it did in the last round, or, in a second attempt, as the rounds
//! of the first one changed it, which knows of carries. It is right where each round leaves what the next one begins
//! with. The rounds up to the first that branches otherwise, or begins otherwise, are alike.
//!
//! Only bytes that a round reads before it writes them matter, which is known at its end. The others are right again
//! after one more round, which therefore must not be left out.

mod compute;
mod heads;

use super::Cpu;
use super::touch::{Touch, touch};
use super::uses::{I, T, uses};
use crate::decode::{Code, Op};
use crate::io::Io;
use crate::registers::SREG;
use crate::status::Status;
use heads::{Heads, find};

/// Rounds at a time.
const LANES: usize = 128;
/// How often heads are guessed.
const ATTEMPTS: usize = 3;
/// Keys of flags are behind those of registers.
const REGISTERS: usize = 32;
/// Fewer are not worth it.
const LEAST: u64 = 4;
/// Bytes of SRAM with values of their own in each round, at most.
const CELLS: usize = 12;

type Lane = [u8; LANES];

/// An instruction of the round, and what was before it.
#[derive(Clone, Debug)]
pub(super) struct Step {
    op: Op,
    pub(super) cycle: u64,
    registers: [u8; 32],
    status: Status,
    pub(super) touch: Option<Touch>,
}

impl Step {
    /// The one that the CPU is about to run.
    pub(super) fn next(cpu: &Cpu, op: Op) -> Step {
        Step {
            op,
            cycle: cpu.cycle,
            registers: *cpu.registers(),
            status: cpu.status,
            touch: touch(cpu, op),
        }
    }

    /// The cycle in which a load or IN reads.
    fn read_cycle(&self) -> u64 {
        self.cycle + u64::from(!matches!(self.op.code, Code::In | Code::Sbic | Code::Sbis))
    }
}

/// A round that has just run, and what it changed.
pub(super) struct Ran<'a> {
    pub(super) steps: &'a [Step],
    pub(super) cpu: &'a Cpu,
    /// Bytes of SRAM that it wrote, each once, and what was there before.
    pub(super) stores: &'a [(u16, u8)],
}

/// Rounds that are alike, and how the last of them begins where that matters.
#[derive(Default)]
pub(super) struct Alike {
    pub(super) rounds: u64,
    pub(super) registers: Vec<(usize, u8)>,
    pub(super) cells: Vec<(u16, u8)>,
}

impl Ran<'_> {
    /// How many rounds until `limit` are like this one, if they take at least `span` cycles.
    pub(super) fn alike<I: Io>(&self, io: &I, limit: u64, span: u64) -> Option<Alike> {
        let period = self.cpu.cycle - self.steps.first()?.cycle;
        let fit = limit.saturating_sub(self.cpu.cycle) / period;
        let least = LEAST.max(span / period);
        if fit < least {
            return None;
        }
        let mut alike = Alike::default();
        let (mut lanes, mut heads) = (Lanes::default(), Heads::guess(self));
        loop {
            let count = (fit - alike.rounds).min(LANES as u64) as usize;
            lanes.begin = self.cpu.cycle + alike.rounds * period;
            let Some((last, next)) = lanes.best(self, io, heads, count) else {
                break;
            };
            alike = Alike {
                rounds: last.rounds.saturating_add(alike.rounds).min(fit),
                ..last
            };
            match next {
                Some(next) if alike.rounds < fit => heads = next,
                _ => break,
            }
        }
        (alike.rounds >= least).then_some(alike)
    }

    /// How a register, and a byte of SRAM that it had found so, changed.
    fn change(&self, register: usize) -> u8 {
        let now = self.cpu.registers()[register];
        let first = self.steps.first();
        first.map_or(0, |step| now.wrapping_sub(step.registers[register]))
    }

    fn changed_flags(&self) -> u8 {
        let now = self.cpu.status.bits();
        let first = self.steps.first();
        first.map_or(0, |step| step.status.bits() ^ now)
    }

    fn change_of(&self, (address, before): (u16, u8)) -> u8 {
        self.cell(address).wrapping_sub(before)
    }

    fn cell(&self, address: u16) -> u8 {
        self.cpu.in_sram(address).unwrap_or_default()
    }
}

/// Rounds side by side.
struct Lanes {
    /// When the first one begins.
    begin: u64,
    /// Something that differs was read.
    varied: bool,
    /// As many go the same way up to here.
    alike: usize,
    /// The registers that differ from round to round, and their values.
    varying: u32,
    values: [Lane; 32],
    /// The same of the flags C, Z, N, V and H, each 0 or 1; S follows from N and V.
    flags_put: u8,
    flags: [Lane; 6],
    /// Bytes of SRAM that differ.
    cells: Vec<(u16, Lane)>,
    /// What has been written, and what was read before that: of SRAM, what is written later.
    written: u32,
    read: u32,
    set: u8,
    tested: u8,
    stored: Vec<u16>,
    loaded: Vec<u16>,
    /// The high bytes of counters whose low bytes were read, by their addresses.
    latches: Vec<(u16, Lane)>,
}

impl Default for Lanes {
    fn default() -> Lanes {
        Lanes {
            begin: 0,
            varied: false,
            alike: 0,
            varying: 0,
            values: [[0; LANES]; 32],
            flags_put: 0,
            flags: [[0; LANES]; 6],
            cells: Vec::new(),
            written: 0,
            read: 0,
            set: 0,
            tested: 0,
            stored: Vec::new(),
            loaded: Vec::new(),
            latches: Vec::new(),
        }
    }
}

impl Lanes {
    /// Begins with these heads.
    fn restart(&mut self, heads: &Heads, count: usize) {
        self.alike = count;
        (self.varying, self.flags_put) = (0, 0);
        for (register, values) in &heads.registers {
            self.put(*register, *values);
        }
        self.cells.clone_from(&heads.cells);
        (self.written, self.read, self.set, self.tested) = (0, 0, 0, 0);
        self.stored.clear();
        self.loaded.clear();
        self.latches.clear();
    }

    /// The most rounds that are alike, by these heads or by those that follow from them; and if these are all, the heads of
    /// those after them.
    fn best<I: Io>(
        &mut self,
        ran: &Ran<'_>,
        io: &I,
        mut heads: Heads,
        count: usize,
    ) -> Option<(Alike, Option<Heads>)> {
        let mut best: Option<(Alike, Option<Heads>)> = None;
        for _ in 0..ATTEMPTS {
            self.restart(&heads, count);
            if self.run(ran, io).is_none() {
                break;
            }
            let same_way = self.alike;
            if !self.varied {
                let same = Alike {
                    rounds: u64::MAX,
                    ..Alike::default()
                };
                return Some((same, None));
            }
            self.keep_those_that_go_on(ran, &heads);
            let rounds = best.as_ref().map_or(0, |(best, _)| best.rounds);
            if self.alike as u64 > rounds {
                let next = (self.alike == LANES).then(|| self.next(ran, &heads));
                best = Some((heads.last(self), next));
            }
            if self.alike == same_way {
                break;
            }
            self.alike = same_way;
            heads = self.summed(ran, &heads);
        }
        best
    }

    /// Does all instructions; `None` if the rounds cannot be done together.
    fn run<I: Io>(&mut self, ran: &Ran<'_>, io: &I) -> Option<()> {
        for (index, step) in ran.steps.iter().enumerate() {
            let after = match ran.steps.get(index + 1) {
                Some(next) => (&next.registers, next.status),
                None => (ran.cpu.registers(), ran.cpu.status),
            };
            self.step(ran, io, step, after)?;
            if self.alike == 0 || self.cells.len() > CELLS {
                return None;
            }
        }
        // T and I have no lanes.
        (ran.changed_flags() & self.tested & (T | I) == 0).then_some(())
    }

    fn step<I: Io>(
        &mut self,
        ran: &Ran<'_>,
        io: &I,
        step: &Step,
        after: (&[u8; 32], Status),
    ) -> Option<()> {
        // N, V and S each on its own.
        if matches!(step.op.code, Code::Bset | Code::Bclr) && matches!(step.op.a, 2..5) {
            return None;
        }
        let mut uses = uses(step.op);
        let mut varies = false;
        match step.touch {
            Some(touch) if touch.address == SREG => {
                uses.tests |= if touch.reads { 0xFF } else { 0 };
                uses.sets |= if touch.writes { 0xFF } else { 0 };
            }
            Some(touch) if touch.reads => varies = self.load(ran, io, step, touch)?,
            _ => {}
        }
        self.read |= uses.reads & !self.written;
        self.tested |= uses.tests & !self.set;
        self.written |= uses.writes;
        self.set |= uses.sets;
        varies |= self.varying & uses.reads != 0 || self.varying_flags() & uses.tests != 0;
        self.varied |= varies;
        if varies {
            self.compute(step, after)?;
        } else {
            self.varying &= !uses.writes;
            self.flags_put &= !uses.sets;
        }
        if let Some(touch) = step.touch
            && touch.writes
            && touch.address != SREG
        {
            self.store(step, touch);
        }
        Some(())
    }

    /// Reads from the data space; returns whether that differs from round to round, then as a cell, or as values of
    /// the destination.
    fn load<I: Io>(&mut self, ran: &Ran<'_>, io: &I, step: &Step, touch: Touch) -> Option<bool> {
        let mut varies = false;
        for address in (touch.address..).take(usize::from(touch.bytes)) {
            match ran.cpu.in_sram(address) {
                Some(_) => {
                    let known = self.stored.contains(&address) || self.loaded.contains(&address);
                    if !known && ran.stores.iter().any(|store| store.0 == address) {
                        self.loaded.push(address);
                    }
                    varies |= self.cell(address).is_some();
                }
                None if address < 32 => return None,
                None => varies |= self.count(ran, io, step, address)?,
            }
        }
        Some(varies)
    }

    /// Reads a counter, if this is one.
    fn count<I: Io>(&mut self, ran: &Ran<'_>, io: &I, step: &Step, address: u16) -> Option<bool> {
        let register = usize::from(step.op.a & 31);
        if let Some(values) = find(&self.latches, address).copied() {
            self.put(register, values);
            return Some(true);
        }
        if io.steady_until(address, step.cycle) > 0 {
            return Some(false);
        }
        let period = ran.cpu.cycle - ran.steps.first()?.cycle;
        let into = step.read_cycle() + period - ran.cpu.cycle;
        let counter = io.counter(address)?;
        let (mut low, mut high) = ([0; LANES], [0; LANES]);
        for lane in 0..self.alike {
            let Some(count) = counter.at(self.begin + into + period * lane as u64) else {
                self.alike = lane;
                break;
            };
            [low[lane], high[lane]] = count.to_le_bytes();
        }
        if counter.is_wide {
            let of_high = |other: &Step| {
                other
                    .touch
                    .is_some_and(|touch| touch.address == address + 1)
            };
            let mut steps = ran.steps.iter();
            // Before its low byte it is that of the round before.
            if steps.any(|other| other.cycle < step.cycle && of_high(other)) {
                return None;
            }
            self.latches.retain(|latch| latch.0 != address + 1);
            self.latches.push((address + 1, high));
        }
        self.put(register, low);
        Some(true)
    }

    fn cell(&self, address: u16) -> Option<&Lane> {
        find(&self.cells, address)
    }

    fn store(&mut self, step: &Step, touch: Touch) {
        for address in (touch.address..).take(usize::from(touch.bytes)) {
            self.stored.push(address);
            let register = usize::from(step.op.a & 31);
            self.cells.retain(|cell| cell.0 != address);
            if touch.bytes == 1 && self.varying >> register & 1 != 0 {
                self.cells.push((address, self.values[register]));
            }
        }
    }
}
