//! A world with its past: snapshots at intervals, between which it is run again, exactly.
//!
//! Between two intervals the world is never halted for good: what a debugger halts is a copy, and at the end of the
//! interval the world itself is run there. So a run is the same with a debugger and without, however often the program
//! stood, and going back to a cycle gives what was there. What a person changes begins a new past: a snapshot is kept
//! there.

use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::gdb::DebuggedWorld;
use rumbo_emulator::observe::Watchpoint;
use rumbo_emulator::observe::trace::{Traced, What};
use std::collections::{BTreeMap, BTreeSet};

/// Most snapshots; then every second one of the older ones goes.
const MOST_SNAPSHOTS: usize = 1_000;
/// Of which so many last ones stay.
const DENSE: usize = 250;
/// Changes that are remembered, each with a decoded program of its own, 1 MB; the past begins at the first of them.
const MOST_CHANGES: usize = 64;
/// Most snapshots of a stretch that is looked through at a time.
const LONGEST_STRETCH: usize = 64;
/// Parts of an interval that are looked through from its end [cycles].
const WINDOWS: [u64; 3] = [1_000, 10_000, u64::MAX];

/// Bytes that the program had sent in each stream.
type Said = BTreeMap<u8, u64>;

/// A world at the beginning of an interval.
#[derive(Clone)]
struct Snapshot<W> {
    world: W,
    said: Said,
    /// A person has changed something here.
    is_changed: bool,
}

impl<W: DebuggedWorld> Snapshot<W> {
    fn cycle(&self) -> u64 {
        self.world.chip().cycle()
    }
}

/// The present and its past.
pub(crate) struct History<W> {
    /// As it stands.
    now: W,
    said: Said,
    /// The beginning of this interval.
    base: Snapshot<W>,
    /// `now` was halted since.
    has_halted: bool,
    past: Vec<Snapshot<W>>,
    /// Where to stop [words], and at which accesses.
    stops: BTreeSet<u32>,
    watches: Vec<Watchpoint>,
    /// Bytes of the program that were given on, and those to give.
    given: Said,
    output: Vec<(u8, Vec<u8>)>,
}

impl<W: DebuggedWorld> History<W> {
    pub(crate) fn new(world: W) -> Self {
        let base = Snapshot {
            world: world.clone(),
            said: Said::new(),
            is_changed: true,
        };
        History {
            now: world,
            said: Said::new(),
            past: vec![base.clone()],
            base,
            has_halted: false,
            stops: BTreeSet::new(),
            watches: Vec::new(),
            given: Said::new(),
            output: Vec::new(),
        }
    }

    pub(crate) fn now(&self) -> &W {
        &self.now
    }

    pub(crate) fn chip(&self) -> &Chip {
        self.now.chip()
    }

    pub(crate) fn cycle(&self) -> u64 {
        self.now.chip().cycle()
    }

    /// What the program has sent, each byte once, however often it is run again.
    pub(crate) fn take_output(&mut self) -> Vec<(u8, Vec<u8>)> {
        std::mem::take(&mut self.output)
    }

    /// Stops there from now on, and nowhere else.
    pub(crate) fn set_stops(&mut self, stops: BTreeSet<u32>, watches: Vec<Watchpoint>) {
        disarm(&mut self.now, &self.stops, &self.watches);
        (self.stops, self.watches) = (stops, watches);
        arm(&mut self.now, &self.stops, &self.watches);
    }

    /// Runs to the next stop or the end of the interval. A stop where it stands does not count.
    pub(crate) fn go(&mut self) -> Stopped {
        self.forget_future();
        let here = self.now.chip().cpu().program_counter();
        let mut stopped = Stopped::Reached;
        if self.stops.contains(&here) {
            stopped = self.now.step();
            self.has_halted = true;
            // It may stand at another one already.
            let there = self.now.chip().cpu().program_counter();
            if stopped == Stopped::Reached && self.stops.contains(&there) {
                stopped = Stopped::Breakpoint;
            }
        }
        if matches!(stopped, Stopped::Reached | Stopped::Output) {
            stopped = self.now.go();
        }
        self.hear();
        match stopped {
            Stopped::Reached | Stopped::Output => self.end_interval(),
            _ => self.has_halted = true,
        }
        stopped
    }

    /// What comes later is another future.
    fn forget_future(&mut self) {
        let cycle = self.cycle();
        self.past.retain(|snapshot| snapshot.cycle() <= cycle);
    }

    /// Runs one instruction.
    pub(crate) fn step(&mut self) -> Stopped {
        self.forget_future();
        self.has_halted = true;
        let stopped = self.now.step();
        self.hear();
        stopped
    }

