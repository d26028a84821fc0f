//! The values found, beside the true values of a simulated robot.

use super::{Calibration, Measured};
use rumbo_control::Side;
use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use serde::Serialize;

/// One quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibrationRow {
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
pub fn rows(calibration: &Calibration, truth: Option<&Params>) -> Vec<CalibrationRow> {
    let row = |name: &str, found: Measured, truth: Option<f64>| CalibrationRow {
        name: name.into(),
        found: found.value,
        standard_error: Some(found.error),
        truth,
    };
    let radii = truth.map(|params| (params.wheels.left.radius_m, params.wheels.right.radius_m));
    let mean_m = radii.map(|(left_m, right_m)| 0.5 * (left_m + right_m));
    let Calibration {
        ratio,
        base_m,
        radius_before_m: radius,
        feedforward,
        ..
    } = calibration;
    let true_ratio = radii.map(|(left_m, right_m)| right_m / left_m);
    let true_base = truth.zip(mean_m);
    let true_base = true_base.map(|(params, mean_m)| params.body.base_m * radius.value / mean_m);
    let mut rows = vec![
        row("radius, right over left", *ratio, true_ratio),
        row("base_m (with the mean radius in force)", *base_m, true_base),
        row("mean radius in force, m", *radius, mean_m),
    ];
    let by_sonar = calibration.radius_m;
    rows.extend(by_sonar.map(|sonar| row("mean radius by the front sonar, m", sonar, mean_m)));
    let [forward, backward] = [&feedforward.forward, &feedforward.backward];
    let fitted = [
        (ParamId::StaticLeftForward, forward.left),
        (ParamId::StaticLeftBackward, backward.left),
        (ParamId::StaticRightForward, forward.right),
        (ParamId::StaticRightBackward, backward.right),
        (ParamId::Velocity, feedforward.velocity),
    ];
    rows.extend(fitted.map(|(id, found)| row(id.name(), found, None)));
    for (way, found) in ["forward", "backward"].iter().zip(&calibration.dead_zone) {
        for (side, word) in [(Side::Left, "left"), (Side::Right, "right")] {
            rows.extend(found[side].map(|duty| CalibrationRow {
                name: format!("dead zone, {word} {way}, duty"),
                found: duty,
                standard_error: None,
                truth: None,
            }));
        }
    }
    rows
}
