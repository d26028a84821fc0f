//! The analog-to-digital converter and the analog comparator (2549Q, sections 25 and 26).
//!
//! A conversion begins at an edge of the converter's clock, samples its input 1.5 of its cycles later and ends after 13; the
//! first one after switching on takes 12 more. A trigger resets the prescaler, and its conversion takes 13.5.

mod inputs;

use super::Core;
use super::ports::Pin;
use super::schedule::Source;
use crate::model::Model;
use crate::registers::{ACSR, ADCH, ADCL, ADCSRA, ADCSRB, ADMUX, DIDR0, DIDR1, DIDR2};
use inputs::{COMPARATOR, Inputs};

/// ADCSRA.
const ADEN: u8 = 0x80;
const ADSC: u8 = 0x40;
const ADATE: u8 = 0x20;
const ADIF: u8 = 0x10;
const ADIE: u8 = 0x08;
const ADPS: u8 = 0x07;
/// ADCSRB.
const ACME: u8 = 0x40;
const MUX5: u8 = 0x08;
const ADTS: u8 = 0x07;
/// ADMUX.
const ADLAR: u8 = 0x20;
/// ACSR.
const ACD: u8 = 0x80;
const ACBG: u8 = 0x40;
const ACO: u8 = 0x20;
const ACI: u8 = 0x10;
const ACIE: u8 = 0x08;
const ACIC: u8 = 0x04;

/// Latency of a trigger [CPU cycles].
const TRIGGER_CYCLES: u64 = 3;

/// What can start a conversion, in the order of ADTS.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Trigger {
    Comparator,
    External0,
    /// A flag of timer 0 or 1.
    Timer(usize, u8),
}

/// A conversion on its way.
#[derive(Clone, Copy, Debug)]
struct Conversion {
    /// When its input is sampled; `None` afterwards.
    sample: Option<u64>,
    end: u64,
    references: u8,
    mux: u8,
    result: u16,
}

/// Converter and comparator.
#[derive(Clone, Debug, Default)]
pub(crate) struct Analog {
    model: &'static Model,
    inputs: Inputs,
    control_a: u8,
    control_b: u8,
    select: u8,
    disabled_digital: [u8; 3],
    flag: bool,
    result: u16,
    /// The low byte was read: the result stays until the high one is.
    locked: bool,
    /// The cycle from which the converter's clock counts.
    origin: u64,
    /// The next conversion is the first one.
    first: bool,
    conversion: Option<Conversion>,
    comparator: u8,
    /// The comparator's output.
    higher: bool,
    /// The capture input last handed to timer 1: the comparator's output, or `None` for its own pin.
    captured: Option<bool>,
    /// The cycle in which the converter lost its clock.
    stopped: Option<u64>,
}

impl Analog {
    pub(crate) fn new(model: &'static Model) -> Analog {
        Analog {
            model,
            inputs: Inputs::new(&model.analog),
            ..Analog::default()
        }
    }

    /// Starts over; what is connected stays.
    pub(crate) fn reset(&mut self, core: &mut Core) {
        *self = Analog {
            inputs: self.inputs,
            ..Analog::new(self.model)
        };
        self.reschedule(core);
    }

    /// A voltage changes; `None` when nothing is connected any more.
    pub(crate) fn set_volts(
        &mut self,
        core: &mut Core,
        channel: u8,
        volts: Option<f64>,
        cycle: u64,
    ) {
        self.inputs.set(channel, volts);
        self.compare(core, cycle);
    }

    /// The chip drives pins of this port differently: the comparator samples them.
    pub(crate) fn port_changed(&mut self, core: &mut Core, port: usize, cycle: u64) {
        let mut pins = self.model.analog.pins.iter().flatten();
        if pins.any(|pin| pin.port() == port) {
            self.compare(core, cycle);
        }
    }

    /// The converter has a clock from now on, or has none.
    pub(crate) fn set_running(&mut self, core: &mut Core, runs: bool, cycle: u64) {
        match self.stopped {
            None if !runs => self.stopped = Some(cycle),
            Some(stopped) if runs => {
                self.stopped = None;
                self.origin += cycle - stopped;
                if let Some(conversion) = &mut self.conversion {
                    conversion.end += cycle - stopped;
                    if let Some(sample) = &mut conversion.sample {
                        *sample += cycle - stopped;
                    }
                }
            }
            _ => return,
        }
        self.reschedule(core);
    }

    /// Cycles of the CPU in one of the converter.
    fn divisor(&self) -> u64 {
        1 << (self.control_a & ADPS).max(1)
    }

