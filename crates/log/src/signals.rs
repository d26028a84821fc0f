//! The signals: the robot's telemetry of one instant, beside the ground truth. [`SIGNALS`] is their one table.

mod row;

pub(crate) use row::tidy;
pub use row::{Row, RowValue};

use crate::scene::{MapPose, Truth};
use rumbo_control::mode::{ModeId, Reference};
use rumbo_control::{Range, SonarId};
use rumbo_wire::Telemetry;
use std::f64::consts::PI;

/// The signals at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Session time of the telemetry \[ms\].
    pub t_ms: i64,
    /// The active mode.
    pub mode: ModeId,
    /// The mode's reference.
    pub reference: Reference,
    /// The heading setpoint \[rad\]; 0 where the mode has none.
    pub heading_ref_rad: f32,
    /// The robot's telemetry.
    pub telemetry: Telemetry,
    /// Origin of its pose, in the world.
    pub origin: MapPose,
    /// Uncertainty of the pose, in the origin's frame.
    pub spread: Spread,
    /// Ground truth [`EARLIER_MS`] before and at `t_ms`; `None` with a real robot.
    pub truth: Option<[Truth; 2]>,
    /// The ghost's ground truth; `None` without one.
    pub ghost: Option<Truth>,
}

/// Uncertainty of a pose, in its origin's frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Standard deviation of x \[m\].
    pub x_m: f32,
    /// Standard deviation of y \[m\].
    pub y_m: f32,
    /// Correlation of x and y, -1..=1.
    pub correlation: f32,
    /// Standard deviation of the heading \[rad\].
    pub heading_rad: f32,
}

/// The first of the two wheel speeds in a telemetry frame is this much older \[ms\].
pub const EARLIER_MS: i64 = 20;

