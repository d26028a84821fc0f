//! Half a motor driver as the chip drives it: its lines, each at a level or pulse-width modulated, and what the motor gets.
//!
//! A line's share of time high comes from the timer that makes it, if one does. Else it is measured: two rising edges within
//! [`LONGEST_CYCLES`] are PWM made by a program, and its share is that of the last whole period. A slower wave is no PWM to the
//! motor, whose current follows within a third of a millisecond: there each edge counts for itself.
//!
//! What the levels of enable and direction inputs make of the motor is a table of each [`Driver`]; modulated inputs count
//! by their shares of time, as if they were independent of each other.

use super::CYCLES_PER_US;
use super::pins::DriverInput;
use super::servo;
use crate::drivers::{Direction, Driver, Stage};
use rumbo_emulator::devices::Pwm;
use rumbo_plant::drivetrain::{Bridge, Decay, Modulation};

/// Longest period that counts as PWM: 4 ms, 250 Hz.
const LONGEST_CYCLES: u64 = 4_000 * CYCLES_PER_US;
/// A servo stops this long after its last pulse: three of its periods.
const PULSES_CYCLES: u64 = 60_000 * CYCLES_PER_US;

/// A wave that the program makes itself.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    share: f64,
    period_cycles: u64,
}

/// One input of the bridge.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Line {
    high: bool,
    been_high: bool,
    been_modulated: bool,
    /// The timer's PWM, if it has the pin.
    timer: Option<Pwm>,
    rise_cycle: Option<u64>,
    edge_cycle: u64,
    wave: Option<Wave>,
    /// Width of the last pulse.
    pulse_cycles: Option<u64>,
}

impl Line {
    /// The line's level from this cycle on.
    pub(super) fn set(&mut self, cycle: u64, high: bool) {
        if high == self.high {
            return;
        }
        self.high = high;
        self.been_high |= high;
        if high {
            self.wave = self.rise_cycle.and_then(|before| {
                let period_cycles = cycle - before;
                let on = self.edge_cycle - before;
                (period_cycles <= LONGEST_CYCLES && period_cycles > 0).then(|| Wave {
                    share: on as f64 / period_cycles as f64,
                    period_cycles,
                })
            });
            self.been_modulated |= self.wave.is_some();
            self.rise_cycle = Some(cycle);
        } else {
            self.pulse_cycles = self.rise_cycle.map(|rise| cycle - rise);
        }
        self.edge_cycle = cycle;
    }

    /// A timer takes the line, or lets go of it.
    pub(super) fn modulate(&mut self, pwm: Option<Pwm>) {
        self.timer = pwm;
        self.been_high |= pwm.is_some_and(|pwm| pwm.share > 0.0);
        self.been_modulated |= pwm.is_some_and(|pwm| pwm.period_cycles.is_some());
        self.wave = None;
        self.rise_cycle = None;
    }

    /// Whether it was ever high.
    pub(super) fn been_high(&self) -> bool {
        self.been_high
    }

    /// Whether a PWM was ever on it.
    pub(super) fn been_modulated(&self) -> bool {
        self.been_modulated
    }

    /// The wave is over if its next edge does not come in time.
    fn expires_cycle(&self) -> Option<u64> {
        let wave = self.wave.filter(|_| self.timer.is_none())?;
        Some(self.edge_cycle + 2 * wave.period_cycles)
    }

    /// Share of time high, and the period of the modulation.
    fn share(&self) -> (f64, Option<u64>) {
        match (self.timer, self.wave) {
            (
                Some(Pwm {
                    share,
                    period_cycles,
                }),
                _,
            ) if period_cycles.is_some() => (share, period_cycles),
            (
                None,
                Some(Wave {
                    share,
                    period_cycles,
                }),
            ) => (share, Some(period_cycles)),
            _ => (f64::from(u8::from(self.high)), None),
        }
    }
}

/// The inputs of one half.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfBridge {
    driver: &'static Driver,
    /// Enable, forward, backward and standby, in this order.
    pub(super) lines: [Line; 4],
    /// The direction input that is the inverse of the other one.
    inverse: Option<usize>,
}

impl HalfBridge {
    /// A half whose inputs are wired so.
    pub(super) fn new(driver: &'static Driver, inputs: [DriverInput; 4]) -> Self {
        let held = |input| Line {
            high: input == DriverInput::High,
            been_high: input == DriverInput::High,
            ..Line::default()
        };
        let unwired = |input: &usize| inputs[*input].pin().is_none();
        Self {
            driver,
            lines: inputs.map(held),
            inverse: match driver.direction {
                Direction::Two | Direction::Motor => None,
                Direction::One | Direction::Pulse => [2, 1].into_iter().find(unwired),
            },
        }
    }

    /// When a wave may be over.
    pub(super) fn expires_cycle(&self) -> Option<u64> {
        if let Some(line) = self.servo_line() {
            return line.pulse_cycles.map(|_| line.edge_cycle + PULSES_CYCLES);
        }
        self.lines.iter().filter_map(Line::expires_cycle).min()
    }

