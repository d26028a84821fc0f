//! How noisy the sonars are: the same figures from a recorded run and from the plant's sonars repeating it.
//!
//! ```text
//! log ──► smooth motion ──► residuals ──► sd at rest and in motion, outliers, losses   (measured)
//!              └──► the plant's sonars, pinged at the log's times ──► the same figures (simulated, mean of many seeds)
//!                        with the growth of the noise over the range, of those that are drawn, that suits the run
//! ```
//!
//! A reading is *lost* if it is no possible range. The residual of another is its distance from a Theil-Sen line
//! through the readings around it (four on each side, itself left out). A row is *at rest* if the bridge is released
//! around it and that line is level. Within each of the two classes a residual is an *outlier* beyond
//! [`OUTLIER_SDS`] robust standard deviations (1.4826 times the median magnitude) and at least [`OUTLIER_LEAST_M`];
//! the standard deviation is that of the others.

pub use log::SonarLog;
pub use residuals::{OUTLIER_LEAST_M, OUTLIER_SDS, SonarStats, statistics};

use rayon::prelude::*;
use rumbo_plant::noise::Noise;
use rumbo_plant::params::{self, Params};
use rumbo_plant::sonar::{self, Sonar, SonarId, View};
use rumbo_plant::world::{Wall, World};

use residuals::{at_rest, line_around};

mod log;
mod residuals;

/// Speed given to the sonars of a moving robot: anything above their threshold counts as motion.
const MOVING_M_S: f64 = 0.2;
/// Between the fall of one echo line and the end of the next trigger pulse in the original program.
const NEXT_PING_US: u64 = 100;
/// Seeds that a simulated figure is the mean of.
const SEEDS: u64 = 50;
/// Growths of the noise with the range that are tried, evenly spaced over what a seed draws: it differs by wall.
const GROWTHS: u8 = 6;
/// Readings beyond [`params::Sonar::noise_full_m`] that show it.
const SEEN_FAR: usize = 5;
/// Fewer readings at rest say nothing.
const LEAST_AT_REST: f64 = 10.0;

/// One sonar of one run: what was measured and what the plant's sonars give in its place.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Log and sonar.
    pub name: String,
    /// From the log.
    pub measured: SonarStats,
    /// Mean over many seeds of the plant.
    pub simulated: SonarStats,
    /// [`params::Sonar::noise_growth`] that suits the run; `None` where that is the robot file's, since none is drawn, or
    /// the run does not show it.
    pub noise_growth: Option<f64>,
}

/// Compares every sonar of a run with the plant's.
#[must_use]
pub fn compare(log: &SonarLog, params: &Params) -> Vec<Comparison> {
    let measured = statistics(log);
    let noise_growth = noise_growth(log, params, &measured);
    let sonar = params::Sonar {
        noise_growth: noise_growth.unwrap_or(params.sonar.noise_growth),
        ..params.sonar
    };
    let simulated = simulated(log, &sonar);
    let both = measured.into_iter().zip(simulated);
    both.enumerate()
        .map(|(index, (measured, simulated))| {
            let side = if log.range_m.len() == 1 {
                ""
            } else {
                [" left", " right"][index.min(1)]
            };
            Comparison {
                name: format!("{}{side}", log.name),
                measured,
                simulated,
                noise_growth,
            }
        })
        .collect()
}

/// The figures of each sonar, mean over [`SEEDS`] of the plant.
fn simulated(log: &SonarLog, sonar: &params::Sonar) -> Vec<SonarStats> {
    let runs = (0..SEEDS).map(|seed| statistics(&repeat(log, sonar, seed)));
    let runs: Vec<_> = runs.collect();
    let mean = |index: usize| {
        let of = |value: fn(&SonarStats) -> f64| {
            runs.iter().map(|run| value(&run[index])).sum::<f64>() / SEEDS as f64
        };
        SonarStats {
            rest_n: of(|s| s.rest_n),
            rest_sd_m: of(|s| s.rest_sd_m),
            motion_n: of(|s| s.motion_n),
            motion_sd_m: of(|s| s.motion_sd_m),
            second_sd_m: of(|s| s.second_sd_m),
            outlier_rate: of(|s| s.outlier_rate),
            loss_rate: of(|s| s.loss_rate),
        }
    };
    (0..log.range_m.len()).map(mean).collect()
}

