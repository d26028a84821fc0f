//! Programs that wait: a loop that comes round to the same state runs the same rounds until something happens, so all
//! but the last of them are left out.
//!
//! Now and then the CPU runs on instruction by instruction and keeps what it changes. Where registers, status, stack
//! pointer and memory are again what they were at the same instruction, and nothing was read that is going to be
//! different by then ([`Io::steady_until`]), the next rounds are copies of this one up to the next event. Where something
//! counts, or a running counter is read, as in `delay`, the next rounds that are alike are found by [`super::lanes`]. What a
//! caller can see is the same to the cycle. A search without success is tried again after a pause that grows.

use super::Cpu;
use super::lanes::{Alike, Ran, Step};
use super::recall::{Held, Kept};
use super::uses::S;
use crate::decode::{Code, Op};
use crate::io::Io;
use crate::registers::{EIND, RAMPZ, SPH, SPL, SREG};
use crate::status::Status;

/// Instructions of one search, and after how many without coming round it begins again from where it then is: where a
/// loop is known, and elsewhere; the next time after twice as many.
const SEARCH: usize = 320;
const PATIENCE: [usize; 2] = [128, 64];
/// Bytes stored in a round at most.
const STORES: usize = 64;
/// Shorter spans to the next event are not worth a search [cycles].
pub(super) const SPAN: u64 = 256;
/// Pauses after searches without success [cycles].
const PAUSE: u64 = 512;
const LONGEST_PAUSE: u64 = 1 << 19;
/// Loops that are known, and after how many searches in vain one is given up.
const LOOPS: usize = 8;
const FAILURES: u8 = 8;

/// Where to search: now and then wherever the program is, and at once where a loop begins that has waited before.
#[derive(Clone, Debug)]
pub(super) struct Search {
    not_before: u64,
    pause: u64,
    loops: Vec<Loop>,
    /// All of them are marked.
    marked: bool,
    /// The program has come to one of them.
    arrived: bool,
    /// Cycles of rounds that did not run.
    left_out: u64,
    /// Empty between searches: the room is kept.
    steps: Vec<Step>,
}

/// A loop that has waited.
#[derive(Clone, Debug)]
struct Loop {
    word: u32,
    failures: u8,
    /// Its last closed round that began there.
    kept: Option<Kept>,
}

impl Default for Search {
    fn default() -> Search {
        Search {
            not_before: 0,
            pause: PAUSE,
            loops: Vec::new(),
            marked: true,
            arrived: false,
            left_out: 0,
            steps: Vec::new(),
        }
    }
}

impl Search {
    /// Operations were decoded again, maybe a marked one, or one of a round that was kept.
    pub(super) fn unmark(&mut self) {
        self.marked = false;
        self.loops.iter_mut().for_each(|known| known.kept = None);
    }

    /// A known loop has this as its lowest word.
    pub(super) fn begins_at(&self, word: u32) -> bool {
        self.loops.iter().any(|known| known.word == word)
    }

    fn known(&mut self, word: u32) -> Option<&mut Loop> {
        self.loops.iter_mut().find(|known| known.word == word)
    }

    fn keep(&mut self, word: u32, kept: Option<Kept>) {
        if let Some(known) = self.known(word) {
            known.kept = kept;
        }
    }
}

/// The state at the beginning of a round, and what the round does with the rest of the world.
struct Round {
    program_counter: u32,
    /// What ran since.
    steps: Vec<Step>,
    /// A counter that runs was read, first here.
    counter: Option<u32>,
    /// The lowest word in it, by which a loop is known.
    lowest: u32,
    cycle: u64,
    held: Held,
    /// Addresses in SRAM that were stored to, and what was there before.
    stores: [(u16, u8); STORES],
    stored: usize,
    /// What was read from peripherals stays as it is before this cycle.
    steady_until: u64,
}

impl Round {
    fn from(cpu: &Cpu, steps: Vec<Step>) -> Round {
        Round {
            program_counter: cpu.program_counter,
            steps,
            counter: None,
            lowest: cpu.program_counter,
            cycle: cpu.cycle,
            held: Held::by(cpu),
            stores: [(0, 0); STORES],
            stored: 0,
            steady_until: u64::MAX,
        }
    }

    /// Begins again where the CPU is.
    fn restart(&mut self, cpu: &Cpu) {
        let mut steps = std::mem::take(&mut self.steps);
        steps.clear();
        *self = Round::from(cpu, steps);
    }

    /// The stack and what only long jumps change are as they were.
    fn is_level(&self, cpu: &Cpu) -> bool {
        self.held.is_level(cpu) && !cpu.shadow
    }

    /// All else is too.
    fn is_closed(&self, cpu: &Cpu) -> bool {
        self.counter.is_none()
            && self.held == Held::by(cpu)
            && self
                .stores()
                .all(|(address, before)| cpu.in_sram(address) == Some(before))
    }

