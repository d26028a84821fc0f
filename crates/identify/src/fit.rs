//! The fit: Levenberg-Marquardt from the robot's present values and from the best point of a global search (CMA-ES), the better of
//! the two; then uncertainties from its Jacobian.
//!
//! The search is seeded and its objective has no randomness: the same logs and robot give the same parameters.

use crate::error::IdentifyError;
use crate::log::{DriveLog, Seen};
use crate::problem::{Problem, UNKNOWNS, dead_zone_pwm};
use crate::score::{RunScore, score};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector};
use rumbo_plant::params::Params;
use serde::Serialize;

/// Generations of the global search that suffice for runs of half a minute.
pub const GENERATIONS: usize = 100;
const POPULATION: usize = 24;
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
    let nuisances = logs.iter().map(|log| Ok(check_one(log, start)?.nuisance));
    let nuisances: Vec<_> = nuisances.collect::<Result<_, IdentifyError>>()?;
    let mut best = descend(problem.clone(), &problem.point(start, &nuisances))?;
    if generations > 0 {
        let found = descend(problem.clone(), &search(&problem, generations, progress)?)?;
        if problem.cost(&found.1) < problem.cost(&best.1) {
            best = found;
        }
    }
    let (problem, z) = best;
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
    Ok(Check {
        runs: useful(logs)?
            .iter()
            .map(|log| check_one(log, params))
            .collect::<Result<_, _>>()?,
    })
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
    let without = |left_out: usize| {
        progress(left_out as f64 / logs.len() as f64);
        let mut others = logs.clone();
        let log = others.remove(left_out);
        let found = identify(&others, start, 0, &|_| {})?;
        check_one(&log, &found.params)
    };
    (0..logs.len()).map(without).collect()
}

fn check_one(log: &DriveLog, params: &Params) -> Result<RunScore, IdentifyError> {
    let run = std::slice::from_ref(log);
    let problem = Problem::new(&[], run, params);
    // A coarse grid first: a battery too low is a robot that never moves, and no slope leads away from that.
    let grid = [-2.0, -1.0, 0.0, 1.0, 2.0]
        .map(|volts| [-2.0, 0.0, 2.0].map(|floor| [volts, floor]))
        .concat();
    let points = grid.iter().map(|point| DVector::from_row_slice(point));
    let best = points.min_by(|a, b| problem.cost(a).total_cmp(&problem.cost(b)));
    let (problem, z) = descend(problem, &best.unwrap_or_else(|| DVector::zeros(2)))?;
    Ok(score(log, params, problem.nuisance(0, &z)))
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

fn descend<'a>(
    mut problem: Problem<'a>,
    from: &DVector<f64>,
) -> Result<(Problem<'a>, DVector<f64>), IdentifyError> {
    problem.set_params(from);
    let optimiser = LevenbergMarquardt::new()
        .with_patience(2)
        .with_ftol(1e-4)
        .with_xtol(1e-3);
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

/// Cholesky factor of the normalised unknowns' covariance: the inverse of the curvature, scaled by the residuals' size.
fn covariance_factor(
    problem: &Problem<'_>,
    z: &DVector<f64>,
) -> Result<DMatrix<f64>, IdentifyError> {
    let jacobian = problem
        .jacobian()
        .ok_or_else(|| IdentifyError::Optimiser("no Jacobian".into()))?;
    let residuals = problem.residuals_at(z);
    let freedom = residuals.len().saturating_sub(z.len()).max(1) as f64;
    let size = (residuals.norm_squared() / freedom).max(1.0);
    let inverse = (jacobian.transpose() * &jacobian).try_inverse();
    let factor = inverse.and_then(|inverse| (inverse * size).cholesky());
    let mut factor = factor
        .ok_or_else(|| IdentifyError::Optimiser("the runs leave a parameter undetermined".into()))?
        .unpack();
    // What is believed beforehand bounds the uncertainty, whatever the residuals' size.
    for mut row in factor.row_iter_mut() {
        let sd = row.norm();
        if sd > 1.0 {
            row /= sd;
        }
    }
    Ok(factor)
}
