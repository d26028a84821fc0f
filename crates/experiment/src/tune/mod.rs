//! Tuning: values of control parameters that serve an objective on many drawn robots.
//!
//! ```text
//! a Sobol sequence over all ranges ─► the best of it and the start ─► CMA-ES (Hansen 2016) from each ─► finalists, on fresh seeds
//! ```
//!
//! Each generation runs all its candidates with the same seeds, and the next one takes others: what suits some robots
//! only does not last. The cost of a candidate is half its mean over the robots and half the mean of the worst
//! quarter of them. A limit that is nearly missed costs too, so that other robots keep it as well. The result depends on
//! the seed and the budget alone, not on threads or time.

mod error;
mod objective;
mod over;
mod plan;

pub use error::TuneError;
pub use objective::{Objective, ObjectiveError};
pub use over::{Over, Tunable, tunable};
pub use plan::{TuningOutcome, TuningPlan, TuningRequest};

use crate::files::parameters::exact;
use crate::files::{FileError, Setup};
use crate::run::{prepare, run};
use crate::sweep::Values;
use nalgebra::DVector;
use rayon::prelude::*;
use rumbo_control::params::{ParamId, ParamKind};
use rumbo_plant::rewrite::{RewriteError, RobotText};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A range without a given one goes from the start's value divided by this to its multiple.
const FACTOR: f64 = 8.0;
/// Driving of a search by default [s].
const DRIVING_S: f64 = 500_000.0;
/// Points of the first look, and the seeds of each.
const LOOK: usize = 48;
const LOOK_SEEDS: usize = 4;
/// Seeds of a generation: at first, and at last, when candidates differ little and rare robots count.
const FIRST_SEEDS: usize = 6;
const LAST_SEEDS: usize = 60;
/// The robots of a search: its generations take their seeds from these in turn, so that no robot is calibrated often.
const ROBOTS: usize = 300;
/// Step size of the search at first, in units of half a range.
const STEP: f64 = 0.35;
/// The search has converged at this step size.
const FINE: f64 = 0.012;
/// Candidates of the end: the start, and the middle and the best of two descents; the seeds of each.
const FINALISTS: usize = 5;
const FINAL_SEEDS: usize = 120;
/// The mean over this share of the robots, the worst ones, is half of the cost.
const WORST: f64 = 0.25;

/// A parameter that is tuned.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The parameter.
    pub id: ParamId,
    /// Its value at the start.
    pub start: f64,
    /// Where it may lie.
    pub range: [f64; 2],
    /// Even steps of the logarithm.
    log: bool,
}

fn limits(id: ParamId) -> [f64; 2] {
    let limits = id.limits();
    [exact(limits.min), exact(limits.max)]
}

/// How the comment of tuned parameters starts.
const MARK: &str = "# Tuned by `rumbo tune`";
const TABLE: &str = "parameters";

/// A robot file with tuned values in its table `[parameters]`, made if absent; `about` says when and what for.
///
/// # Errors
/// A text that is no TOML, or in which `parameters` is no table.
pub fn rewrite(text: &str, values: &[(ParamId, f64)], about: &str) -> Result<String, RewriteError> {
    let mut file = RobotText::parse(text)?;
    for (id, value) in values {
        file.set(TABLE, id.name(), *value)?;
    }
    file.annotate(TABLE, MARK, about)?;
    Ok(file.to_string())
}

/// Whether a robot file has tuned parameters.
#[must_use]
pub fn is_tuned(text: &str) -> bool {
    text.lines().any(|line| line.starts_with(MARK))
}

