//! The fit: Levenberg-Marquardt from the robot's present values and from the best point of a global search (CMA-ES), the better of
//! the two; then uncertainties from its Jacobian.
//!
//! The search is seeded and its objective has no randomness: the same logs and robot give the same parameters.

use crate::contradiction;
use crate::error::IdentifyError;
use crate::log::{DriveLog, Seen};
use crate::problem::{Problem, UNKNOWNS, dead_zone_pwm};
use crate::replay::Nuisance;
use crate::score::{RunScore, score};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector};
use rumbo_plant::params::Params;
use serde::Serialize;

/// Generations of the global search that suffice for runs of half a minute.
pub const GENERATIONS: usize = 100;
const POPULATION: usize = 24;
/// Half of the 95 % interval of a normal distribution, in standard deviations.
pub(crate) const SDS_95: f64 = 1.96;
/// Most by which the uncertainty's square grows for the residuals that the fit has taken away.
const MOST_TAKEN: f64 = 2.0;
/// First spread of the search, in standard deviations of what is believed beforehand.
const SPREAD: f64 = 0.7;

/// One identified parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// Dotted keys below `[plant]` that have this value.
    pub keys: Vec<String>,
    /// The value.
    pub value: f64,
    /// One standard deviation of the value, from the curvature of the fit and the size of its residuals.
    pub uncertainty: f64,
    /// Unit.
    pub unit: String,
    /// Share of the knowledge that came from the runs, 0 to 1; the rest is what was believed beforehand.
    pub told_by_runs: f64,
    /// The experiment that shows it.
    pub shown_by: &'static str,
}

/// A parameter of a simulated robot, identified and true.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AgainstTruth {
    /// Its first key.
    pub key: String,
    /// What was found.
    pub value: f64,
    /// Half of the 95 % interval.
    pub within: f64,
    /// Its true value.
    pub truth: f64,
}

/// The outcome of an identification.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identification {
    /// All parameters of the plant, the identified ones among them.
    #[serde(skip)]
    pub params: Params,
    /// The identified ones.
    pub parameters: Vec<Identified>,
    /// PWM at which the wheels start to turn in the air, mean of wheels and directions, nominal battery.
    pub dead_zone_air_pwm: f64,
    /// The same on the floor.
    pub dead_zone_floor_pwm: f64,
    /// How well each run is repeated.
    pub runs: Vec<RunScore>,
    /// How sure the identified parameters are, together.
    #[serde(skip)]
    pub posterior: Posterior,
}

/// What the runs leave possible: a normal distribution of the normalised unknowns about the fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    pub(crate) params: Params,
    pub(crate) z: DVector<f64>,
    /// Cholesky factor of the covariance.
    pub(crate) factor: DMatrix<f64>,
}

impl Identification {
    /// The identified parameters beside those of the robot that drove. A floor's resistance is what its scale makes of
    /// it.
    #[must_use]
    pub fn against(&self, truth: &Params) -> Vec<AgainstTruth> {
        let scale = truth.floor.friction_scale / self.params.floor.friction_scale;
        let of = |parameter: &Identified| {
            let key = parameter.keys.first()?;
            let is_dry = matches!(key.as_str(), "floor.rolling_n_m" | "floor.scrub_n_m");
            Some(AgainstTruth {
                key: key.clone(),
                value: parameter.value,
                within: SDS_95 * parameter.uncertainty,
                truth: truth.get(key)? * if is_dry { scale } else { 1.0 },
            })
        };
        self.parameters.iter().filter_map(of).collect()
    }
}

impl Posterior {
    /// A plant that the runs leave possible, for independent standard normal numbers; with all of them 0 the fit itself.
    pub fn plant(&self, mut normal: impl FnMut() -> f64) -> Params {
        let normals = DVector::from_fn(self.z.len(), |_, _| normal());
        Problem::new(&UNKNOWNS, &[], &self.params).plant(&(&self.z + &self.factor * normals))
    }
}

/// The outcome of a check: nothing fitted but two nuisance values per run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// How well each run is repeated.
    pub runs: Vec<RunScore>,
}

