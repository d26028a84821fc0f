//! Rows that the sketches of the report's robot print as published: without header and time, `, ` between the values.
//!
//! | modes | columns |
//! |---|---|
//! | 1 | reference, distance, error, PWM of both |
//! | 2 | reference, first, second, 0, distance, angle, error, PWM A, PWM B |
//! | 3, 4 | first, second, reference, distance, angle reference, angle, PWM A, PWM B |
//! | 5, 6 | speed A, speed B, reference A, reference B, PWM A, PWM B |
//! | 7 | reference A, reference B, distance to go, angle reference, dx, dy, x, y, heading, state |
//!
//! Units are the text protocol's. The first sonar of a pair is the right one ahead, the front one (`left`) on a side.

use crate::decimal;
use crate::text_row::{DistanceRow, SpeedRow, TextRow, WaypointsRow};
use rumbo_control::Wheels;
use rumbo_control::math::round;

/// Most columns of such a row.
const MOST: usize = 10;
/// The error of a row is its reference less its distance, but for the rounding of both [cm].
const ROUNDING_CM: f32 = 0.02;

/// The row in a line; `None` of any other text.
pub(crate) fn row(line: &str) -> Option<TextRow> {
    let (mut values, mut count) = ([0.0; MOST], 0);
    for field in line.split(',') {
        *values.get_mut(count)? = decimal::parse(field.trim_ascii().as_bytes())?;
        count += 1;
    }
    match *values.get(..count)? {
        [reference_cm, distance_cm, error_cm, pwm]
            if differ(reference_cm, distance_cm, error_cm) =>
        {
            let pwm = counts([pwm; 2])?;
            Some(distances(1, [distance_cm; 2], reference_cm, pwm))
        }
        [
            reference_cm,
            first_cm,
            second_cm,
            zero,
            distance_cm,
            _,
            error_cm,
            a,
            b,
        ] if zero == 0.0 && differ(reference_cm, distance_cm, error_cm) => {
            let pwm = counts([a, b])?;
            Some(distances(2, [second_cm, first_cm], reference_cm, pwm))
        }
        [first_cm, second_cm, reference_cm, _, _, _, a, b] => {
            let pwm = counts([a, b])?;
            Some(distances(3, [first_cm, second_cm], reference_cm, pwm))
        }
        [right, left, reference_rpm, _, a, b] => Some(TextRow::Speed(SpeedRow {
            dt_ms: 0,
            wheel_rpm: Wheels { left, right },
            reference_rpm,
            mode: 5,
            pwm: counts([a, b])?,
        })),
        // A row with a time has ten columns in this mode too, and begins with whole milliseconds.
        [right, left, _, _, _, _, x_m, y_m, heading_deg, _]
            if line.split(',').next()?.contains('.') =>
        {
            Some(TextRow::Waypoints(WaypointsRow {
                reference_rpm: Wheels { left, right },
                x_m,
                y_m,
                heading_deg,
                ..WaypointsRow::default()
            }))
        }
        _ => None,
    }
}

fn differ(reference_cm: f32, distance_cm: f32, error_cm: f32) -> bool {
    let off_cm = reference_cm - distance_cm - error_cm;
    off_cm < ROUNDING_CM && off_cm > -ROUNDING_CM
}

fn distances(
    mode: u8,
    [left_cm, right_cm]: [f32; 2],
    reference_cm: f32,
    pwm: Wheels<i16>,
) -> TextRow {
    TextRow::Distance(DistanceRow {
        dt_ms: 0,
        left_cm,
        right_cm,
        reference_cm,
        mode,
        pwm,
    })
}

/// Motor A is the right wheel.
fn counts([a, b]: [f32; 2]) -> Option<Wheels<i16>> {
    let count = |pwm: f32| (-255.0..=255.0).contains(&pwm).then(|| round(pwm) as i16);
    Some(Wheels {
        left: count(b)?,
        right: count(a)?,
    })
}
