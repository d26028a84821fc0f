//! The least-squares problem: unknowns, what is known about them beforehand, residuals.
//!
//! Each unknown is a normalised number `z`: 0 is the nominal value of such a robot's parts, +-1 one standard deviation
//! of what is believed about it (in the logarithm of its distance from the lower limit over that from the upper one, so
//! that it stays allowed and always has a slope). The values before the fit are a place to start from and nothing more, so
//! that a second fit does not drift from the first.
//! The beliefs enter as residuals; they hold what the runs cannot tell, such as which part of a torque is voltage and which is
//! friction. Two facts of the report are such residuals too: wheels start to turn at a PWM of about 35 in the air and
//! 65 on the floor.

use crate::log::{DriveLog, RobotProgram};
use crate::replay::{Nuisance, Replay};
use crate::residuals::{Residuals, run_residuals};
use crate::unknowns::{SCRUB_SD, TURNS, Unknown};
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use rayon::prelude::*;
use rumbo_plant::drivetrain::{Bridge, Drivetrain, Side};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::{Limit, Params};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Standard deviations from what is believed at which a fit begins at most.
const FARTHEST: f64 = 5.0;
/// Battery voltage believed beforehand and its standard deviation, V; of the floor's scale and that of its scrubbing:
/// standard deviations of their logarithms from day to day. Modes 7 and 8 ask for a scrubbing five times apart.
const BATTERY_V: (f64, f64) = (7.4, 0.4);
const FLOOR_SD: f64 = 0.2;
/// Of each source.
pub(crate) const NUISANCES: usize = 3;

/// By how much another robot of the same kind differs: standard deviation in the logarithm.
const SAME_KIND_SD: f64 = 0.3;
/// Logs of our program: standard deviations are larger by this than their residuals tell, which are few where a wheel
/// breaks away; and those of what turns show by that: on a rough floor the yaw's inertia comes out too large. Chosen on
/// simulated robots (docs/theory/plant.md).
const TIMED_MODEL_ERROR: f64 = 2.0;
const TURNS_MODEL_ERROR: f64 = 1.6;
/// PWM at which wheels start, in the air and on the floor, each with its standard deviation.
const DEAD_ZONES: [(bool, f64, f64); 2] = [(false, 35.0, 2.0), (true, 65.0, 4.0)];

/// What is believed beforehand of a source's battery and floor: mean and standard deviation, V, and the standard
/// deviations of the logarithms of the floor's scales.
#[derive(Clone, Copy, Debug)]
struct Day {
    battery_v: (f64, f64),
    floor_sd: f64,
    scrub_sd: f64,
}

/// Unknowns, runs, and a point among the unknowns.
#[derive(Clone)]
pub(crate) struct Problem<'a> {
    unknowns: &'a [Unknown],
    logs: &'a [DriveLog],
    /// The number of each log's source.
    sources: Vec<usize>,
    /// What is believed of each source.
    days: Vec<Day>,
    start: Params,
    limits: Vec<Limit>,
    /// Standard deviation of what is believed of each unknown, in the logarithm.
    prior_sd: Vec<f64>,
    /// The report's dead zones hold: no other robot's logs are among these.
    pub(crate) is_the_reports: bool,
    /// Set when what solves it is to end.
    stop: Option<&'a AtomicBool>,
    z: DVector<f64>,
}

impl<'a> Problem<'a> {
    /// All of `unknowns` around what is believed, the rest as in `start`, and three nuisance values per source. With
    /// logs of our program the unknowns are believed to be near `start`: it is a robot of that kind.
    pub(crate) fn new(unknowns: &'a [Unknown], logs: &'a [DriveLog], start: &Params) -> Self {
        let is_the_reports = logs.iter().all(|log| log.program == RobotProgram::Original);
        let all = Params::limits();
        let limits = unknowns.iter().filter_map(|unknown| {
            let key = unknown.keys[0];
            let mut limit = all.iter().find(|limit| limit.key == key)?.clone();
            let believed = unknown.believed.unwrap_or(limit.nominal);
            let within = |value: &f64| limit.min < *value && *value < limit.max;
            let of_start = start.get(key).filter(within);
            limit.nominal = match is_the_reports {
                true => believed,
                false => of_start.unwrap_or(believed),
            };
            Some(limit)
        });
        let prior_sd = unknowns.iter().map(|unknown| match unknown.believed {
            None if !is_the_reports => SAME_KIND_SD,
            _ => unknown.prior_sd,
        });
        // Our own runs are long enough to tell it: it is an unknown of theirs, the same one on all days.
        let fits_ours = !is_the_reports && !unknowns.is_empty();
        let mut paths: Vec<&Path> = Vec::new();
        let mut days = Vec::new();
        let mut sources = Vec::new();
        for log in logs {
            let known = paths.iter().position(|path| *path == log.source);
            sources.push(known.unwrap_or(paths.len()));
            if known.is_none() {
                // Without runs on other floors the first one is the floor of the robot file.
                let is_the_floor = paths.is_empty() && fits_ours;
                paths.push(&log.source);
                days.push(Day {
                    battery_v: log.battery_v.unwrap_or(BATTERY_V),
                    floor_sd: if is_the_floor { 1e-3 } else { FLOOR_SD },
                    scrub_sd: if fits_ours { 1e-3 } else { SCRUB_SD },
                });
            }
        }
        Self {
            unknowns,
            logs,
            sources,
            start: *start,
            limits: limits.collect(),
            prior_sd: prior_sd.collect(),
            is_the_reports,
            stop: None,
            z: DVector::zeros(unknowns.len() + NUISANCES * days.len()),
            days,
        }
    }

