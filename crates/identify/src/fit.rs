//! The fit: Levenberg-Marquardt from the robot's present values and from what is believed beforehand; a search (CMA-ES)
//! around the better of the two; then uncertainties from its Jacobian.
//!
//! Whether a wheel breaks away or sticks is a step of the objective, which ends a descent by slopes early. A population
//! looks past such steps. It searches in standard deviations of the curvature, along the valley in which all torques scale
//! together, and begins again from what it has found, as the curvature differs there (docs/theory/plant.md).
//!
//! The search is seeded and its objective has no randomness: the same logs and robot give the same parameters.

use crate::contradiction;
use crate::descent::descend;
use crate::error::IdentifyError;
use crate::log::{DriveLog, Seen};
use crate::problem::{NUISANCES, Problem, dead_zone_pwm};
use crate::progress::FitProgress;
use crate::replay::Nuisance;
use crate::row::LogRow;
use crate::score::{RunScore, score};
use crate::unknowns::UNKNOWNS;
use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::{DMatrix, DVector};
use rumbo_plant::params::Params;
use serde::Serialize;
use std::collections::BTreeMap;

/// Generations of each round of the search that suffice for runs of half a minute.
pub const GENERATIONS: usize = 60;
/// Rounds of the search.
const SEARCHES: usize = 3;
const POPULATION: usize = 24;
/// Half of the 95 % interval of a normal distribution, in standard deviations.
pub(crate) const SDS_95: f64 = 1.96;
/// First spread of a round, in standard deviations of the curvature.
const SPREAD: f64 = 1.0;

/// One identified parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    pub from_runs: f64,
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
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
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
    /// Half the sum of squares of all errors and beliefs, each in standard deviations: what the fit makes least.
    pub cost: f64,
    /// The largest misfit of a run's file under the common fit, beside a fit of its own: 1 if they agree, or it is the only one.
    pub disagreement: f64,
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

