//! A hobby servo's input: the width of each pulse is an angle.
//!
//! Arduino's `Servo` library sends 544 us for 0 degrees and 2400 us for 180; the servo here understands just that, so
//! that `write(90)`, 1472 us, looks straight ahead. More is to the left. Pulses outside 500 to 2500 us are none of a servo's, and
//! without pulses it holds where it is.
//!
//! A continuous-rotation servo makes a speed of that width, [`turning`].

use super::CYCLES_PER_US;
use std::f64::consts::{FRAC_PI_2, PI};

/// Pulse widths that a servo takes for an angle [us].
const CREDIBLE_US: std::ops::RangeInclusive<f64> = 500.0..=2500.0;
/// Width at 0 degrees [us].
const RIGHT_US: f64 = 544.0;
/// Width at 180 degrees [us].
const LEFT_US: f64 = 2400.0;

/// A continuous-rotation servo stands at this width, [us]; about it is its dead band, within which `write(90)` stands too: Parallax's has
/// a narrower one, Feetech's FS90R one of 45 us.
const MIDDLE_US: f64 = 1500.0;
const DEAD_US: f64 = 30.0;
/// Off the middle by this it has its whole speed, in between one in proportion: an estimate, as the dead band is.
const WHOLE_US: f64 = 100.0;

/// The share of its whole speed that a pulse of this width makes, positive for long ones.
pub(super) fn turning(width_us: f64) -> Option<f64> {
    let off_us = width_us - MIDDLE_US;
    let share = ((off_us.abs() - DEAD_US) / (WHOLE_US - DEAD_US)).clamp(0.0, 1.0);
    CREDIBLE_US
        .contains(&width_us)
        .then_some(share.copysign(off_us))
}

/// The input pin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ServoInput {
    rise_cycle: Option<u64>,
}

impl ServoInput {
    /// The pin's level from this cycle on; gives the angle that a pulse asks for [rad], 0 ahead, positive to the left.
    pub(super) fn set(&mut self, cycle: u64, high: bool) -> Option<f64> {
        if high {
            self.rise_cycle.get_or_insert(cycle);
            return None;
        }
        let width_us = (cycle - self.rise_cycle.take()?) as f64 / CYCLES_PER_US as f64;
        let turned = (width_us - RIGHT_US) / (LEFT_US - RIGHT_US);
        CREDIBLE_US
            .contains(&width_us)
            .then_some(turned * PI - FRAC_PI_2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle_deg(width_us: u64) -> Option<f64> {
        let mut servo = ServoInput::default();
        assert_eq!(servo.set(77, true), None);
        servo
            .set(77 + CYCLES_PER_US * width_us, false)
            .map(f64::to_degrees)
    }

    #[test]
    fn the_arduino_library_s_0_90_and_180_degrees_are_right_ahead_and_left() {
        for (width_us, expected_deg) in [(544, -90.0), (1472, 0.0), (2400, 90.0)] {
            assert!((angle_deg(width_us).unwrap() - expected_deg).abs() < 1e-9);
        }
    }

    #[test]
    fn what_is_no_servo_pulse_moves_nothing() {
        assert_eq!(angle_deg(490), None);
        assert_eq!(angle_deg(2510), None);
        assert_eq!(ServoInput::default().set(5, false), None);
    }
}
