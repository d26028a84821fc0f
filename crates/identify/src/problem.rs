//! The least-squares problem: unknowns, what is known about them beforehand, residuals.
//!
//! Each unknown is a normalised number `z`: 0 is the nominal value of such a robot's parts, +-1 one standard deviation
//! of what is believed about it (in the logarithm of its distance from the lower limit, so that it stays allowed). The
//! values before the fit are a place to start from and nothing more, so that a second fit does not drift from the first.
//! The beliefs enter as residuals; they hold what the runs cannot tell, such as which part of a torque is voltage and which is
//! friction. Two facts of the report are such residuals too: wheels start to turn at a PWM of about 35 in the air and
//! 65 on the floor.

use crate::log::{DriveLog, Seen};
use crate::replay::{Correct, Nuisance, Replay};
use crate::wall;
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use rayon::prelude::*;
use rumbo_plant::drivetrain::{Bridge, Drivetrain, Side};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::{Limit, Params};

/// A parameter (or several of one value) to identify.
#[derive(Clone, Copy, Debug)]
pub struct Unknown {
    /// The dotted keys that take the value.
    pub keys: &'static [&'static str],
    /// Standard deviation of what is believed beforehand, in the logarithm.
    pub prior_sd: f64,
    /// What is believed, where that is not the nominal value.
    pub believed: Option<f64>,
}

const fn unknown(keys: &'static [&'static str], prior_sd: f64) -> Unknown {
    Unknown {
        keys,
        prior_sd,
        believed: None,
    }
}

/// What the runs can tell. Resistance, gear efficiency and mass scale all torques together and stay nominal.
pub const UNKNOWNS: [Unknown; 17] = [
    unknown(&["motor.back_emf_v_s"], 0.3),
    unknown(&["motor.inductance_h"], 0.5),
    unknown(&["motor.inertia_kg_m2"], 0.5),
    unknown(&["motor.resistance_ohm"], 0.3),
    unknown(&["body.yaw_inertia_kg_m2"], 0.2),
    unknown(&["wheels.left.coulomb_forward_n_m"], 0.5),
    unknown(&["wheels.left.coulomb_backward_n_m"], 0.5),
    unknown(&["wheels.right.coulomb_forward_n_m"], 0.5),
    unknown(&["wheels.right.coulomb_backward_n_m"], 0.5),
    unknown(
        &["wheels.left.viscous_n_m_s", "wheels.right.viscous_n_m_s"],
        0.7,
    ),
    unknown(
        &["wheels.left.static_ratio", "wheels.right.static_ratio"],
        0.7,
    ),
    unknown(
        &["wheels.left.stribeck_rad_s", "wheels.right.stribeck_rad_s"],
        0.5,
    ),
    unknown(
        &[
            "wheels.left.friction_memory_s",
            "wheels.right.friction_memory_s",
        ],
        0.7,
    ),
    // 10 % of the whole: the logarithm counts from the lower limit, 0.5.
    unknown(&["wheels.right.strength"], 0.2),
    unknown(&["floor.rolling_n_m"], 0.5),
    unknown(&["floor.scrub_n_m"], 0.7),
    // Nominal floors have none.
    Unknown {
        believed: Some(0.01),
        ..unknown(&["floor.yaw_damping_n_m_s"], 1.0)
    },
];

/// Standard deviations from what is believed at which a fit begins at most.
const FARTHEST: f64 = 5.0;
/// Battery voltage believed beforehand and its standard deviation, V; floor scale: standard deviation of its logarithm.
const BATTERY_V: (f64, f64) = (7.4, 0.4);
const FLOOR_SD: f64 = 0.2;

/// Wheel speed error that counts as one standard deviation, rad/s: 10 rpm over the whole run, 1.7 rpm half a second ahead:
/// the prediction tells more, since the floor's disturbances have less time to add up.
const WHOLE_SD_RAD_S: f64 = 1.0;
const AHEAD_SD_RAD_S: f64 = 0.18;
/// The same for a distance to a wall, over a stretch of some seconds, m.
pub(crate) const RANGE_SD_M: f64 = 0.006;
/// Errors in turns on the spot count as this much smaller: the castor and the tyres scrub in ways not modelled.
const TURNING: f64 = 3.0;
/// Errors closer in time than this say the same thing once, s.
const CORRELATION_S: f64 = 0.2;
/// Every so manieth row starts a prediction half a second ahead.
const AHEAD_EVERY: usize = 4;
/// PWM at which wheels start, in the air and on the floor, each with its standard deviation.
const DEAD_ZONES: [(bool, f64, f64); 2] = [(false, 35.0, 2.0), (true, 65.0, 4.0)];