/// The growth, of those that a seed draws, with which the plant's figures come nearest to those of the run.
fn noise_growth(log: &SonarLog, params: &Params, measured: &[SonarStats]) -> Option<f64> {
    let (sonar, spread) = (&params.sonar, params.spread.noise_growth);
    let readings = log.range_m.iter().flatten();
    let far = readings.filter(|&&range_m| range_m > sonar.noise_full_m);
    if spread == 0.0 || far.count() < SEEN_FAR {
        return None;
    }
    let growth = |number: u8| {
        let share = f64::from(number) / f64::from(GROWTHS - 1);
        sonar.noise_growth * (1.0 + spread * (2.0 * share - 1.0))
    };
    let misfit = |noise_growth: f64| {
        let sonar = params::Sonar {
            noise_growth,
            ..*sonar
        };
        let simulated = simulated(log, &sonar);
        let both = measured.iter().zip(&simulated);
        both.map(|(one, other)| distance(one, other)).sum::<f64>()
    };
    let tried = (0..GROWTHS).into_par_iter().map(growth);
    tried
        .map(|growth| (misfit(growth), growth))
        .filter(|(misfit, _)| misfit.is_finite())
        .min_by(|one, other| one.0.total_cmp(&other.0))
        .map(|(_, growth)| growth)
}

/// Between the figures of a sonar: squares of the logarithms of their ratios, in quarters. Outliers are counted: few say
/// little, and one more on both sides makes no ratio of none. Not finite where a figure is 0 or missing.
fn distance(measured: &SonarStats, simulated: &SonarStats) -> f64 {
    const QUARTER: f64 = 0.25 * 0.25;
    let ratio = |value: fn(&SonarStats) -> f64| (value(simulated) / value(measured)).ln().powi(2);
    let readings = measured.rest_n + measured.motion_n;
    let outliers = |stats: &SonarStats| stats.outlier_rate * readings + 1.0;
    let (expected, counted) = (outliers(simulated), outliers(measured));
    let mut sum = (ratio(|s| s.motion_sd_m) + ratio(|s| s.second_sd_m)) / QUARTER;
    if measured.rest_n >= LEAST_AT_REST {
        sum += ratio(|s| s.rest_sd_m) / QUARTER;
    }
    sum + (expected / counted).ln().powi(2) / (QUARTER + 1.0 / counted)
}

/// A table of comparisons, measured and simulated side by side.
#[must_use]
pub fn table(comparisons: &[Comparison]) -> String {
    let mut text = format!(
        "{:<32} {:>18} {:>18} {:>18} {:>18} {:>18} {:>7}\n{:<32}{}\n",
        "sonar, measured | simulated",
        "sd at rest, cm",
        "sd in motion, cm",
        "second diff., cm",
        "outliers, %",
        "lost, %",
        "growth",
        "",
        format!("{:>9} {:>9}", "measured", "simulated").repeat(5)
    );
    for Comparison {
        name,
        measured,
        simulated,
        noise_growth,
    } in comparisons
    {
        let pair = |says: bool, value: fn(&SonarStats) -> f64| match says {
            true => {
                let [measured, simulated] = [measured, simulated].map(|s| 100.0 * value(s));
                format!("{measured:>9.3} {simulated:>9.3}")
            }
            false => format!("{:>9} {:>9}", "-", "-"),
        };
        let growth = noise_growth.map_or("-".to_owned(), |growth| format!("{growth:.1}"));
        text += &format!(
            "{name:<32}{}{}{}{}{} {growth:>7}\n",
            pair(measured.rest_n >= LEAST_AT_REST, |s| s.rest_sd_m),
            pair(measured.motion_n > 0.0, |s| s.motion_sd_m),
            pair(measured.motion_n > 0.0, |s| s.second_sd_m),
            pair(true, |s| s.outlier_rate),
            pair(true, |s| s.loss_rate),
        );
    }
    text
}

