//! Ranges of a recorded run against those of its simulation, a stretch of some seconds at a time.
//!
//! Where the robot stands at the beginning of a stretch no log tells; distance and heading there, and a slow turn that
//! the floor or unequal wheels add, are fitted to the stretch itself. They enter linearly: with the simulated way s and
//! turn p since its beginning, towards the wall, and the sonar x ahead of the axis,
//!
//! ```text
//! reading = d - h (s + x) - b (int t ds + x t) - (int p ds + x p)
//! ```
//!
//! for the distance d, heading h and added turn b; ahead of a wall only d - s is left. What remains says how fast the
//! robot goes and how it answers to a difference of PWM.

use crate::log::{DriveLog, Seen};
use crate::replay::Trace;
use crate::row::LogRow;
use nalgebra::{DMatrix, DVector};

/// Length of a stretch.
const STRETCH_MS: usize = 3_000;
/// Where the sonars of the report's side pair sit, ahead of the axis, front and rear, m.
const AHEAD_M: [f64; 2] = [0.10, -0.04];
/// What is believed of distance, heading and added turn beforehand: standard deviations, m, rad, rad/s.
const BELIEVED: [f64; 3] = [1.0, 0.3, 0.1];
/// Rounds in which outliers lose their weight.
const ROUNDS: usize = 4;
/// Errors beyond this many standard deviations lose weight.
const BEND: f64 = 2.0;

/// Errors of all readings of the run, m; empty if it has none that show the drive.
pub(crate) fn errors_m(log: &DriveLog, trace: &Trace, sd_m: f64) -> Vec<f64> {
    let mut errors = Vec::new();
    let mut from = 0;
    while from < log.rows.len() {
        let until_ms = log.rows[from].at_ms + STRETCH_MS;
        let rows = &log.rows[from..];
        let rows = &rows[..rows.partition_point(|row| row.at_ms < until_ms)];
        from += rows.len();
        let (design, offsets) = match (log.seen, log.pair.and_then(|pair| pair.beside_wall())) {
            (Seen::FrontRange, _) => ahead(rows, trace),
            (Seen::SidePair, Some((front, side))) => beside(rows, trace, front, side),
            _ => return Vec::new(),
        };
        errors.extend(remainders(&design, &offsets, sd_m).iter());
    }
    errors
}

/// Reading `index` of a row as [`errors_m`] counts them: the mean ahead, or front and rear sonar, m.
pub(crate) fn reading_m(log: &DriveLog, row: &LogRow, index: usize) -> f64 {
    match log.pair.and_then(|pair| pair.beside_wall()) {
        Some((front, _)) => row.range_m[if index == 0 { front } else { 1 - front }],
        None => row.mean_m(),
    }
}

/// Rows of unknowns and what is known: the reading and the simulated way.
fn ahead(rows: &[LogRow], trace: &Trace) -> (DMatrix<f64>, DVector<f64>) {
    let start_m = trace.way_m[rows[0].at_ms];
    let offsets = rows
        .iter()
        .map(|row| row.mean_m() + trace.way_m[row.at_ms] - start_m);
    (
        DMatrix::from_element(rows.len(), 1, 1.0),
        DVector::from_iterator(rows.len(), offsets),
    )
}

fn beside(rows: &[LogRow], trace: &Trace, front: usize, side: f64) -> (DMatrix<f64>, DVector<f64>) {
    let start_ms = rows[0].at_ms;
    let turn = |ms: usize| side * (trace.heading_rad[ms] - trace.heading_rad[start_ms]);
    let (mut design, mut offsets) = (Vec::new(), Vec::new());
    let (mut ms, mut way_m, mut late, mut turned) = (start_ms, 0.0, 0.0, 0.0);
    for row in rows {
        while ms < row.at_ms {
            let step_m = trace.way_m[ms + 1] - trace.way_m[ms];
            way_m += step_m;
            late += 1e-3 * (ms - start_ms) as f64 * step_m;
            turned += turn(ms) * step_m;
            ms += 1;
        }
        let t_s = 1e-3 * (ms - start_ms) as f64;
        for (column, x_m) in [(front, AHEAD_M[0]), (1 - front, AHEAD_M[1])] {
            design.extend([1.0, -(way_m + x_m), -(late + x_m * t_s)]);
            offsets.push(row.range_m[column] + turned + x_m * turn(ms));
        }
    }
    (
        DMatrix::from_row_slice(offsets.len(), 3, &design),
        DVector::from_vec(offsets),
    )
}

/// What a robust fit of the unknowns leaves.
fn remainders(design: &DMatrix<f64>, offsets: &DVector<f64>, sd_m: f64) -> DVector<f64> {
    let unknowns = design.ncols();
    // About the first reading, so that what is believed of the distance is no matter.
    let about = offsets.add_scalar(-offsets[0]);
    let mut weights = DVector::from_element(offsets.len(), 1.0);
    let mut left = about.clone();
    for _ in 0..ROUNDS {
        let weighted =
            DMatrix::from_fn(design.nrows(), unknowns, |i, j| weights[i] * design[(i, j)]);
        let mut normal = weighted.transpose() * design;
        for (j, believed) in BELIEVED.iter().take(unknowns).enumerate() {
            normal[(j, j)] += (sd_m / believed).powi(2);
        }
        let right = weighted.transpose() * &about;
        let Some(found) = normal.cholesky().map(|normal| normal.solve(&right)) else {
            return left;
        };
        left = &about - design * found;
        weights = left.map(|error| (BEND * sd_m / error.abs().max(1e-9)).min(1.0));
    }
    left
}