    /// Changes the present; the past leads there no longer, so that a snapshot remembers it.
    pub(crate) fn change<T>(&mut self, change: impl FnOnce(&mut W) -> T) -> T {
        let done = change(&mut self.now);
        self.forget_future();
        let mut world = self.now.clone();
        disarm(&mut world, &self.stops, &self.watches);
        self.base = Snapshot {
            world,
            said: self.said.clone(),
            is_changed: true,
        };
        self.past.push(self.base.clone());
        let changes = self.past.iter().rev().enumerate();
        let mut changes = changes.filter(|(_, snapshot)| snapshot.is_changed);
        if let Some((after, _)) = changes.nth(MOST_CHANGES - 1) {
            self.past.drain(..self.past.len() - 1 - after);
        }
        self.has_halted = false;
        self.given = self.said.clone();
        done
    }

    fn hear(&mut self) {
        for (stream, bytes) in self.now.take_output() {
            let said = self.said.entry(stream).or_default();
            *said += bytes.len() as u64;
            let given = self.given.entry(stream).or_default();
            let fresh = said.saturating_sub(*given).min(bytes.len() as u64) as usize;
            *given += fresh as u64;
            if fresh > 0 {
                self.output
                    .push((stream, bytes[bytes.len() - fresh..].to_vec()));
            }
        }
    }

    fn end_interval(&mut self) {
        // With breakpoints too, so that all snapshots share the program's memory without them.
        if self.has_halted || !self.stops.is_empty() || !self.watches.is_empty() {
            self.base.world.go();
            self.base.world.take_output();
            self.now = self.base.world.clone();
            arm(&mut self.now, &self.stops, &self.watches);
            self.has_halted = false;
        } else {
            self.base.world = self.now.clone();
        }
        self.base.said = self.said.clone();
        self.base.is_changed = false;
        self.past.push(self.base.clone());
        if self.past.len() > MOST_SNAPSHOTS {
            let old = self.past.len() - DENSE;
            let mut number = 0;
            self.past.retain(|snapshot| {
                number += 1;
                number > old || number % 2 == 1 || snapshot.is_changed
            });
        }
    }

    /// The beginning of the interval that a cycle is in or ends.
    fn before(&self, cycle: u64) -> Snapshot<W> {
        let after = self
            .past
            .partition_point(|snapshot| snapshot.cycle() <= cycle);
        let mut base = self.past[after.saturating_sub(1)].clone();
        // From a sparse past, through the intervals in between.
        loop {
            let mut next = base.clone();
            let stopped = next.world.go();
            count(&mut next.said, &next.world.take_output());
            next.is_changed = false;
            if next.cycle() > cycle
                || next.cycle() == base.cycle()
                || matches!(stopped, Stopped::Ended(_))
            {
                return base;
            }
            base = next;
        }
    }

    /// Goes back, or forward again, to a cycle.
    pub(crate) fn travel(&mut self, cycle: u64) {
        self.base = self.before(cycle);
        self.now = self.base.world.clone();
        self.said = self.base.said.clone();
        self.has_halted = self.cycle() < cycle;
        if self.has_halted {
            self.now.go_to(cycle);
            count(&mut self.said, &self.now.take_output());
        }
        arm(&mut self.now, &self.stops, &self.watches);
    }

    /// Goes to the beginning; what the program sends from there on is given on again.
    pub(crate) fn restart(&mut self) {
        self.travel(self.first());
        self.given = self.said.clone();
    }

    /// The first cycle that there is.
    pub(crate) fn first(&self) -> u64 {
        self.past.first().map_or(0, Snapshot::cycle)
    }

    /// The last cycle before this one at which the program stands at one of these words, or touches what is watched, and
    /// that is accepted. Looked for in ever longer stretches of the past.
    pub(crate) fn last_stop(
        &self,
        stops: &BTreeSet<u32>,
        watches: &[Watchpoint],
        accept: &mut dyn FnMut(&Chip) -> bool,
    ) -> Option<u64> {
        let (mut limit, mut stretch) = (self.cycle(), 1);
        loop {
            let before = self
                .past
                .partition_point(|snapshot| snapshot.cycle() < limit);
            let first = before.checked_sub(1)?.saturating_sub(stretch - 1);
            let from = &self.past.get(first)?.world;
            match last_interval(from, limit, stops, watches) {
                Some(interval) => {
                    if let Some(found) = last_within(&interval, limit, stops, watches, accept) {
                        return Some(found);
                    }
                    (limit, stretch) = (interval.chip().cycle(), 1);
                }
                None => {
                    (limit, stretch) = (from.chip().cycle(), (2 * stretch).min(LONGEST_STRETCH))
                }
            }
        }
    }