    /// The same problem, left unsolved when this is set.
    pub(crate) fn until(self, stop: Option<&'a AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// What ends it.
    pub(crate) fn stop(&self) -> Option<&'a AtomicBool> {
        self.stop
    }

    /// Whether what solves it is to end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Number of unknowns with the nuisances.
    pub(crate) fn dimension(&self) -> usize {
        self.z.len()
    }

    /// The value of unknown `index` at normalised `z`.
    pub(crate) fn value(&self, index: usize, z: f64) -> f64 {
        let Limit {
            min, max, nominal, ..
        } = &self.limits[index];
        let odds = self.odds(index, *nominal) * (self.steepness(index) * z).exp();
        min + (max - min) / (1.0 + 1.0 / odds)
    }

    /// Change of that value per unit of `z`.
    pub(crate) fn slope(&self, index: usize, z: f64) -> f64 {
        let Limit { min, max, .. } = &self.limits[index];
        let value = self.value(index, z);
        self.steepness(index) * (value - min) * (max - value) / (max - min)
    }

    /// How far a value is from its lower limit, relative to its distance from the upper one.
    fn odds(&self, index: usize, value: f64) -> f64 {
        let Limit { min, max, .. } = &self.limits[index];
        (value - min).max(1e-9) / (max - value).max(1e-9)
    }

    /// Change of the logarithm of the odds per unit of z: at the nominal value that of the value's is what is believed.
    fn steepness(&self, index: usize) -> f64 {
        let Limit {
            min, max, nominal, ..
        } = &self.limits[index];
        self.prior_sd[index] * (max - min) / (max - nominal)
    }

    /// By how much the standard deviation of unknown or nuisance `index` is larger than the residuals tell.
    pub(crate) fn model_error(&self, index: usize) -> f64 {
        let unknown = self.unknowns.get(index);
        match unknown.is_some_and(|unknown| unknown.shown_by == TURNS) {
            _ if self.is_the_reports => 1.0,
            true => TURNS_MODEL_ERROR,
            false => TIMED_MODEL_ERROR,
        }
    }

