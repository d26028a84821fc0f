//! The peripherals.
//!
//! Each is a module with its registers; what they share is in `Core`: interrupt requests, ports, the schedule of
//! events and the stream of outputs. An access first lets everything happen that is due before it.

mod analog;
mod bus;
mod clock;
mod eeprom;
pub(crate) mod external;
pub(crate) mod interrupts;
pub mod ports;
mod power;
mod prescaler;
mod programming;
pub(crate) mod schedule;
mod shared;
mod signal;
mod spi;
mod system;
pub(crate) mod timer;
mod twi;
pub(crate) mod usart;
mod watchdog;

use std::collections::{BTreeSet, VecDeque};

use crate::io::Demand;
pub use crate::model::Fuses;
use crate::model::Model;
use analog::{Analog, Trigger};
use clock::Clock;
use eeprom::Eeprom;
use external::External;
use ports::{Change, Drive, Pin};
use power::Power;
use programming::Programming;
use schedule::Source;
pub(crate) use shared::Core;
pub use signal::{Cause, Event, Input, Level, Output, Pwm, Reply, Transfer};
use spi::Spi;
use system::System;
use timer::Timer;
use twi::Twi;
use usart::Usart;
use watchdog::{TimeOut, Watchdog};

/// Cycles of the crystal in a second.
pub const CLOCK_HZ: u64 = 16_000_000;

/// The supply [V].
const SUPPLY_V: f64 = 5.0;
/// From a reset to the first instruction: 14 cycles and 65 ms, as set by the Mega's fuses (2549Q, table 10-4).
const RESET_CYCLES: u64 = 14 + 65 * CLOCK_HZ / 1000;

/// An access to a register that is not modelled; each address is reported once.
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

/// The peripherals.
#[derive(Clone, Debug)]
pub struct Devices {
    core: Core,
    external: External,
    timers: Box<[Timer]>,
    usarts: Box<[Usart]>,
    spi: Spi,
    twi: Twi,
    analog: Analog,
    eeprom: Eeprom,
    watchdog: Watchdog,
    power: Power,
    programming: Programming,
    system: System,
    /// The cycle in which the clock of the peripherals was stopped.
    stopped_at: Option<u64>,
    /// Where the program starts after a reset [words].
    start: u32,
    inputs: VecDeque<(u64, Input)>,
    /// The inputs of timers and USARTs, by the pin's number.
    sensed: u128,
    unmodelled: Vec<Unmodelled>,
    /// Their addresses.
    strange: BTreeSet<u16>,
}

impl Devices {
    /// Those of a chip after power-on.
    pub(crate) fn new(model: &'static Model) -> Devices {
        Devices {
            core: Core::new(model),
            external: External::new(model),
            timers: model.timers.iter().map(timer::new).collect(),
            usarts: model.usarts.iter().map(usart::new).collect(),
            spi: Spi::default(),
            twi: Twi::default(),
            analog: Analog::new(model),
            eeprom: Eeprom::new(model),
            watchdog: Watchdog::default(),
            power: Power::default(),
            programming: Programming::new(model),
            system: System::default().after_reset(Cause::PowerOn),
            stopped_at: None,
            start: 0,
            inputs: VecDeque::new(),
            sensed: model.sensed(),
            unmodelled: Vec::new(),
            strange: BTreeSet::new(),
        }
    }

    /// Schedules an input at `cycle` of the crystal, in any order; one in the past takes effect at once.
    pub fn input(&mut self, cycle: u64, input: Input) {
        let at = self.inputs.partition_point(|(other, _)| *other <= cycle);
        self.inputs.insert(at, (cycle, input));
        self.schedule_input();
    }

