//! The fit: Levenberg-Marquardt from the robot's present values and from the best point of a global search (CMA-ES), the better of
//! the two; then uncertainties from its Jacobian.
//!
//! The search is seeded and its objective has no randomness: the same logs and robot give the same parameters.

use crate::error::IdentifyError;
use crate::log::{DriveLog, Seen};
use crate::problem::{Problem, UNKNOWNS, dead_zone_pwm};
use crate::score::{RunScore, score};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::DVector;
use rumbo_plant::params::Params;
use serde::Serialize;

/// Generations of the global search that suffice for runs of half a minute.
pub const GENERATIONS: usize = 200;
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
}

/// The outcome of a check: nothing fitted but two nuisance values per run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// How well each run is repeated.
    pub runs: Vec<RunScore>,
}

/// Fits the plant to all runs together, from the values in `start` and, unless `generations` is 0, from the best point of a global
/// search of so many generations ([`GENERATIONS`] suffice); the better fit wins.
///
/// # Errors
/// No run with speeds or a distance ahead; a fit that breaks down.
pub fn identify(
    logs: &[DriveLog],
    start: &Params,
    generations: usize,
) -> Result<Identification, IdentifyError> {
    let logs = useful(logs)?;
    let problem = Problem::new(&UNKNOWNS, &logs, start);
    let nuisances = logs.iter().map(|log| Ok(check_one(log, start)?.nuisance));
    let nuisances: Vec<_> = nuisances.collect::<Result<_, IdentifyError>>()?;
    let mut best = descend(problem.clone(), &problem.point(start, &nuisances))?;
    if generations > 0 {
        let found = descend(problem.clone(), &search(&problem, generations)?)?;
        if problem.cost(&found.1) < problem.cost(&best.1) {
            best = found;
        }
    }
    let (problem, z) = best;
    let sd = standard_deviations(&problem, &z)?;

    let params = problem.plant(&z);
    let parameters = UNKNOWNS.iter().enumerate().map(|(i, unknown)| {
        let value = problem.value(i, z[i]);
        Identified {
            keys: unknown.keys.iter().map(|&key| key.to_owned()).collect(),
            value,
            uncertainty: problem.slope(i, z[i]) * sd[i],
            unit: problem.unit(i).to_owned(),
            told_by_runs: (1.0 - sd[i] * sd[i]).max(0.0),
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
    let useful: Vec<DriveLog> = logs
        .iter()
        .filter(|log| log.seen != Seen::Nothing)
        .cloned()
        .collect();
    if useful.is_empty() {
        Err(IdentifyError::NothingToFit)
    } else {
        Ok(useful)
    }
}

fn search(problem: &Problem<'_>, generations: usize) -> Result<DVector<f64>, IdentifyError> {
    let mut search = cmaes::CMAESOptions::new(DVector::zeros(problem.dimension()), SPREAD)
        .seed(1)
        .population_size(POPULATION)
        .max_generations(generations)
        .build(|z: &DVector<f64>| problem.cost(z))
        .map_err(|error| IdentifyError::Optimiser(format!("{error:?}")))?;
    let best = search.run_parallel().overall_best;
    best.map(|best| best.point)
        .ok_or_else(|| IdentifyError::Optimiser("the search found no finite error".into()))
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

/// Standard deviations of the normalised unknowns: the inverse of the curvature, scaled by the residuals' size.
fn standard_deviations(
    problem: &Problem<'_>,
    z: &DVector<f64>,
) -> Result<DVector<f64>, IdentifyError> {
    let jacobian = problem
        .jacobian()
        .ok_or_else(|| IdentifyError::Optimiser("no Jacobian".into()))?;
    let residuals = problem.residuals_at(z);
    let freedom = residuals.len().saturating_sub(z.len()).max(1) as f64;
    let size = (residuals.norm_squared() / freedom).max(1.0);
    let inverse = (jacobian.transpose() * &jacobian).try_inverse();
    let covariance = inverse.ok_or_else(|| {
        IdentifyError::Optimiser("the runs leave a parameter undetermined".into())
    })?;
    // What is believed beforehand bounds the uncertainty, whatever the residuals' size.
    Ok(covariance
        .diagonal()
        .map(|variance| (variance * size).max(0.0).sqrt().min(1.0)))
}