    /// Unit of unknown `index`.
    pub(crate) fn unit(&self, index: usize) -> &'static str {
        self.limits[index].unit
    }

    /// The point with the values in `params` and these nuisance values, one per log; those of a source are the first of
    /// its logs'.
    pub(crate) fn point(&self, params: &Params, nuisances: &[Nuisance]) -> DVector<f64> {
        let unknowns = self.limits.iter().enumerate().map(|(index, limit)| {
            let value = params.get(&limit.key).unwrap_or(limit.nominal);
            let relative = self.odds(index, value) / self.odds(index, limit.nominal);
            let z = relative.ln() / self.steepness(index);
            // A value at its limit is infinitely far.
            z.clamp(-FARTHEST, FARTHEST)
        });
        let nuisances = self.days.iter().enumerate().flat_map(|(source, day)| {
            let of = self.sources.iter().position(|&each| each == source);
            let nuisance = of.and_then(|log| nuisances.get(log));
            let (mean_v, sd_v) = day.battery_v;
            nuisance.map_or([0.0; NUISANCES], |nuisance| {
                let battery = (nuisance.battery_v - mean_v) / sd_v;
                let floor = nuisance.floor_scale.ln() / day.floor_sd;
                let scrub = nuisance.scrub_scale.ln() / day.scrub_sd;
                [battery, floor, scrub].map(|z| z.clamp(-FARTHEST, FARTHEST))
            })
        });
        DVector::from_iterator(self.dimension(), unknowns.chain(nuisances))
    }

    /// The plant at `z`.
    pub(crate) fn plant(&self, z: &DVector<f64>) -> Params {
        let mut params = self.start;
        for (index, unknown) in self.unknowns.iter().enumerate() {
            for key in unknown.keys {
                // The transform stays within the limits, so that this cannot fail.
                let _ = params.set(key, self.value(index, z[index]));
            }
        }
        params
    }

    /// The nuisance values of run `run` at `z`.
    pub(crate) fn nuisance(&self, run: usize, z: &DVector<f64>) -> Nuisance {
        let source = self.sources[run];
        let at = self.unknowns.len() + NUISANCES * source;
        let Day {
            battery_v: (mean_v, sd_v),
            floor_sd,
            scrub_sd,
        } = self.days[source];
        Nuisance {
            battery_v: (mean_v + sd_v * z[at]).clamp(6.0, 8.6),
            floor_scale: (floor_sd * z[at + 1]).exp().clamp(0.5, 2.0),
            scrub_scale: (scrub_sd * z[at + 2]).exp().clamp(0.1, 10.0),
        }
    }

    /// All residuals at `z`, each in standard deviations.
    pub(crate) fn residuals_at(&self, z: &DVector<f64>) -> DVector<f64> {
        DVector::from_vec(self.measured(z).values)
    }

    /// The block of each residual: those of one block may have one cause. `None` for what is believed beforehand.
    pub(crate) fn blocks(&self, z: &DVector<f64>) -> Vec<Option<usize>> {
        self.measured(z).blocks
    }

    fn measured(&self, z: &DVector<f64>) -> Residuals {
        let params = self.plant(z);
        let mut residuals = Residuals::default();
        z.iter().for_each(|z| residuals.believe(*z));
        if !self.unknowns.is_empty() && self.is_the_reports {
            for (on_floor, pwm, sd) in DEAD_ZONES {
                residuals.believe((dead_zone_pwm(&params, on_floor) - pwm) / sd);
            }
        }
        for (run, log) in self.logs.iter().enumerate() {
            residuals.begin_run();
            let replay = Replay::new(log, &params, self.nuisance(run, z));
            run_residuals(log, &replay, &mut residuals);
        }
        residuals
    }

    /// Relative change below which a fit has converged. Timed speeds tell far more than counted ones.
    pub(crate) fn tolerance(&self) -> f64 {
        if self.is_the_reports { 1e-5 } else { 1e-6 }
    }

    /// How many evaluations a fit may take, in units of its unknowns.
    pub(crate) fn patience(&self) -> usize {
        if self.is_the_reports { 4 } else { 8 }
    }

    /// Half the width of a difference that counts as a slope: past single edges of stick and slip, which are steps of the
    /// residuals.
    fn step(&self) -> f64 {
        if self.is_the_reports { 0.03 } else { 0.01 }
    }

    /// Half the sum of squares at `z`.
    pub(crate) fn cost(&self, z: &DVector<f64>) -> f64 {
        0.5 * self.residuals_at(z).norm_squared()
    }
}

impl levenberg_marquardt::LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_> {
    type ParameterStorage = Owned<f64, Dyn>;
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;

    fn set_params(&mut self, z: &DVector<f64>) {
        self.z.copy_from(z);
    }

    fn params(&self) -> DVector<f64> {
        self.z.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        (!self.is_stopped()).then(|| self.residuals_at(&self.z))
    }

    /// Central differences.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        if self.is_stopped() {
            return None;
        }
        let step = self.step();
        let column = |i: usize| {
            let at = |shift: f64| {
                let mut z = self.z.clone();
                z[i] += shift;
                self.residuals_at(&z)
            };
            (at(step) - at(-step)) / (2.0 * step)
        };
        let columns: Vec<DVector<f64>> = (0..self.z.len()).into_par_iter().map(column).collect();
        Some(DMatrix::from_columns(&columns))
    }
}

/// PWM at which the wheels start to turn, both alike, mean of wheels and directions.
pub(crate) fn dead_zone_pwm(params: &Params, on_floor: bool) -> f64 {
    let mut params = *params;
    params.floor.roughness = 0.0;
    let drivetrain = Drivetrain::new(&params, Noise::new(0, 0), on_floor);
    let moves = |side: Side, duty: f64| {
        let bridge = Bridge::driven(duty);
        let mut state = drivetrain.start();
        drivetrain.set_bridge(&mut state, Side::Left, bridge);
        drivetrain.set_bridge(&mut state, Side::Right, bridge);
        drivetrain.step(&mut state, 0.001, [0.0; 2]);
        state.wheels[side.index()].speed_rad_s != 0.0
    };
    let threshold = |(side, direction): (Side, f64)| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            match moves(side, direction * middle) {
                true => high = middle,
                false => low = middle,
            }
        }
        high * 255.0
    };
    let wheels = [Side::Left, Side::Right].into_iter();
    let ways = wheels.flat_map(|side| [(side, 1.0), (side, -1.0)]);
    ways.map(threshold).sum::<f64>() / 4.0
}