/// Fits the plant to all runs together, from the values in `start` and, unless `generations` is 0, also from what is believed
/// beforehand, with a search around the better of the two, each round so many generations ([`GENERATIONS`] suffice).
///
/// # Errors
/// No run with speeds or a distance ahead; a fit that breaks down, or is interrupted.
pub fn identify(
    logs: &[DriveLog],
    start: &Params,
    generations: usize,
    progress: &FitProgress<'_>,
) -> Result<Identification, IdentifyError> {
    let logs = useful(logs)?;
    let problem = Problem::new(&UNKNOWNS, &logs, start).until(Some(progress.stop));
    (progress.report)(0.0);
    let fit = |params: &Params| -> Result<DVector<f64>, IdentifyError> {
        let runs = check(&logs, params)?;
        let nuisances: Vec<Nuisance> = runs.iter().map(|run| run.nuisance).collect();
        Ok(descend(problem.clone(), &problem.point(params, &nuisances))?.1)
    };
    let mut z = fit(start)?;
    if generations > 0 {
        let other = fit(&problem.plant(&DVector::zeros(problem.dimension())))?;
        if problem.cost(&other) < problem.cost(&z) {
            z = other;
        }
        for round in 0..SEARCHES {
            let share =
                |done: f64| (progress.report)(0.9 * (round as f64 + done) / SEARCHES as f64);
            let found = search(&problem, &z, generations, &share)?;
            if problem.cost(&found) >= problem.cost(&z) {
                break;
            }
            z = found;
        }
    }
    (progress.report)(0.9);
    let disagreement = contradiction::refuse(&logs, start, &problem, &z)?;
    let sds = standard_deviations(&problem, &z)?;

    let params = problem.plant(&z);
    let parameters = UNKNOWNS.iter().enumerate().map(|(i, unknown)| {
        let value = problem.value(i, z[i]);
        Identified {
            keys: unknown.keys.iter().map(|&key| key.to_owned()).collect(),
            value,
            uncertainty: problem.slope(i, z[i]) * sds[i],
            unit: problem.unit(i).to_owned(),
            from_runs: 1.0 - sds[i] * sds[i],
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
        cost: problem.cost(&z),
        disagreement,
        params,
    })
}

/// Repeats each run on the plant `params`, fitting only its battery voltage, floor friction and scrubbing.
///
/// # Errors
/// As [`identify`].
pub fn check(logs: &[DriveLog], params: &Params) -> Result<Vec<RunScore>, IdentifyError> {
    let logs = useful(logs)?;
    let sources = logs.chunk_by(|a, b| a.source == b.source);
    let runs: Result<Vec<_>, _> = sources.map(|source| check_source(source, params)).collect();
    Ok(runs?.concat())
}

/// Fits the plant to all runs but one, from `start`, and repeats that one on it: for each run in turn. What a plant
/// predicts of a run that it has not seen.
///
/// # Errors
/// As [`identify`], or a single run.
pub fn leave_one_out(
    logs: &[DriveLog],
    start: &Params,
    progress: &FitProgress<'_>,
) -> Result<Vec<RunScore>, IdentifyError> {
    let logs = useful(logs)?;
    let mut scores = Vec::new();
    for (done, left_out) in logs.chunk_by(|a, b| a.source == b.source).enumerate() {
        (progress.report)(done as f64 / logs.len() as f64);
        let source = &left_out[0].source;
        let others = logs.iter().filter(|log| log.source != *source);
        let others: Vec<DriveLog> = others.cloned().collect();
        if others.is_empty() {
            return Err(IdentifyError::NothingLeft);
        }
        let quietly = FitProgress {
            report: &|_| {},
            ..*progress
        };
        let found = identify(&others, start, 0, &quietly)?;
        scores.extend(check_source(left_out, &found.params)?);
    }
    Ok(scores)
}

/// Repeats the runs of one source, which share battery and floor.
fn check_source(logs: &[DriveLog], params: &Params) -> Result<Vec<RunScore>, IdentifyError> {
    let problem = Problem::new(&[], logs, params);
    // A coarse grid first: a battery too low, or a floor too hard to turn on, is a robot that never moves, and no slope leads
    // away from that.
    let mut rows = logs.iter().flat_map(|log| &log.rows);
    let scrubs: &[f64] = match rows.any(LogRow::is_turning) {
        true => &[-1.0, 0.0, 1.0],
        false => &[0.0],
    };
    let mut best = (f64::INFINITY, DVector::zeros(NUISANCES));
    for volts in [-2.0, -1.0, 0.0, 1.0, 2.0] {
        for floor in [-2.0, 0.0, 2.0] {
            for scrub in scrubs {
                let point = DVector::from_row_slice(&[volts, floor, *scrub]);
                let cost = problem.cost(&point);
                if cost < best.0 {
                    best = (cost, point);
                }
            }
        }
    }
    let (problem, z) = descend(problem, &best.1)?;
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
    match useful.is_empty() {
        true => Err(IdentifyError::NothingToFit),
        false => Ok(useful),
    }
}

/// The best point that a population finds around this one.
fn search(
    problem: &Problem<'_>,
    around: &DVector<f64>,
    generations: usize,
    progress: &dyn Fn(f64),
) -> Result<DVector<f64>, IdentifyError> {
    let nothing = || IdentifyError::Optimiser("the search found no finite error".into());
    let jacobian = jacobian(problem, around)?;
    let covariance = (jacobian.transpose() * jacobian).try_inverse();
    let axes = covariance
        .and_then(DMatrix::cholesky)
        .ok_or_else(undetermined)?
        .l();
    let mut search = cmaes::CMAESOptions::new(DVector::zeros(problem.dimension()), SPREAD)
        .seed(1)
        .population_size(POPULATION)
        .build(|along: &DVector<f64>| problem.cost(&(around + &axes * along)))
        .map_err(|error| IdentifyError::Optimiser(format!("{error:?}")))?;
    for generation in 0..generations {
        if problem.is_stopped() {
            return Err(IdentifyError::Interrupted);
        }
        progress(generation as f64 / generations as f64);
        // It has converged, or cannot go on.
        if search.next_parallel().is_some() {
            break;
        }
    }
    let best = search.overall_best_individual().ok_or_else(nothing)?;
    Ok(around + &axes * &best.point)
}

/// Standard deviations of the normalised unknowns.
///
/// For the report's runs the inverse of the curvature H, scaled by the residuals' size. For logs of our program, in which
/// residuals near each other have common causes such as the floor at a place, that would be too small: there it is the
/// sandwich H^-1 (B + sum g g') H^-1, with B the curvature of what is believed beforehand and g the gradient of one block
/// of residuals, among which anything may be correlated, at the fit without it.
fn standard_deviations(problem: &Problem<'_>, z: &DVector<f64>) -> Result<Vec<f64>, IdentifyError> {
    let jacobian = jacobian(problem, z)?;
    let residuals = problem.residuals_at(z);
    let curvature = jacobian.transpose() * &jacobian;
    let inverse = curvature.clone().try_inverse().ok_or_else(undetermined)?;
    let middle = match problem.is_the_reports {
        true => {
            let freedom = residuals.len().saturating_sub(z.len()).max(1) as f64;
            &curvature * (residuals.norm_squared() / freedom).max(1.0)
        }
        false => correlated(problem, z, &jacobian, &residuals, &inverse),
    };
    let covariance = &inverse * middle * &inverse;
    // What is believed beforehand bounds the uncertainty, whatever the residuals' size.
    let sd =
        |(index, variance): (usize, &f64)| (problem.model_error(index) * variance.sqrt()).min(1.0);
    Ok(covariance.diagonal().iter().enumerate().map(sd).collect())
}

fn jacobian(problem: &Problem<'_>, z: &DVector<f64>) -> Result<DMatrix<f64>, IdentifyError> {
    let mut at = problem.clone();
    at.set_params(z);
    let none = || match problem.is_stopped() {
        true => IdentifyError::Interrupted,
        false => IdentifyError::Optimiser("no Jacobian".into()),
    };
    at.jacobian().ok_or_else(none)
}

fn undetermined() -> IdentifyError {
    IdentifyError::Optimiser("the runs leave a parameter undetermined".into())
}

/// B + sum g g' of the sandwich, given H^-1.
///
/// A fit takes part of each block's residuals away, the more the fewer blocks tell a parameter. So a block's gradient is
/// what it would be at the fit without it, (1 - C H^-1)^-1 g with C the block's curvature: the jackknife.
fn correlated(
    problem: &Problem<'_>,
    z: &DVector<f64>,
    jacobian: &DMatrix<f64>,
    residuals: &DVector<f64>,
    inverse: &DMatrix<f64>,
) -> DMatrix<f64> {
    let unknowns = z.len();
    let square = || DMatrix::zeros(unknowns, unknowns);
    let of_block = || (square(), DVector::<f64>::zeros(unknowns));
    let (mut blocks, mut middle) = (BTreeMap::new(), square());
    for (i, block) in problem.blocks(z).iter().enumerate() {
        let slopes = jacobian.row(i).transpose();
        let curvature = &slopes * slopes.transpose();
        match block {
            Some(block) => {
                let (of_all, gradient) = blocks.entry(*block).or_insert_with(of_block);
                *of_all += curvature;
                *gradient += slopes * residuals[i];
            }
            None => middle += curvature,
        }
    }
    for (curvature, gradient) in blocks.into_values() {
        let left = DMatrix::identity(unknowns, unknowns) - curvature * inverse;
        // What only this block tells has no fit without it; what is believed beforehand bounds that.
        let without = left.lu().solve(&gradient).unwrap_or(gradient);
        middle += &without * without.transpose();
    }
    middle
}
