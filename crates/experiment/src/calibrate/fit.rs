//! Fits the movements by least squares. Derivation: docs/theory/calibration.md.

use super::error::CalibrateError;
use super::sample::Sample;
use nalgebra::{DMatrix, DVector};
use rumbo_control::{SIDES, SonarId, Wheels};

/// Fewest ranges of a leg along the wall.
const FEWEST_RANGES: usize = 25;
/// Shortest leg from which a curvature can be fitted [m].
const SHORTEST_M: f64 = 0.4;

/// A value and the standard deviation of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Standard error.
    pub error: f64,
}

/// Mean of values with weights, and its standard error from their scatter.
pub(super) fn mean(values: &[(f64, f64)]) -> Option<Measured> {
    let weight: f64 = values.iter().map(|(_, weight)| weight).sum();
    let count = values.len() as f64;
    if values.len() < 2 || weight <= 0.0 {
        return None;
    }
    let value = values
        .iter()
        .map(|(value, weight)| value * weight)
        .sum::<f64>()
        / weight;
    let scatter: f64 = values
        .iter()
        .map(|(each, weight)| weight * (each - value) * (each - value))
        .sum();
    Some(Measured {
        value,
        error: (scatter / (count - 1.0) / weight).sqrt(),
    })
}

/// Fit of a leg along the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LegFit {
    /// Heading to the wall at the start of the leg, to the left positive [rad].
    pub(super) start_rad: f64,
    /// The same at its end.
    pub(super) end_rad: f64,
    /// Turn per metre of signed distance beyond that of the odometry [rad/m].
    pub(super) curvature_rad_m: f64,
    /// Distance, without sign [m].
    pub(super) way_m: f64,
}

/// Fits the distances to the wall along a leg. `ahead_m`: position of the side sonar ahead of the wheels' axis.
pub(super) fn leg(
    samples: &[Sample],
    side: SonarId,
    ahead_m: f64,
) -> Result<LegFit, CalibrateError> {
    const WHAT: &str = "how straight the robot drives";
    let undetermined = CalibrateError::NotDetermined(WHAT);
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Err(undetermined);
    };
    // To the right of the wall the distance grows as the robot moves left; on its left it shrinks.
    let sign = if side == SonarId::Left { -1.0 } else { 1.0 };
    let (sin, cos) = first.heading_rad.sin_cos();
    let mut rows = Vec::new();
    for sample in samples {
        let Some(range_m) = sample.range_m(side) else {
            continue;
        };
        let (dx, dy) = (sample.x_m - first.x_m, sample.y_m - first.y_m);
        let (way_m, left_m) = (cos * dx + sin * dy, cos * dy - sin * dx);
        let turned_rad = sample.heading_rad - first.heading_rad;
        // Distance = c + sign (left + ahead heading), where heading and left are the odometry's plus h + k s and h s + k s^2 / 2.
        let known_m = sign * (left_m + ahead_m * turned_rad);
        let slope = sign * (way_m + ahead_m);
        let bend = sign * (0.5 * way_m * way_m + ahead_m * way_m);
        rows.push(([1.0, slope, bend], range_m - known_m));
    }
    let far_m = cos * (last.x_m - first.x_m) + sin * (last.y_m - first.y_m);
    if rows.len() < FEWEST_RANGES || far_m.abs() < SHORTEST_M {
        return Err(undetermined);
    }
    let [_, start_rad, curvature_rad_m] = solve(&robust(&rows)?).ok_or(undetermined)?;
    Ok(LegFit {
        start_rad,
        end_rad: start_rad + curvature_rad_m * far_m + last.heading_rad - first.heading_rad,
        curvature_rad_m,
        way_m: far_m.abs(),
    })
}

type Row<const N: usize> = ([f64; N], f64);

