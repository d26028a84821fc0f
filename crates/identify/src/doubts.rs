//! Why a fit is not to be believed.

use crate::fit::Identification;
use crate::score::{RunScore, WheelError};

/// Share of the wheels' motion that a fit explains at least: those of the recorded runs explain 0.95 to 0.996.
const EXPLAINED: f64 = 0.5;
/// A parameter that the runs tell less about is what was believed beforehand.
const TOLD: f64 = 0.02;
/// An error this many times as large is larger.
const WORSE: f64 = 1.02;

impl Identification {
    /// Why these parameters are not to be believed, a line each; `before` is how the robot's own repeat the runs.
    #[must_use]
    pub fn doubts(&self, before: &[RunScore]) -> Vec<String> {
        let mut doubts = Vec::new();
        if let Some(explained) = explained(&self.runs).filter(|share| *share < EXPLAINED) {
            let percent = (100.0 * explained.max(0.0)).round();
            doubts.push(format!(
                "it explains {percent} % of how the wheels turned, and {} % is the least to believe; were motors, gears, wheels or supply others than the robot file's?",
                100.0 * EXPLAINED
            ));
        }
        for (what, error) in [
            ("speeds", rmse_rpm as fn(&[RunScore]) -> Option<f64>),
            ("distances", rmse_m),
        ] {
            if let (Some(before), Some(now)) = (error(before), error(&self.runs))
                && now > WORSE * before
            {
                doubts.push(format!(
                    "its errors of the {what} are {:.2} times those of the robot file's own parameters",
                    now / before
                ));
            }
        }
        let told = |parameter: &crate::fit::Identified| parameter.from_runs >= TOLD;
        if !self.parameters.iter().any(told) {
            doubts.push(
                "the runs tell nothing about any parameter: all are what was believed beforehand"
                    .into(),
            );
        }
        doubts
    }
}

fn wheels(runs: &[RunScore]) -> impl Iterator<Item = &WheelError> {
    runs.iter().flat_map(|run| run.whole.iter().flatten())
}

/// Share of the variance of all wheels' speeds that whole runs explain.
fn explained(runs: &[RunScore]) -> Option<f64> {
    let (mut squares, mut variance) = (0.0, 0.0);
    for wheel in wheels(runs).filter(|wheel| wheel.r2 < 1.0) {
        let square = wheel.rows as f64 * wheel.rmse_rpm.powi(2);
        squares += square;
        variance += square / (1.0 - wheel.r2);
    }
    (variance > 0.0).then(|| 1.0 - squares / variance)
}

fn rmse_rpm(runs: &[RunScore]) -> Option<f64> {
    let rows: f64 = wheels(runs).map(|wheel| wheel.rows as f64).sum();
    let square = |wheel: &WheelError| wheel.rows as f64 * wheel.rmse_rpm.powi(2);
    (rows > 0.0).then(|| (wheels(runs).map(square).sum::<f64>() / rows).sqrt())
}

fn rmse_m(runs: &[RunScore]) -> Option<f64> {
    let errors: Vec<f64> = runs.iter().filter_map(|run| run.range_rmse_m).collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    (!errors.is_empty()).then(|| (squares / errors.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Identified;

    fn runs(rmse_rpm: f64, r2: f64) -> Vec<RunScore> {
        let wheel = WheelError {
            rmse_rpm,
            r2,
            rows: 100,
        };
        vec![RunScore {
            whole: Some([wheel; 2]),
            ..RunScore::default()
        }]
    }

    fn found(runs: Vec<RunScore>, from_runs: f64) -> Identification {
        Identification {
            parameters: vec![Identified {
                from_runs,
                ..Identified::default()
            }],
            runs,
            ..Identification::default()
        }
    }

    #[test]
    fn a_fit_that_repeats_the_runs_is_believed() {
        let doubts = found(runs(4.0, 0.99), 0.8).doubts(&runs(5.0, 0.98));
        assert!(doubts.is_empty(), "{doubts:?}");
    }

    #[test]
    fn a_fit_is_doubted_for_what_it_explains_its_errors_and_what_the_runs_tell() {
        let only = |found: Identification, before: &[RunScore]| match &found.doubts(before)[..] {
            [doubt] => doubt.clone(),
            doubts => format!("{doubts:?}"),
        };
        let little = only(found(runs(60.0, -3.4), 0.8), &runs(60.0, -3.4));
        assert!(little.starts_with("it explains 0 % of how"), "{little}");
        let worse = only(found(runs(6.0, 0.9), 0.8), &runs(4.0, 0.95));
        assert!(worse.contains("speeds are 1.50 times"), "{worse}");
        let nothing = only(found(runs(4.0, 0.9), 0.0), &runs(4.0, 0.9));
        assert!(nothing.starts_with("the runs tell nothing"), "{nothing}");
    }
}