    /// The line with the pulses of a servo, if this is one.
    fn servo_line(&self) -> Option<&Line> {
        let is_servo = self.driver.direction == Direction::Pulse;
        is_servo.then(|| &self.lines[if self.inverse == Some(1) { 2 } else { 1 }])
    }

    /// What the servo's own bridge does.
    fn servo(&self, line: &Line) -> (Bridge, Modulation) {
        let width_us = line
            .pulse_cycles
            .map(|cycles| cycles as f64 / CYCLES_PER_US as f64);
        let share = width_us.and_then(servo::turning);
        let share = share.map(|share| {
            if self.inverse == Some(1) {
                -share
            } else {
                share
            }
        });
        let bridge = match share {
            None => Bridge::Released,
            Some(0.0) => Bridge::Brake(1.0),
            Some(share) if share > 0.0 => Bridge::Forward(share),
            Some(share) => Bridge::Backward(-share),
        };
        let decay = Decay::Slow;
        (bridge, Modulation { hz: None, decay })
    }

    /// Ends the waves that have timed out.
    pub(super) fn expire(&mut self, cycle: u64) {
        let is_over =
            self.servo_line().is_some() && self.expires_cycle().is_some_and(|due| due <= cycle);
        for line in &mut self.lines {
            line.pulse_cycles = line.pulse_cycles.filter(|_| !is_over);
            if line.expires_cycle().is_some_and(|due| due <= cycle) {
                line.wave = None;
                line.rise_cycle = None;
            }
        }
    }

