//! Voltages at the analog inputs, and which of them a conversion is about (2549Q, tables 26-3 and 26-4).
//!
//! What the chip does to a pin itself counts too: an output has its level, a pull-up reaches the supply where nothing else is connected.

use crate::devices::SUPPLY_V;
use crate::devices::ports::{Drive, Ports};
use crate::model;

/// The reference that is an input too [V].
pub(super) const BANDGAP_V: f64 = 1.1;
/// The temperature sensor at 25 degrees (DS40002061B, table 23-2) [V].
const TEMPERATURE_V: f64 = 0.314;
/// Inputs: ADC0 to ADC15, the pin AREF, AIN0 and AIN1.
const INPUTS: usize = 19;
const AREF: usize = 16;
/// The comparator's inputs, AIN0 and AIN1.
pub(super) const COMPARATOR: [u8; 2] = [17, 18];

/// What is connected outside [V]; `None` where nothing is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs {
    model: &'static model::Analog,
    volts: [Option<f64>; INPUTS],
}

impl Default for Inputs {
    fn default() -> Inputs {
        Inputs::new(&<&model::Model>::default().analog)
    }
}

impl Inputs {
    pub(super) const fn new(model: &'static model::Analog) -> Inputs {
        Inputs {
            model,
            volts: [None; INPUTS],
        }
    }

    /// Another voltage, or none; what the pins cannot bear is cut off at the supply and at ground.
    pub(super) fn set(&mut self, channel: u8, volts: Option<f64>) {
        if let Some(input) = self.volts.get_mut(usize::from(channel))
            && volts.is_none_or(f64::is_finite)
        {
            *input = volts.map(|volts| volts.clamp(0.0, SUPPLY_V));
        }
    }

    /// The voltage at an input; a pin that nothing drives is at ground.
    pub(super) fn volts(&self, channel: u8, ports: &Ports) -> f64 {
        let outside = self.volts.get(usize::from(channel)).copied().flatten();
        match self.model.pin(channel).map(|pin| ports.drive(pin)) {
            Some(Drive::Low) => 0.0,
            Some(Drive::High) => SUPPLY_V,
            Some(Drive::PullUp) => outside.unwrap_or(SUPPLY_V),
            Some(Drive::Floating) | None => outside.unwrap_or_default(),
        }
    }

    /// The reference that REFS selects.
    fn reference(&self, select: u8) -> f64 {
        match select & 3 {
            0 => self.volts[AREF].unwrap_or(SUPPLY_V),
            1 => SUPPLY_V,
            2 => self.model.internal_v[0],
            _ => self.model.internal_v[1],
        }
    }

    /// The voltage of a single input by its MUX number; `None` for the differential ones.
    pub(super) fn single(&self, mux: u8, ports: &Ports) -> Option<f64> {
        if !self.model.differential {
            return Some(match mux & 0x0F {
                channel @ 0..8 => self.volts(channel, ports),
                8 => TEMPERATURE_V,
                0x0E => BANDGAP_V,
                _ => 0.0,
            });
        }
        match mux & 0x3F {
            0x1E => Some(BANDGAP_V),
            0x1F => Some(0.0),
            mux if mux & 0x18 == 0 => Some(self.volts(mux & 7 | mux >> 2 & 8, ports)),
            _ => None,
        }
    }

    /// What a conversion gives: 0 to 1023, or in two's complement for two inputs -512 to 511.
    pub(super) fn convert(&self, references: u8, mux: u8, ports: &Ports) -> u16 {
        let reference = self.reference(references);
        let ratio = |volts: f64| {
            if reference > 0.0 {
                volts / reference
            } else {
                0.0
            }
        };
        if let Some(volts) = self.single(mux, ports) {
            return (ratio(volts) * 1024.0).clamp(0.0, 1023.0) as u16;
        }
        let (positive, negative, gain) = pair(mux);
        let volts = |input: u8| self.volts(input | mux >> 2 & 8, ports);
        let steps = ratio((volts(positive) - volts(negative)) * gain) * 512.0;
        (steps.floor().clamp(-512.0, 511.0) as i16).cast_unsigned() & 0x3FF
    }
}

/// The two inputs of a differential channel within their bank of eight, and the gain.
fn pair(mux: u8) -> (u8, u8, f64) {
    let low = mux & 0x1F;
    match low {
        0x08..=0x0F => {
            let negative = if low & 4 != 0 { 2 } else { 0 };
            let gain = if low & 2 != 0 { 200.0 } else { 10.0 };
            (negative + (low & 1), negative, gain)
        }
        0x10..=0x17 => (low & 7, 1, 1.0),
        _ => (low & 7, 2, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conversion_is_a_share_of_its_reference() {
        let mut inputs = Inputs::default();
        let ports = Ports::default();
        for (channel, volts) in [(3, 2.5), (11, 1.0), (8, 0.99)] {
            inputs.set(channel, Some(volts));
        }
        for (references, mux, expected) in [
            (1, 0x03, 512),
            (1, 0x00, 0),
            (3, 0x03, 1000),
            (2, 0x03, 1023),
            (3, 0x23, 400),
            (1, 0x1E, 225),
            (1, 0x1F, 0),
            // ADC3 - ADC2, ten times: beyond the end; ADC1 - ADC3 does not exist, ADC2 - ADC1 is 0.
            (1, 0x0D, 511),
            (1, 0x13, 256),
            (1, 0x12, 0),
            // ADC8 - ADC10 at 2.56 V; ADC9 - ADC8, ten times: below the end.
            (3, 0x38, 198),
            (3, 0x29, 0x200),
        ] {
            assert_eq!(
                inputs.convert(references, mux, &ports),
                expected,
                "{references} {mux:#x}"
            );
        }
    }
}
