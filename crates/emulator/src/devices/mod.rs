//! The peripherals.
//!
//! Each is a module with its registers; what they share is in `Core`: interrupt requests, ports, the schedule of
//! events and the stream of outputs. An access first lets everything happen that is due before it.

mod bus;
pub(crate) mod external;
pub(crate) mod interrupts;
mod map;
pub mod ports;
pub(crate) mod schedule;
mod signal;
mod system;
pub(crate) mod timer;
pub(crate) mod usart;

use std::collections::VecDeque;

use external::External;
use interrupts::Interrupts;
use ports::{Change, Drive, Pin, Ports};
use schedule::{Schedule, Source};
pub use signal::{Cause, Event, Input, Level, Output, Pwm};
use system::System;
use timer::{Prescaler, Timer};
use usart::Usart;

/// Cycles of the crystal in a second.
pub const CLOCK_HZ: u64 = 16_000_000;

/// An access to a register that is not modelled; each address is told once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unmodelled {
    /// Its address in the data space.
    pub address: u16,
    /// The instruction [words].
    pub program_counter: u32,
    /// When.
    pub cycle: u64,
    /// It was written.
    pub written: bool,
}

/// What all peripherals share.
#[derive(Clone, Debug, Default)]
pub(crate) struct Core {
    pub(crate) interrupts: Interrupts,
    pub(crate) ports: Ports,
    pub(crate) schedule: Schedule,
    pub(crate) outputs: Vec<Output>,
    /// The one that timers 0, 1, 3, 4 and 5 share, and timer 2's.
    pub(crate) prescalers: [Prescaler; 2],
    changes: VecDeque<(Change, u64)>,
    /// Pins whose outputs pause the run, by their number.
    watched: u128,
    noticed: bool,
    /// Levels since they were last asked for, if somebody wants to know.
    levels: Option<Vec<Level>>,
}

impl Core {
    /// Says what the chip does, at its cycle.
    pub(crate) fn say(&mut self, cycle: u64, event: Event) {
        if let Event::Pin(pin, _) | Event::Duty { pin, .. } = event {
            self.noticed |= self.watched >> pin.number() & 1 != 0;
        }
        self.outputs.push(Output { cycle, event });
    }

    /// Notes what changed on a port; whoever listens to pins hears of it before the access ends.
    pub(crate) fn note(&mut self, change: Option<Change>, cycle: u64) {
        self.changes.extend(change.map(|change| (change, cycle)));
    }
}

/// The peripherals.
#[derive(Clone, Debug)]
pub struct Devices {
    core: Core,
    external: External,
    timers: [Timer; 6],
    usarts: [Usart; 4],
    system: System,
    inputs: VecDeque<(u64, Input)>,
    unmodelled: Vec<Unmodelled>,
}

/// Peripherals after power-on.
impl Default for Devices {
    fn default() -> Devices {
        Devices {
            core: Core::default(),
            external: External::default(),
            timers: timer::all(),
            usarts: usart::all(),
            system: System::after(Cause::PowerOn),
            inputs: VecDeque::new(),
            unmodelled: Vec::new(),
        }
    }
}

impl Devices {
    /// Something from outside at `cycle`, in any order; what lies in the past happens at once.
    pub fn input(&mut self, cycle: u64, input: Input) {
        let at = self.inputs.partition_point(|(other, _)| *other <= cycle);
        self.inputs.insert(at, (cycle, input));
        self.schedule_input();
    }

