//! How well a plant repeats a run: RMSE and R^2 per wheel, whole run and half a second ahead.

use crate::log::{DriveLog, Seen};
use crate::replay::{Correct, Nuisance, Replay};
use crate::residuals::RANGE_SD_M;
use crate::row::LogRow;
use crate::wall;
use rumbo_plant::params::Params;
use serde::Serialize;

pub(crate) const RPM_PER_RAD_S: f64 = 30.0 / std::f64::consts::PI;
/// Variance of a speed that never changes, but for rounding: none of it is to be explained [(rad/s)^2].
const STEADY: f64 = 1e-9;

/// Error of one wheel, or of both; rpm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WheelError {
    /// Root mean square over the rows, rpm.
    pub rmse_rpm: f64,
    /// Share of the variance explained; negative if the mean would do better.
    pub r2: f64,
    /// Rows compared.
    pub rows: usize,
}

/// Errors of one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunScore {
    /// Name of the log.
    pub name: String,
    /// The two values fitted for this run alone.
    pub nuisance: Nuisance,
    /// Whole run replayed open loop from rest: left, right wheel. `None` for runs without speeds.
    pub whole: Option<[WheelError; 2]>,
    /// The same over rows in which both wheels are asked to go the same way.
    pub whole_straight: Option<[WheelError; 2]>,
    /// The same over rows in which the wheels are asked to turn against each other.
    pub whole_turning: Option<[WheelError; 2]>,
    /// Half a second ahead from the state observed in the rows up to the start.
    pub ahead: Option<[WheelError; 2]>,
    /// Half a second ahead, rows as in `whole_straight`.
    pub ahead_straight: Option<[WheelError; 2]>,
    /// Half a second ahead, rows as in `whole_turning`.
    pub ahead_turning: Option<[WheelError; 2]>,
    /// Distances to a wall over stretches of some seconds, RMS, m. `None` for runs without one.
    pub range_rmse_m: Option<f64>,
}

/// Replays a run and compares.
pub(crate) fn score(log: &DriveLog, params: &Params, nuisance: Nuisance) -> RunScore {
    let replay = Replay::new(log, params, nuisance);
    let mut score = RunScore {
        name: log.name.clone(),
        nuisance,
        ..RunScore::default()
    };
    match log.seen {
        Seen::FrontRange | Seen::SidePair => {
            let errors_m = wall::errors_m(log, &replay.whole(), RANGE_SD_M);
            let squares: f64 = errors_m.iter().map(|error_m| error_m * error_m).sum();
            score.range_rmse_m = Some((squares / errors_m.len().max(1) as f64).sqrt());
        }
        Seen::Speeds => {
            let simulated = replay.speeds(&replay.whole());
            let whole: Vec<Pair> = log.rows.iter().zip(simulated).collect();
            let ahead: Vec<Pair> = replay
                .observe(Correct::SpeedsAndFloor)
                .iter()
                .enumerate()
                .filter_map(|(index, observed)| replay.ahead(index, observed))
                .map(|(target, speeds)| (&log.rows[target], speeds))
                .collect();
            let straight = |row: &LogRow| !row.is_turning();
            let of = |pairs: &[Pair]| {
                let [straight, turning] =
                    [straight, LogRow::is_turning].map(|is| errors(pairs, is));
                [errors(pairs, |_| true), straight, turning]
            };
            [score.whole, score.whole_straight, score.whole_turning] = of(&whole);
            [score.ahead, score.ahead_straight, score.ahead_turning] = of(&ahead);
        }
    }
    score
}

/// A measured row with the speeds simulated for it, rad/s.
type Pair<'a> = (&'a LogRow, [f64; 2]);

fn errors(pairs: &[Pair<'_>], choose: impl Fn(&LogRow) -> bool) -> Option<[WheelError; 2]> {
    let chosen: Vec<&Pair<'_>> = pairs.iter().filter(|(row, _)| choose(row)).collect();
    let wheel = |i: usize| {
        let mean_of = |value: &dyn Fn(f64, f64) -> f64| {
            let values = chosen
                .iter()
                .map(|(row, speed)| value(row.speed_rad_s[i], speed[i]));
            values.sum::<f64>() / chosen.len() as f64
        };
        let mean = mean_of(&|measured, _| measured);
        let variance = mean_of(&|measured, _| (measured - mean).powi(2));
        let square = mean_of(&|measured, simulated| (measured - simulated).powi(2));
        let r2 = if variance > STEADY {
            1.0 - square / variance
        } else {
            0.0
        };
        WheelError {
            rmse_rpm: square.sqrt() * RPM_PER_RAD_S,
            r2,
            rows: chosen.len(),
        }
    };
    (!chosen.is_empty()).then(|| [wheel(0), wheel(1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_speed_that_never_changes_nothing_is_explained() {
        let row = LogRow {
            duty: [0.5; 2],
            speed_rad_s: [10.1; 2],
            ..LogRow::default()
        };
        let pairs: Vec<Pair<'_>> = (0..199).map(|_| (&row, [8.0; 2])).collect();
        let [left, right] = errors(&pairs, |_| true).unwrap();
        assert_eq!([left.r2, right.r2], [0.0; 2]);
    }
}
