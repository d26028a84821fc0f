//! Noise figures of a series of readings, from its residuals about local lines.

use super::SonarLog;

/// A residual beyond this many robust standard deviations is an outlier...
pub const OUTLIER_SDS: f64 = 5.0;
/// ...if it is also at least this large.
pub const OUTLIER_LEAST_M: f64 = 0.01;
/// Readings outside are lost: nearer than the sensor measures, or farther than its pulse can last.
const POSSIBLE_M: std::ops::RangeInclusive<f64> = 0.02..=4.5;
/// Rows on each side that a line is fitted to.
const SIDE: usize = 4;
/// A line steeper than this is motion.
const LEVEL_M_S: f64 = 0.01;

/// Figures of one sonar in one run.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct SonarStats {
    /// Readings at rest that are not lost.
    pub rest_n: f64,
    /// Standard deviation at rest without outliers.
    pub rest_sd_m: f64,
    /// Readings in motion that are not lost.
    pub motion_n: f64,
    /// Standard deviation in motion without outliers: how the motion bends is in it.
    pub motion_sd_m: f64,
    /// The same from second differences of rows that follow each other, which hardly show the motion.
    pub second_sd_m: f64,
    /// Share of outliers among the readings that are not lost.
    pub outlier_rate: f64,
    /// Share of readings lost.
    pub loss_rate: f64,
}

/// Figures of every sonar of a run.
#[must_use]
pub fn statistics(log: &SonarLog) -> Vec<SonarStats> {
    log.range_m
        .iter()
        .map(|range_m| one_sonar(log, range_m))
        .collect()
}

fn one_sonar(log: &SonarLog, range_m: &[f64]) -> SonarStats {
    let (mut rest, mut motion) = (Class::default(), Class::default());
    let mut lost = 0.0;
    for (row, &reading_m) in range_m.iter().enumerate() {
        if !POSSIBLE_M.contains(&reading_m) {
            lost += 1.0;
        } else if let Some(line) = line_around(&log.t_s, range_m, row, false) {
            let class = if at_rest(log, row, &line) {
                &mut rest
            } else {
                &mut motion
            };
            class.rows.push(row);
            class.residuals_m.push(reading_m - line.at_row_m);
        }
    }
    let readings = (rest.rows.len() + motion.rows.len()) as f64;
    let [rest_inner, motion_inner] = [&rest, &motion].map(Class::without_outliers);
    let inner = (rest_inner.rows.len() + motion_inner.rows.len()) as f64;
    SonarStats {
        rest_n: rest.rows.len() as f64,
        rest_sd_m: sd(&rest_inner.residuals_m),
        motion_n: motion.rows.len() as f64,
        motion_sd_m: sd(&motion_inner.residuals_m),
        second_sd_m: sd(&second_differences(range_m, &motion_inner.rows)),
        outlier_rate: (readings - inner) / readings.max(1.0),
        loss_rate: lost / (range_m.len() as f64).max(1.0),
    }
}

/// Rows at rest or in motion, and their residuals.
#[derive(Default)]
struct Class {
    rows: Vec<usize>,
    residuals_m: Vec<f64>,
}

impl Class {
    fn without_outliers(&self) -> Class {
        let robust_sd = 1.4826 * median(self.residuals_m.iter().map(|r| r.abs()).collect());
        let limit = (OUTLIER_SDS * robust_sd).max(OUTLIER_LEAST_M);
        let inner = self.rows.iter().zip(&self.residuals_m);
        let inner = inner.filter(|(_, residual_m)| residual_m.abs() <= limit);
        let (rows, residuals_m) = inner.unzip();
        Class { rows, residuals_m }
    }
}

/// Of each three of these rows that follow each other, with the standard deviation of one reading if it is white.
fn second_differences(range_m: &[f64], rows: &[usize]) -> Vec<f64> {
    let threes = rows.windows(3).filter(|three| three[2] == three[0] + 2);
    let difference = |three: &[usize]| {
        let [before, here, after] = [0, 1, 2].map(|i| range_m[three[i]]);
        (before - 2.0 * here + after) / 6f64.sqrt()
    };
    threes.map(difference).collect()
}

fn sd(values: &[f64]) -> f64 {
    let n = (values.len() as f64).max(1.0);
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / n;
    variance.sqrt()
}

/// A local line: its value at the row it was fitted around, and its slope.
pub(super) struct Line {
    pub(super) at_row_m: f64,
    slope_m_s: f64,
}

/// Theil-Sen line through the possible readings around a row, itself included or not; `None` for fewer than four.
pub(super) fn line_around(t_s: &[f64], range_m: &[f64], row: usize, itself: bool) -> Option<Line> {
    let from = row.saturating_sub(SIDE);
    let until = (row + SIDE + 1).min(range_m.len());
    let near: Vec<usize> = (from..until)
        .filter(|&i| (itself || i != row) && POSSIBLE_M.contains(&range_m[i]))
        .collect();
    if near.len() < 4 {
        return None;
    }
    let slopes = near.iter().enumerate().flat_map(|(k, &i)| {
        near[k + 1..].iter().filter_map(move |&j| {
            let dt_s = t_s[j] - t_s[i];
            (dt_s > 0.0).then(|| (range_m[j] - range_m[i]) / dt_s)
        })
    });
    let slope_m_s = median(slopes.collect());
    let at_row_m = median(
        near.iter()
            .map(|&i| range_m[i] - slope_m_s * (t_s[i] - t_s[row]))
            .collect(),
    );
    Some(Line {
        at_row_m,
        slope_m_s,
    })
}

pub(super) fn at_rest(log: &SonarLog, row: usize, line: &Line) -> bool {
    let from = row.saturating_sub(SIDE);
    let until = (row + SIDE + 1).min(log.driven.len());
    !log.driven[from..until].contains(&true) && line.slope_m_s.abs() < LEVEL_M_S
}

fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 {
        values[middle]
    } else {
        0.5 * (values[middle - 1] + values[middle])
    }
}
