//! What a PWM output amounts to: the share of time for which it is high, and its period (2549Q, sections 16.7, 17.9 and 20.7).

use super::Clock;
use super::wave::{Kind, Wave};
use crate::devices::Pwm;

/// The PWM on a channel's pin; `None` without one.
///
/// `clock_divisor` are the crystal's cycles in one of the system clock.
pub(super) fn pwm(wave: &Wave, channel: usize, clock: Clock, clock_divisor: u64) -> Option<Pwm> {
    if !wave.is_connected(channel) || !wave.mode.is_pwm() {
        return None;
    }
    let constant = |high: bool| Pwm {
        share: if high { 1.0 } else { 0.0 },
        period_cycles: None,
    };
    let output = wave.output[channel];
    let divisor = match clock {
        Clock::Stopped => return Some(constant(output)),
        Clock::Pin { .. } => None,
        Clock::Divided(divisor) => Some(divisor * clock_divisor),
    };
    let (compare, top) = (wave.compare[channel], wave.top());
    let period = wave.period();
    if wave.pin_mode[channel] == 1 {
        // It toggles once in a period, if the counter comes past at all.
        return Some(if compare > top {
            constant(output)
        } else {
            Pwm {
                share: 0.5,
                period_cycles: divisor.map(|divisor| 2 * period * divisor),
            }
        });
    }
    let high = if compare >= top {
        period
    } else if wave.mode.kind == Kind::Fast {
        u64::from(compare) + 1
    } else {
        2 * u64::from(compare)
    };
    let share = high as f64 / period as f64;
    Some(Pwm {
        share: if wave.pin_mode[channel] == 2 {
            share
        } else {
            1.0 - share
        },
        period_cycles: divisor.map(|divisor| period * divisor),
    })
}