    fn mux(&self) -> u8 {
        self.select & 0x1F | (self.control_b & MUX5) << 2
    }

    /// What starts conversions, if anything does.
    pub(crate) fn trigger(&self) -> Option<Trigger> {
        if self.control_a & (ADEN | ADATE) != ADEN | ADATE {
            return None;
        }
        match self.control_b & ADTS {
            0 => None,
            1 => Some(Trigger::Comparator),
            2 => Some(Trigger::External0),
            3 => Some(Trigger::Timer(0, 0x02)),
            4 => Some(Trigger::Timer(0, 0x01)),
            5 => Some(Trigger::Timer(1, 0x04)),
            6 => Some(Trigger::Timer(1, 0x01)),
            _ => Some(Trigger::Timer(1, 0x20)),
        }
    }

    fn runs_freely(&self) -> bool {
        self.control_a & ADATE != 0 && self.control_b & ADTS == 0
    }

    pub(crate) fn read(&mut self, address: u16) -> u8 {
        let [low, high] = if self.select & ADLAR != 0 {
            self.result << 6
        } else {
            self.result
        }
        .to_le_bytes();
        match address {
            ADCL => {
                self.locked = true;
                low
            }
            ADCH => {
                self.locked = false;
                high
            }
            ADCSRA => {
                let busy = if self.conversion.is_some() { ADSC } else { 0 };
                let flag = if self.flag { ADIF } else { 0 };
                self.control_a | busy | flag
            }
            ADCSRB => self.control_b,
            ADMUX => self.select,
            DIDR0 => self.disabled_digital[0],
            DIDR1 => self.disabled_digital[1],
            DIDR2 => self.disabled_digital[2],
            ACSR => self.comparator | if self.higher { ACO } else { 0 },
            _ => 0,
        }
    }

    pub(crate) fn write(&mut self, core: &mut Core, address: u16, value: u8, cycle: u64) {
        match address {
            ADCSRA => self.write_control(value, cycle),
            ADCSRB => {
                let mux5 = if self.model.analog.differential {
                    MUX5
                } else {
                    0
                };
                self.control_b = value & (ACME | mux5 | ADTS);
            }
            ADMUX => self.select = value,
            DIDR0 => self.disabled_digital[0] = value,
            DIDR1 => self.disabled_digital[1] = value & 3,
            DIDR2 => self.disabled_digital[2] = value,
            ACSR => {
                let flag = self.comparator & ACI & !value;
                self.comparator = value & !(ACO | ACI) | flag;
            }
            _ => {}
        }
        self.compare(core, cycle);
        self.reschedule(core);
    }

    fn write_control(&mut self, value: u8, cycle: u64) {
        let was_on = self.control_a & ADEN != 0;
        self.control_a = value & (ADEN | ADATE | ADIE | ADPS);
        self.flag &= value & ADIF == 0;
        if value & ADEN == 0 {
            self.conversion = None;
        } else if !was_on {
            self.origin = cycle;
            self.first = true;
        }
        if value & ADEN != 0 && value & ADSC != 0 && self.conversion.is_none() {
            self.start(cycle);
        }
    }

    /// Sleep modes that quieten the chip start a conversion.
    pub(crate) fn start_asleep(&mut self, core: &mut Core, cycle: u64) {
        if self.control_a & ADEN != 0 && self.conversion.is_none() {
            self.start(cycle);
            self.reschedule(core);
        }
    }

    fn start(&mut self, cycle: u64) {
        let divisor = self.divisor();
        // A trigger may come while the clock is still coming up.
        let waited = (cycle + 1).saturating_sub(self.origin).div_ceil(divisor);
        let extra = if self.first { 12 } else { 0 };
        self.begin(self.origin + waited * divisor, 2 * extra + 3, 13 + extra);
    }

    /// A conversion whose clock starts at `start`: `sample` half cycles to its sample, `length` cycles to its end.
    fn begin(&mut self, start: u64, sample: u64, length: u64) {
        let divisor = self.divisor();
        self.first = false;
        self.conversion = Some(Conversion {
            sample: Some(start + sample * divisor / 2),
            end: start + length * divisor,
            references: self.select >> 6,
            mux: self.mux(),
            result: 0,
        });
    }

