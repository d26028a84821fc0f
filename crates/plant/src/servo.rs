//! The hobby servo that carries the front sonar: it follows its command at a finite speed.

use crate::params;

/// State of a servo.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Its angle: 0 straight ahead, positive to the left.
    pub angle_rad: f64,
    /// The commanded angle.
    pub target_rad: f64,
}

impl State {
    /// Commands an angle, limited to the servo's travel; it keeps moving until it is there.
    pub fn command(&mut self, servo: &params::Servo, angle_rad: f64) {
        self.target_rad = angle_rad.clamp(-servo.travel_rad, servo.travel_rad);
    }

    /// Moves towards the command for `dt_s`.
    pub fn step(&mut self, servo: &params::Servo, dt_s: f64) {
        let left_rad = self.target_rad - self.angle_rad;
        if left_rad != 0.0 {
            let most_rad = servo.speed_rad_s * dt_s;
            self.angle_rad = if left_rad > most_rad {
                self.angle_rad + most_rad
            } else if left_rad < -most_rad {
                self.angle_rad - most_rad
            } else {
                self.target_rad
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_servo_takes_its_time() {
        let servo = params::Servo::default();
        let mut state = State::default();
        state.command(&servo, 1.0);
        let mut time_s = 0.0;
        while state.angle_rad != 1.0 {
            state.step(&servo, 0.001);
            time_s += 0.001;
        }
        assert!(
            (time_s - 1.0 / servo.speed_rad_s).abs() <= 0.001,
            "{time_s}"
        );
    }

    #[test]
    fn a_servo_stops_at_the_end_of_its_travel() {
        let servo = params::Servo::default();
        let mut state = State::default();
        state.command(&servo, -9.0);
        for _ in 0..2_000 {
            state.step(&servo, 0.001);
        }
        assert_eq!(state.angle_rad, -servo.travel_rad);
    }
}