/// Fits the plant to all runs together, from the values in `start` and, unless `generations` is 0, from the best point of a global
/// search of so many generations ([`GENERATIONS`] suffice); the better fit wins. `progress` is given the share of the
/// search that is done.
///
/// # Errors
/// No run with speeds or a distance ahead; a fit that breaks down.
pub fn identify(
    logs: &[DriveLog],
    start: &Params,
    generations: usize,
    progress: &dyn Fn(f64),
) -> Result<Identification, IdentifyError> {
    let logs = useful(logs)?;
    let problem = Problem::new(&UNKNOWNS, &logs, start);
    progress(0.0);
    let nuisances: Vec<Nuisance> = check(&logs, start)?
        .runs
        .iter()
        .map(|run| run.nuisance)
        .collect();
    let mut best = descend(problem.clone(), &problem.point(start, &nuisances))?;
    if generations > 0 {
        let found = descend(problem.clone(), &search(&problem, generations, progress)?)?;
        if problem.cost(&found.1) < problem.cost(&best.1) {
            best = found;
        }
    }
    let (problem, z) = best;
    progress(0.9);
    contradiction::refuse(&logs, start, &problem, &z)?;
    let factor = covariance_factor(&problem, &z)?;
    let sd = |i: usize| factor.row(i).norm();

    let params = problem.plant(&z);
    let parameters = UNKNOWNS.iter().enumerate().map(|(i, unknown)| {
        let value = problem.value(i, z[i]);
        Identified {
            keys: unknown.keys.iter().map(|&key| key.to_owned()).collect(),
            value,
            uncertainty: problem.slope(i, z[i]) * sd(i),
            unit: problem.unit(i).to_owned(),
            told_by_runs: (1.0 - sd(i) * sd(i)).max(0.0),
            shown_by: unknown.shown_by,
        }
    });
    Ok(Identification {
        parameters: parameters.collect(),
        dead_zone_air_pwm: dead_zone_pwm(&params, false),
        dead_zone_floor_pwm: dead_zone_pwm(&params, true),
        runs: logs
            .iter()
            .enumerate()
            .map(|(i, log)| score(log, &params, problem.nuisance(i, &z)))
            .collect(),
        posterior: Posterior {
            params,
            z: z.rows(0, UNKNOWNS.len()).into_owned(),
            factor: factor
                .rows(0, UNKNOWNS.len())
                .columns(0, UNKNOWNS.len())
                .into_owned(),
        },
        params,
    })
}

/// Repeats each run on the plant `params`, fitting only its battery voltage and floor friction.
///
/// # Errors
/// As [`identify`].
pub fn check(logs: &[DriveLog], params: &Params) -> Result<Check, IdentifyError> {
    let logs = useful(logs)?;
    let mut runs = Vec::new();
    for source in logs.chunk_by(|a, b| a.source == b.source) {
        runs.extend(check_source(source, params)?);
    }
    Ok(Check { runs })
}

/// Fits the plant to all runs but one, from `start`, and repeats that one on it: for each run in turn. What a plant
/// predicts of a run that it has not seen.
///
/// # Errors
/// As [`identify`].
pub fn leave_one_out(
    logs: &[DriveLog],
    start: &Params,
    progress: &dyn Fn(f64),
) -> Result<Vec<RunScore>, IdentifyError> {
    let logs = useful(logs)?;
    let mut scores = Vec::new();
    for (done, left_out) in logs.chunk_by(|a, b| a.source == b.source).enumerate() {
        progress(done as f64 / logs.len() as f64);
        let source = &left_out[0].source;
        let others = logs.iter().filter(|log| log.source != *source);
        let found = identify(&others.cloned().collect::<Vec<_>>(), start, 0, &|_| {})?;
        scores.extend(check_source(left_out, &found.params)?);
    }
    Ok(scores)
}

/// Repeats the runs of one source, which share battery and floor.
fn check_source(logs: &[DriveLog], params: &Params) -> Result<Vec<RunScore>, IdentifyError> {
    let problem = Problem::new(&[], logs, params);
    // A coarse grid first: a battery too low is a robot that never moves, and no slope leads away from that.
    let grid = [-2.0, -1.0, 0.0, 1.0, 2.0]
        .map(|volts| [-2.0, 0.0, 2.0].map(|floor| [volts, floor]))
        .concat();
    let points = grid.iter().map(|point| DVector::from_row_slice(point));
    let best = points.min_by(|a, b| problem.cost(a).total_cmp(&problem.cost(b)));
    let (problem, z) = descend(problem, &best.unwrap_or_else(|| DVector::zeros(2)))?;
    let scores = logs.iter().enumerate();
    Ok(scores
        .map(|(i, log)| score(log, params, problem.nuisance(i, &z)))
        .collect())
}

