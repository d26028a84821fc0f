//! Sweeps: a scenario with many values of its parameters, each point with the same seeds.
//!
//! ```text
//! Axis, Design ─► Plan (points x seeds) ─► run on all cores ─► Row, one for each run ─► Sweep: medians, ranks
//! ```
//!
//! A run depends on its point and seed alone: what was interrupted goes on where it ended.

mod axis;
mod outcome;

pub use axis::{Axis, AxisError, Values};
pub use outcome::{MetricSpread, RunRow, SweepOutcome};

use crate::files::{FileError, Setup};
use crate::run::{RunResult, run_each};
use rumbo_plant::noise::{Noise, source};
use std::borrow::Cow;
use thiserror::Error;

/// Most runs of a sweep.
pub const MOST_RUNS: usize = 10_000_000;
/// Most points of a sweep.
pub const MOST_POINTS: usize = 1_000_000;
/// Most parameters that vary.
const MOST_AXES: usize = sobol_burley::NUM_DIMENSIONS as usize;
/// Most points of a Sobol sequence.
const MOST_SOBOL: usize = 1 << 16;

/// How points are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Every combination of the axes' values.
    Grid,
    /// So many points, drawn independently.
    Random(usize),
    /// So many points of a scrambled Sobol sequence: more even than random ones.
    Sobol(usize),
}

/// What is run.
#[derive(Clone, Debug)]
pub struct SweepPlan {
    /// The parameters that vary.
    pub axes: Vec<Axis>,
    /// How the points were chosen.
    pub design: Design,
    /// Their values at each point.
    pub points: Vec<Vec<f64>>,
    /// The first seed.
    pub seed: u64,
    /// Runs of each point, with consecutive seeds.
    pub runs: u32,
}

/// Why there is no plan.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum PlanError {
    /// A parameter has two axes.
    #[error("{0} has two axes; give each parameter once")]
    Twice(String),
    /// A grid needs a count.
    #[error(
        "{0}: a grid needs a count, e.g. {0}=1:20:10; or have points drawn, at random or of a Sobol sequence"
    )]
    NoCount(String),
    /// Drawn points have no count.
    #[error("{0}: points are drawn from the whole range; leave its count away")]
    Count(String),
    /// More points or runs than can be.
    #[error(
        "{0} points are too many: at most {MOST_POINTS} points and {MOST_RUNS} runs; take fewer values or fewer \
         runs, or have points of a Sobol sequence drawn"
    )]
    TooMany(usize),
    /// The same of a Sobol sequence.
    #[error(
        "{0} points are too many: a Sobol sequence has at most {MOST_SOBOL}; have them drawn at random"
    )]
    TooManySobol(usize),
    /// More parameters than can vary at once.
    #[error("at most {MOST_AXES} parameters vary at once")]
    TooManyAxes,
}

