//! The chip: the CPU with its peripherals, and what a caller does with it.

use crate::cpu::{Cpu, Stopped};
use crate::devices::ports::Pin;
use crate::devices::{Devices, Fuses, Input, Level, Output, Unmodelled};
use crate::image::Image;
use crate::model::Model;
use crate::observe::{self, Observers};

/// A chip with a program. A clone is a snapshot: it continues exactly as the original.
#[derive(Clone, Debug)]
pub struct Chip {
    cpu: Cpu,
    devices: Devices,
    observers: Observers,
}

/// Resolution of the search for a boot loader's end [cycles].
const BOOT_SLICE: u64 = 1_000;

impl Chip {
    /// The image's chip after power-on, with the fuses of its Arduino board. Without anything in the boot section it
    /// starts at 0, where a boot loader would go on.
    pub fn new(image: &Image) -> Chip {
        Chip::with_fuses(image, image.model().fuses)
    }

    /// The same with other fuses.
    pub fn with_fuses(image: &Image, fuses: Fuses) -> Chip {
        let model = image.model();
        let mut cpu = Cpu::new(model, image.flash());
        if let Some(end) = image.data_end() {
            cpu.set_stack_floor(end);
        }
        let mut devices = Devices::new(model);
        let boot_start = model.boot_start(fuses);
        let boot = image.flash().get(2 * boot_start as usize..);
        let boot = boot.is_some_and(|boot| boot.iter().take(2).any(|byte| *byte != 0xFF));
        if boot {
            cpu.set_boot_loader(boot_start);
        }
        cpu.set_program_counter(devices.set_fuses(fuses, boot));
        let eeprom = image.eeprom();
        let fits = eeprom.len().min(model.eeprom_bytes);
        devices.eeprom_mut()[..fits].copy_from_slice(&eeprom[..fits]);
        Chip {
            cpu,
            devices,
            observers: Observers::default(),
        }
    }

    /// Which chip it is.
    pub fn model(&self) -> &'static Model {
        self.cpu.model()
    }

    /// Cycles of the crystal since power-on. Inputs and outputs are timed in these; CPU cycles are the same unless the
    /// program divides its clock.
    pub fn cycle(&self) -> u64 {
        self.devices.clock().time(self.cpu.cycle())
    }

    /// The crystal's cycle at one of the CPU's, by how the clock is divided now.
    pub fn time_of(&self, cycle: u64) -> u64 {
        self.devices.clock().time(cycle)
    }

    /// Runs until `cycle` cycles of the crystal have passed since power-on, to the end of the instruction that passes it.
    pub fn run_until(&mut self, cycle: u64) -> Stopped {
        loop {
            let until = self.devices.clock().cycle(cycle);
            let stopped =
                observe::run(&mut self.cpu, &mut self.devices, &mut self.observers, until);
            let rescaled = self.devices.take_rescaled();
            if !rescaled || !matches!(stopped, Stopped::Reached | Stopped::Output) {
                return stopped;
            }
        }
    }

    /// Runs a boot loader, if the program starts with one, until it has jumped to the application or `cycles` of the
    /// crystal have passed. A Mega's boot loader waits most of a second for a programmer.
    pub fn pass_boot_loader(&mut self, cycles: u64) {
        let end = self.cycle().saturating_add(cycles);
        let boot = self.model().boot_start(self.model().fuses);
        while self.cpu.program_counter() >= boot && self.cycle() < end {
            let stopped = self.run_until(self.cycle() + BOOT_SLICE);
            if matches!(stopped, Stopped::Ended(_) | Stopped::Breakpoint) {
                return;
            }
        }
    }

    /// Runs one instruction, also where a breakpoint stands; or sleeps on, or enters an interrupt that is due before it.
    pub fn step(&mut self) -> Stopped {
        self.devices.take_rescaled();
        observe::step(&mut self.cpu, &mut self.devices, &mut self.observers)
    }

    /// Schedules an input at a cycle; one in the past takes effect at once.
    pub fn input(&mut self, cycle: u64, input: Input) {
        self.devices.input(cycle, input);
    }

    /// Makes runs pause ([`Stopped::Output`]) after an instruction that changes how the chip drives one of these pins.
    pub fn watch(&mut self, pins: &[Pin]) {
        self.devices.watch(pins);
    }

    /// Makes runs pause ([`Stopped::Output`]) where a byte begins on the two-wire bus; with `pull_ups` of devices on it, both
    /// of its lines are high where nobody pulls them down.
    pub fn watch_two_wire(&mut self, pull_ups: bool) {
        let cycle = self.cycle();
        self.devices.watch_two_wire(pull_ups, cycle);
    }

    /// What the chip did since the last call, in order.
    pub fn take_outputs(&mut self) -> Vec<Output> {
        self.devices.take_outputs()
    }

    /// Records every change of a pin's level from now on, by the chip or from outside, starting with the present
    /// levels.
    pub fn record_levels(&mut self) {
        self.devices.record_levels(self.cycle());
    }

    /// The levels kept since the last call, in order.
    pub fn take_levels(&mut self) -> Vec<Level> {
        self.devices.take_levels()
    }

    /// What an instruction would read at an address of the data space, without side effects.
    pub fn read_data(&self, address: u16) -> u8 {
        self.cpu.peek(&self.devices, address)
    }

    /// Writes to the data space as an instruction does now.
    pub fn write_data(&mut self, address: u16, value: u8) {
        self.cpu.poke(&mut self.devices, address, value);
    }

    /// The CPU.
    pub fn cpu(&self) -> &Cpu {
        &self.cpu
    }

    /// The CPU, to change registers and memory or to set breakpoints.
    pub fn cpu_mut(&mut self) -> &mut Cpu {
        &mut self.cpu
    }

    /// The peripherals, to look at pins.
    pub fn devices(&self) -> &Devices {
        &self.devices
    }

    /// The peripherals, to read and write their registers as a debugger does.
    pub fn devices_mut(&mut self) -> &mut Devices {
        &mut self.devices
    }

    /// The observers of the running program.
    pub fn observers(&self) -> &Observers {
        &self.observers
    }

    /// The same, to ask for watchpoints, a trace, a profile.
    pub fn observers_mut(&mut self) -> &mut Observers {
        &mut self.observers
    }

    /// Accesses to what is not modelled, each address once.
    pub fn unmodelled(&self) -> &[Unmodelled] {
        self.devices.unmodelled()
    }
}
