//! Busy waiting: stretches in which a program changes nothing, and the turns of its main loop.
//!
//! # Theory of operation
//!
//! What waits in a loop, `delay`, `pulseIn`, `_delay_ms` or a loop of its own over `millis`, changes neither a variable nor a
//! pin: it writes registers, its stack and SREG. A stretch of [`LEAST`] cycles without any other change is a wait. Cycles of
//! interrupts count, since time passes, and their changes do not. Sleep is none.
//!
//! A program that polls changes nothing for long either, but comes around: the main loop ends a stretch. It is the jump
//! back within `main` that leads farthest back of those that are still taken in the last half of the time; which one that is
//! shows at the end, so that each is watched as if it were the one.

use super::Moment;
use crate::cpu::touch::Touch;
use crate::cpu::{Cpu, Turn};
use crate::decode::Code;
use crate::image::{Image, Symbol};
use std::ops::Range;

/// The shortest stretch that is a wait: a millisecond at 16 MHz.
pub const LEAST: u64 = 16_000;
/// In its first half it may still be on its way into the loop that waits.
const SETTLED: u64 = LEAST / 2;
/// The status register, in the data space.
const SREG: u16 = 0x5F;
/// Most jumps back in `main` that are watched.
const MOST_JUMPS: usize = 64;

/// The waits of a program, and the turns of its main loop.
#[derive(Clone, Debug)]
pub struct Waits {
    functions: Vec<Symbol>,
    /// `main`, from its first word to its end.
    main: Range<u32>,
    interrupts: u32,
    /// The cycle of the last change.
    since: u64,
    /// The outermost code of this stretch: its stack pointer and place.
    outermost: (u16, u32),
    start: Option<u64>,
    end: u64,
    jumps: Vec<Jump>,
    /// The waits of a program without a main loop.
    without: Stretches,
}

/// A jump back in `main`.
#[derive(Clone, Debug)]
struct Jump {
    target: u32,
    last: u64,
    turns: u64,
    longest: u64,
    waits: Stretches,
}

#[derive(Clone, Copy, Debug, Default)]
struct Stretches {
    count: u64,
    total: u64,
    longest: u64,
    /// Where the longest one was, in words.
    place: u32,
}

impl Stretches {
    fn close(&mut self, cycles: u64, place: u32) {
        if cycles < LEAST {
            return;
        }
        self.count += 1;
        self.total += cycles;
        if cycles > self.longest {
            (self.longest, self.place) = (cycles, place);
        }
    }
}

/// What was seen. Times are in cycles.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Waited {
    /// How often it waited.
    pub count: u64,
    /// All waits together.
    pub total: u64,
    /// The longest wait.
    pub longest: u64,
    /// The function whose loop waited longest.
    pub function: Option<String>,
    /// The longest turn of the main loop; `None` where it came around less than twice.
    pub longest_turn: Option<u64>,
    /// All cycles observed.
    pub cycles: u64,
}

impl Waits {
    /// Of a program, by its symbols; `None` for an image without them.
    #[must_use]
    pub fn of(image: &Image) -> Option<Waits> {
        let functions = image.functions().to_vec();
        let index = functions.iter().position(|one| one.name == "main")?;
        let end = functions
            .get(index + 1)
            .map_or(u32::MAX, |next| next.address);
        Some(Waits {
            main: functions[index].address..end,
            functions,
            interrupts: 0,
            since: 0,
            outermost: (0, 0),
            start: None,
            end: 0,
            jumps: Vec::new(),
            without: Stretches::default(),
        })
    }

    /// An instruction, sleep, or the entry of an interrupt has passed.
    pub(super) fn note(&mut self, cpu: &Cpu, before: &Moment, turn: Turn, touched: Option<&Touch>) {
        self.start.get_or_insert(before.cycle);
        self.end = cpu.cycle();
        match turn {
            Turn::Entered(_) => self.interrupts += 1,
            Turn::Slept => self.change(cpu.cycle()),
            Turn::Ran if before.operation.code == Code::Reti => {
                self.interrupts = self.interrupts.saturating_sub(1);
            }
            Turn::Ran if self.interrupts == 0 => self.ran(cpu, before, touched),
            _ => {}
        }
    }

    fn ran(&mut self, cpu: &Cpu, before: &Moment, touched: Option<&Touch>) {
        let is_change = |touch: &Touch| {
            let own = touch.stack || touch.address > cpu.stack_pointer() || touch.address == SREG;
            touch.writes && !own
        };
        if touched.is_some_and(is_change) {
            self.change(cpu.cycle());
            return;
        }
        let place = before.program_counter;
        let settled = cpu.cycle() - self.since > SETTLED;
        if settled && before.stack_pointer > self.outermost.0 {
            self.outermost = (before.stack_pointer, place);
        }
        let is_jump = !matches!(before.operation.code, Code::Ret | Code::Reti);
        let target = cpu.program_counter();
        if is_jump && target < place && self.main.contains(&target) && self.main.contains(&place) {
            self.jump(target, cpu.cycle());
        }
    }

    /// A variable, a pin or a peripheral has changed, or the program slept.
    fn change(&mut self, cycle: u64) {
        if cycle - self.since >= LEAST {
            let place = self.outermost.1;
            self.without.close(cycle - self.since, place);
            for jump in &mut self.jumps {
                jump.waits.close(cycle - self.since.max(jump.last), place);
            }
        }
        self.since = cycle;
        self.outermost = (0, 0);
    }

    fn jump(&mut self, target: u32, cycle: u64) {
        let Some(jump) = self.jumps.iter_mut().find(|jump| jump.target == target) else {
            if self.jumps.len() < MOST_JUMPS {
                self.jumps.push(Jump {
                    target,
                    last: cycle,
                    turns: 0,
                    longest: 0,
                    // What was before it first came around is setup's.
                    waits: Stretches::default(),
                });
            }
            return;
        };
        jump.waits
            .close(cycle - self.since.max(jump.last), self.outermost.1);
        jump.turns += 1;
        jump.longest = jump.longest.max(cycle - jump.last);
        jump.last = cycle;
    }

    /// What was seen so far.
    #[must_use]
    pub fn waited(&self) -> Waited {
        let start = self.start.unwrap_or(self.end);
        let half = start + (self.end - start) / 2;
        let lasting = self.jumps.iter().filter(|jump| jump.last >= half);
        let main_loop = lasting.min_by_key(|jump| jump.target);
        let mut waits = main_loop.map_or(self.without, |jump| jump.waits);
        let since = self.since.max(main_loop.map_or(0, |jump| jump.last));
        waits.close(self.end - since.max(start), self.outermost.1);
        Waited {
            count: waits.count,
            total: waits.total,
            longest: waits.longest,
            function: (waits.count > 0)
                .then(|| self.function_at(waits.place))
                .flatten(),
            longest_turn: main_loop
                .filter(|jump| jump.turns > 0)
                .map(|jump| jump.longest),
            cycles: self.end - start,
        }
    }

    fn function_at(&self, word: u32) -> Option<String> {
        let after = self.functions.partition_point(|one| one.address <= word);
        let symbol = self.functions.get(after.checked_sub(1)?)?;
        Some(symbol.name.clone())
    }
}