    /// The flag of the trigger was raised.
    pub(crate) fn triggered(&mut self, core: &mut Core, cycle: u64) {
        if self.conversion.is_some() {
            return;
        }
        if self.first {
            self.start(cycle);
        } else {
            self.origin = cycle + TRIGGER_CYCLES;
            self.begin(self.origin, 4, 13);
            let half = self.divisor() / 2;
            if let Some(conversion) = &mut self.conversion {
                conversion.end += half;
            }
        }
        self.reschedule(core);
    }

    /// The sample or the end of the conversion is due.
    pub(crate) fn happen(&mut self, core: &mut Core, cycle: u64) {
        if let Some(conversion) = &mut self.conversion {
            if conversion
                .sample
                .take_if(|sample| *sample <= cycle)
                .is_some()
            {
                let (references, mux) = (conversion.references, conversion.mux);
                conversion.result = self.inputs.convert(references, mux, &core.ports);
            } else if conversion.end <= cycle {
                let result = conversion.result;
                self.finish(result, cycle);
            }
        }
        self.reschedule(core);
    }

    fn finish(&mut self, result: u16, cycle: u64) {
        if !self.locked {
            self.result = result;
        }
        self.flag = true;
        self.conversion = None;
        if self.runs_freely() {
            self.begin(cycle, 3, 13);
        }
    }

    fn reschedule(&self, core: &mut Core) {
        let running = self.conversion.filter(|_| self.stopped.is_none());
        let next = running.map(|conversion| conversion.sample.unwrap_or(conversion.end));
        core.schedule.set(Source::Analog, next);
        let converted = self.flag && self.control_a & ADIE != 0;
        core.interrupts.set(core.model.numbers.converted, converted);
        let compared = self.comparator & (ACI | ACIE) == ACI | ACIE;
        core.interrupts.set(core.model.numbers.compared, compared);
    }

    /// The comparator samples its inputs.
    fn compare(&mut self, core: &mut Core, cycle: u64) {
        let higher = self.comparator & ACD == 0 && self.is_higher(core);
        if higher != self.higher {
            self.changed(core, higher, cycle);
        }
        let captured = (self.comparator & ACIC != 0).then_some(higher);
        if captured != self.captured {
            self.captured = captured;
            core.captured = Some((captured, cycle));
        }
    }

    /// The positive input is above the negative one (section 25.1, table 25-1).
    fn is_higher(&self, core: &Core) -> bool {
        let ports = &core.ports;
        let [positive, negative] = COMPARATOR;
        let positive = match self.comparator & ACBG {
            0 => self.inputs.volts(positive, ports),
            _ => inputs::BANDGAP_V,
        };
        let multiplexed = self.control_b & ACME != 0 && self.control_a & ADEN == 0;
        let negative = if multiplexed {
            let channel = self.mux() & 0x27;
            self.inputs.single(channel, ports).unwrap_or_default()
        } else {
            self.inputs.volts(negative, ports)
        };
        positive > negative
    }

    /// The comparator's output changes.
    fn changed(&mut self, core: &mut Core, higher: bool, cycle: u64) {
        self.higher = higher;
        // ACIS: toggle, reserved, falling, rising.
        let meant = match self.comparator & 3 {
            2 => !higher,
            3 => higher,
            _ => true,
        };
        if self.comparator & ACD == 0 && meant {
            let raised = self.comparator & ACI == 0;
            self.comparator |= ACI;
            if raised && self.trigger() == Some(Trigger::Comparator) {
                self.triggered(core, cycle);
            }
        }
        self.reschedule(core);
    }

    /// Pins whose digital input is off, by their port: each of the registers is for one.
    pub(crate) fn disabled_digital(&self) -> impl Iterator<Item = (usize, u8)> + use<> {
        let (model, registers) = (self.model, self.disabled_digital);
        let firsts = [0, usize::from(COMPARATOR[0]), 8];
        firsts
            .into_iter()
            .zip(registers)
            .filter_map(|(first, bits)| {
                let pins = model.analog.pins[first..].iter().take(8);
                let off = |(bit, pin): (usize, &Option<Pin>)| {
                    pin.map_or(0, |pin| if bits >> bit & 1 != 0 { pin.mask() } else { 0 })
                };
                let mask = pins.enumerate().map(off).fold(0, |all, mask| all | mask);
                Some((model.analog.pins[first]?.port(), mask))
            })
    }

    /// One of the two interrupts is entered.
    pub(crate) fn acknowledge(&mut self, core: &mut Core, vector: u8) {
        if vector == core.model.numbers.converted {
            self.flag = false;
        } else {
            self.comparator &= !ACI;
        }
        self.reschedule(core);
    }
}