    /// Addresses that were stored to, each once.
    fn stores(&self) -> impl Iterator<Item = (u16, u8)> {
        let stores = &self.stores[..self.stored];
        let first = |(index, (address, _)): &(usize, &(u16, u8))| {
            stores[..*index].iter().all(|(other, _)| other != address)
        };
        stores
            .iter()
            .enumerate()
            .filter(first)
            .map(|(_, store)| *store)
    }

    /// How many rounds like this one follow before `limit`.
    fn alike<I: Io>(&self, cpu: &Cpu, io: &I, limit: u64) -> Option<Alike> {
        let stores: Vec<_> = self.stores().collect();
        let steps = &self.steps;
        let stores = &stores;
        Ran { steps, cpu, stores }.alike(io, limit, SPAN)
    }

    /// Takes note of what the instruction is about to do; `None` if rounds with it cannot be told from each other.
    fn note<I: Io>(&mut self, cpu: &Cpu, io: &I, op: Op) -> Option<()> {
        let unfit = match op.code {
            Code::Sleep
            | Code::Wdr
            | Code::Spm
            | Code::Breakpoint
            | Code::Erased
            | Code::Illegal => true,
            Code::Lpm | Code::LpmInc | Code::Elpm | Code::ElpmInc => cpu.programming,
            _ => false,
        };
        if unfit {
            return None;
        }
        self.lowest = self.lowest.min(cpu.program_counter);
        let step = Step::next(cpu, op);
        let touch = step.touch;
        self.steps.push(step);
        let Some(touch) = touch else {
            return Some(());
        };
        for address in (touch.address..).take(usize::from(touch.bytes)) {
            match (cpu.in_sram(address), address) {
                (Some(before), _) if touch.writes => {
                    *self.stores.get_mut(self.stored)? = (address, before);
                    self.stored += 1;
                }
                (Some(_), _) | (None, SREG) => {}
                (None, _) if touch.writes => return None,
                (None, own) if cpu.has_own(own) => {}
                (None, _) => {
                    let until = io.steady_until(address, cpu.cycle);
                    if until == 0 {
                        io.counter(address)?;
                        self.counter.get_or_insert(cpu.program_counter);
                    } else {
                        self.steady_until = self.steady_until.min(until);
                    }
                }
            }
        }
        Some(())
    }
}

impl Cpu {
    /// Cycles so far that did not run, since they are rounds of a loop that waits.
    pub fn cycles_left_out(&self) -> u64 {
        self.search.left_out
    }

    /// The CPU itself has this register, besides SREG, which an instruction may also write.
    pub(super) fn has_own(&self, address: u16) -> bool {
        matches!(address, 0..32 | SPL | SPH | SREG)
            || self.is_far && matches!(address, RAMPZ | EIND)
    }

    pub(super) fn in_sram(&self, address: u16) -> Option<u8> {
        let index = usize::from(address.wrapping_sub(self.sram_start));
        self.sram.get(index).copied()
    }

    /// Nothing happens for a while: runs some instructions, where it may be worth it, and if they are a loop that waits,
    /// leaves out its rounds up to the next event or `until`. Returns whether anything ran.
    #[inline(always)]
    pub(super) fn look_for_rounds<I: Io>(&mut self, io: &mut I, until: u64) -> bool {
        let worth_it = self.search.arrived || self.cycle >= self.search.not_before;
        if worth_it {
            self.leave_out_rounds(io, until);
        } else if !self.search.marked {
            self.mark_loops();
        }
        worth_it
    }

    #[cold]
    #[inline(never)]
    fn leave_out_rounds<I: Io>(&mut self, io: &mut I, until: u64) {
        let known = std::mem::take(&mut self.search.arrived).then_some(self.program_counter);
        if let Some(word) = known
            && let Some(kept) = self.search.known(word).and_then(|known| known.kept.take())
        {
            let limit = io.deadline(self.status.interrupts).min(until);
            if self.recall(io, limit, &kept) {
                self.search.keep(word, Some(kept));
            }
            // Behind an event a round may differ only by what came before: that one is not worth a record.
            if self.cycle < limit {
                self.step_until(io, self.cycle, self.cycle + 1);
            }
            return;
        }
        let steps = std::mem::take(&mut self.search.steps);
        let mut round = Round::from(self, steps);
        let patience = PATIENCE[usize::from(known.is_none())];
        let found = self.search_rounds(io, until, &mut round, patience);
        round.steps.clear();
        self.search.steps = round.steps;
        let search = &mut self.search;
        match (known, found) {
            (None, Some(word)) if !search.begins_at(word) => {
                search.pause = PAUSE;
                search.loops.push(Loop {
                    word,
                    failures: 0,
                    kept: None,
                });
                let oldest = (search.loops.len() > LOOPS).then(|| search.loops.remove(0));
                self.predecode_around(word);
                if let Some(oldest) = oldest {
                    self.predecode_around(oldest.word);
                }
            }
            (None, _) => {
                search.not_before = self.cycle + search.pause;
                search.pause = (2 * search.pause).min(LONGEST_PAUSE);
            }
            (Some(word), found) => {
                let Some(at) = search.loops.iter().position(|known| known.word == word) else {
                    return;
                };
                let failures = if found.is_some() {
                    0
                } else {
                    search.loops[at].failures + 1
                };
                search.loops[at].failures = failures;
                if failures > FAILURES {
                    search.loops.remove(at);
                    self.predecode_around(word);
                }
            }
        }
    }

