//! The values found, beside the true values of a simulated robot.

use super::{Calibration, Measured};
use rumbo_control::Side;
use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use serde::Serialize;

/// One quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Its name, with its unit.
    pub name: String,
    /// The value found.
    pub found: f64,
    /// Standard deviation of its error.
    pub standard_error: Option<f64>,
    /// The true value, where the simulated robot has such a number.
    pub truth: Option<f64>,
}

/// All quantities; `truth` is the simulated robot, where there is one.
pub fn rows(calibration: &Calibration, truth: Option<&Params>) -> Vec<Row> {
    let row = |name: &str, found: Measured, truth: Option<f64>| Row {
        name: name.into(),
        found: found.value,
        standard_error: Some(found.error),
        truth,
    };
    let radii = truth.map(|params| (params.wheels.left.radius_m, params.wheels.right.radius_m));
    let mean_m = radii.map(|(left_m, right_m)| 0.5 * (left_m + right_m));
    let mut rows = vec![
        row(
            "radius, right over left",
            calibration.ratio,
            radii.map(|(left_m, right_m)| right_m / left_m),
        ),
        row(
            "base_m (with the mean radius in force)",
            calibration.base_m,
            truth.zip(mean_m).map(|(params, mean_m)| {
                params.body.base_m * calibration.radius_before_m.value / mean_m
            }),
        ),
        row(
            "mean radius in force, m",
            calibration.radius_before_m,
            mean_m,
        ),
    ];
    rows.extend(
        calibration
            .radius_m
            .map(|sonar| row("mean radius by the front sonar, m", sonar, mean_m)),
    );
    let feedforward = &calibration.feedforward;
    for (name, found) in [
        (ParamId::StaticLeftForward.name(), feedforward.forward.left),
        (
            ParamId::StaticLeftBackward.name(),
            feedforward.backward.left,
        ),
        (
            ParamId::StaticRightForward.name(),
            feedforward.forward.right,
        ),
        (
            ParamId::StaticRightBackward.name(),
            feedforward.backward.right,
        ),
        (ParamId::Velocity.name(), feedforward.velocity),
    ] {
        rows.push(row(name, found, None));
    }
    for (way, found) in ["forward", "backward"].iter().zip(&calibration.dead_zone) {
        for (side, word) in [(Side::Left, "left"), (Side::Right, "right")] {
            rows.extend(found[side].map(|duty| Row {
                name: format!("dead zone, {word} {way}, duty"),
                found: duty,
                standard_error: None,
                truth: None,
            }));
        }
    }
    rows
}