fn useful(logs: &[DriveLog]) -> Result<Vec<DriveLog>, IdentifyError> {
    let shows_drive = |log: &&DriveLog| match log.seen {
        Seen::Speeds | Seen::FrontRange => true,
        Seen::SidePair => log.pair.is_some_and(|pair| pair.beside_wall().is_some()),
    };
    let useful: Vec<DriveLog> = logs.iter().filter(shows_drive).cloned().collect();
    if useful.is_empty() {
        Err(IdentifyError::NothingToFit)
    } else {
        Ok(useful)
    }
}

fn search(
    problem: &Problem<'_>,
    generations: usize,
    progress: &dyn Fn(f64),
) -> Result<DVector<f64>, IdentifyError> {
    let nothing = || IdentifyError::Optimiser("the search found no finite error".into());
    let mut search = cmaes::CMAESOptions::new(DVector::zeros(problem.dimension()), SPREAD)
        .seed(1)
        .population_size(POPULATION)
        .build(|z: &DVector<f64>| problem.cost(z))
        .map_err(|error| IdentifyError::Optimiser(format!("{error:?}")))?;
    for generation in 0..generations {
        progress(generation as f64 / generations as f64);
        // It has converged, or cannot go on.
        if search.next_parallel().is_some() {
            break;
        }
    }
    let best = search.overall_best_individual().ok_or_else(nothing)?;
    Ok(best.point.clone())
}

pub(crate) fn descend<'a>(
    mut problem: Problem<'a>,
    from: &DVector<f64>,
) -> Result<(Problem<'a>, DVector<f64>), IdentifyError> {
    problem.set_params(from);
    let tolerance = problem.tolerance();
    let optimiser = LevenbergMarquardt::new()
        .with_patience(problem.patience())
        .with_ftol(tolerance)
        .with_xtol(10.0 * tolerance);
    let (problem, report) = optimiser.minimize(problem);
    let z = LeastSquaresProblem::params(&problem);
    match report.termination {
        TerminationReason::Converged { .. }
        | TerminationReason::ResidualsZero
        | TerminationReason::Orthogonal
        | TerminationReason::NoImprovementPossible(_)
        | TerminationReason::LostPatience => Ok((problem, z)),
        other => Err(IdentifyError::Optimiser(format!("{other:?}"))),
    }
}

/// Cholesky factor of the normalised unknowns' covariance.
///
/// Residuals near each other have common causes, such as the floor at a place, so the inverse of the curvature H alone
/// would be too small. This is the sandwich H^-1 (B + sum g g') H^-1: B the curvature of what is believed beforehand, g
/// the gradient of one block of residuals, among which anything may be correlated.
fn covariance_factor(
    problem: &Problem<'_>,
    z: &DVector<f64>,
) -> Result<DMatrix<f64>, IdentifyError> {
    let jacobian = problem
        .jacobian()
        .ok_or_else(|| IdentifyError::Optimiser("no Jacobian".into()))?;
    let residuals = problem.residuals_at(z);
    let blocks = problem.blocks(z);
    let count = blocks.iter().flatten().max().map_or(0, |last| last + 1);
    let (mut gradients, mut middle) = (
        DMatrix::zeros(count, z.len()),
        DMatrix::zeros(z.len(), z.len()),
    );
    for (i, block) in blocks.iter().enumerate() {
        let row = jacobian.row(i);
        match block {
            Some(block) => {
                let mut gradient = gradients.row_mut(*block);
                gradient += row * residuals[i];
            }
            None => middle += row.transpose() * row,
        }
    }
    // The fit has taken part of each block's residuals away.
    let blocks = count as f64;
    let freedom = (blocks / (blocks - z.len() as f64).max(1.0)).min(MOST_TAKEN);
    middle += gradients.transpose() * &gradients * freedom;
    let undetermined =
        || IdentifyError::Optimiser("the runs leave a parameter undetermined".into());
    let inverse = (jacobian.transpose() * &jacobian).try_inverse();
    let inverse = inverse.ok_or_else(undetermined)?;
    let covariance = &inverse * middle * &inverse * problem.model_error().powi(2);
    let factor = (0.5 * (&covariance + covariance.transpose())).cholesky();
    let mut factor = factor.ok_or_else(undetermined)?.unpack();
    // What is believed beforehand bounds the uncertainty, whatever the residuals' size.
    for mut row in factor.row_iter_mut() {
        let sd = row.norm();
        if sd > 1.0 {
            row /= sd;
        }
    }
    Ok(factor)
}
