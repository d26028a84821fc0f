//! The peripherals, as far as the pins reach.
//!
//! Each is a module with its registers; what they share is in `Core`: interrupt requests, ports, the schedule of
//! events and the stream of outputs. An access first lets everything happen that is due before it.

pub(crate) mod external;
pub(crate) mod interrupts;
pub mod ports;
pub(crate) mod schedule;
mod signal;
pub(crate) mod timer;

use std::collections::VecDeque;

use crate::io::{Access, Io};
use external::External;
use interrupts::Interrupts;
use ports::{Change, Drive, Pin, Ports};
use schedule::{Schedule, Source};
pub use signal::{Cause, Event, Input, Output, Pwm};
use timer::{Prescaler, Timer};

const GPIOR0: u16 = 0x3E;
const GPIOR1: u16 = 0x4A;
const GPIOR2: u16 = 0x4B;
const SMCR: u16 = 0x53;
const MCUSR: u16 = 0x54;
const MCUCR: u16 = 0x55;

/// Sleep enable in SMCR.
const SE: u8 = 1;
/// Pull-up disable in MCUCR.
const PUD: u8 = 0x10;
/// Vectors in the boot section, and the permission to change that, in MCUCR.
const IVSEL: u8 = 2;
const IVCE: u8 = 1;
/// Cycles for which IVCE permits.
const IVCE_CYCLES: u64 = 4;
/// Start of the largest boot section [words], as the fuses are shipped.
const BOOT_WORDS: u32 = 0x1_F000;

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
    general: [u8; 3],
    sleep_control: u8,
    reset_cause: u8,
    control: u8,
    control_open_until: u64,
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
            general: [0; 3],
            sleep_control: 0,
            // PORF: the power was applied.
            reset_cause: 1,
            control: 0,
            control_open_until: 0,
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
                    match input {
                        Input::Pin(pin, level) => {
                            let change = self.core.ports.set_outside(pin, level, cycle);
                            self.core.note(Some(change), cycle);
                        }
                        // Nothing takes these in yet.
                        Input::Serial { .. }
                        | Input::Frame { .. }
                        | Input::Volts { .. }
                        | Input::Reset(_) => {}
                    }
                }
                self.schedule_input();
            }
            _ => {
                let index = source as usize - Source::Timer0 as usize;
                self.timers[index].happen(&mut self.core, cycle);
            }
        }
        self.settle();
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
                self.tell_timers(&change, cycle);
            }
        }
    }

    fn tell_timers(&mut self, change: &Change, cycle: u64) {
        for bit in 0..8 {
            if change.levels >> bit & 1 != 0 {
                let pin = Pin::at(change.port, bit);
                let level = self.core.ports.level(pin);
                for timer in &mut self.timers {
                    timer.pin_changed(&mut self.core, pin, level, cycle);
                }
            }
        }
    }

    fn not_modelled(&mut self, address: u16, at: Access, written: bool) {
        let known = self.unmodelled.iter().any(|other| other.address == address);
        if !known {
            self.unmodelled.push(Unmodelled {
                address,
                program_counter: at.program_counter,
                cycle: at.cycle,
                written,
            });
        }
    }

    /// MCUCR: IVSEL changes only within four cycles after IVCE was written.
    fn write_control(&mut self, value: u8, cycle: u64) {
        let kept = PUD | 0x80;
        let select = if cycle <= self.control_open_until && value & IVCE == 0 {
            value & IVSEL
        } else {
            self.control & IVSEL
        };
        if value & IVCE != 0 {
            self.control_open_until = cycle + IVCE_CYCLES;
        }
        self.control = value & kept | select;
        let changes = self.core.ports.disable_pull_ups(value & PUD != 0, cycle);
        for change in changes {
            self.core.note(Some(change), cycle);
        }
    }
}

