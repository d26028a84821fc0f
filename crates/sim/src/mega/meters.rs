//! Instruments at the wired pins: what a voltmeter, a counter and a pulse meter show, whatever the program is.
//!
//! A level is a mean over time, 0 to 1: sampled now and then, the level of a modulated pin would be noise.

use super::CYCLES_PER_US;
use rumbo_emulator::devices::Pwm;
use rumbo_emulator::devices::ports::Pin;

/// An echo this wide or wider is none: the sonar gave up \[us\].
const NO_ECHO_US: f64 = 30_000.0;
/// Half the speed of sound: the way there and back \[m/us\].
const M_PER_US: f64 = 0.5 * 343.4e-6;
/// A pulse is shown for this long after its end \[us\].
const SHOWN_US: u64 = 500_000;

/// An instrument at one pin.
#[derive(Clone, Debug)]
pub(super) struct Meter {
    name: String,
    pin: Pin,
    high: bool,
    /// Share of the time high, where a timer makes the level.
    share: Option<f64>,
    /// Cycles high since the last reading, up to `at_cycle`.
    high_cycles: f64,
    at_cycle: u64,
    read_cycle: u64,
    edges: u32,
    /// Of them those that a frequency has been made of.
    edges_read: u32,
    rise_cycle: u64,
    /// Width of the last pulse, and when it ended.
    pulse: Option<(u64, u64)>,
}

impl Meter {
    fn new(name: String, pin: Pin) -> Self {
        Self {
            name,
            pin,
            high: false,
            share: None,
            high_cycles: 0.0,
            at_cycle: 0,
            read_cycle: 0,
            edges: 0,
            edges_read: 0,
            rise_cycle: 0,
            pulse: None,
        }
    }

    fn pass(&mut self, cycle: u64) {
        let share = self.share.unwrap_or(f64::from(u8::from(self.high)));
        self.high_cycles += share * cycle.saturating_sub(self.at_cycle) as f64;
        self.at_cycle = self.at_cycle.max(cycle);
    }

    fn set(&mut self, cycle: u64, high: bool) {
        if high == self.high {
            return;
        }
        self.pass(cycle);
        self.high = high;
        self.edges = self.edges.wrapping_add(1);
        if high {
            self.rise_cycle = cycle;
        } else {
            self.pulse = Some((cycle.saturating_sub(self.rise_cycle), cycle));
        }
    }

    fn read_level(&mut self, cycle: u64) -> f64 {
        self.pass(cycle);
        let passed = self.at_cycle.saturating_sub(self.read_cycle);
        let level = match passed {
            0 => f64::from(u8::from(self.high)),
            passed => self.high_cycles / passed as f64,
        };
        (self.high_cycles, self.read_cycle) = (0.0, self.at_cycle);
        level
    }

    /// Frequency of its level since the last reading \[Hz\].
    fn read_hz(&mut self, cycle: u64) -> f64 {
        let edges = self.edges.wrapping_sub(self.edges_read);
        self.edges_read = self.edges;
        let passed = cycle.saturating_sub(self.read_cycle) as f64 / (1e6 * CYCLES_PER_US as f64);
        if passed > 0.0 {
            0.5 * f64::from(edges) / passed
        } else {
            0.0
        }
    }

    /// Width of the last pulse, unless it is long ago \[us\].
    fn pulse_us(&self, cycle: u64) -> Option<f64> {
        let (width, end) = self.pulse?;
        let recent = cycle <= end + SHOWN_US * CYCLES_PER_US;
        recent.then_some(width as f64 / CYCLES_PER_US as f64)
    }
}

/// The instruments at all wired pins and the LED.
#[derive(Clone, Debug)]
pub(super) struct Meters(Vec<Meter>);

impl Meters {
    /// At these pins, each with its name.
    pub(super) fn at(pins: impl IntoIterator<Item = (String, Pin)>) -> Self {
        let pins = pins.into_iter();
        Self(pins.map(|(name, pin)| Meter::new(name, pin)).collect())
    }

    fn at_pin(&mut self, pin: Pin) -> impl Iterator<Item = &mut Meter> {
        self.0.iter_mut().filter(move |meter| meter.pin == pin)
    }

    /// The pin's level from this cycle on.
    pub(super) fn set(&mut self, cycle: u64, pin: Pin, high: bool) {
        self.at_pin(pin).for_each(|meter| meter.set(cycle, high));
    }

