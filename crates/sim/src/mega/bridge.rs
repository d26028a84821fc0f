//! Half an L298N as the chip drives it: three lines, each at a level or pulse-width modulated, and what the motor gets.
//!
//! A line's share of time high comes from the timer that makes it, if one does. Else it is measured: two rising edges within
//! [`LONGEST_CYCLES`] are PWM made by a program, and its share is that of the last whole period. A slower wave is no PWM to the
//! motor, whose current follows within a third of a millisecond: there each edge counts for itself.
//!
//! | enable | inputs | motor |
//! |---|---|---|
//! | low | any | released |
//! | high | one high, one low | driven |
//! | high | alike | shorted: a brake |
//!
//! (L298 datasheet, "bidirectional DC motor control".) Modulated inputs count by their shares: driven by the difference.

use super::CYCLES_PER_US;
use rumbo_emulator::devices::Pwm;
use rumbo_plant::drivetrain::Bridge;

/// Longest period that counts as PWM: 4 ms, 250 Hz.
const LONGEST_CYCLES: u64 = 4_000 * CYCLES_PER_US;

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
    /// The timer's PWM, if it has the pin.
    timer: Option<Pwm>,
    rise_cycle: Option<u64>,
    edge_cycle: u64,
    wave: Option<Wave>,
}

impl Line {
    /// The line's level from this cycle on.
    pub(super) fn set(&mut self, cycle: u64, high: bool) {
        if high == self.high {
            return;
        }
        self.high = high;
        if high {
            self.wave = self.rise_cycle.and_then(|before| {
                let period_cycles = cycle - before;
                let on = self.edge_cycle - before;
                (period_cycles <= LONGEST_CYCLES && period_cycles > 0).then(|| Wave {
                    share: on as f64 / period_cycles as f64,
                    period_cycles,
                })
            });
            self.rise_cycle = Some(cycle);
        }
        self.edge_cycle = cycle;
    }

    /// A timer takes the line, or lets go of it.
    pub(super) fn modulate(&mut self, pwm: Option<Pwm>) {
        self.timer = pwm;
        self.wave = None;
        self.rise_cycle = None;
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

/// The three inputs of one half.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HalfBridge {
    /// Enable, forward and backward, in this order.
    pub(super) lines: [Line; 3],
}

impl HalfBridge {
    /// When a wave may be over.
    pub(super) fn expires_cycle(&self) -> Option<u64> {
        self.lines.iter().filter_map(Line::expires_cycle).min()
    }

    /// Ends the waves that have timed out.
    pub(super) fn expire(&mut self, cycle: u64) {
        for line in &mut self.lines {
            if line.expires_cycle().is_some_and(|due| due <= cycle) {
                line.wave = None;
                line.rise_cycle = None;
            }
        }
    }

    /// What the motor gets, and the frequency of the modulation [Hz].
    pub(super) fn state(&self) -> (Bridge, Option<f64>) {
        let [
            (enable, enable_period),
            (forward, forward_period),
            (backward, backward_period),
        ] = self.lines.each_ref().map(Line::share);
        let period = enable_period.or(forward_period).or(backward_period);
        let pwm_hz = period.map(|cycles| 1e6 * CYCLES_PER_US as f64 / cycles as f64);
        let share = enable * (forward - backward);
        let bridge = if enable <= 0.0 {
            Bridge::Released
        } else if share > 0.0 {
            Bridge::Forward(share)
        } else if share < 0.0 {
            Bridge::Backward(-share)
        } else {
            Bridge::Brake(enable)
        };
        (bridge, pwm_hz)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn half(enable: bool, forward: bool, backward: bool) -> HalfBridge {
        let mut half = HalfBridge::default();
        for (line, high) in half.lines.iter_mut().zip([enable, forward, backward]) {
            line.set(0, high);
        }
        half
    }

    #[test]
    fn the_bridge_does_what_its_truth_table_says() {
        assert_eq!(half(true, true, false).state().0, Bridge::Forward(1.0));
        assert_eq!(half(true, false, true).state().0, Bridge::Backward(1.0));
        assert_eq!(half(true, true, true).state().0, Bridge::Brake(1.0));
        assert_eq!(half(true, false, false).state().0, Bridge::Brake(1.0));
        for inputs in [[false, false], [true, false], [false, true], [true, true]] {
            assert_eq!(
                half(false, inputs[0], inputs[1]).state(),
                (Bridge::Released, None)
            );
        }
    }

    #[test]
    fn a_timer_s_pwm_counts_by_its_share_and_frequency_whatever_the_level_is() {
        let mut half = half(false, false, true);
        half.lines[0].modulate(Some(Pwm {
            share: 0.4,
            period_cycles: Some(32_640),
        }));
        let (bridge, hz) = half.state();
        assert_eq!(bridge, Bridge::Backward(0.4));
        assert!((hz.unwrap() - 490.2).abs() < 0.01);
    }

    #[test]
    fn a_program_s_own_pwm_is_measured_over_its_last_period_and_ends_with_its_edges() {
        let mut half = half(false, true, false);
        for n in 0..3 {
            half.lines[0].set(10_000 + 16_000 * n, true);
            half.lines[0].set(14_000 + 16_000 * n, false);
        }
        let (bridge, hz) = half.state();
        assert_eq!((bridge, hz), (Bridge::Forward(0.25), Some(1_000.0)));
        let due = half.expires_cycle().unwrap();
        assert_eq!(due, 46_000 + 32_000);
        half.expire(due);
        assert_eq!(half.state().0, Bridge::Released);
    }

    #[test]
    fn a_slow_wave_is_on_and_off() {
        let mut half = half(false, true, false);
        for n in 0..3 {
            half.lines[0].set(100_000 * n, true);
            assert_eq!(half.state().0, Bridge::Forward(1.0));
            half.lines[0].set(100_000 * n + 50_000, false);
            assert_eq!(half.state().0, Bridge::Released);
        }
    }

    #[test]
    fn modulated_inputs_under_a_constant_enable_drive_by_their_difference() {
        let mut half = half(true, false, true);
        half.lines[1].modulate(Some(Pwm {
            share: 0.25,
            period_cycles: Some(32_640),
        }));
        assert_eq!(half.state().0, Bridge::Backward(0.75));
    }
}