/// The parameters to tune, with their starts and ranges.
///
/// # Errors
/// [`TuneError`], as text, or a setup whose values do not fit together.
pub fn tuned(setup: &Setup, over: &[Over]) -> Result<Vec<Tuned>, FileError> {
    let now = setup.params()?;
    let mut all: Vec<Tuned> = Vec::new();
    for one in over {
        let id = one.id();
        if all.iter().any(|other| other.id == id) {
            return Err(TuneError::Twice(id.name().to_owned()).into());
        }
        if id.kind() != ParamKind::Number {
            return Err(TuneError::NoNumber(id).into());
        }
        let start = f64::from(now.get(id));
        let limits = limits(id);
        let (range, log) = match one {
            Over::Range(_, axis) => match axis.values {
                Values::Range {
                    from,
                    to,
                    count: None,
                    log,
                } => ([from, to], log || (from > 0.0 && to / from > 4.0)),
                _ => return Err(TuneError::Form(id.name().to_owned()).into()),
            },
            // A gain of zero has no scale.
            Over::Name(_) if start <= 0.0 => (limits, false),
            Over::Name(_) => {
                let range = [
                    (start / FACTOR).max(limits[0]),
                    (start * FACTOR).min(limits[1]),
                ];
                (range, range[0] > 0.0)
            }
        };
        if range[0] < limits[0] || range[1] > limits[1] {
            return Err(TuneError::Range(id).into());
        }
        all.push(Tuned {
            id,
            start: start.clamp(range[0], range[1]),
            range,
            log,
        });
    }
    Ok(all)
}

impl Tuned {
    /// The value at a place from -1 to 1.
    fn at(&self, place: f64) -> f64 {
        let share = 0.5 * (place.clamp(-1.0, 1.0) + 1.0);
        let [from, to] = self.range;
        let value = match self.log {
            true => from * libm::pow(to / from, share),
            false => from + share * (to - from),
        };
        // Four digits: more would claim what no robot shows.
        format!("{value:.3e}")
            .parse::<f64>()
            .unwrap_or(value)
            .clamp(from, to)
    }

    fn place(&self, value: f64) -> f64 {
        let [from, to] = self.range;
        let share = match self.log {
            true => libm::log(value / from) / libm::log(to / from),
            false => (value - from) / (to - from),
        };
        2.0 * share - 1.0
    }
}

/// A search.
#[derive(Clone, Copy, Debug)]
pub struct Search<'a> {
    /// What is driven.
    pub setup: &'a Setup,
    /// What is tuned.
    pub over: &'a [Tuned],
    /// What for.
    pub objective: &'a Objective,
    /// The first seed; seeds of a search do not exceed it by more than [`Self::SEEDS`].
    pub seed: u64,
    /// Most runs.
    pub budget: usize,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// The values, in the order of the parameters.
    pub values: Vec<f64>,
    /// Runs made.
    pub runs: usize,
}

