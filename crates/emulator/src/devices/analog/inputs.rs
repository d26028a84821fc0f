//! Voltages at the analog inputs, and which of them a conversion is about (DS40002549, tables 26-3 and 26-4).

use crate::devices::SUPPLY_V;

/// The two references on the chip [V].
const BANDGAP_V: f64 = 1.1;
const INTERNAL_V: f64 = 2.56;
/// Inputs: ADC0 to ADC15, and the pin AREF.
const INPUTS: usize = 17;
const AREF: usize = 16;

/// What is connected outside [V].
#[derive(Clone, Copy, Debug)]
pub(super) struct Inputs([f64; INPUTS]);

impl Default for Inputs {
    /// Nothing: inputs at ground, AREF at the supply.
    fn default() -> Inputs {
        let mut volts = [0.0; INPUTS];
        volts[AREF] = SUPPLY_V;
        Inputs(volts)
    }
}

impl Inputs {
    /// Another voltage; what the pins cannot bear is cut off at the supply and at ground.
    pub(super) fn set(&mut self, channel: u8, volts: f64) {
        if let Some(input) = self.0.get_mut(usize::from(channel))
            && volts.is_finite()
        {
            *input = volts.clamp(0.0, SUPPLY_V);
        }
    }

    /// The reference that REFS selects.
    fn reference(&self, select: u8) -> f64 {
        match select & 3 {
            0 => self.0[AREF],
            1 => SUPPLY_V,
            2 => BANDGAP_V,
            _ => INTERNAL_V,
        }
    }

    /// The voltage of a single input by its MUX number; `None` for the differential ones.
    pub(super) fn single(&self, mux: u8) -> Option<f64> {
        match mux & 0x3F {
            0x1E => Some(BANDGAP_V),
            0x1F => Some(0.0),
            mux if mux & 0x18 == 0 => Some(self.0[usize::from(mux & 7 | mux >> 2 & 8)]),
            _ => None,
        }
    }

    /// What a conversion gives: 0 to 1023, or in two's complement for two inputs -512 to 511.
    pub(super) fn convert(&self, references: u8, mux: u8) -> u16 {
        let reference = self.reference(references);
        let ratio = |volts: f64| {
            if reference > 0.0 {
                volts / reference
            } else {
                0.0
            }
        };
        if let Some(volts) = self.single(mux) {
            return (ratio(volts) * 1024.0).clamp(0.0, 1023.0) as u16;
        }
        let (positive, negative, gain) = pair(mux);
        let volts = |input: u8| self.0[usize::from(input | mux >> 2 & 8)];
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
        inputs.set(3, 2.5);
        inputs.set(11, 1.0);
        inputs.set(8, 0.99);
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
                inputs.convert(references, mux),
                expected,
                "{references} {mux:#x}"
            );
        }
    }
}
