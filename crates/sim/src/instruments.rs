//! What can be shown of a robot beside its telemetry, as named signals, the unit last; logs and pages go by the names.
//!
//! Of an emulated robot ground truth and pins, whatever its program is, even one that prints nothing. Of our native robot
//! what its control loops add up, which the link has no room for.

use crate::sim::Sim;
use rumbo_control::drive::WheelTerms;
use rumbo_control::mode::ModeTerms;
use rumbo_control::{Drive, Duty, Wheels};
use rumbo_robot::Loops;

/// Period of the readings \[us\]: 33 Hz.
pub const READING_US: u64 = 30_000;

/// Values with their names.
type Signals = Vec<(String, f64)>;

impl Sim {
    /// What is true of an emulated robot now, and what instruments at the wired pins show since the last call. Not a number:
    /// not known; infinite: a sonar without an echo. Nothing where no chip is emulated.
    pub fn read_instruments(&mut self) -> Signals {
        let (truth, duty, is_off) = (self.truth(), self.duty(), self.is_off());
        let Some(mega) = self.mega_mut() else {
            return Vec::new();
        };
        let [left_rad_s, right_rad_s] = truth.wheel_rad_s;
        let ranges_m = truth.range_m.map(|m| m.unwrap_or(f64::NAN));
        let [left_m, right_m, front_m, ..] = ranges_m;
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
        let others = mega.firmware().other_sonars().iter().zip(&ranges_m[3..]);
        let others: Vec<_> = others
            .map(|(name, range_m)| (format!("true_range_{name}_m"), *range_m))
            .collect();
        // Without power there is nothing to measure.
        let pins = match is_off {
            true => Vec::new(),
            false => mega.read_meters(),
        };
        named.into_iter().chain(others).chain(pins).collect()
    }
}

/// What the control loops add up, by name. Terms of the wheels' loops are in counts of PWM, as the PWM in telemetry is. Not
/// a number: that loop is not at work.
#[must_use]
pub fn loop_signals(loops: &Loops) -> Signals {
    let wheel = |of: fn(&WheelTerms) -> f32, scale: f32| -> Wheels<f64> {
        let value = |terms: Option<WheelTerms>| terms.map(|terms| hundredths(scale * of(&terms)));
        loops.wheels.map(|terms| signal(value(terms)))
    };
    let counts = f32::from(Duty::MAX);
    let wheels = [
        ("p_pwm", wheel(|terms| terms.pid.proportional, counts)),
        ("i_pwm", wheel(|terms| terms.pid.integral, counts)),
        ("d_pwm", wheel(|terms| terms.pid.derivative, counts)),
        ("feedforward_pwm", wheel(|terms| terms.feedforward, counts)),
        ("ramp_rad_s", wheel(|terms| terms.ramp_rad_s, 1.0)),
    ];
    let wheels = wheels.into_iter().flat_map(|(name, value)| {
        [("left", value.left), ("right", value.right)]
            .map(|(side, value)| (format!("{side}_{name}"), value))
    });
    let mut motion = match loops.request {
        Drive::Twist {
            forward_m_s,
            yaw_rad_s,
        } => Some((forward_m_s, yaw_rad_s)),
        _ => None,
    };
    let (mut wall, mut network) = (None, None);
    match loops.mode {
        Some(ModeTerms::Wall(terms)) => wall = Some(terms),
        Some(ModeTerms::Velocity(asked)) => motion = Some((asked.forward_m_s, asked.yaw_rad_s)),
        Some(ModeTerms::Network(outputs)) => network = Some(outputs),
        None => {}
    }
    let outer = [
        (
            "forward_ref_m_s",
            motion.map(|(forward_m_s, _)| forward_m_s),
        ),
        ("yaw_ref_rad_s", motion.map(|(_, yaw_rad_s)| yaw_rad_s)),
        ("distance_p_rad", wall.map(|wall| wall.distance_p_rad)),
        ("distance_i_rad", wall.map(|wall| wall.distance_i_rad)),
        ("heading_p_rad_s", wall.map(|wall| wall.heading_p_rad_s)),
        ("heading_d_rad_s", wall.map(|wall| wall.heading_d_rad_s)),
    ];
    let outer = outer.map(|(name, value)| (name.to_owned(), signal(value)));
    // Of mode 9 only: logs of other modes are no longer for it.
    let network = network.into_iter().flat_map(|outputs| {
        ["network_left", "network_right", "network_servo"]
            .into_iter()
            .zip(outputs)
            .map(|(name, share)| (name.to_owned(), f64::from(share)))
    });
    wheels.chain(outer).chain(network).collect()
}

/// Not a number where unknown; no zero with a sign.
fn signal(value: Option<f32>) -> f64 {
    value.map_or(f64::NAN, |value| f64::from(value) + 0.0)
}

/// A hundredth of a count of PWM is finer than anyone reads; more digits would only make logs longer.
fn hundredths(value: f32) -> f32 {
    (100.0 * value).round() / 100.0
}
