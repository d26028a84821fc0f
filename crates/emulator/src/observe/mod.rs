//! Looking at a program while it runs: watchpoints, a trace of instructions, a profile, waits, the stack's depth.
//!
//! While nothing is enabled, the CPU runs as if this module did not exist. Else it goes from one instruction to
//! the next, and what each is about to do is worked out from its operands ([`crate::cpu::touch`]): slower by an order of magnitude, and
//! the program cannot tell the difference.

pub mod profile;
mod report;

pub mod trace;
pub mod wait;
pub mod waveform;

use crate::cpu::touch::{Touch, touch};
use crate::cpu::{Cpu, Pace, Stopped, Turn};
use crate::decode::Op;
use crate::devices::Devices;
use profile::Profile;
use std::ops::Range;
use trace::{Trace, Traced};
use wait::Waits;

pub use crate::watchpoint::Watchpoint;

impl Watchpoint {
    fn hit(&self, touch: &Touch) -> Option<u16> {
        let meant = self.reads && touch.reads || self.writes && touch.writes;
        let address = touch.address.max(self.addresses.start);
        let end =
            (u32::from(touch.address) + u32::from(touch.bytes)).min(u32::from(self.addresses.end));
        (meant && u32::from(address) < end).then_some(address)
    }
}

/// What is enabled.
#[derive(Clone, Debug, Default)]
pub struct Observers {
    watchpoints: Vec<Watchpoint>,
    trace: Option<Trace>,
    profile: Option<Box<Profile>>,
    waits: Option<Box<Waits>>,
    lowest_stack_pointer: Option<u16>,
}

impl Observers {
    /// Stops the program after an instruction that touches these addresses.
    pub fn watch(&mut self, watchpoint: Watchpoint) {
        self.watchpoints.push(watchpoint);
    }

    /// Removes a watchpoint; returns whether there was one.
    pub fn unwatch(&mut self, watchpoint: &Watchpoint) -> bool {
        let before = self.watchpoints.len();
        self.watchpoints.retain(|other| other != watchpoint);
        self.watchpoints.len() < before
    }

    /// Records every instruction that starts in these cycles, the first [`trace::LONGEST`] of them.
    pub fn trace(&mut self, cycles: Range<u64>) {
        self.trace = Some(Trace::new(cycles));
    }

    /// What was recorded since the last call.
    pub fn take_trace(&mut self) -> Vec<Traced> {
        self.trace.as_mut().map(Trace::take).unwrap_or_default()
    }

    /// Counts cycles by function and interrupt from here on.
    pub fn profile(&mut self, profile: Profile) {
        self.profile = Some(Box::new(profile));
    }

    /// Ends that: the program runs at full speed again.
    pub fn end_profile(&mut self) {
        self.profile = None;
    }

    /// The counts so far.
    pub fn profiled(&self) -> Option<&Profile> {
        self.profile.as_deref()
    }

    /// Watches for busy waiting from here on.
    pub fn wait(&mut self, waits: Waits) {
        self.waits = Some(Box::new(waits));
    }

    /// The waits so far.
    pub fn waited(&self) -> Option<&Waits> {
        self.waits.as_deref()
    }

    /// Notes how far down the stack comes from here on.
    pub fn measure_stack(&mut self) {
        self.lowest_stack_pointer = Some(u16::MAX);
    }

    /// The lowest stack pointer since [`Observers::measure_stack`]: the byte below the last one used.
    pub fn lowest_stack_pointer(&self) -> Option<u16> {
        self.lowest_stack_pointer
            .filter(|lowest| *lowest < u16::MAX)
    }

    /// Whether anything is observed from the cycle `now` on, and up to which cycle that holds.
    fn span(&self, now: u64) -> (bool, u64) {
        let always = !self.watchpoints.is_empty()
            || self.profile.is_some()
            || self.waits.is_some()
            || self.lowest_stack_pointer.is_some();
        match &self.trace {
            _ if always => (true, u64::MAX),
            Some(trace) => trace.span(now),
            None => (false, u64::MAX),
        }
    }
}

/// Runs until `until` cycles have passed since power-on, as [`Cpu::run`] does.
pub(crate) fn run(
    cpu: &mut Cpu,
    devices: &mut Devices,
    observers: &mut Observers,
    until: u64,
) -> Stopped {
    loop {
        let (observed, end) = observers.span(cpu.cycle());
        let end = end.min(until);
        let stopped = if observed {
            cpu.run_by(devices, end, |cpu, devices| {
                turn(cpu, devices, observers, end)
            })
        } else {
            cpu.run(devices, end)
        };
        if stopped != Stopped::Reached || cpu.cycle() >= until {
            return stopped;
        }
    }
}

/// Runs one instruction, also where a breakpoint stands; sleeps on, or enters an interrupt that is due before it.
pub(crate) fn step(cpu: &mut Cpu, devices: &mut Devices, observers: &mut Observers) -> Stopped {
    let until = cpu.cycle() + 1;
    cpu.past_breakpoint(|cpu| run(cpu, devices, observers, until))
}

/// One turn of the CPU's loop under observation.
fn turn(
    cpu: &mut Cpu,
    devices: &mut Devices,
    observers: &mut Observers,
    until: u64,
) -> Option<Stopped> {
    let before = Moment::of(cpu);
    let touched = touch(cpu, before.operation);
    let turn = cpu.turn(devices, until, Pace::One);
    let touched = match turn {
        Turn::Breakpoint => return Some(Stopped::Breakpoint),
        Turn::Noticed => return Some(Stopped::Output),
        Turn::Slept | Turn::Held => None,
        Turn::Entered(_) => Some(Touch::pushed_address(cpu.model(), before.stack_pointer)),
        Turn::Ran => touched,
    };
    if let Some(trace) = &mut observers.trace {
        trace.note(cpu, &before, turn);
    }
    if let Some(profile) = &mut observers.profile {
        profile.note(cpu, &before, turn, |vector| devices.requested_since(vector));
    }
    if let Some(waits) = &mut observers.waits {
        waits.note(cpu, &before, turn, touched.as_ref());
    }
    if let Some(lowest) = &mut observers.lowest_stack_pointer
        && touched.as_ref().is_some_and(|touch| touch.stack)
    {
        *lowest = cpu.stack_pointer().min(*lowest);
    }
    let touched = touched?;
    let hit = |watchpoint: &Watchpoint| Some((watchpoint.hit(&touched)?, watchpoint.clone()));
    let (address, watchpoint) = observers.watchpoints.iter().find_map(hit)?;
    Some(Stopped::Watched {
        address,
        watchpoint,
    })
}

/// The CPU before an instruction.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    cycle: u64,
    program_counter: u32,
    operation: Op,
    registers: [u8; 32],
    status: u8,
    stack_pointer: u16,
}

impl Moment {
    fn of(cpu: &Cpu) -> Moment {
        Moment {
            cycle: cpu.cycle(),
            program_counter: cpu.program_counter(),
            operation: cpu.next_operation(),
            registers: *cpu.registers(),
            status: cpu.status().bits(),
            stack_pointer: cpu.stack_pointer(),
        }
    }
}