/// Unknowns, runs, and a point among the unknowns.
#[derive(Clone)]
pub struct Problem<'a> {
    unknowns: &'a [Unknown],
    logs: &'a [DriveLog],
    start: Params,
    limits: Vec<Limit>,
    z: DVector<f64>,
}

impl<'a> Problem<'a> {
    /// All of `unknowns` around their nominal values, the rest as in `start`, and two nuisance values per log.
    #[must_use]
    pub fn new(unknowns: &'a [Unknown], logs: &'a [DriveLog], start: &Params) -> Self {
        let all = Params::limits();
        let limits = unknowns.iter().filter_map(|unknown| {
            let mut limit = all
                .iter()
                .find(|limit| limit.key == unknown.keys[0])?
                .clone();
            limit.nominal = unknown.believed.unwrap_or(limit.nominal);
            Some(limit)
        });
        let z = DVector::zeros(unknowns.len() + 2 * logs.len());
        Self {
            unknowns,
            logs,
            start: *start,
            limits: limits.collect(),
            z,
        }
    }

    /// Number of unknowns with the nuisances.
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.z.len()
    }

    /// The value of unknown `index` at normalised `z`.
    #[must_use]
    pub fn value(&self, index: usize, z: f64) -> f64 {
        let Limit {
            min, max, nominal, ..
        } = &self.limits[index];
        (min + (nominal - min).max(1e-9) * (self.unknowns[index].prior_sd * z).exp()).min(*max)
    }

    /// Change of that value per unit of `z`.
    #[must_use]
    pub fn slope(&self, index: usize, z: f64) -> f64 {
        (self.value(index, z) - self.limits[index].min) * self.unknowns[index].prior_sd
    }

    /// Unit of unknown `index`.
    #[must_use]
    pub fn unit(&self, index: usize) -> &'static str {
        self.limits[index].unit
    }

    /// The point with the values in `params` and these nuisance values, one pair per log.
    #[must_use]
    pub fn point(&self, params: &Params, nuisances: &[Nuisance]) -> DVector<f64> {
        let unknowns = self
            .unknowns
            .iter()
            .zip(&self.limits)
            .map(|(unknown, limit)| {
                let above = |value: f64| (value - limit.min).max(1e-9);
                let value = params.get(&limit.key).unwrap_or(limit.nominal);
                let z = (above(value) / above(limit.nominal)).ln() / unknown.prior_sd;
                // A value at its limit is infinitely far.
                z.clamp(-FARTHEST, FARTHEST)
            });
        let nuisances = nuisances.iter().flat_map(|nuisance| {
            let battery = (nuisance.battery_v - BATTERY_V.0) / BATTERY_V.1;
            [battery, nuisance.floor_scale.ln() / FLOOR_SD]
        });
        DVector::from_iterator(self.dimension(), unknowns.chain(nuisances))
    }

    /// The plant at `z`.
    #[must_use]
    pub fn plant(&self, z: &DVector<f64>) -> Params {
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
    #[must_use]
    pub fn nuisance(&self, run: usize, z: &DVector<f64>) -> Nuisance {
        let at = self.unknowns.len() + 2 * run;
        Nuisance {
            battery_v: (BATTERY_V.0 + BATTERY_V.1 * z[at]).clamp(6.0, 8.6),
            floor_scale: (FLOOR_SD * z[at + 1]).exp().clamp(0.5, 2.0),
        }
    }

    /// All residuals at `z`, each in standard deviations.
    #[must_use]
    pub fn residuals_at(&self, z: &DVector<f64>) -> DVector<f64> {
        let params = self.plant(z);
        let mut residuals: Vec<f64> = z.iter().copied().collect();
        if !self.unknowns.is_empty() {
            residuals.extend(
                DEAD_ZONES.map(|(on_floor, pwm, sd)| (dead_zone_pwm(&params, on_floor) - pwm) / sd),
            );
        }
        for (run, log) in self.logs.iter().enumerate() {
            let replay = Replay::new(log, &params, self.nuisance(run, z));
            run_residuals(log, &replay, &mut residuals);
        }
        DVector::from_vec(residuals)
    }

    /// Half the sum of squares at `z`.
    #[must_use]
    pub fn cost(&self, z: &DVector<f64>) -> f64 {
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
        Some(self.residuals_at(&self.z))
    }

    /// Central differences, wide enough to see past single edges of stick and slip.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        const STEP: f64 = 0.01;
        let column = |i: usize| {
            let at = |shift: f64| {
                let mut z = self.z.clone();
                z[i] += shift;
                self.residuals_at(&z)
            };
            (at(STEP) - at(-STEP)) / (2.0 * STEP)
        };
        let columns: Vec<DVector<f64>> = (0..self.z.len()).into_par_iter().map(column).collect();
        Some(DMatrix::from_columns(&columns))
    }
}