    /// The cycle at which the instruction before began.
    pub(crate) fn last_instruction(&self) -> Option<u64> {
        let mut limit = self.cycle();
        while limit > self.first() {
            let mut world = self.before(limit - 1).world;
            let start = world.chip().cycle();
            let near = limit.saturating_sub(WINDOWS[0]);
            if near > start {
                world.go_to(near);
            }
            world.chip_mut().observers_mut().trace(0..u64::MAX);
            world.go_to(limit);
            let trace = world.chip_mut().observers_mut().take_trace();
            let time = |cycle| world.chip().time_of(cycle);
            let is_instruction = |traced: &&Traced| matches!(traced.what, What::Instruction(_));
            let cycles = trace
                .iter()
                .filter(is_instruction)
                .map(|traced| time(traced.cycle));
            match cycles.filter(|cycle| *cycle < limit).max() {
                Some(found) => return Some(found),
                None => limit = start,
            }
        }
        None
    }
}

fn count(said: &mut Said, output: &[(u8, Vec<u8>)]) {
    for (stream, bytes) in output {
        *said.entry(*stream).or_default() += bytes.len() as u64;
    }
}

/// The beginning of the last interval before a cycle in which a world stops.
fn last_interval<W: DebuggedWorld>(
    from: &W,
    limit: u64,
    stops: &BTreeSet<u32>,
    watches: &[Watchpoint],
) -> Option<W> {
    let (mut world, mut found) = (from.clone(), None);
    arm(&mut world, stops, watches);
    while world.chip().cycle() < limit {
        let mut start = world.clone();
        let stands = stops.contains(&world.chip().cpu().program_counter());
        let stopped = match stands {
            true => Stopped::Breakpoint,
            false => world.go_to(limit),
        };
        let is_stop = matches!(stopped, Stopped::Breakpoint | Stopped::Watched { .. });
        if is_stop && world.chip().cycle() < limit {
            disarm(&mut start, stops, watches);
            world = start.clone();
            world.go();
            arm(&mut world, stops, watches);
            found = Some(start);
        } else if world.chip().cycle() == start.chip().cycle() {
            // The program has ended.
            break;
        }
    }
    found
}

/// The last accepted stop of an interval before a cycle, looked for from its end.
fn last_within<W: DebuggedWorld>(
    interval: &W,
    limit: u64,
    stops: &BTreeSet<u32>,
    watches: &[Watchpoint],
    accept: &mut dyn FnMut(&Chip) -> bool,
) -> Option<u64> {
    let start = interval.chip().cycle();
    let mut end = interval.clone();
    end.go_to(limit);
    let limit = limit.min(end.chip().cycle());
    WINDOWS.into_iter().find_map(|window| {
        let from = limit.saturating_sub(window);
        if from < start && window != u64::MAX {
            return None;
        }
        let mut world = interval.clone();
        if from > start {
            world.go_to(from);
        }
        last_in(&mut world, limit, stops, watches, accept)
    })
}

/// The last accepted stop of a world before a cycle.
fn last_in<W: DebuggedWorld>(
    world: &mut W,
    limit: u64,
    stops: &BTreeSet<u32>,
    watches: &[Watchpoint],
    accept: &mut dyn FnMut(&Chip) -> bool,
) -> Option<u64> {
    let mut found = None;
    let is_stop = |world: &W| stops.contains(&world.chip().cpu().program_counter());
    if is_stop(world) && world.chip().cycle() < limit && accept(world.chip()) {
        found = Some(world.chip().cycle());
    }
    arm(world, stops, watches);
    loop {
        let mut stopped = match is_stop(world) {
            true => world.step(),
            false => Stopped::Reached,
        };
        if stopped == Stopped::Reached && !is_stop(world) && world.chip().cycle() < limit {
            stopped = world.go_to(limit);
        }
        let cycle = world.chip().cycle();
        if cycle >= limit {
            return found;
        }
        match stopped {
            Stopped::Ended(_) => return found,
            Stopped::Reached | Stopped::Output if !is_stop(world) => return found,
            _ if accept(world.chip()) => found = Some(cycle),
            _ => {}
        }
    }
}

fn arm<W: DebuggedWorld>(world: &mut W, stops: &BTreeSet<u32>, watches: &[Watchpoint]) {
    let chip = world.chip_mut();
    stops
        .iter()
        .for_each(|word| chip.cpu_mut().set_breakpoint(*word));
    for watch in watches {
        chip.observers_mut().watch(watch.clone());
    }
}

fn disarm<W: DebuggedWorld>(world: &mut W, stops: &BTreeSet<u32>, watches: &[Watchpoint]) {
    let chip = world.chip_mut();
    stops
        .iter()
        .for_each(|word| chip.cpu_mut().clear_breakpoint(*word));
    for watch in watches {
        chip.observers_mut().unwatch(watch);
    }
}