/// The rows without outliers from a first fit: a sonar's outlier passes its filter now and then.
fn robust<const N: usize>(rows: &[Row<N>]) -> Result<Vec<Row<N>>, CalibrateError> {
    let fit = solve(rows).ok_or(CalibrateError::NotDetermined("a straight wall"))?;
    let residual = |(factors, value): &Row<N>| {
        value
            - factors
                .iter()
                .zip(&fit)
                .map(|(factor, parameter)| factor * parameter)
                .sum::<f64>()
    };
    let mut sizes: Vec<f64> = rows.iter().map(|row| residual(row).abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let most = 4.0 * median.max(0.001);
    Ok(rows
        .iter()
        .filter(|row| residual(row).abs() <= most)
        .copied()
        .collect())
}

/// Least squares; `None` when the rows do not determine it.
fn solve<const N: usize>(rows: &[Row<N>]) -> Option<[f64; N]> {
    let factors = DMatrix::from_fn(rows.len(), N, |row, column| rows[row].0[column]);
    let values = DVector::from_fn(rows.len(), |row, _| rows[row].1);
    let normal = factors.transpose() * &factors;
    let solved = normal.cholesky()?.solve(&(factors.transpose() * values));
    let mut parameters = [0.0; N];
    for (parameter, value) in parameters.iter_mut().zip(solved.iter()) {
        *parameter = *value;
    }
    parameters
        .iter()
        .all(|value| value.is_finite())
        .then_some(parameters)
}

/// Mean duty and speed of a wheel over the steady part of a leg, without sign.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steady {
    /// Turns forward.
    pub(super) forward: bool,
    /// Speed [rad/s].
    pub(super) rad_s: Wheels<f64>,
    /// Duty, 0..=1.
    pub(super) duty: Wheels<f64>,
}

/// The steady part of a leg; `None` if it has none.
pub(super) fn steady(samples: &[Sample], forward: bool) -> Option<Steady> {
    let fastest = samples
        .iter()
        .map(|sample| sample.reference_rad_s.left.abs())
        .fold(0.0, f64::max);
    let cruising: Vec<&Sample> = samples
        .iter()
        .filter(|sample| {
            sample.reference_rad_s.left.abs() > 0.9 * fastest
                && sample.wheel_rad_s.left.abs() > 0.8 * fastest
        })
        .collect();
    // The first samples are still affected by the start.
    let kept = cruising.get(cruising.len() / 4..)?;
    if kept.len() < 20 {
        return None;
    }
    let mean = |of: &dyn Fn(&Sample) -> f64| {
        kept.iter().map(|sample| of(sample)).sum::<f64>().abs() / kept.len() as f64
    };
    let (mut rad_s, mut duty) = (Wheels::both(0.0), Wheels::both(0.0));
    for side in SIDES {
        rad_s[side] = mean(&|sample| sample.wheel_rad_s[side]);
        duty[side] = mean(&|sample| sample.duty[side]);
    }
    Some(Steady {
        forward,
        rad_s,
        duty,
    })
}

/// Duty = kS of wheel and direction + kV speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedFeedforward {
    /// Forward, both wheels.
    pub forward: Wheels<Measured>,
    /// Backward, both wheels.
    pub backward: Wheels<Measured>,
    /// Duty per speed [s/rad].
    pub velocity: Measured,
}

/// The feedforward that explains the steady parts of all legs.
pub(super) fn feedforward(legs: &[Steady]) -> Result<FittedFeedforward, CalibrateError> {
    let mut rows: Vec<Row<5>> = Vec::new();
    for leg in legs {
        for (index, side) in SIDES.into_iter().enumerate() {
            let mut factors = [0.0; 5];
            factors[index + if leg.forward { 0 } else { 2 }] = 1.0;
            factors[4] = leg.rad_s[side];
            rows.push((factors, leg.duty[side]));
        }
    }
    let undetermined = CalibrateError::NotDetermined("the duty that each speed takes");
    if rows.len() < 10 {
        return Err(undetermined);
    }
    let found = solve(&rows).ok_or(undetermined)?;
    let squares: f64 = rows
        .iter()
        .map(|(factors, duty)| {
            let explained: f64 = factors.iter().zip(&found).map(|(a, b)| a * b).sum();
            (duty - explained) * (duty - explained)
        })
        .sum();
    let variance = squares / (rows.len() - 5) as f64;
    let factors = DMatrix::from_fn(rows.len(), 5, |row, column| rows[row].0[column]);
    let inverse =
        (factors.transpose() * factors)
            .try_inverse()
            .ok_or(CalibrateError::NotDetermined(
                "the duty that each speed takes",
            ))?;
    let measured = |index: usize| Measured {
        value: found[index],
        error: (variance * inverse[(index, index)]).sqrt(),
    };
    Ok(FittedFeedforward {
        forward: Wheels {
            left: measured(0),
            right: measured(1),
        },
        backward: Wheels {
            left: measured(2),
            right: measured(3),
        },
        velocity: measured(4),
    })
}