    /// The CPU stops where a known loop begins.
    fn mark_loops(&mut self) {
        self.search.marked = true;
        for index in 0..self.search.loops.len() {
            let word = self.search.loops[index].word;
            let op = self.operations[word as usize];
            if op.code != Code::Breakpoint {
                self.put(
                    word,
                    Op {
                        code: Code::Waits,
                        ..op
                    },
                );
            }
        }
    }

    /// The program has come to a known loop, and nothing happens before `limit`; returns whether to search for rounds,
    /// else it just goes on.
    #[cold]
    #[inline(never)]
    pub(super) fn arrive(&mut self, program_counter: u32, cycle: u64, limit: u64) -> bool {
        self.predecode(program_counter & self.last_word);
        self.search.marked = false;
        self.search.arrived = limit > cycle + SPAN;
        self.search.arrived
    }

    /// Runs some instructions; if they are rounds of a loop that waits, leaves out the next ones. Returns the word by which
    /// the loop is known.
    fn search_rounds<I: Io>(
        &mut self,
        io: &mut I,
        until: u64,
        round: &mut Round,
        mut patience: usize,
    ) -> Option<u32> {
        let restarts = self.restarts;
        let (mut counter, mut again) = (None, false);
        for _ in 0..SEARCH {
            let limit = io.deadline(self.status.interrupts).min(until);
            let held = self.shadow;
            if self.cycle >= limit && !held {
                return None;
            }
            if self.operations[self.program_counter as usize].code == Code::Waits {
                self.arrive(self.program_counter, self.cycle, 0);
            }
            let op = self.operations[self.program_counter as usize].alone();
            round.note(self, io, op)?;
            self.shadow = false;
            self.step_until(io, self.cycle, self.cycle + 1);
            if self.cycle >= limit || self.verdict.is_some() || self.restarts != restarts {
                return None;
            }
            if self.program_counter == round.program_counter {
                if round.is_level(self) {
                    let limit = limit.min(round.steady_until);
                    if round.is_closed(self) {
                        self.keep(io, round);
                        let period = self.cycle - round.cycle;
                        self.leave_out(limit.saturating_sub(self.cycle) / period * period);
                        return Some(round.lowest);
                    }
                    // The second round of a loop that just polls is closed.
                    let alike = if again || round.counter.is_some() {
                        round.alike(self, io, limit)
                    } else {
                        None
                    };
                    if let Some(alike) = alike {
                        self.leave_out_all_but_one(&alike, self.cycle - round.cycle);
                        return Some(round.counter.unwrap_or(round.program_counter));
                    }
                }
                // Where a counter is read, what was read before is used up.
                counter = round.counter.filter(|word| *word != round.program_counter);
                again = true;
                round.restart(self);
            } else if round.steps.len() > patience || counter == Some(self.program_counter) {
                patience *= 2;
                (counter, again) = (None, false);
                round.restart(self);
            }
        }
        None
    }

    /// Keeps a closed round that a known loop begins with.
    fn keep<I: Io>(&mut self, io: &mut I, round: &Round) {
        if self.search.begins_at(round.program_counter) {
            let stores = round.stores().collect();
            let kept = Kept::of(self, io, &round.steps, stores);
            self.search.keep(round.program_counter, kept);
        }
    }

    pub(super) fn leave_out(&mut self, cycles: u64) {
        self.cycle += cycles;
        self.search.left_out += cycles;
    }

    /// The last of them runs: it leaves behind what no other round needs.
    fn leave_out_all_but_one(&mut self, alike: &Alike, period: u64) {
        let (registers, flags) = alike
            .registers
            .iter()
            .partition::<Vec<_>, _>(|(key, _)| *key < 32);
        for (register, value) in registers {
            self.registers_mut()[register] = value;
        }
        let mut bits = self.status.bits();
        for (key, value) in flags {
            bits = bits & !(1 << (key - 32)) | value << (key - 32);
            bits = bits & !S | (bits << 2 ^ bits << 1) & S;
        }
        self.status = Status::from_bits(bits);
        for (address, value) in &alike.cells {
            let index = usize::from(address.wrapping_sub(self.sram_start));
            if let Some(byte) = self.sram.get_mut(index) {
                *byte = *value;
            }
        }
        self.leave_out((alike.rounds - 1) * period);
    }
}