impl SweepPlan {
    /// The points of these axes; `seed` is the first run's and draws the points of a random design.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn new(axes: Vec<Axis>, design: Design, seed: u64, runs: u32) -> Result<Self, PlanError> {
        for (index, axis) in axes.iter().enumerate() {
            if axes[..index].iter().any(|other| other.name == axis.name) {
                return Err(PlanError::Twice(axis.name.clone()));
            }
        }
        if axes.len() > MOST_AXES {
            return Err(PlanError::TooManyAxes);
        }
        let points = match design {
            Design::Sobol(count) if count > MOST_SOBOL => {
                return Err(PlanError::TooManySobol(count));
            }
            Design::Grid => grid(&axes, runs)?,
            Design::Random(count) | Design::Sobol(count) => {
                if within_bounds(count, runs).is_none() {
                    return Err(PlanError::TooMany(count));
                }
                drawn(&axes, design, count, seed)?
            }
        };
        Ok(Self {
            axes,
            design,
            points,
            seed,
            runs,
        })
    }

    /// How many runs there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len() * self.runs as usize
    }

    /// There are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Point and seed of a run.
    #[must_use]
    pub fn job(&self, index: usize) -> (usize, u64) {
        let runs = self.runs as usize;
        let seed = self.seed.wrapping_add((index % runs) as u64);
        (index / runs, seed)
    }

    /// The setup of a point.
    ///
    /// # Errors
    /// A parameter that does not exist, or a value out of its limits.
    pub fn setup(&self, setup: &Setup, point: usize) -> Result<Setup, FileError> {
        let names = self.axes.iter().map(|axis| axis.name.as_str());
        let values = names.zip(self.points[point].iter().copied());
        setup.with_parameters(&values.collect::<Vec<_>>())
    }

    /// Checks every point, before anything runs.
    ///
    /// # Errors
    /// As [`Self::setup`].
    pub fn check(&self, setup: &Setup) -> Result<(), FileError> {
        (0..self.points.len()).try_for_each(|point| self.setup(setup, point).map(drop))
    }

    /// Runs everything from `first` on, on this many threads; `handle` gets each row in order as soon as it and all before it
    /// are there.
    ///
    /// # Errors
    /// The first error, of a setup, of `go_on`, which is asked in between, or of `handle`; no further run is begun.
    pub fn run<E: From<FileError>>(
        &self,
        setup: &Setup,
        first: usize,
        threads: usize,
        go_on: impl Fn() -> Result<(), E>,
        mut handle: impl FnMut(RunRow) -> Result<(), E>,
    ) -> Result<(), E> {
        let job = |index: usize| {
            let (point, seed) = self.job(first + index);
            Ok((Cow::Owned(self.setup(setup, point)?), seed))
        };
        let row = |index: usize, result: RunResult| RunRow::of(self.job(first + index).0, &result);
        let count = self.len() - first;
        run_each(threads, count, job, row, go_on, |_, row| handle(row))
    }
}

/// The number of runs, where it is not too large.
fn within_bounds(points: usize, runs: u32) -> Option<usize> {
    let all = points.checked_mul(runs as usize)?;
    (points <= MOST_POINTS && all <= MOST_RUNS).then_some(all)
}

fn grid(axes: &[Axis], runs: u32) -> Result<Vec<Vec<f64>>, PlanError> {
    let values = axes.iter().map(|axis| {
        let name = || PlanError::NoCount(axis.name.clone());
        axis.grid().ok_or_else(name)
    });
    let values: Vec<Vec<f64>> = values.collect::<Result<_, _>>()?;
    let count = values
        .iter()
        .fold(1usize, |count, axis| count.saturating_mul(axis.len()));
    if within_bounds(count, runs).is_none() {
        return Err(PlanError::TooMany(count));
    }
    // The last axis varies fastest.
    let point = |index: usize| {
        let mut left = index;
        let mut point: Vec<f64> = values
            .iter()
            .rev()
            .map(|axis| {
                let value = axis[left % axis.len()];
                left /= axis.len();
                value
            })
            .collect();
        point.reverse();
        point
    };
    Ok((0..count).map(point).collect())
}

fn drawn(
    axes: &[Axis],
    design: Design,
    count: usize,
    seed: u64,
) -> Result<Vec<Vec<f64>>, PlanError> {
    for axis in axes {
        if let Values::Range { count: Some(_), .. } = axis.values {
            return Err(PlanError::Count(axis.name.clone()));
        }
    }
    let noise = Noise::new(seed, 0);
    let share = |point: usize, dimension: usize| match design {
        Design::Sobol(_) => {
            // Folded: every bit of the seed scrambles.
            let scramble = (seed ^ (seed >> 32)) as u32;
            f64::from(sobol_burley::sample(
                point as u32,
                dimension as u32,
                scramble,
            ))
        }
        _ => noise.uniform(source::SWEEP + dimension as u32, point as u64),
    };
    let point = |index: usize| {
        let values = axes.iter().enumerate();
        values
            .map(|(dimension, axis)| axis.at(share(index, dimension)))
            .collect()
    };
    Ok((0..count).map(point).collect())
}

#[cfg(test)]
mod tests;
