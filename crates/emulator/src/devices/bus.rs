//! The peripherals as the CPU meets them: an access finds its register, after everything that is due has happened.

use super::analog::Trigger;
use super::ports::{self, Change};
use super::system::Sleep;
use super::{Core, Devices, Unmodelled, timer};
use crate::io::{Access, Counter, Demand, Io, Stored};
use crate::model::map::{Owner, is_flags};
use crate::registers::{ADCH, ADCL, EECR, MCUCR, TWAR, XMCRA};

impl Devices {
    /// Whose register an address is.
    #[inline(always)]
    fn owner(&self, address: u16) -> Owner {
        let owner = self.core.model.owners.get(usize::from(address));
        owner.copied().unwrap_or(Owner::Nobody)
    }

    fn not_modelled(&mut self, address: u16, at: Access, written: bool) {
        if self.strange.insert(address) {
            self.unmodelled.push(Unmodelled {
                address,
                program_counter: at.program_counter,
                cycle: self.core.clock.time(at.cycle),
                written,
            });
        }
    }

    /// A register of a port was written; an output that a timer modulates may have become one, or an input.
    fn write_port(&mut self, address: u16, change: Option<Change>, cycle: u64) {
        self.core.note(change, cycle);
        if self.core.shared[0].is_some() {
            self.core.modulate(cycle);
        }
        if change.is_some() && ports::is_direction(address) {
            for timer in &mut self.timers {
                timer.publish_duty(&mut self.core, cycle);
            }
            for usart in &mut self.usarts {
                usart.direction_changed(&mut self.core, cycle);
            }
        }
    }

    fn request_external(&mut self) {
        let Core {
            interrupts, ports, ..
        } = &mut self.core;
        self.external.request(interrupts, ports);
    }

    /// The converter has other sources of its trigger, or pins another digital input.
    fn write_analog(&mut self, address: u16, value: u8, at: Access) {
        self.analog.write(&mut self.core, address, value, at.cycle);
        for (port, disabled) in self.analog.disabled_digital() {
            let change = self.core.ports.disable_inputs(port, disabled, at.cycle);
            self.core.note(change, at.cycle);
        }
        let trigger = self.analog.trigger();
        for (index, timer) in self.timers.iter_mut().enumerate().take(2) {
            let flag = match trigger {
                Some(Trigger::Timer(which, flag)) if which == index => flag,
                _ => 0,
            };
            timer.want(&mut self.core, flag, at.cycle);
        }
    }

    fn write_system(&mut self, address: u16, value: u8, cycle: u64) {
        let kept = self.core.model.control_bits;
        self.system.write(address, value, kept, cycle);
        if address == MCUCR {
            let disabled = self.system.pull_ups_disabled();
            let changes = self.core.ports.disable_pull_ups(disabled, cycle);
            for change in changes {
                self.core.note(Some(change), cycle);
            }
        }
    }
}

impl Io for Devices {
    fn read(&mut self, address: u16, at: Access) -> u8 {
        self.advance(at.cycle);
        match self.owner(address) {
            Owner::Ports => self.core.ports.read(address, at.cycle),
            Owner::External => self.external.read(address),
            Owner::Timer(index) => {
                self.timers[usize::from(index)].read(&mut self.core, address, at)
            }
            Owner::TimerPrescalers => timer::read_general_control(&self.core),
            Owner::Usart(index) => {
                self.usarts[usize::from(index)].read(&mut self.core, address, at)
            }
            Owner::Analog => self.analog.read(address),
            Owner::Eeprom => self.eeprom.read(address, at.cycle),
            Owner::Watchdog => self.watchdog.read(at.cycle),
            Owner::Programming => self.programming.read(at.cycle),
            Owner::Spi => self.spi.read(&mut self.core, address),
            Owner::Twi => self.twi.read(address),
            Owner::Power => self.power.read(address, at.cycle),
            Owner::System => self.system.read(address),
            Owner::Nobody => {
                self.not_modelled(address, at, false);
                0
            }
        }
    }

    fn steady_until(&self, address: u16, cycle: u64) -> u64 {
        let steady = match self.owner(address) {
            Owner::Ports => self.core.ports.is_steady(address, cycle),
            Owner::Usart(index) => self.usarts[usize::from(index)].is_steady(address),
            Owner::Analog => !matches!(address, ADCL | ADCH),
            Owner::Spi => self.spi.is_steady(address),
            Owner::Timer(index) => {
                return self.timers[usize::from(index)].steady_until(&self.core, address);
            }
            Owner::External | Owner::TimerPrescalers | Owner::Twi | Owner::System => true,
            Owner::Eeprom => address != EECR || self.eeprom.is_steady(cycle),
            Owner::Watchdog | Owner::Programming | Owner::Power => false,
            Owner::Nobody => self.strange.contains(&address),
        };
        if steady { u64::MAX } else { 0 }
    }

    fn counter(&self, address: u16) -> Option<Counter> {
        match self.owner(address) {
            Owner::Timer(index) => self.timers[usize::from(index)].counter(&self.core, address),
            _ => None,
        }
    }

