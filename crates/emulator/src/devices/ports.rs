//! The ports A to L: direction, output, pull-up, toggling by writing PIN, overrides by timers.
//!
//! A level that changes in cycle c is read from cycle c + 2 on: the synchroniser holds it for one clock and a half at most
//! (2549Q, section 13.2.4: an OUT and the IN that reads it back need a NOP in between).

use crate::model::Model;
pub use crate::model::pin::{PORTS, Pin};
use crate::model::pin::{PortRegister, register};

/// Cycles after which a changed level is read.
const SYNCHRONISER: u64 = 2;

/// What the chip does to a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Nothing: an input.
    Floating,
    /// Pulls it up weakly: an input with its pull-up.
    PullUp,
    /// Low.
    Low,
    /// High.
    High,
}

/// One port.
#[derive(Clone, Copy, Debug, Default)]
struct Port {
    output: u8,
    direction: u8,
    /// Pins that something outside drives, and to what.
    driven_outside: u8,
    outside: u8,
    /// Pins whose output a peripheral takes over.
    output_override: u8,
    output_value: u8,
    /// Pins whose direction a peripheral takes over, to input or to output.
    forced_input: u8,
    forced_output: u8,
    /// Pins whose digital input is off: they read as low.
    disabled: u8,
    level: u8,
    level_before: u8,
    changed: u64,
}

impl Port {
    /// The directions in force: ones are outputs.
    fn directions(&self) -> u8 {
        (self.direction | self.forced_output) & !self.forced_input
    }

    fn outputs(&self) -> u8 {
        self.output & !self.output_override | self.output_value & self.output_override
    }

    /// What the chip does to its pins: which it drives, and which it drives or pulls high.
    fn drives(&self, pull_ups: bool) -> [u8; 2] {
        let directions = self.directions();
        let pulled = if pull_ups { self.output } else { 0 };
        [
            directions,
            self.outputs() & directions | pulled & !directions,
        ]
    }
}

/// How a peripheral takes a pin over, direction and all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Force {
    /// Not at all.
    None,
    /// An input, with the pull-up that the port's registers select.
    Input,
    /// It is an output with this level.
    Output(bool),
}

/// What a change did to a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Change {
    pub(crate) port: usize,
    /// Levels that changed.
    pub(crate) levels: u8,
    /// Pins to which the chip does something else than before.
    pub(crate) driven: u8,
}

impl Change {
    /// The pins of some bits of the port, lowest first.
    pub(crate) fn pins(&self, mut bits: u8) -> impl Iterator<Item = Pin> + use<> {
        let port = self.port;
        std::iter::from_fn(move || {
            let bit = bits.trailing_zeros() as u8;
            bits &= bits.wrapping_sub(1);
            (bit < 8).then(|| Pin::at(port, bit))
        })
    }
}

/// All ports.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ports {
    model: &'static Model,
    ports: [Port; PORTS],
    pull_ups_disabled: bool,
}

/// A register of directions.
pub(crate) fn is_direction(address: u16) -> bool {
    matches!(register(address), Some((_, PortRegister::Direction)))
}

impl Ports {
    pub(crate) fn new(model: &'static Model) -> Ports {
        Ports {
            model,
            ..Ports::default()
        }
    }

    pub(crate) fn read(&self, address: u16, cycle: u64) -> u8 {
        let Some((index, register)) = register(address) else {
            return 0;
        };
        let port = &self.ports[index];
        match register {
            PortRegister::Direction => port.direction,
            PortRegister::Output => port.output,
            PortRegister::Pin if cycle < port.changed + SYNCHRONISER => port.level_before,
            PortRegister::Pin => port.level,
        }
    }

    /// From `cycle` on a register reads the same until the port changes.
    pub(crate) fn is_steady(&self, address: u16, cycle: u64) -> bool {
        register(address).is_none_or(|(index, _)| cycle >= self.ports[index].changed + SYNCHRONISER)
    }

    pub(crate) fn write(&mut self, address: u16, value: u8, cycle: u64) -> Option<Change> {
        let (index, register) = register(address)?;
        let value = value & self.model.ports[index];
        self.change(index, cycle, |port| match register {
            PortRegister::Pin => port.output ^= value,
            PortRegister::Direction => port.direction = value,
            PortRegister::Output => port.output = value,
        })
    }

    /// SBI and CBI change one bit; SBI on PIN toggles it.
    pub(crate) fn write_bit(
        &mut self,
        address: u16,
        mask: u8,
        set: bool,
        cycle: u64,
    ) -> Option<Change> {
        let (index, register) = register(address)?;
        let mask = mask & self.model.ports[index];
        let put = |value: &mut u8| *value = if set { *value | mask } else { *value & !mask };
        self.change(index, cycle, |port| match register {
            PortRegister::Pin => port.output ^= if set { mask } else { 0 },
            PortRegister::Direction => put(&mut port.direction),
            PortRegister::Output => put(&mut port.output),
        })
    }

    /// Something outside drives a pin, or lets it go (`None`).
    pub(crate) fn set_outside(&mut self, pin: Pin, level: Option<bool>, cycle: u64) -> Change {
        let mask = pin.mask();
        let change = self.change(pin.port(), cycle, |port| {
            port.driven_outside &= !mask;
            port.outside &= !mask;
            if let Some(level) = level {
                port.driven_outside |= mask;
                port.outside |= if level { mask } else { 0 };
            }
        });
        change.unwrap_or(Change {
            port: pin.port(),
            levels: 0,
            driven: 0,
        })
    }