    /// What the chip did since the last call, in order.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        std::mem::take(&mut self.core.outputs)
    }

    /// Records every change of a pin's level from now on, starting with the levels of all pins in this cycle.
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

    /// Makes runs pause after an instruction that changes how the chip drives one of these pins.
    pub fn watch(&mut self, pins: &[Pin]) {
        let bits = pins.iter().map(|pin| 1 << pin.number());
        self.core.watched = bits.fold(0, |all, bit: u128| all | bit);
    }

    /// The run pauses where a byte begins on the two-wire bus, whose lines may have pull-ups.
    pub(crate) fn watch_two_wire(&mut self, pull_ups: bool, cycle: u64) {
        self.core.bus_watched = true;
        for pin in self.core.model.twi.into_iter().filter(|_| pull_ups) {
            self.input(cycle, Input::Pin(pin, Some(true)));
        }
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

    /// Programs the fuses; `boot` if there is a program in the boot section. Returns the reset address [words].
    pub(crate) fn set_fuses(&mut self, fuses: Fuses, boot: bool) -> u32 {
        self.programming.fuses = fuses;
        self.power = Power::after_reset(fuses.divides_clock());
        self.set_divisor(0);
        self.start = if fuses.starts_in_boot() && boot {
            self.programming.boot_start()
        } else {
            0
        };
        self.start
    }

    /// The rate at which a USART receives, if its receiver is on \[baud\].
    pub fn receiving_baud(&self, usart: u8) -> Option<f64> {
        self.usarts
            .get(usize::from(usart))?
            .receiving_baud(&self.core)
    }

    /// Whether a change of this pin raises an interrupt, as where SoftwareSerial receives.
    pub fn awaits(&self, pin: Pin) -> bool {
        self.external.awaits(pin)
    }

    /// The first instruction \[words\] that wrote a byte to this USART while its transmitter was off: the byte is lost.
    pub fn unsent_at(&self, usart: u8) -> Option<u32> {
        self.usarts.get(usize::from(usart))?.unsent_at()
    }

    /// What the EEPROM holds.
    pub fn eeprom(&self) -> &[u8] {
        &self.eeprom.bytes
    }

    /// The same, to change it.
    pub fn eeprom_mut(&mut self) -> &mut [u8] {
        &mut self.eeprom.bytes
    }

    /// Accesses to what is not modelled, each address once.
    pub fn unmodelled(&self) -> &[Unmodelled] {
        &self.unmodelled
    }

    fn schedule_input(&mut self) {
        let clock = self.core.clock;
        let next = self.inputs.front().map(|(time, _)| clock.cycle(*time));
        self.core.schedule.set(Source::Input, next);
    }

    fn happen(&mut self, source: Source, cycle: u64) {
        self.core.interrupts.set_time(cycle);
        match source {
            Source::Input => {
                if let Some((_, input)) = self.inputs.pop_front() {
                    self.apply(input, cycle);
                }
                self.schedule_input();
            }
            Source::Timer(index) => self.timers[index].happen(&mut self.core, cycle),
            Source::Usart(index) => self.usarts[index].happen(&mut self.core, cycle),
            Source::Eeprom => self.eeprom.happen(&mut self.core),
            Source::Programming => self.programming.happen(&mut self.core),
            Source::Spi => self.spi.happen(&mut self.core, cycle),
            Source::Twi => self.twi.happen(&mut self.core, cycle),
            Source::Analog => self.analog.happen(&mut self.core, cycle),
            Source::Watchdog => {
                if self.watchdog.happen(&mut self.core, cycle) == TimeOut::Reset {
                    self.reset(Cause::Watchdog, cycle);
                }
            }
        }
        self.settle();
    }

    /// Applies an input that is due.
    fn apply(&mut self, input: Input, cycle: u64) {
        let core = &mut self.core;
        match input {
            Input::Pin(pin, level) => {
                let change = core.ports.set_outside(pin, level, cycle);
                core.note(Some(change), cycle);
                // A released line may read low as a pin, but is high as a line of the bus.
                self.twi.pin_changed(core, pin, cycle);
                if let Some(channel) = core.model.analog.channel(pin) {
                    let volts = level.map(|level| if level { SUPPLY_V } else { 0.0 });
                    self.analog.set_volts(core, channel, volts, cycle);
                }
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
            Input::Volts { channel, volts } => {
                self.analog.set_volts(core, channel, Some(volts), cycle);
                if let Some(pin) = core.model.analog.pin(channel) {
                    let level = volts >= SUPPLY_V / 2.0;
                    let change = core.ports.set_outside(pin, Some(level), cycle);
                    core.note(Some(change), cycle);
                }
            }
            Input::TwoWire(reply) => self.twi.answer(core, reply, cycle),
            Input::Reset(cause) => self.reset(cause, cycle),
        }
    }

    /// Resets everything but the memories and what is outside; the CPU follows when the oscillator has settled.
    fn reset(&mut self, cause: Cause, cycle: u64) {
        let divides = self.programming.fuses.divides_clock();
        self.power = Power::after_reset(divides);
        self.core.clock.set_divisor(1, cycle);
        let start = cycle + RESET_CYCLES;
        for change in self.core.ports.reset(cycle) {
            self.core.note(Some(change), cycle);
        }
        self.core.interrupts.clear();
        self.core.prescalers = Default::default();
        self.core.shared = [None; 2];
        self.programming.reset(&mut self.core);
        self.stopped_at = None;
        self.external = External::new(self.core.model);
        for timer in &mut self.timers {
            timer.reset(&mut self.core, cycle);
        }
        for usart in &mut self.usarts {
            usart.reset(&mut self.core);
        }
        self.spi.reset(&mut self.core);
        self.twi.reset(&mut self.core, cycle);
        self.analog.reset(&mut self.core);
        self.eeprom.reset();
        self.core.schedule.set(Source::Eeprom, None);
        self.watchdog =
            Watchdog::after_reset(cause == Cause::Watchdog, self.core.clock.time(start));
        self.watchdog.reschedule(&mut self.core, start);
        self.system = self.system.after_reset(cause);
        self.core.demand = Some(Demand::Reset {
            program_counter: self.start,
            cycle: start,
        });
        self.settle();
        self.core.emit(cycle, Event::Reset(cause));
        self.set_divisor(start);
    }

    /// The system clock divides the crystal's by CLKPR from a cycle on.
    fn set_divisor(&mut self, cycle: u64) {
        let divisor = self.power.divisor();
        if divisor == self.core.clock.divisor() {
            return;
        }
        let core = &mut self.core;
        core.clock.set_divisor(divisor, cycle);
        core.rescaled = true;
        // Events timed in cycles of the crystal now fall in another CPU cycle.
        self.watchdog.reschedule(core, cycle);
        self.eeprom.reschedule(core);
        self.programming.reschedule(core);
        for usart in &self.usarts {
            usart.reschedule(core);
        }
        for timer in &mut self.timers {
            timer.publish_duty(core, cycle);
        }
        self.schedule_input();
    }

    /// The present conversion between cycles and time.
    pub(crate) fn clock(&self) -> Clock {
        self.core.clock
    }

    /// Whether the clock's divisor has changed since the last call.
    pub(crate) fn take_rescaled(&mut self) -> bool {
        std::mem::take(&mut self.core.rescaled)
    }

    /// Starts and stops the clocks of the peripherals as sleep and power reduction require.
    fn set_clocks(&mut self, cycle: u64) {
        if !self.power.io_runs() {
            self.stopped_at.get_or_insert(cycle);
        } else if let Some(stopped) = self.stopped_at.take() {
            for prescaler in &mut self.core.prescalers {
                prescaler.delay(cycle - stopped);
            }
        }
        for (index, timer) in self.timers.iter_mut().enumerate() {
            let runs = self.power.timer_runs(index);
            timer.set_running(&mut self.core, runs, cycle);
        }
        for (index, usart) in self.usarts.iter_mut().enumerate() {
            let runs = self.power.usart_runs(index);
            usart.set_running(&mut self.core, runs, cycle);
        }
        let (spi, twi) = (self.power.spi_runs(), self.power.twi_runs());
        self.spi.set_running(&mut self.core, spi, cycle);
        self.twi.set_running(&mut self.core, twi, cycle);
        let runs = self.power.analog_runs();
        self.analog.set_running(&mut self.core, runs, cycle);
    }

    /// Propagates pin changes to the peripherals that watch pins, until nothing changes any more.
    fn settle(&mut self) {
        while let Some((change, cycle)) = self.core.changes.pop_front() {
            for pin in change.pins(change.driven) {
                let event = Event::Pin(pin, self.core.ports.drive(pin));
                self.core.emit(cycle, event);
            }
            if change.driven != 0 {
                self.analog.port_changed(&mut self.core, change.port, cycle);
            }
            if change.levels != 0 {
                let ports = &self.core.ports;
                let raised = self.external.int0_flag();
                let clocked = self.power.io_runs();
                self.external
                    .changed(change.port, change.levels, ports, clocked);
                self.external.request(&mut self.core.interrupts, ports);
                if !raised
                    && self.external.int0_flag()
                    && self.analog.trigger() == Some(Trigger::External0)
                {
                    self.core.triggered = Some(cycle);
                }
                self.notify_pins(&change, cycle);
            }
        }
        if let Some((output, cycle)) = self.core.captured.take() {
            self.timers[1].set_comparator(&mut self.core, output, cycle);
        }
        if let Some(cycle) = self.core.triggered.take() {
            self.analog.triggered(&mut self.core, cycle);
        }
    }

    fn notify_pins(&mut self, change: &Change, cycle: u64) {
        for pin in change.pins(change.levels) {
            let level = self.core.ports.level(pin);
            if let Some(levels) = &mut self.core.levels {
                let high = level;
                let cycle = self.core.clock.time(cycle);
                levels.push(Level { cycle, pin, high });
            }
            if self.sensed >> pin.number() & 1 != 0 {
                for timer in &mut self.timers {
                    timer.pin_changed(&mut self.core, pin, level, cycle);
                }
                for usart in &mut self.usarts {
                    usart.pin_changed(&mut self.core, pin, cycle);
                }
            }
            self.spi.pin_changed(&mut self.core, pin, cycle);
            self.twi.pin_changed(&mut self.core, pin, cycle);
        }
    }
}