/// The same run with the plant's sonars: they look square at a wall from the smoothed distances of the log, and are
/// pinged at its times as the original program does, each as soon as the one before has its echo.
#[must_use]
pub fn repeat(log: &SonarLog, sonar: &params::Sonar, seed: u64) -> SonarLog {
    let rangers = Sonar::new(sonar, Noise::new(seed, 0));
    let world = World::new(
        &[Wall {
            from_m: [0.0, -50.0],
            to_m: [0.0, 50.0],
            thickness_m: 0.0,
        }],
        &[],
    );
    // A wall of these numbers is a valid shape.
    let world = world.unwrap_or_default();
    let sound_m_s = 331.3 + 0.606 * sonar.temperature_c;
    let mut states = [sonar::State::default(); 3];
    let mut range_m = vec![Vec::with_capacity(log.t_s.len()); log.range_m.len()];
    for (row, &t_s) in log.t_s.iter().enumerate() {
        let mut now_us = (t_s * 1e6).round() as u64;
        for (index, (id, readings_m)) in [SonarId::Left, SonarId::Right]
            .into_iter()
            .zip(&mut range_m)
            .enumerate()
        {
            let line = line_around(&log.t_s, &log.range_m[index], row, true);
            let Some(line) = line else {
                readings_m.push(0.0);
                continue;
            };
            let speed_m_s = if at_rest(log, row, &line) {
                0.0
            } else {
                MOVING_M_S
            };
            let view = View {
                at: [-line.at_row_m, 0.14 * index as f64],
                axis_rad: 0.0,
                speed_m_s,
            };
            rangers.trigger(&mut states, id, now_us, &world, &view);
            let (mut rise_us, mut fall_us) = (now_us, now_us);
            Sonar::advance(&mut states[id.index()], now_us + 60_000, |edge| {
                *(if edge.level {
                    &mut rise_us
                } else {
                    &mut fall_us
                }) = edge.at_us;
            });
            now_us = fall_us + NEXT_PING_US;
            readings_m.push((fall_us - rise_us) as f64 * 1e-6 * sound_m_s / 2.0);
        }
    }
    SonarLog {
        name: log.name.clone(),
        t_s: log.t_s.clone(),
        driven: log.driven.clone(),
        range_m,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const CYCLE_M: f64 = 0.5 * 343.42 / 40_000.0;

    /// A log of two sonars: 300 rows driven towards a wall, then 300 at rest, each reading changed by `error`.
    fn log(error: impl Fn(usize, usize) -> f64) -> SonarLog {
        let distance_m = |row: usize| 1.0 - 0.002 * row.min(300) as f64;
        let series = |sonar: usize| {
            (0..600)
                .map(|row| distance_m(row) + error(sonar, row))
                .collect()
        };
        SonarLog {
            name: "made.csv".into(),
            t_s: (0..600).map(|row| 0.07 * row as f64).collect(),
            driven: (0..600).map(|row| row < 300).collect(),
            range_m: vec![series(0), series(1)],
        }
    }

    #[test]
    fn the_figures_are_those_that_the_log_was_made_with() {
        let noise = Noise::new(1, 0);
        let [left, right] = statistics(&log(|sonar, row| {
            let sd_m = if row < 300 { 0.003 } else { 0.001 };
            match (sonar, row % 50) {
                (1, 20) => -0.08,
                (1, 40) => 21.0,
                _ => sd_m * noise.normal(sonar as u32, row as u64),
            }
        }))
        .try_into()
        .unwrap();
        // A line through eight noisy neighbours adds about a sixth of their variance.
        assert!((0.003..0.0036).contains(&left.motion_sd_m), "{left:?}");
        assert!((0.001..0.0013).contains(&left.rest_sd_m), "{left:?}");
        assert_eq!((left.outlier_rate, left.loss_rate), (0.0, 0.0));
        assert_eq!(left.rest_n + left.motion_n, 600.0);
        assert!(
            (right.loss_rate - 0.02).abs() < 1e-9
                && (right.outlier_rate - 12.0 / 588.0).abs() < 3.0 / 588.0,
            "{right:?}"
        );
        assert!(
            (right.motion_sd_m / left.motion_sd_m - 1.0).abs() < 0.15,
            "outliers and losses are apart"
        );
    }

    #[test]
    fn a_repeated_run_has_the_noise_of_the_plants_sonars() {
        let quiet = params::Sonar {
            noise_m: 0.0,
            outlier_rate: 0.0,
            loss_rate: 0.0,
            crosstalk_bounce: 0.0,
            ..params::Sonar::default()
        };
        let clean = log(|_, _| 0.0);
        let [left, _] = statistics(&repeat(&clean, &quiet, 3)).try_into().unwrap();
        assert!(
            (left.motion_sd_m / quiet.jitter_m - 1.1).abs() < 0.15 && left.outlier_rate == 0.0,
            "{left:?}"
        );
        let usual = params::Sonar::default();
        let [left, right] = statistics(&repeat(&clean, &usual, 3)).try_into().unwrap();
        assert!(left.motion_sd_m > 0.3 * CYCLE_M, "{left:?}");
        assert!(
            right.outlier_rate > left.outlier_rate,
            "the second of the pair hears the first: {right:?}"
        );
        assert_eq!(repeat(&clean, &usual, 3), repeat(&clean, &usual, 3));
    }

    /// Nominal robots, whose growth differs as that of the recorded runs.
    fn drawn() -> Params {
        let mut params = Params::default();
        params.spread.noise_growth = 0.7;
        params
    }

    #[test]
    fn the_growth_of_a_run_is_found_where_its_wall_is_far_enough() {
        let of = |noise_growth: f64, log: &SonarLog| {
            let sonar = params::Sonar {
                noise_growth,
                ..params::Sonar::default()
            };
            let run = repeat(log, &sonar, 2);
            compare(&run, &drawn())[0].noise_growth
        };
        let far = log(|_, _| 0.5);
        // One run tells it to one step of those that are tried.
        for growth in [0.6, 1.9, 3.2] {
            let found = of(growth, &far).unwrap();
            assert!((found - growth).abs() < 0.75, "{found} for {growth}");
        }
        let near = log(|_, _| -0.15);
        assert_eq!(of(3.2, &near), None);
        assert_eq!(compare(&far, &Params::default())[0].noise_growth, None);
        // Without any noise to compare with.
        assert_eq!(compare(&log(|_, _| 9.0), &drawn())[0].noise_growth, None);
    }

    #[test]
    fn a_malformed_log_is_refused_with_line_and_column() {
        let path = Path::new("run.csv");
        let header = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n";
        let error = SonarLog::parse(
            path,
            &format!("{header}70,50,50,30,1,60,60\n70,5o,50,30,1,60,60\n"),
        )
        .unwrap_err();
        assert_eq!(
            error.to_string(),
            "run.csv, line 3: `left_cm` is `5o`, not a number"
        );
        let error = SonarLog::parse(path, "dt_ms,speed_a_rpm\n50,0\n").unwrap_err();
        assert!(error.to_string().contains("no column `left_cm`"), "{error}");
    }

    #[test]
    fn the_doubled_reading_of_mode_1_is_one_sonar() {
        let text = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n70,50,50,30,1,60,60\n71,49,49,30,1,0,0\n";
        let log = SonarLog::parse(Path::new("run.csv"), text).unwrap();
        assert_eq!(log.range_m, [[0.5, 0.49]]);
        assert_eq!(log.driven, [true, false]);
        assert!((log.t_s[1] - 0.141).abs() < 1e-12);
    }

    /// With the recorded runs at hand (`RUMBO_DATA`): each figure of their sonars within 25 % of the data, with the growth
    /// of each run; of outliers also by no more than chance gives.
    #[test]
    fn the_sonars_are_as_noisy_as_the_recorded_ones() {
        let Some(folder) = std::env::var_os("RUMBO_DATA") else {
            return;
        };
        let mut recorded = drawn();
        recorded.sonar.bounce_reach_m = 0.65;
        for file in [
            "mode1_stop_at_wall.csv",
            "mode2_square_to_wall.csv",
            "mode3_follow_wall.csv",
        ] {
            let log = SonarLog::read(&Path::new(&folder).join(file)).unwrap();
            let compared = compare(&log, &recorded);
            println!("{}", table(&compared));
            for Comparison {
                name,
                measured,
                simulated,
                ..
            } in compared
            {
                let rest = measured.rest_n >= LEAST_AT_REST;
                let figures = |s: &SonarStats| {
                    let at_rest = if rest { s.rest_sd_m } else { 0.0 };
                    [at_rest, s.motion_sd_m, s.second_sd_m]
                };
                for (data, plant) in figures(&measured).into_iter().zip(figures(&simulated)) {
                    assert!(
                        (plant - data).abs() <= 0.25 * data,
                        "{name}: {plant} for {data}"
                    );
                }
                let readings = measured.rest_n + measured.motion_n;
                let [data, plant] = [&measured, &simulated].map(|s| s.outlier_rate * readings);
                assert!(
                    (plant - data).abs() <= (0.25 * data).max(plant.sqrt()),
                    "{name}: {plant} outliers for {data}"
                );
                // 3 of 1,716 pings were lost, all of the second sonar in one run: the plant loses fewer.
                assert!(simulated.loss_rate < 1e-3, "{name}: {simulated:?}");
            }
        }
    }
}