impl Search<'_> {
    /// A search uses no more seeds than so many from its first on.
    pub const SEEDS: u64 = 1_000_000;

    /// The seeds of so many robots that a search from a first seed does not drive.
    #[must_use]
    pub fn held_out(first: u64, count: u32) -> Vec<u64> {
        let from = first.wrapping_add(Self::SEEDS);
        let seeds = 0..u64::from(count);
        seeds.map(|index| from.wrapping_add(index)).collect()
    }
    /// Fewer runs are no search.
    pub const LEAST: usize = 2_000;

    /// Most runs of a search by default.
    #[must_use]
    pub fn default_budget(setup: &Setup) -> usize {
        ((DRIVING_S / setup.scenario.duration_s) as usize).max(Self::LEAST)
    }

    /// Searches; `progress` gets the share of the budget that is used. `goes_on` is asked before each run.
    ///
    /// # Errors
    /// A budget that is too small, the first error of a run, or [`TuneError::Ended`] once `goes_on` denies.
    pub fn run(
        &self,
        progress: impl Fn(f64),
        goes_on: &(dyn Fn() -> bool + Sync),
    ) -> Result<Found, FileError> {
        if self.budget < Self::LEAST {
            return Err(TuneError::Budget(Self::LEAST).into());
        }
        let units = self.units()?;
        let evaluator = Evaluator {
            search: self,
            units: &units,
            runs: AtomicUsize::new(0),
            goes_on,
        };
        let share = || evaluator.share();
        let dimension = self.over.len();
        let start: Vec<f64> = self.over.iter().map(|one| one.place(one.start)).collect();
        // The first look.
        evaluator.calibrate(0, LOOK_SEEDS)?;
        let mut looked: Vec<(f64, Vec<f64>)> = (0..LOOK)
            .into_par_iter()
            .map(|index| {
                let place: Vec<f64> = match index {
                    0 => start.clone(),
                    _ => (0..dimension)
                        .map(|axis| {
                            let share = sobol_burley::sample(index as u32, axis as u32, 1);
                            2.0 * f64::from(share) - 1.0
                        })
                        .collect(),
                };
                let cost = evaluator.cost(&place, 0, LOOK_SEEDS)?;
                Ok((cost, place))
            })
            .collect::<Result<_, FileError>>()?;
        looked.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut finalists: Vec<Vec<f64>> = vec![start];
        // From the two best places: the surface may have more than one valley.
        for (number, (_, from)) in looked.iter().take(2).enumerate() {
            let until = 0.5 * (number + 1) as f64 * (1.0 - self.last_share());
            let found = self.descend(&evaluator, from, number, &|| {
                progress(share());
                share() < until && goes_on()
            })?;
            finalists.extend(found);
        }
        self.finish(&evaluator, finalists)
    }

    /// What the end needs of the budget.
    fn last_share(&self) -> f64 {
        (FINALISTS * FINAL_SEEDS) as f64 / self.budget as f64
    }

    /// The scale of each aim: its median at the start, or else its limit in the scenario.
    fn units(&self) -> Result<Vec<f64>, FileError> {
        let values: Vec<f64> = self.over.iter().map(|one| one.start).collect();
        let setup = self.setup_of(&values)?;
        let seeds = (0..FIRST_SEEDS as u64).into_par_iter();
        let runs = seeds.map(|index| run(&setup, self.seed.wrapping_add(index)));
        let runs: Vec<_> = runs.collect::<Result<_, _>>()?;
        let unit = |name: &String| {
            let values = runs
                .iter()
                .filter_map(|run| crate::metrics::worst(&run.metrics, name));
            let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            let median = values.get(values.len() / 2).map(|value| value.abs());
            let limits = self.setup.scenario.limits.iter();
            let own = limits
                .filter(|(limit, _)| crate::metrics::bare(limit) == crate::metrics::bare(name));
            let own = own
                .filter_map(|(_, bounds)| bounds.max.or(bounds.min))
                .reduce(f64::max);
            own.or(median).filter(|unit| *unit > 0.0).unwrap_or(1.0)
        };
        Ok(self.objective.aims.iter().map(unit).collect())
    }

    /// The setup with these values.
    ///
    /// # Errors
    /// A value out of its limits.
    pub fn setup_of(&self, values: &[f64]) -> Result<Setup, FileError> {
        let names = self.over.iter().map(|one| one.id.name());
        let values: Vec<_> = names.zip(values.iter().copied()).collect();
        self.setup.with_parameters(&values)
    }

    /// CMA-ES from a place; returns the middle of its last distribution and its last best candidate.
    fn descend(
        &self,
        evaluator: &Evaluator<'_>,
        from: &[f64],
        number: usize,
        go_on: &dyn Fn() -> bool,
    ) -> Result<Vec<Vec<f64>>, FileError> {
        let (first, seeds) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let broken = |error: String| FileError::Setting(format!("the search failed: {error}"));
        let search = cmaes::CMAESOptions::new(DVector::from_column_slice(from), STEP)
            .seed(self.seed.wrapping_add(number as u64))
            .build(|place: &DVector<f64>| {
                let [first, seeds] = [&first, &seeds].map(|of| of.load(Ordering::Relaxed));
                // An error shows again where it can be returned.
                evaluator
                    .cost(place.as_slice(), first, seeds)
                    .unwrap_or(f64::MAX)
            });
        let mut search = search.map_err(|error| broken(format!("{error:?}")))?;
        let begun = evaluator.share();
        let mut next = 0;
        while go_on() && search.sigma() > FINE {
            let done = (evaluator.share() - begun) / (0.5 * (1.0 - self.last_share()));
            let more = (LAST_SEEDS - FIRST_SEEDS) as f64 * done;
            let count = FIRST_SEEDS + more as usize;
            let from = next % (ROBOTS - count);
            next += count;
            first.store(from, Ordering::Relaxed);
            seeds.store(count, Ordering::Relaxed);
            evaluator.calibrate(from, count)?;
            if search.next_parallel().is_some() {
                break;
            }
        }
        let best = search.current_best_individual();
        let best = best.map(|best| best.point.as_slice().to_vec());
        let mean = search.mean().as_slice().to_vec();
        Ok([mean].into_iter().chain(best).collect())
    }

    /// The best of the finalists on fresh seeds.
    fn finish(
        &self,
        evaluator: &Evaluator<'_>,
        finalists: Vec<Vec<f64>>,
    ) -> Result<Found, FileError> {
        let first = Self::SEEDS as usize / 2;
        evaluator.calibrate(first, FINAL_SEEDS)?;
        let costs: Vec<f64> = finalists
            .par_iter()
            .map(|place| evaluator.cost(place, first, FINAL_SEEDS))
            .collect::<Result<_, _>>()?;
        let best = (0..finalists.len()).min_by(|one, other| costs[*one].total_cmp(&costs[*other]));
        let place = &finalists[best.unwrap_or(0)];
        let values = self.over.iter().zip(place);
        Ok(Found {
            // The start keeps its digits.
            values: match best {
                Some(0) | None => self.over.iter().map(|one| one.start).collect(),
                _ => values.map(|(one, place)| one.at(*place)).collect(),
            },
            runs: evaluator.runs.load(Ordering::Relaxed),
        })
    }
}