    /// What the motor gets, and how it is modulated.
    pub(super) fn state(&self) -> (Bridge, Modulation) {
        if let Some(line) = self.servo_line() {
            return self.servo(line);
        }
        let shares = self.lines.each_ref().map(Line::share);
        let period = shares.iter().find_map(|(_, period)| *period);
        let [enable, mut forward, mut backward, standby] = shares.map(|(share, _)| share);
        match self.inverse {
            Some(1) => forward = 1.0 - backward,
            Some(_) => backward = 1.0 - forward,
            None => {}
        }
        let mut times = [0.0; 4];
        for (row, enabled) in self.driver.does.iter().zip([1.0 - enable, enable]) {
            for (index, stage) in row.iter().enumerate() {
                let of = |bit: usize, share: f64| {
                    if index >> bit & 1 == 1 {
                        share
                    } else {
                        1.0 - share
                    }
                };
                times[*stage as usize] += enabled * of(0, forward) * of(1, backward);
            }
        }
        let time = |stage: Stage| {
            if standby > 0.0 {
                times[stage as usize]
            } else {
                0.0
            }
        };
        let share = time(Stage::Forward) - time(Stage::Backward);
        let bridge = if share > 0.0 {
            Bridge::Forward(share)
        } else if share < 0.0 {
            Bridge::Backward(-share)
        } else if time(Stage::Brake) > 0.0 {
            Bridge::Brake(time(Stage::Brake))
        } else {
            Bridge::Released
        };
        let decay = match time(Stage::Brake) > time(Stage::Coast) {
            true => Decay::Slow,
            false => Decay::Fast,
        };
        let hz = period.map(|cycles| 1e6 * CYCLES_PER_US as f64 / cycles as f64);
        (bridge, Modulation { hz, decay })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half(driver: &str, levels: [bool; 4]) -> HalfBridge {
        let inputs = levels.map(|high| {
            if high {
                DriverInput::High
            } else {
                DriverInput::Low
            }
        });
        HalfBridge::new(Driver::named(driver).unwrap(), inputs)
    }

    fn pwm(share: f64) -> Option<Pwm> {
        Some(Pwm {
            share,
            period_cycles: Some(32_640),
        })
    }

    #[test]
    fn every_driver_does_what_its_truth_table_says() {
        use Bridge::{Backward, Brake, Forward, Released};
        let levels = |word: &str| -> [bool; 4] {
            let mut bits = word.bytes().map(|bit| bit == b'1');
            std::array::from_fn(|_| bits.next().unwrap())
        };
        for (driver, word, does) in [
            // Enable, forward, backward, standby.
            ("l298n", "1101", Forward(1.0)),
            ("l298n", "1011", Backward(1.0)),
            ("l298n", "1111", Brake(1.0)),
            ("l298n", "1001", Brake(1.0)),
            ("l298n", "0101", Released),
            ("l298n", "0001", Released),
            ("tb6612", "1101", Forward(1.0)),
            ("tb6612", "0101", Brake(1.0)),
            ("tb6612", "1001", Released),
            ("tb6612", "1111", Brake(1.0)),
            ("tb6612", "1100", Released),
            ("drv8833", "1011", Backward(1.0)),
            ("drv8833", "1001", Released),
            ("drv8833", "1111", Brake(1.0)),
            ("drv8833", "1010", Released),
            ("mx1508", "1001", Released),
            ("l9110s", "1011", Backward(1.0)),
            ("l9110s", "1001", Brake(1.0)),
            ("l9110s", "1111", Brake(1.0)),
            ("bts7960", "1101", Forward(1.0)),
            ("bts7960", "1001", Brake(1.0)),
            ("bts7960", "0101", Released),
        ] {
            assert_eq!(
                half(driver, levels(word)).state().0,
                does,
                "{driver} {word}"
            );
        }
    }

    #[test]
    fn one_direction_input_drives_both_ways_whichever_way_its_high_is() {
        let pin =
            |bit| DriverInput::Pin(rumbo_emulator::devices::ports::Pin::new('B', bit).unwrap());
        let driver = Driver::named("dir-pwm").unwrap();
        for (inputs, line) in [
            ([pin(0), pin(1), DriverInput::Low, DriverInput::High], 1),
            ([pin(0), DriverInput::Low, pin(1), DriverInput::High], 2),
        ] {
            let mut half = HalfBridge::new(driver, inputs);
            half.lines[0].modulate(pwm(0.5));
            let low = half.state();
            half.lines[line].set(0, true);
            let high = half.state();
            let (forward, backward) = if line == 1 { (high, low) } else { (low, high) };
            assert_eq!(forward.0, Bridge::Forward(0.5));
            assert_eq!(backward.0, Bridge::Backward(0.5));
            assert_eq!(forward.1.decay, Decay::Slow);
        }
    }

    #[test]
    fn a_timer_s_pwm_counts_by_its_share_and_frequency_whatever_the_level_is() {
        let mut half = half("l298n", [false, false, true, true]);
        half.lines[0].modulate(pwm(0.4));
        let (bridge, modulation) = half.state();
        assert_eq!(bridge, Bridge::Backward(0.4));
        assert_eq!(modulation.decay, Decay::Fast);
        assert!((modulation.hz.unwrap() - 490.2).abs() < 0.01);
    }

    #[test]
    fn a_program_s_own_pwm_is_measured_over_its_last_period_and_ends_with_its_edges() {
        let mut half = half("l298n", [false, true, false, true]);
        for n in 0..3 {
            half.lines[0].set(10_000 + 16_000 * n, true);
            half.lines[0].set(14_000 + 16_000 * n, false);
        }
        let (bridge, modulation) = half.state();
        assert_eq!(bridge, Bridge::Forward(0.25));
        assert_eq!(modulation.hz, Some(1_000.0));
        let due = half.expires_cycle().unwrap();
        assert_eq!(due, 46_000 + 32_000);
        half.expire(due);
        assert_eq!(half.state().0, Bridge::Released);
    }

    #[test]
    fn a_slow_wave_is_on_and_off() {
        let mut half = half("l298n", [false, true, false, true]);
        for n in 0..3 {
            half.lines[0].set(100_000 * n, true);
            assert_eq!(half.state().0, Bridge::Forward(1.0));
            half.lines[0].set(100_000 * n + 50_000, false);
            assert_eq!(half.state().0, Bridge::Released);
        }
    }

    #[test]
    fn an_input_modulated_under_a_constant_enable_drives_and_brakes() {
        let mut half = half("l298n", [true, false, true, true]);
        half.lines[1].modulate(pwm(0.25));
        let (bridge, modulation) = half.state();
        assert_eq!(
            (bridge, modulation.decay),
            (Bridge::Backward(0.75), Decay::Slow)
        );
    }

    #[test]
    fn a_continuous_servo_turns_by_the_width_of_its_pulses_and_stands_without_them() {
        let pin =
            |bit| DriverInput::Pin(rumbo_emulator::devices::ports::Pin::new('B', bit).unwrap());
        let driver = Driver::named("continuous-servos").unwrap();
        let (low, high) = (DriverInput::Low, DriverInput::High);
        let mut left = HalfBridge::new(driver, [high, pin(0), low, high]);
        let mut right = HalfBridge::new(driver, [high, low, pin(1), high]);
        assert_eq!(left.state().0, Bridge::Released);
        let mut cycle = 0;
        let mut pulse = |half: &mut HalfBridge, line: usize, width_us: u64| {
            cycle += 20_000 * CYCLES_PER_US;
            half.lines[line].set(cycle, true);
            half.lines[line].set(cycle + width_us * CYCLES_PER_US, false);
            half.state().0
        };
        assert_eq!(pulse(&mut left, 1, 1_700), Bridge::Forward(1.0));
        assert_eq!(pulse(&mut left, 1, 1_300), Bridge::Backward(1.0));
        assert_eq!(pulse(&mut right, 2, 1_300), Bridge::Forward(1.0));
        assert_eq!(pulse(&mut right, 2, 1_565), Bridge::Backward(0.5));
        // write(90) of the Servo library is 1472 us.
        assert_eq!(pulse(&mut left, 1, 1_472), Bridge::Brake(1.0));
        let due = left.expires_cycle().unwrap();
        left.expire(due);
        assert_eq!(
            (left.state().0, left.expires_cycle()),
            (Bridge::Released, None)
        );
    }
}