/// True distance over the odometry's, by the front sonar on a forward leg; `None` if it had too few readings ahead.
pub(super) fn way_scale(samples: &[Sample]) -> Option<f64> {
    let first = samples.first()?;
    let rows: Vec<Row<2>> = samples
        .iter()
        .filter_map(|sample| {
            let way_m = (sample.x_m - first.x_m).hypot(sample.y_m - first.y_m);
            let range_m = sample
                .range_m(SonarId::Front)
                .filter(|range_m| *range_m < 2.0)?;
            Some(([1.0, -way_m], range_m))
        })
        .collect();
    let farthest_m = rows
        .iter()
        .map(|([_, way_m], _)| -way_m)
        .fold(0.0, f64::max);
    let nearest_m = rows
        .iter()
        .map(|([_, way_m], _)| -way_m)
        .fold(f64::MAX, f64::min);
    if rows.len() < FEWEST_RANGES || farthest_m - nearest_m < 2.0 * SHORTEST_M {
        return None;
    }
    let [_, scale] = solve(&robust(&rows).ok()?)?;
    Some(scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A robot that drives a leg at 0.2 m/s beside a wall, `heading_rad` off its direction and bent by `curvature_rad_m`.
    fn drive(side: SonarId, backward: bool, heading_rad: f64, curvature_rad_m: f64) -> Vec<Sample> {
        let sign = if side == SonarId::Left { -1.0 } else { 1.0 };
        (0..200)
            .map(|step| {
                let way_m = 0.008 * f64::from(step) * if backward { -1.0 } else { 1.0 };
                let true_rad = heading_rad + curvature_rad_m * way_m;
                let left_m = heading_rad * way_m + 0.5 * curvature_rad_m * way_m * way_m;
                let mut range_m = [None; 3];
                range_m[side as usize] = Some(0.35 + sign * (left_m + 0.03 * true_rad));
                Sample {
                    t_s: 0.04 * f64::from(step),
                    x_m: way_m,
                    y_m: 0.0,
                    heading_rad: 0.0,
                    wheel_rad_s: Wheels::both(6.0),
                    reference_rad_s: Wheels::both(6.0),
                    duty: Wheels::both(0.3),
                    range_m,
                    faulty: [false; 3],
                }
            })
            .collect()
    }

    #[test]
    fn a_wall_on_either_side_gives_the_curvature_forward_and_backward() {
        for side in [SonarId::Left, SonarId::Right] {
            for backward in [false, true] {
                let found = leg(&drive(side, backward, 0.03, -0.05), side, 0.03).unwrap();
                assert!((found.curvature_rad_m + 0.05).abs() < 1e-9, "{found:?}");
                assert!((found.start_rad - 0.03).abs() < 1e-9, "{found:?}");
                let end_rad = 0.03 - 0.05 * found.way_m * if backward { -1.0 } else { 1.0 };
                assert!((found.end_rad - end_rad).abs() < 1e-9, "{found:?}");
            }
        }
    }

    #[test]
    fn a_spike_of_the_sonar_does_not_bend_the_wall() {
        let mut samples = drive(SonarId::Right, false, 0.02, 0.04);
        for spike in [30, 31, 120] {
            samples[spike].range_m[1] = Some(0.25);
        }
        let found = leg(&samples, SonarId::Right, 0.03).unwrap();
        assert!((found.curvature_rad_m - 0.04).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn too_little_wall_is_an_error_not_a_curvature() {
        let samples = drive(SonarId::Right, false, 0.0, 0.0);
        assert!(leg(&samples[..40], SonarId::Right, 0.03).is_err());
        assert!(leg(&samples, SonarId::Left, 0.03).is_err());
    }

    #[test]
    fn the_mean_of_few_values_carries_its_error() {
        let found = mean(&[(1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]).unwrap();
        assert!((found.value - 2.0).abs() < 1e-12);
        assert!((found.error - (1.0f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(mean(&[(1.0, 1.0)]), None);
    }

    #[test]
    fn feedforward_is_found_for_each_wheel_and_direction() {
        let legs: Vec<Steady> = [
            (true, 4.0),
            (false, 4.0),
            (true, 8.0),
            (false, 8.0),
            (true, 6.0),
        ]
        .map(|(forward, rad_s)| Steady {
            forward,
            rad_s: Wheels::both(rad_s),
            duty: Wheels {
                left: if forward { 0.20 } else { 0.22 } + 0.018 * rad_s,
                right: if forward { 0.17 } else { 0.19 } + 0.018 * rad_s,
            },
        })
        .to_vec();
        let found = feedforward(&legs).unwrap();
        for (measured, value) in [
            (found.forward.left, 0.20),
            (found.forward.right, 0.17),
            (found.backward.left, 0.22),
            (found.backward.right, 0.19),
            (found.velocity, 0.018),
        ] {
            assert!((measured.value - value).abs() < 1e-9, "{found:?}");
        }
        assert!(feedforward(&legs[..2]).is_err());
    }
}