impl Io for Devices {
    fn read(&mut self, address: u16, at: Access) -> u8 {
        self.advance(at.cycle);
        match address {
            _ if Ports::has(address) => self.core.ports.read(address, at.cycle),
            _ if External::has(address) => self.external.read(address),
            timer::GTCCR => timer::read_general_control(&self.core),
            GPIOR0 => self.general[0],
            GPIOR1 => self.general[1],
            GPIOR2 => self.general[2],
            SMCR => self.sleep_control,
            MCUSR => self.reset_cause,
            MCUCR => self.control,
            _ => match timer::at(address) {
                Some(index) => self.timers[index].read(&mut self.core, address, at),
                None => {
                    self.not_modelled(address, at, false);
                    0
                }
            },
        }
    }

    fn write(&mut self, address: u16, value: u8, at: Access) {
        self.advance(at.cycle);
        match address {
            _ if Ports::has(address) => {
                let change = self.core.ports.write(address, value, at.cycle);
                self.core.note(change, at.cycle);
            }
            _ if External::has(address) => {
                self.external.write(address, value);
                let Core {
                    interrupts, ports, ..
                } = &mut self.core;
                self.external.request(interrupts, ports);
            }
            GPIOR0 => self.general[0] = value,
            GPIOR1 => self.general[1] = value,
            GPIOR2 => self.general[2] = value,
            SMCR => self.sleep_control = value & 0x0F,
            // Flags of the reset: a zero clears, a one leaves.
            MCUSR => self.reset_cause &= value,
            MCUCR => self.write_control(value, at.cycle),
            timer::GTCCR => {
                timer::write_general_control(&mut self.timers, &mut self.core, value, at.cycle);
            }
            _ => match timer::at(address) {
                Some(index) => self.timers[index].write(&mut self.core, address, value, at),
                None => self.not_modelled(address, at, true),
            },
        }
        self.settle();
    }

    /// A flag register takes the bit alone: a one clears it, and no other flag is touched.
    fn write_bit(&mut self, address: u16, mask: u8, set: bool, at: Access) {
        if Ports::has(address) {
            self.advance(at.cycle);
            let change = self.core.ports.write_bit(address, mask, set, at.cycle);
            self.core.note(change, at.cycle);
            self.settle();
        } else if matches!(address, external::PCIFR | external::EIFR) || timer::is_flags(address) {
            self.write(address, if set { mask } else { 0 }, at);
        } else {
            let before = self.read(address, at);
            let value = if set { before | mask } else { before & !mask };
            self.write(address, value, at);
        }
    }

    fn advance(&mut self, cycle: u64) {
        while let Some((source, at)) = self.core.schedule.due(cycle) {
            self.happen(source, at);
        }
        self.core.interrupts.set_time(cycle);
    }

    #[inline(always)]
    fn deadline(&self, interrupts_enabled: bool) -> u64 {
        if self.core.noticed || interrupts_enabled && self.core.interrupts.any() {
            0
        } else {
            self.core.schedule.next()
        }
    }

    fn take_notice(&mut self) -> bool {
        std::mem::take(&mut self.core.noticed)
    }

    fn pending(&self) -> Option<u8> {
        self.core.interrupts.first()
    }

    fn acknowledge(&mut self, vector: u8, cycle: u64) {
        if (interrupts::vector::INT0..interrupts::vector::PCINT0 + 3).contains(&vector) {
            self.external.acknowledge(vector);
            let Core {
                interrupts, ports, ..
            } = &mut self.core;
            self.external.request(interrupts, ports);
        } else if let Some(index) = timer::of_vector(vector) {
            self.timers[index].acknowledge(&mut self.core, vector, cycle);
        }
        self.settle();
    }

    fn vector_base(&self) -> u32 {
        if self.control & IVSEL != 0 {
            BOOT_WORDS
        } else {
            0
        }
    }

    fn sleep(&mut self, _: u64) -> bool {
        self.sleep_control & SE != 0
    }

    fn reset_watchdog(&mut self, _: u64) {}

    fn store_program(&mut self, _: u32, _: u16, _: Access) -> Vec<(u32, u16)> {
        Vec::new()
    }
}