/// What people read a signal in: the unit's name, and the factor to it.
pub(crate) type Shown = (&'static str, f64);

const RPM: Shown = ("rpm", 30.0 / PI);
const DEGREES: Shown = ("°", 180.0 / PI);
const CENTIMETRES: Shown = ("cm", 100.0);
const METRES: Shown = ("m", 1.0);
const OF_255: Shown = ("of 255", 1.0);
/// A number without a unit, or one that is not plotted as it is.
const PLAIN: Shown = ("", 1.0);

/// A signal of a [`Sample`]: what logs, tables, plots and the page know of it.
#[derive(Clone, Copy, Debug)]
pub struct Signal {
    /// Its name in logs and tables, unit last.
    pub name: &'static str,
    /// Beside its curve.
    pub label: &'static str,
    /// What it is, for people; empty where it is not plotted.
    pub about: &'static str,
    /// What people read it in.
    pub shown: Shown,
    /// In its own unit; not a number where unknown, infinite where a range is clear.
    pub(crate) value: fn(&Sample) -> f32,
}

const fn signal(
    name: &'static str,
    label: &'static str,
    about: &'static str,
    shown: Shown,
    value: fn(&Sample) -> f32,
) -> Signal {
    Signal {
        name,
        label,
        about,
        shown,
        value,
    }
}

/// One that is read, not plotted.
const fn unplotted(name: &'static str, value: fn(&Sample) -> f32) -> Signal {
    signal(name, "", "", PLAIN, value)
}

/// Not known.
const UNKNOWN: f32 = f32::NAN;

fn flag(is_so: bool) -> f32 {
    f32::from(u8::from(is_so))
}

/// Infinite where nothing is in range.
fn range(sample: &Sample, sonar: SonarId) -> f32 {
    match sample.telemetry.ranges[sonar as usize].range {
        Range::Valid(range_m) => range_m,
        Range::Clear => f32::INFINITY,
        Range::Faulty => UNKNOWN,
    }
}

fn truly(sample: &Sample, value: fn(&Truth) -> f64) -> f32 {
    let truth = sample.truth.as_ref();
    truth.map_or(UNKNOWN, |[_, at]| value(at) as f32)
}

fn truly_before(sample: &Sample, value: fn(&Truth) -> f64) -> f32 {
    let truth = sample.truth.as_ref();
    truth.map_or(UNKNOWN, |[before, _]| value(before) as f32)
}

fn ghost(sample: &Sample, value: fn(&Truth) -> f64) -> f32 {
    let truth = sample.ghost.as_ref();
    truth.map_or(UNKNOWN, |truth| value(truth) as f32)
}

fn true_range(truth: &Truth, sonar: SonarId) -> f64 {
    truth.range_m[sonar as usize].unwrap_or(f64::NAN)
}

/// The signals, in the order of a row. A line here brings one into logs, tables, Python and the page.
#[rustfmt::skip]
pub const SIGNALS: &[Signal] = &[
    unplotted("t_s", |s| (s.t_ms as f64 / 1e3) as f32),
    unplotted("mode", |s| f32::from(s.mode as u8)),
    unplotted("state", |s| f32::from(s.telemetry.state)),
    unplotted("armed", |s| flag(s.telemetry.armed)),
    unplotted("faulted", |s| flag(s.telemetry.faulted)),
    unplotted("reference_left", |s| s.reference.numbers()[0]),
    unplotted("reference_right", |s| s.reference.numbers()[1]),
    signal("x_m", "x", "estimated position, x", METRES, |s| s.telemetry.pose.x_m),
    signal("y_m", "y", "estimated position, y", METRES, |s| s.telemetry.pose.y_m),
    signal("heading_rad", "heading", "estimated heading", DEGREES, |s| s.telemetry.pose.heading_rad),
    signal("x_deviation_m", "σ x", "standard deviation of the estimated position, x", METRES, |s| s.spread.x_m),
    signal("y_deviation_m", "σ y", "standard deviation of the estimated position, y", METRES, |s| s.spread.y_m),
    unplotted("xy_correlation", |s| s.spread.correlation),
    signal("heading_deviation_rad", "σ heading", "standard deviation of the estimated heading", DEGREES, |s| s.spread.heading_rad),
    signal("heading_ref_rad", "setpoint", "heading setpoint", DEGREES, |s| s.heading_ref_rad),
    unplotted("origin_x_m", |s| s.origin.x_m as f32),
    unplotted("origin_y_m", |s| s.origin.y_m as f32),
    unplotted("origin_heading_rad", |s| s.origin.heading_rad as f32),
    signal("servo_rad", "servo", "angle of the servo", DEGREES, |s| s.telemetry.servo_rad),
    unplotted("left_before_rad_s", |s| s.telemetry.wheel_rad_s[0].left),
    unplotted("right_before_rad_s", |s| s.telemetry.wheel_rad_s[0].right),
    signal("left_rad_s", "left", "speed, left wheel", RPM, |s| s.telemetry.wheel_rad_s[1].left),
    signal("right_rad_s", "right", "speed, right wheel", RPM, |s| s.telemetry.wheel_rad_s[1].right),
    signal("left_ref_rad_s", "set l.", "speed setpoint, left wheel", RPM, |s| s.telemetry.wheel_ref_rad_s.left),
    signal("right_ref_rad_s", "set r.", "speed setpoint, right wheel", RPM, |s| s.telemetry.wheel_ref_rad_s.right),
    signal("left_pwm", "left", "PWM, left wheel", OF_255, |s| f32::from(s.telemetry.duty.left.counts())),
    signal("right_pwm", "right", "PWM, right wheel", OF_255, |s| f32::from(s.telemetry.duty.right.counts())),
    signal("range_left_m", "left", "range, left sonar", CENTIMETRES, |s| range(s, SonarId::Left)),
    signal("range_right_m", "right", "range, right sonar", CENTIMETRES, |s| range(s, SonarId::Right)),
    signal("range_front_m", "front", "range, front sonar", CENTIMETRES, |s| range(s, SonarId::Front)),
    signal("true_x_m", "true x", "true position, x", METRES, |s| truly(s, |at| at.pose.x_m)),
    signal("true_y_m", "true y", "true position, y", METRES, |s| truly(s, |at| at.pose.y_m)),
    signal("true_heading_rad", "true", "true heading", DEGREES, |s| truly(s, |at| at.pose.heading_rad)),
    unplotted("true_left_before_rad_s", |s| truly_before(s, |at| at.wheel_rad_s.left)),
    unplotted("true_right_before_rad_s", |s| truly_before(s, |at| at.wheel_rad_s.right)),
    signal("true_left_rad_s", "true l.", "true speed, left wheel", RPM, |s| truly(s, |at| at.wheel_rad_s.left)),
    signal("true_right_rad_s", "true r.", "true speed, right wheel", RPM, |s| truly(s, |at| at.wheel_rad_s.right)),
    signal("true_range_left_m", "true l.", "true range, left sonar", CENTIMETRES, |s| truly(s, |at| true_range(at, SonarId::Left))),
    signal("true_range_right_m", "true r.", "true range, right sonar", CENTIMETRES, |s| truly(s, |at| true_range(at, SonarId::Right))),
    signal("true_range_front_m", "true front", "true range, front sonar", CENTIMETRES, |s| truly(s, |at| true_range(at, SonarId::Front))),
    signal("true_servo_rad", "true servo", "true angle of the servo", DEGREES, |s| truly(s, |at| at.servo_rad)),
    unplotted("contact", |s| truly(s, |at| f64::from(u8::from(at.contact)))),
    signal("ghost_x_m", "ghost x", "ghost position, x", METRES, |s| ghost(s, |at| at.pose.x_m)),
    signal("ghost_y_m", "ghost y", "ghost position, y", METRES, |s| ghost(s, |at| at.pose.y_m)),
    signal("ghost_heading_rad", "ghost", "ghost heading", DEGREES, |s| ghost(s, |at| at.pose.heading_rad)),
    signal("ghost_left_rad_s", "ghost l.", "ghost speed, left wheel", RPM, |s| ghost(s, |at| at.wheel_rad_s.left)),
    signal("ghost_right_rad_s", "ghost r.", "ghost speed, right wheel", RPM, |s| ghost(s, |at| at.wheel_rad_s.right)),
    signal("ghost_range_left_m", "ghost l.", "ghost range, left sonar", CENTIMETRES, |s| ghost(s, |at| true_range(at, SonarId::Left))),
    signal("ghost_range_right_m", "ghost r.", "ghost range, right sonar", CENTIMETRES, |s| ghost(s, |at| true_range(at, SonarId::Right))),
    signal("ghost_range_front_m", "ghost front", "ghost range, front sonar", CENTIMETRES, |s| ghost(s, |at| true_range(at, SonarId::Front))),
];

impl Sample {
    /// The values of the row.
    #[must_use]
    pub fn row(&self) -> Row {
        let value = |column: usize| (SIGNALS[column].value)(self);
        Row::new(self.t_ms, std::array::from_fn(value))
    }

    /// A sample of which only the telemetry is known.
    #[must_use]
    pub fn of(telemetry: Telemetry) -> Self {
        Self {
            telemetry,
            ..Self::empty()
        }
    }

    /// A sample without known values.
    pub(crate) fn empty() -> Self {
        Self {
            t_ms: 0,
            mode: ModeId::default(),
            reference: Reference::None,
            heading_ref_rad: 0.0,
            telemetry: Telemetry::default(),
            origin: MapPose::default(),
            spread: Spread::default(),
            truth: None,
            ghost: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::{AgedRange, Wheels};

    #[test]
    fn nothing_in_reach_is_not_an_unknown_range() {
        let mut telemetry = Telemetry::default();
        telemetry.ranges[0] = AgedRange {
            range: Range::Clear,
            age_ticks: 0,
        };
        telemetry.ranges[2] = AgedRange {
            range: Range::Valid(0.31234),
            age_ticks: 0,
        };
        let sample = Sample {
            t_ms: 1_040,
            mode: ModeId::FrontDistance,
            reference: Reference::Distance(0.3),
            heading_ref_rad: 0.0,
            telemetry,
            origin: MapPose::default(),
            spread: Spread::default(),
            truth: None,
            ghost: None,
        };
        let json = serde_json::to_value(sample.row().cells()).unwrap();
        let column = |name: &str| Row::column(name).unwrap();
        assert_eq!(json[column("t_s")], 1.04);
        assert_eq!(json[column("range_left_m")], "clear");
        assert!(json[column("range_right_m")].is_null());
        assert_eq!(json[column("range_front_m")], 0.3123);
        assert!(json[column("true_x_m")].is_null());
    }

    #[test]
    fn every_column_is_of_its_own_signal() {
        let wheels = |left: f32| Wheels {
            left,
            right: left + 1.0,
        };
        // The number of its column everywhere.
        let truth = |pose: f64, wheels: f64, ranges: f64, servo_rad: f64| Truth {
            pose: MapPose {
                x_m: pose,
                y_m: pose + 1.0,
                heading_rad: pose + 2.0,
            },
            wheel_rad_s: Wheels {
                left: wheels,
                right: wheels + 1.0,
            },
            range_m: [0.0, 1.0, 2.0].map(|sonar| Some(ranges + sonar)),
            servo_rad,
            contact: true,
            battery_v: 99.0,
        };
        let range = |range_m| AgedRange {
            range: Range::Valid(range_m),
            age_ticks: 0,
        };
        let sample = Sample {
            t_ms: 0,
            mode: ModeId::default(),
            reference: Reference::Wheels(wheels(5.0)),
            heading_ref_rad: 14.0,
            telemetry: Telemetry {
                pose: rumbo_control::Pose {
                    x_m: 7.0,
                    y_m: 8.0,
                    heading_rad: 9.0,
                },
                servo_rad: 18.0,
                wheel_rad_s: [wheels(19.0), wheels(21.0)],
                wheel_ref_rad_s: wheels(23.0),
                ranges: [27.0, 28.0, 29.0].map(range),
                ..Telemetry::default()
            },
            origin: MapPose {
                x_m: 15.0,
                y_m: 16.0,
                heading_rad: 17.0,
            },
            spread: Spread {
                x_m: 10.0,
                y_m: 11.0,
                correlation: 12.0,
                heading_rad: 13.0,
            },
            truth: Some([truth(0.0, 33.0, 0.0, 0.0), truth(30.0, 35.0, 37.0, 40.0)]),
            ghost: Some(truth(42.0, 45.0, 47.0, 0.0)),
        };
        for (column, signal) in SIGNALS.iter().enumerate() {
            let is_number = ![
                "t_s",
                "mode",
                "state",
                "armed",
                "faulted",
                "left_pwm",
                "right_pwm",
                "contact",
            ]
            .contains(&signal.name);
            if is_number {
                assert_eq!((signal.value)(&sample), column as f32, "{}", signal.name);
            }
        }
    }
}