fn run_residuals(log: &DriveLog, replay: &Replay<'_>, residuals: &mut Vec<f64>) {
    let trace = replay.whole();
    let weight = (log.duration_ms() as f64 / log.rows.len() as f64 / 1000.0 / CORRELATION_S)
        .min(1.0)
        .sqrt();
    if log.seen != Seen::Speeds {
        let errors_m = wall::errors_m(log, &trace, RANGE_SD_M);
        residuals.extend(
            errors_m
                .iter()
                .map(|error_m| weight * robust(error_m / RANGE_SD_M)),
        );
        return;
    }
    for (simulated, row) in replay.speeds(&trace).iter().zip(&log.rows) {
        let weight = if row.is_turning() {
            weight / TURNING
        } else {
            weight
        };
        let errors = simulated
            .iter()
            .zip(row.speed_rad_s)
            .map(|(simulated, measured)| simulated - measured);
        residuals.extend(errors.map(|error| weight * robust(error / WHOLE_SD_RAD_S)));
    }
    let weight = weight * (AHEAD_EVERY as f64).sqrt();
    let observed = replay.observe(Correct::Speeds);
    for (index, observed) in observed.iter().enumerate().step_by(AHEAD_EVERY) {
        if let Some((target, predicted)) = replay.ahead(index, observed) {
            let row = &log.rows[target];
            let weight = if row.is_turning() {
                weight / TURNING
            } else {
                weight
            };
            for (i, speed) in predicted.iter().enumerate() {
                residuals.push(weight * robust((speed - row.speed_rad_s[i]) / AHEAD_SD_RAD_S));
            }
        }
    }
}

/// Pseudo-Huber: quadratic below five standard deviations, linear far above.
fn robust(residual: f64) -> f64 {
    const BEND: f64 = 5.0;
    let relative = residual / BEND;
    (BEND * (2.0 * ((1.0 + relative * relative).sqrt() - 1.0)).sqrt()).copysign(residual)
}

/// PWM at which the wheels start to turn, both alike, mean of wheels and directions.
#[must_use]
pub fn dead_zone_pwm(params: &Params, on_floor: bool) -> f64 {
    let mut params = *params;
    params.floor.roughness = 0.0;
    let drivetrain = Drivetrain::new(&params, Noise::new(0, 0), on_floor);
    let moves = |side: Side, forward: bool, duty: f64| {
        let bridge = if forward {
            Bridge::Forward(duty)
        } else {
            Bridge::Backward(duty)
        };
        let mut state = drivetrain.start();
        drivetrain.set_bridge(&mut state, Side::Left, bridge);
        drivetrain.set_bridge(&mut state, Side::Right, bridge);
        drivetrain.step(&mut state, 0.001, [0.0; 2]);
        state.wheels[side.index()].speed_rad_s != 0.0
    };
    let threshold = |side: Side, forward: bool| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..30 {
            let middle = 0.5 * (low + high);
            if moves(side, forward, middle) {
                high = middle
            } else {
                low = middle
            }
        }
        high * 255.0
    };
    let all = [
        (Side::Left, true),
        (Side::Left, false),
        (Side::Right, true),
        (Side::Right, false),
    ];
    all.map(|(side, forward)| threshold(side, forward))
        .iter()
        .sum::<f64>()
        / 4.0
}