    /// What the chip did since the last call, in order.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.core.outputs)
    }

    /// From now on every level of a pin that changes is kept, beginning with those that all pins have in this cycle.
    pub(crate) fn record_levels(&mut self, cycle: u64) {
        let now = |pin| Level {
            cycle,
            pin,
            high: self.core.ports.level(pin),
        };
        let pins = (0..ports::PORTS).flat_map(|port| (0..8).map(move |bit| Pin::at(port, bit)));
        self.core.levels = Some(pins.map(now).collect());
    }

    /// Levels that changed since the last call, in order.
    pub(crate) fn take_levels(&mut self) -> Vec<Level> {
        self.core
            .levels
            .as_mut()
            .map(std::mem::take)
            .unwrap_or_default()
    }

    /// From now on a run pauses after an instruction in which the chip drives one of these pins in another way.
    pub fn watch(&mut self, pins: &[Pin]) {
        let bits = pins.iter().map(|pin| 1 << pin.number());
        self.core.watched = bits.fold(0, |all, bit: u128| all | bit);
    }

    /// The cycle in which an interrupt was requested last: flag raised and enabled, whether the CPU serves it or not.
    pub fn requested_since(&self, vector: u8) -> u64 {
        self.core.interrupts.since(vector)
    }

    /// The level of a pin now.
    pub fn level(&self, pin: Pin) -> bool {
        self.core.ports.level(pin)
    }

    /// What the chip does to a pin now.
    pub fn drive(&self, pin: Pin) -> Drive {
        self.core.ports.drive(pin)
    }

    /// Accesses to what is not modelled, each address once.
    pub fn unmodelled(&self) -> &[Unmodelled] {
        &self.unmodelled
    }

    fn schedule_input(&mut self) {
        let next = self.inputs.front().map(|(cycle, _)| *cycle);
        self.core.schedule.set(Source::Input, next);
    }

    fn happen(&mut self, source: Source, cycle: u64) {
        self.core.interrupts.set_time(cycle);
        match source {
            Source::Input => {
                if let Some((_, input)) = self.inputs.pop_front() {
                    self.take(input, cycle);
                }
                self.schedule_input();
            }
            Source::Timer(index) => self.timers[index].happen(&mut self.core, cycle),
            Source::Usart(index) => self.usarts[index].happen(&mut self.core, cycle),
        }
        self.settle();
    }

    /// An input's time has come.
    fn take(&mut self, input: Input, cycle: u64) {
        let core = &mut self.core;
        match input {
            Input::Pin(pin, level) => {
                let change = core.ports.set_outside(pin, level, cycle);
                core.note(Some(change), cycle);
            }
            Input::Serial { usart, byte, baud } => {
                if let Some(usart) = self.usarts.get_mut(usize::from(usart)) {
                    usart.receive(core, u16::from(byte) | 0x100, 9, baud, cycle);
                }
            }
            Input::Frame {
                usart,
                bits,
                count,
                baud,
            } => {
                if let Some(usart) = self.usarts.get_mut(usize::from(usart)) {
                    usart.receive(core, bits, count, baud, cycle);
                }
            }
            // Nothing takes these in yet.
            Input::Volts { .. } | Input::Reset(_) => {}
        }
    }

    /// Lets those who listen to pins hear what changed, until nothing changes any more.
    fn settle(&mut self) {
        while let Some((change, cycle)) = self.core.changes.pop_front() {
            for bit in 0..8 {
                if change.driven >> bit & 1 != 0 {
                    let pin = Pin::at(change.port, bit);
                    let event = Event::Pin(pin, self.core.ports.drive(pin));
                    self.core.say(cycle, event);
                }
            }
            if change.levels != 0 {
                let ports = &self.core.ports;
                self.external.changed(change.port, change.levels, ports);
                self.external.request(&mut self.core.interrupts, ports);
                self.tell_pins(&change, cycle);
            }
        }
    }

    fn tell_pins(&mut self, change: &Change, cycle: u64) {
        for bit in 0..8 {
            if change.levels >> bit & 1 != 0 {
                let pin = Pin::at(change.port, bit);
                let level = self.core.ports.level(pin);
                if let Some(levels) = &mut self.core.levels {
                    let high = level;
                    levels.push(Level { cycle, pin, high });
                }
                for timer in &mut self.timers {
                    timer.pin_changed(&mut self.core, pin, level, cycle);
                }
                for usart in &mut self.usarts {
                    usart.pin_changed(&mut self.core, pin, cycle);
                }
            }
        }
    }
}
