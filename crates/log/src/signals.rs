//! Samples of the signals: the robot's telemetry of one instant, beside the ground truth.

mod row;

pub(crate) use row::tidy;
pub use row::{Cell, Row};

use crate::scene::{MapPose, Truth};
use rumbo_control::mode::ModeId;
use rumbo_control::{Range, Wheels};
use rumbo_wire::Telemetry;

/// The signals at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Session time of the telemetry \[ms\].
    pub t_ms: i64,
    /// The active mode.
    pub mode: ModeId,
    /// The mode's reference; units as in [`rumbo_wire::Status::reference`].
    pub reference: Wheels<f32>,
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

/// Not known.
const UNKNOWN: f32 = f32::NAN;

fn optional(value: Option<f64>) -> f32 {
    value.map_or(UNKNOWN, |value| value as f32)
}

/// Infinite where nothing is in range.
fn measured(range: Range) -> f32 {
    match range {
        Range::Valid(range_m) => range_m,
        Range::Clear => f32::INFINITY,
        Range::Faulty => UNKNOWN,
    }
}

/// The ghost's signals.
pub(crate) const GHOST: [&str; 8] = [
    "ghost_x_m",
    "ghost_y_m",
    "ghost_heading_rad",
    "ghost_left_rad_s",
    "ghost_right_rad_s",
    "ghost_range_left_m",
    "ghost_range_right_m",
    "ghost_range_front_m",
];

/// Their values, in this order; not a number where unknown.
pub(crate) fn ghost_values(truth: &Truth) -> [f64; GHOST.len()] {
    let [left, right, front] = truth.range_m.map(|range_m| range_m.unwrap_or(f64::NAN));
    [
        truth.pose.x_m,
        truth.pose.y_m,
        truth.pose.heading_rad,
        truth.wheel_rad_s.left,
        truth.wheel_rad_s.right,
        left,
        right,
        front,
    ]
}

/// Values in a row.
pub(crate) const COLUMNS: usize = 42 + GHOST.len();

impl Sample {
    /// The row of this sample, each value with its name. The page finds the values by the names.
    pub(crate) fn named_row(&self) -> [(&'static str, f32); COLUMNS] {
        let said = &self.telemetry;
        let [before, at] = said.wheel_rad_s;
        let [left, right, front] = said.ranges.map(|aged| measured(aged.range));
        let was = |value: fn(&Truth) -> f64| optional(self.truth.as_ref().map(|[_, at]| value(at)));
        let was_before = |value: fn(&Truth) -> f64| {
            optional(self.truth.as_ref().map(|[before, _]| value(before)))
        };
        let was_range =
            |id: usize| optional(self.truth.as_ref().and_then(|[_, at]| at.range_m[id]));
        let ghost = self.ghost.as_ref().map(ghost_values);
        let ghosts = |index: usize| (GHOST[index], optional(ghost.map(|values| values[index])));
        [
            ("t_s", (self.t_ms as f64 / 1e3) as f32),
            ("mode", f32::from(self.mode as u8)),
            ("state", f32::from(said.state)),
            ("armed", f32::from(u8::from(said.armed))),
            ("faulted", f32::from(u8::from(said.faulted))),
            ("reference_left", self.reference.left),
            ("reference_right", self.reference.right),
            ("x_m", said.pose.x_m),
            ("y_m", said.pose.y_m),
            ("heading_rad", said.pose.heading_rad),
            ("x_deviation_m", self.spread.x_m),
            ("y_deviation_m", self.spread.y_m),
            ("xy_correlation", self.spread.correlation),
            ("heading_deviation_rad", self.spread.heading_rad),
            ("heading_ref_rad", self.heading_ref_rad),
            ("origin_x_m", self.origin.x_m as f32),
            ("origin_y_m", self.origin.y_m as f32),
            ("origin_heading_rad", self.origin.heading_rad as f32),
            ("servo_rad", said.servo_rad),
            ("left_before_rad_s", before.left),
            ("right_before_rad_s", before.right),
            ("left_rad_s", at.left),
            ("right_rad_s", at.right),
            ("left_ref_rad_s", said.wheel_ref_rad_s.left),
            ("right_ref_rad_s", said.wheel_ref_rad_s.right),
            ("left_pwm", f32::from(said.duty.left.counts())),
            ("right_pwm", f32::from(said.duty.right.counts())),
            ("range_left_m", left),
            ("range_right_m", right),
            ("range_front_m", front),
            ("true_x_m", was(|truth| truth.pose.x_m)),
            ("true_y_m", was(|truth| truth.pose.y_m)),
            ("true_heading_rad", was(|truth| truth.pose.heading_rad)),
            (
                "true_left_before_rad_s",
                was_before(|truth| truth.wheel_rad_s.left),
            ),
            (
                "true_right_before_rad_s",
                was_before(|truth| truth.wheel_rad_s.right),
            ),
            ("true_left_rad_s", was(|truth| truth.wheel_rad_s.left)),
            ("true_right_rad_s", was(|truth| truth.wheel_rad_s.right)),
            ("true_range_left_m", was_range(0)),
            ("true_range_right_m", was_range(1)),
            ("true_range_front_m", was_range(2)),
            ("true_servo_rad", was(|truth| truth.servo_rad)),
            ("contact", was(|truth| f64::from(u8::from(truth.contact)))),
            ghosts(0),
            ghosts(1),
            ghosts(2),
            ghosts(3),
            ghosts(4),
            ghosts(5),
            ghosts(6),
            ghosts(7),
        ]
    }

    /// The values of the row.
    #[must_use]
    pub fn row(&self) -> Row {
        Row::new(self.t_ms, self.named_row().map(|(_, value)| value))
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
            reference: Wheels::both(0.0),
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
    use rumbo_control::AgedRange;

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
            reference: Wheels::both(0.3),
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
}
