//! A row of telemetry as the robot writes it: one column after the other, from SI units to the original's.

use rumbo_control::{Duty, Pose, Range, Wheels};

use crate::decimal::Text;
use crate::text_units::{MAX_LINE, RAD_PER_DEG, RAD_S_PER_RPM, cm_from_range};

/// A row being written. Its first column is the time since the previous row; [`Row`](crate::text::TextRow) defines the
/// rest.
pub struct TextLine(Text<MAX_LINE>);

impl TextLine {
    /// Begins a row, `dt_ms` after the one before.
    pub fn new(dt_ms: u32) -> TextLine {
        let mut line = TextLine(Text::EMPTY);
        line.0
            .push_integer(i32::try_from(dt_ms).unwrap_or(i32::MAX));
        line
    }

    /// A number, with at most two decimals.
    pub fn number(&mut self, value: f32) {
        self.0.push(b',');
        self.0.push_hundredths(value);
    }

    /// An integer.
    pub fn integer(&mut self, value: i16) {
        self.0.push(b',');
        self.0.push_integer(i32::from(value));
    }

    /// A wheel speed [rad/s], in rpm.
    pub fn speed(&mut self, rad_s: f32) {
        self.number(rad_s / RAD_S_PER_RPM);
    }

    /// The speeds of motor A, then B.
    pub fn speeds(&mut self, rad_s: &Wheels<f32>) {
        self.speed(rad_s.right);
        self.speed(rad_s.left);
    }

    /// The PWM of motor A, then B.
    pub fn pwm(&mut self, duty: &Wheels<Duty>) {
        self.integer(duty.right.counts());
        self.integer(duty.left.counts());
    }

    /// An angle [rad], in degrees.
    pub fn angle(&mut self, angle_rad: f32) {
        self.number(angle_rad / RAD_PER_DEG);
    }

    /// Position and heading.
    pub fn pose(&mut self, pose: &Pose) {
        self.number(pose.x_m);
        self.number(pose.y_m);
        self.angle(pose.heading_rad);
    }

    /// A range, in cm.
    pub fn range(&mut self, range: Range) {
        self.number(cm_from_range(range));
    }

    /// Ends the row, with CR LF as the original's `println` does.
    pub fn end(&mut self) {
        self.0.push(b'\r');
        self.0.push(b'\n');
    }

    /// The bytes.
    pub fn bytes(&self) -> &[u8] {
        self.0.bytes()
    }
}
