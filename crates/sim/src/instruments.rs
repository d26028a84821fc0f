//! Ground truth and pins of an emulated robot as named signals, the unit last: what can be shown of any program, even one
//! that prints nothing. This is the one list of them; logs and pages go by the names.

use crate::sim::Sim;

/// Period of the readings \[us\]: 33 Hz.
pub const READING_US: u64 = 30_000;

impl Sim {
    /// What is true of the robot now, and what instruments at the wired pins show since the last call. Not a number:
    /// not known; infinite: a sonar without an echo. Nothing where no chip is emulated.
    pub fn read_instruments(&mut self) -> Vec<(String, f64)> {
        let (truth, duty, is_off) = (self.truth(), self.duty(), self.is_off());
        let Some(mega) = self.mega_mut() else {
            return Vec::new();
        };
        let [left_rad_s, right_rad_s] = truth.wheel_rad_s;
        let [left_m, right_m, front_m] = truth.range_m.map(|m| m.unwrap_or(f64::NAN));
        let signals = [
            ("true_x_m", truth.pose.x_m),
            ("true_y_m", truth.pose.y_m),
            ("true_heading_rad", truth.pose.heading_rad),
            ("true_left_rad_s", left_rad_s),
            ("true_right_rad_s", right_rad_s),
            ("true_left_pwm", f64::from(duty.left.counts())),
            ("true_right_pwm", f64::from(duty.right.counts())),
            ("true_range_left_m", left_m),
            ("true_range_right_m", right_m),
            ("true_range_front_m", front_m),
            ("true_servo_rad", truth.servo_rad),
            ("contact", f64::from(u8::from(truth.touching))),
        ];
        let named = signals.map(|(name, value)| (name.to_owned(), value));
        // Without power there is nothing to measure.
        let pins = match is_off {
            true => Vec::new(),
            false => mega.read_meters(),
        };
        named.into_iter().chain(pins).collect()
    }
}
