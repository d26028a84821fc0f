//! Which sonar of a pair is which, by what the wheels do to its readings.
//!
//! Motor A is the right wheel: more PWM on it turns the robot to the left. Beside a wall the mean of both readings grows
//! while the front sonar reads more than the rear one; that says which of the two is in front. While the robot turns to
//! the left, the front reading then falls against the rear one if the wall is on the left. Ahead of a wall, the left
//! reading grows.

use crate::row::LogRow;
use std::fmt;

/// Rows over which a difference of PWM acts, and after which it shows.
const SPAN: usize = 5;
const DELAY: usize = 2;
/// Rows over which the distance to a wall follows the heading.
const WAY: usize = 15;
/// Changes beyond this are outliers, m.
const OUTLIER_M: f64 = 0.1;
/// Correlations this many standard deviations from 0 say something.
const SURE_SDS: f64 = 2.0;

/// A correlation, with the number of independent pairs of values that it is from.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Correlation {
    /// Pearson's coefficient.
    pub r: f64,
    /// Independent pairs of values.
    pub n: f64,
}

impl Correlation {
    fn of(pairs: &[(f64, f64)], span: usize) -> Self {
        let n = pairs.len() as f64;
        let mean = |value: fn(&(f64, f64)) -> f64| pairs.iter().map(value).sum::<f64>() / n;
        let (x, y) = (mean(|pair| pair.0), mean(|pair| pair.1));
        let sum = |value: &dyn Fn(f64, f64) -> f64| -> f64 {
            pairs.iter().map(|pair| value(pair.0 - x, pair.1 - y)).sum()
        };
        let scale = (sum(&|x, _| x * x) * sum(&|_, y| y * y)).sqrt();
        Self {
            r: if scale > 0.0 {
                sum(&|x, y| x * y) / scale
            } else {
                0.0
            },
            n: n / span as f64,
        }
    }

    /// How many standard deviations it is from 0: Student's t.
    fn in_sds(&self) -> f64 {
        let unexplained = (1.0 - self.r * self.r).max(1e-9);
        self.r.abs() * ((self.n - 2.0).max(0.0) / unexplained).sqrt()
    }

    /// Its sign, if it is surely not 0.
    fn sign(&self) -> Option<f64> {
        (self.in_sds() > SURE_SDS).then(|| self.r.signum())
    }
}

/// What a run says about its pair of sonars; the first is the column `left_cm`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct SonarPair {
    /// Both look to one side.
    pub beside: bool,
    /// Change of first - second against PWM of the right wheel - left wheel.
    pub turning: Correlation,
    /// Change of the mean against first - second.
    pub following: Correlation,
}

impl SonarPair {
    /// Reads it off the rows of a run with two sonars.
    pub(crate) fn of(rows: &[LogRow], beside: bool) -> Self {
        let apart = |row: &LogRow| row.range_m[0] - row.range_m[1];
        let turn = |row: &LogRow| row.duty[1] - row.duty[0];
        let mean = |rows: &[LogRow], value: &dyn Fn(&LogRow) -> f64| {
            rows.iter().map(value).sum::<f64>() / rows.len() as f64
        };
        let turning: Vec<_> = rows
            .windows(SPAN + DELAY + 1)
            .map(|rows| {
                (
                    mean(&rows[..SPAN], &turn),
                    apart(&rows[SPAN + DELAY]) - apart(&rows[DELAY]),
                )
            })
            .filter(|(_, change_m)| change_m.abs() < OUTLIER_M)
            .collect();
        let following: Vec<_> = rows
            .windows(WAY + 1)
            .map(|rows| (mean(rows, &apart), rows[WAY].mean_m() - rows[0].mean_m()))
            .filter(|(_, change_m)| change_m.abs() < OUTLIER_M)
            .collect();
        Self {
            beside,
            turning: Correlation::of(&turning, SPAN),
            following: Correlation::of(&following, WAY),
        }
    }

    /// The column of the front sonar beside a wall, and 1 if the wall is on the left, -1 if on the right.
    pub(crate) fn beside_wall(&self) -> Option<(usize, f64)> {
        let first_in_front = self.following.sign().filter(|_| self.beside)?;
        let turning = self.turning.sign()?;
        Some((usize::from(first_in_front < 0.0), -turning * first_in_front))
    }
}

impl fmt::Display for SonarPair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = ["left_cm", "right_cm"];
        if let Some((front, side)) = self.beside_wall() {
            let side = if side > 0.0 { "left" } else { "right" };
            write!(
                f,
                "{} is the sonar in front, the wall on the {side}",
                names[front]
            )?;
        } else if let Some(turning) = self.turning.sign().filter(|_| !self.beside) {
            write!(f, "{} is the left sonar", names[usize::from(turning < 0.0)])?;
        } else {
            write!(f, "which sonar is which does not show")?;
        }
        write!(f, " (correlation with the turn {:+.2}", self.turning.r)?;
        if self.beside {
            write!(f, ", of the distance {:+.2}", self.following.r)?;
        }
        write!(f, ")")
    }
}