    /// A timer modulates the pin, or lets go of it.
    pub(super) fn modulate(&mut self, cycle: u64, pin: Pin, pwm: Option<Pwm>) {
        let moving = pwm.filter(|pwm| pwm.period_cycles.is_some());
        self.at_pin(pin).for_each(|meter| {
            meter.pass(cycle);
            meter.share = moving.map(|pwm| pwm.share);
        });
    }

    /// What they show, by name: the level of each pin since the last reading (`pin_left_enable`), the edges of the
    /// encoders so far, the frequency of a buzzer, the range that the last echo of each sonar gave, infinite without an echo, and the width of the
    /// servo's last pulse. Not a number where nothing was measured lately.
    pub(super) fn read(&mut self, cycle: u64) -> Vec<(String, f64)> {
        let mut shown = Vec::new();
        for meter in &mut self.0 {
            let name = meter.name.clone();
            let name = name.as_str();
            let pulse_us = meter.pulse_us(cycle).unwrap_or(f64::NAN);
            if let Some(side) = name.strip_suffix("_encoder") {
                shown.push((format!("{side}_edges"), f64::from(meter.edges)));
            } else if let Some(sonar) = name.strip_suffix("_echo") {
                let range_m = match pulse_us >= NO_ECHO_US {
                    true => f64::INFINITY,
                    false => pulse_us * M_PER_US,
                };
                shown.push((format!("pinged_{sonar}_m"), range_m));
            } else if let Some(name) = name.strip_suffix("_buzzer") {
                shown.push((format!("{name}_hz"), meter.read_hz(cycle)));
            } else if name == "servo" {
                shown.push(("servo_pulse_us".into(), pulse_us));
            }
            shown.push((format!("pin_{name}"), meter.read_level(cycle)));
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000 * CYCLES_PER_US;

    fn shown(meters: &mut Meters, cycle: u64, name: &str) -> f64 {
        let shown = meters.read(cycle);
        shown.iter().find(|(known, _)| known == name).unwrap().1
    }

    fn meters(name: &str) -> (Meters, Pin) {
        let pin = Pin::new('B', 7).unwrap();
        (Meters::at([(name.to_owned(), pin)]), pin)
    }

    #[test]
    fn a_level_is_its_share_of_the_time_since_the_last_reading() {
        let (mut meters, pin) = meters("led");
        meters.set(MS, pin, true);
        meters.set(4 * MS, pin, false);
        assert_eq!(shown(&mut meters, 10 * MS, "pin_led"), 0.3);
        assert_eq!(shown(&mut meters, 20 * MS, "pin_led"), 0.0);
        let pwm = Pwm {
            share: 0.25,
            period_cycles: Some(32_640),
        };
        meters.modulate(20 * MS, pin, Some(pwm));
        assert_eq!(shown(&mut meters, 30 * MS, "pin_led"), 0.25);
    }

    #[test]
    fn an_echo_is_a_range_until_it_is_old_and_a_long_one_is_clear() {
        let (mut meters, pin) = meters("front_echo");
        assert!(shown(&mut meters, MS, "pinged_front_m").is_nan());
        meters.set(10 * MS, pin, true);
        meters.set(16 * MS, pin, false);
        let range_m = shown(&mut meters, 20 * MS, "pinged_front_m");
        assert!((range_m - 1.0302).abs() < 1e-9, "{range_m}");
        assert!(shown(&mut meters, 600 * MS, "pinged_front_m").is_nan());
        meters.set(700 * MS, pin, true);
        meters.set(738 * MS, pin, false);
        assert_eq!(
            shown(&mut meters, 740 * MS, "pinged_front_m"),
            f64::INFINITY
        );
    }

    #[test]
    fn every_edge_of_an_encoder_counts_once() {
        let (mut meters, pin) = meters("left_encoder");
        for level in [true, true, false, true] {
            meters.set(MS, pin, level);
        }
        assert_eq!(shown(&mut meters, 2 * MS, "left_edges"), 3.0);
    }

    #[test]
    fn a_buzzer_sounds_at_half_of_its_edges() {
        let (mut meters, pin) = meters("horn_buzzer");
        meters.read(0);
        for half in 1..=40 {
            meters.set(half * MS / 2, pin, half % 2 == 1);
        }
        assert_eq!(shown(&mut meters, 20 * MS, "horn_hz"), 1_000.0);
        assert_eq!(shown(&mut meters, 40 * MS, "horn_hz"), 0.0);
    }
}