    /// A peripheral takes over a pin's output, or gives it back (`None`).
    pub(crate) fn override_output(
        &mut self,
        pin: Pin,
        level: Option<bool>,
        cycle: u64,
    ) -> Option<Change> {
        let mask = pin.mask();
        self.change(pin.port(), cycle, |port| {
            port.output_override &= !mask;
            port.output_value &= !mask;
            if let Some(level) = level {
                port.output_override |= mask;
                port.output_value |= if level { mask } else { 0 };
            }
        })
    }

    /// A peripheral takes over a pin's direction, and its level if it is an output.
    pub(crate) fn force(&mut self, pin: Pin, force: Force, cycle: u64) -> Option<Change> {
        let mask = pin.mask();
        self.change(pin.port(), cycle, |port| {
            let overridden = port.forced_output & mask;
            port.forced_input &= !mask;
            port.forced_output &= !mask;
            // A timer's override of another pin of the port stays.
            port.output_override &= !overridden;
            port.output_value &= !overridden;
            match force {
                Force::None => {}
                Force::Input => port.forced_input |= mask,
                Force::Output(level) => {
                    port.forced_output |= mask;
                    port.output_override |= mask;
                    port.output_value |= if level { mask } else { 0 };
                }
            }
        })
    }

    /// All registers start over: every pin is an input again. Gives what that changes.
    pub(crate) fn reset(&mut self, cycle: u64) -> Vec<Change> {
        let (before, disabled) = (self.ports, self.pull_ups_disabled);
        self.pull_ups_disabled = false;
        (0..PORTS)
            .filter_map(|index| {
                let port = &mut self.ports[index];
                *port = Port {
                    driven_outside: port.driven_outside,
                    outside: port.outside,
                    level: port.level,
                    level_before: port.level_before,
                    changed: port.changed,
                    ..Port::default()
                };
                self.settle(index, &before[index], disabled, cycle)
            })
            .collect()
    }

    /// The digital inputs of these pins of a port are off, and no others.
    pub(crate) fn disable_inputs(&mut self, port: usize, pins: u8, cycle: u64) -> Option<Change> {
        self.change(port, cycle, |port| port.disabled = pins)
    }

    /// Something outside drives the pin.
    pub(crate) fn is_driven_outside(&self, pin: Pin) -> bool {
        self.ports[pin.port() % PORTS].driven_outside & pin.mask() != 0
    }

    /// PUD of MCUCR; gives what it changes.
    pub(crate) fn disable_pull_ups(&mut self, disabled: bool, cycle: u64) -> Vec<Change> {
        if self.pull_ups_disabled == disabled {
            return Vec::new();
        }
        let before = self.ports;
        self.pull_ups_disabled = disabled;
        (0..PORTS)
            .filter_map(|index| self.settle(index, &before[index], !disabled, cycle))
            .collect()
    }

    /// The level of a pin now, without the synchroniser.
    pub(crate) fn level(&self, pin: Pin) -> bool {
        self.ports[pin.port() % PORTS].level & pin.mask() != 0
    }

    /// The bit of the output register.
    pub(crate) fn output(&self, pin: Pin) -> bool {
        self.ports[pin.port() % PORTS].output & pin.mask() != 0
    }

    /// The pin is an output.
    pub(crate) fn is_output(&self, pin: Pin) -> bool {
        self.ports[pin.port() % PORTS].directions() & pin.mask() != 0
    }

    /// What the chip does to a pin.
    pub(crate) fn drive(&self, pin: Pin) -> Drive {
        let port = &self.ports[pin.port() % PORTS];
        let drives = port.drives(!self.pull_ups_disabled);
        match drives.map(|pins| pins & pin.mask() != 0) {
            [true, true] => Drive::High,
            [true, false] => Drive::Low,
            [false, true] => Drive::PullUp,
            [false, false] => Drive::Floating,
        }
    }

    fn change(
        &mut self,
        index: usize,
        cycle: u64,
        apply: impl FnOnce(&mut Port),
    ) -> Option<Change> {
        let port = self.ports.get_mut(index)?;
        let before = *port;
        apply(port);
        self.settle(index, &before, self.pull_ups_disabled, cycle)
    }

    /// Works out the levels after a change.
    fn settle(
        &mut self,
        index: usize,
        before: &Port,
        pull_ups_disabled_before: bool,
        cycle: u64,
    ) -> Option<Change> {
        let pull_ups = if self.pull_ups_disabled { 0 } else { 0xFF };
        let port = self.ports.get_mut(index)?;
        let directions = port.directions();
        let pulled = port.output & pull_ups;
        let inputs = port.outside & port.driven_outside | pulled & !port.driven_outside;
        let level = (port.outputs() & directions | inputs & !directions) & !port.disabled;
        let levels = level ^ port.level;
        if levels != 0 {
            // Two changes in a row: what was already visible stays so until the second one is.
            if cycle >= port.changed + SYNCHRONISER {
                port.level_before = port.level;
            }
            port.level = level;
            port.changed = cycle;
        }
        let was = before.drives(!pull_ups_disabled_before);
        let is = port.drives(pull_ups != 0);
        let driven = was[0] ^ is[0] | was[1] ^ is[1];
        (levels | driven != 0).then_some(Change {
            port: index,
            levels,
            driven,
        })
    }
}

#[cfg(test)]
mod tests;
