//! Whether logs can be of one robot: what each leaves unexplained under the common fit, against a fit of its own.
//!
//! A fit of its own is always better. It is much better, beyond what the number of independent errors explains, if
//! another robot drove, or one that was wired otherwise. Days differ in battery and floor, and have values for them.

use crate::descent::descend;
use crate::error::IdentifyError;
use crate::log::DriveLog;
use crate::problem::Problem;
use crate::unknowns::UNKNOWNS;
use nalgebra::DVector;
use rumbo_plant::params::Params;

/// Two runs of one robot differ less: root mean square under the common fit over that under a fit of its own. The
/// recorded runs reach 1.09 (docs/theory/plant.md).
const MOST: f64 = 1.6;
/// The same of logs of our program, whose speeds tell more: two days of one simulated robot reach 2.12, two robots are
/// 4.0 to 8.4 apart.
const MOST_TIMED: f64 = 3.0;

/// A source alone.
struct Alone {
    logs: Vec<DriveLog>,
    /// Root mean square of its errors under the common fit over that under its own.
    ratio: f64,
    plant: Params,
}

/// The largest ratio among the sources. Refuses logs that no common plant explains, naming the one that fits worst and
/// the one that contradicts it most.
pub(crate) fn refuse(
    logs: &[DriveLog],
    start: &Params,
    joint: &Problem<'_>,
    z: &DVector<f64>,
) -> Result<f64, IdentifyError> {
    let sources: Vec<&[DriveLog]> = logs.chunk_by(|a, b| a.source == b.source).collect();
    if sources.len() < 2 {
        return Ok(1.0);
    }
    let common = joint.plant(z);
    let mut first = 0;
    let mut alone = Vec::new();
    for source in sources {
        let problem = Problem::new(&UNKNOWNS, source, start).until(joint.stop());
        let nuisance = joint.nuisance(first, z);
        first += source.len();
        let from = problem.point(&common, &vec![nuisance; source.len()]);
        let before = unexplained(&problem, &from);
        let (problem, own) = descend(problem, &from)?;
        alone.push(Alone {
            logs: source.to_vec(),
            ratio: (before / unexplained(&problem, &own).max(1e-12)).sqrt(),
            plant: problem.plant(&own),
        });
    }
    let Some(worst) = alone.iter().max_by(|a, b| a.ratio.total_cmp(&b.ratio)) else {
        return Ok(1.0);
    };
    let most = if joint.is_the_reports {
        MOST
    } else {
        MOST_TIMED
    };
    if worst.ratio <= most {
        return Ok(worst.ratio);
    }
    let against = |other: &&Alone| {
        let problem = Problem::new(&[], &other.logs, &worst.plant);
        unexplained(&problem, &DVector::zeros(problem.dimension()))
            / unexplained(
                &Problem::new(&[], &other.logs, &other.plant),
                &DVector::zeros(problem.dimension()),
            )
    };
    let others = alone
        .iter()
        .filter(|other| other.logs[0].source != worst.logs[0].source);
    let other = others.max_by(|a, b| against(a).total_cmp(&against(b)));
    let name = |alone: &Alone| alone.logs[0].source.display().to_string();
    Err(IdentifyError::Contradiction {
        one: name(worst),
        other: other.map(name).unwrap_or_default(),
        ratio: worst.ratio,
    })
}

/// Mean square of what is measured, without what is believed.
fn unexplained(problem: &Problem<'_>, z: &DVector<f64>) -> f64 {
    let residuals = problem.residuals_at(z);
    let measured = residuals.iter().zip(problem.blocks(z));
    let squares: Vec<f64> = measured
        .filter_map(|(residual, block)| block.map(|_| residual * residual))
        .collect();
    squares.iter().sum::<f64>() / squares.len().max(1) as f64
}