    fn write(&mut self, address: u16, value: u8, at: Access) {
        self.advance(at.cycle);
        match self.owner(address) {
            Owner::Ports => {
                let change = self.core.ports.write(address, value, at.cycle);
                self.write_port(address, change, at.cycle);
            }
            Owner::External => {
                self.external.write(address, value);
                self.request_external();
            }
            Owner::Timer(index) => {
                self.timers[usize::from(index)].write(&mut self.core, address, value, at)
            }
            Owner::TimerPrescalers => {
                timer::write_general_control(&mut self.timers, &mut self.core, value, at.cycle);
            }
            Owner::Usart(index) => {
                self.usarts[usize::from(index)].write(&mut self.core, address, value, at)
            }
            Owner::Analog => self.write_analog(address, value, at),
            Owner::Eeprom => self.eeprom.write(&mut self.core, address, value, at.cycle),
            Owner::Watchdog => {
                let held = self.system.watchdog_held();
                self.watchdog.write(&mut self.core, value, held, at.cycle);
            }
            Owner::Programming => self.programming.write(&mut self.core, value, at.cycle),
            Owner::Spi => self.spi.write(&mut self.core, address, value, at.cycle),
            Owner::Twi => {
                self.twi.write(&mut self.core, address, value, at.cycle);
                // An address of its own: it would be a slave.
                if address == TWAR {
                    self.not_modelled(address, at, true);
                }
            }
            Owner::Power => {
                self.power.write(address, value, at.cycle);
                self.set_divisor(at.cycle);
                self.set_clocks(at.cycle);
            }
            Owner::System => {
                self.write_system(address, value, at.cycle);
                if address == XMCRA && self.system.external_memory() {
                    self.not_modelled(address, at, true);
                }
            }
            Owner::Nobody => self.not_modelled(address, at, true),
        }
        self.settle();
    }

    /// A flag register takes the bit alone: a one clears it, and no other flag is touched.
    fn write_bit(&mut self, address: u16, mask: u8, set: bool, at: Access) {
        if self.owner(address) == Owner::Ports {
            self.advance(at.cycle);
            let change = self.core.ports.write_bit(address, mask, set, at.cycle);
            self.write_port(address, change, at.cycle);
            self.settle();
        } else if is_flags(address) {
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
        if self.core.is_wanted() || interrupts_enabled && self.core.interrupts.any() {
            0
        } else {
            self.core.schedule.next()
        }
    }

    fn take_notice(&mut self) -> bool {
        std::mem::take(&mut self.core.noticed) || self.core.rescaled
    }

    fn take_demand(&mut self) -> Option<Demand> {
        self.core.demand.take()
    }

    fn pending(&self) -> Option<u8> {
        self.core.interrupts.first()
    }

    fn acknowledge(&mut self, vector: u8, cycle: u64) {
        let numbers = &self.core.model.numbers;
        let mut timers = self.timers.iter_mut();
        let mut usarts = self.usarts.iter_mut();
        if self.external.has_vector(vector) {
            self.external.acknowledge(vector);
            self.request_external();
        } else if let Some(timer) = timers.find(|timer| timer.has_vector(vector)) {
            timer.acknowledge(&mut self.core, vector, cycle);
        } else if let Some(usart) = usarts.find(|usart| usart.has_vector(vector)) {
            usart.acknowledge(&mut self.core, vector, cycle);
        } else if vector == numbers.watchdog {
            self.watchdog.acknowledge(&mut self.core, cycle);
        } else if vector == numbers.converted || vector == numbers.compared {
            self.analog.acknowledge(&mut self.core, vector);
        } else if vector == numbers.spi {
            self.spi.acknowledge(&mut self.core);
        }
        self.settle();
    }

    fn vector_base(&self) -> u32 {
        if self.system.vectors_in_boot() {
            self.programming.boot_start()
        } else {
            0
        }
    }

    fn sleep(&mut self, cycle: u64) -> bool {
        self.advance(cycle);
        if !self.system.sleep_enabled() {
            return false;
        }
        let mode = self.system.sleep_mode();
        if mode == Sleep::QuietForAnalog {
            self.analog.start_asleep(&mut self.core, cycle);
        }
        if mode != Sleep::Idle {
            self.power.sleep(mode);
            self.set_clocks(cycle);
        }
        true
    }

    fn wake(&mut self, cycle: u64) -> u64 {
        if self.power.io_runs() {
            return 0;
        }
        let delay = self.core.clock.cycles(self.power.wake());
        self.set_clocks(cycle + delay);
        delay
    }

    fn reset_watchdog(&mut self, cycle: u64) {
        self.advance(cycle);
        self.watchdog.restart(&mut self.core, cycle);
    }

    fn store_program(&mut self, address: u32, value: u16, at: Access) -> Stored {
        self.advance(at.cycle);
        self.programming.store(&mut self.core, address, value, at)
    }

    fn load_program(&mut self, address: u32, at: Access) -> Option<u8> {
        self.advance(at.cycle);
        self.programming.load(address, at.cycle)
    }
}
