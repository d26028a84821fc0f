//! Levenberg-Marquardt on a [`Problem`].

use crate::error::IdentifyError;
use crate::problem::Problem;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::DVector;

/// Longest first step of a descent, in standard deviations of what is believed beforehand.
const FIRST_STEP: f64 = 3.0;

/// Goes down from a point; gives the problem there, and where that is.
pub(crate) fn descend<'a>(
    mut problem: Problem<'a>,
    from: &DVector<f64>,
) -> Result<(Problem<'a>, DVector<f64>), IdentifyError> {
    problem.set_params(from);
    let tolerance = problem.tolerance();
    let optimiser = LevenbergMarquardt::new()
        .with_patience(problem.patience())
        .with_ftol(tolerance)
        .with_xtol(10.0 * tolerance)
        .with_stepbound(FIRST_STEP)
        // All unknowns have one scale. Scaled by their slopes, one that met a step would hardly move again.
        .with_scale_diag(false);
    let (problem, report) = optimiser.minimize(problem);
    let z = LeastSquaresProblem::params(&problem);
    match report.termination {
        TerminationReason::Converged { .. }
        | TerminationReason::ResidualsZero
        | TerminationReason::Orthogonal
        | TerminationReason::NoImprovementPossible(_)
        | TerminationReason::LostPatience => Ok((problem, z)),
        _ if problem.is_stopped() => Err(IdentifyError::Interrupted),
        other => Err(IdentifyError::Optimiser(format!("{other:?}"))),
    }
}