struct Evaluator<'a> {
    search: &'a Search<'a>,
    units: &'a [f64],
    runs: AtomicUsize,
    goes_on: &'a (dyn Fn() -> bool + Sync),
}

impl Evaluator<'_> {
    /// The share of the budget that is used.
    fn share(&self) -> f64 {
        self.runs.load(Ordering::Relaxed) as f64 / self.search.budget as f64
    }

    /// Calibrates the robots of so many seeds from one on, if their scenario requests it: else each candidate would.
    fn calibrate(&self, first: usize, seeds: usize) -> Result<(), FileError> {
        let Search { setup, seed, .. } = self.search;
        (first..first + seeds)
            .into_par_iter()
            .try_for_each(|index| {
                self.goes_on()?;
                prepare(setup, seed.wrapping_add(index as u64)).map(|_| ())
            })
    }

    fn goes_on(&self) -> Result<(), FileError> {
        match (self.goes_on)() {
            true => Ok(()),
            false => Err(TuneError::Ended.into()),
        }
    }

    /// The cost at a place over so many seeds from one on.
    fn cost(&self, place: &[f64], first: usize, seeds: usize) -> Result<f64, FileError> {
        let search = self.search;
        let values = search.over.iter().zip(place);
        let values: Vec<f64> = values.map(|(one, place)| one.at(*place)).collect();
        let setup = search.setup_of(&values)?;
        let costs = (first..first + seeds).into_par_iter().map(|index| {
            self.goes_on()?;
            let result = run(&setup, search.seed.wrapping_add(index as u64))?;
            let objective = search.objective;
            Ok(objective.cost(&setup.scenario, self.units, &result.metrics, result.pass))
        });
        let mut costs: Vec<f64> = costs.collect::<Result<_, FileError>>()?;
        self.runs.fetch_add(seeds, Ordering::Relaxed);
        costs.sort_by(|one, other| other.total_cmp(one));
        let mean = |costs: &[f64]| costs.iter().sum::<f64>() / costs.len() as f64;
        let worst = ((WORST * seeds as f64).ceil() as usize).max(1);
        // Beyond the ranges there is nothing.
        let outside = place.iter().map(|place| (place.abs() - 1.0).max(0.0));
        Ok(0.5 * mean(&costs) + 0.5 * mean(&costs[..worst]) + 10.0 * outside.sum::<f64>())
    }
}

#[cfg(test)]
mod tests;
