//! A recorded run once more on the plant: the recorded duty in, what the original would have measured out.
//!
//! The plant runs without its random parts (slip, rough floor). Speeds are taken as the original takes them, over 50 ms
//! windows, but from the angle instead of whole edges: where the edges were no log tells, and the angle is their mean.

use super::log::{DriveLog, Row, WINDOW_MS};
use rumbo_plant::drivetrain::{Bridge, Drivetrain, Side, State};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::Params;

const STEP_S: f64 = 0.001;
/// Horizon of the short prediction, ms.
pub(super) const AHEAD_MS: usize = 500;

/// What differs from run to run and no log says.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Nuisance {
    /// Open-circuit voltage of the battery, V.
    pub battery_v: f64,
    /// Friction of the floor relative to the robot file's.
    pub floor_scale: f64,
}

/// The plant of one run.
pub(super) struct Replay<'a> {
    log: &'a DriveLog,
    drivetrain: Drivetrain,
    /// What the friction remembers of the measured speeds, at each row, rad/s.
    remembered_rad_s: Vec<[f64; 2]>,
}

/// Angles and way on the millisecond grid.
pub(super) struct Trace {
    /// Both wheels' angles at each millisecond, rad.
    pub angle_rad: Vec<[f64; 2]>,
    /// Way of the body at each millisecond, m.
    pub way_m: Vec<f64>,
}

impl<'a> Replay<'a> {
    /// The run of this log on a plant with these parameters.
    #[must_use]
    pub(super) fn new(log: &'a DriveLog, params: &Params, nuisance: Nuisance) -> Self {
        let mut params = *params;
        params.battery.open_circuit_v = nuisance.battery_v;
        params.floor.friction_scale *= nuisance.floor_scale;
        params.floor.roughness = 0.0;
        params.floor.slip = 0.0;
        let drivetrain = Drivetrain::new(&params, Noise::new(0, 0), true);
        Self {
            log,
            drivetrain,
            remembered_rad_s: remembered_rad_s(log, &params),
        }
    }

    /// The whole run from rest.
    #[must_use]
    pub(super) fn whole(&self) -> Trace {
        let mut trace = Trace {
            angle_rad: Vec::new(),
            way_m: Vec::new(),
        };
        let (mut state, mut way_m) = (self.drivetrain.start(), 0.0);
        // The first row reports the time since a pass that is not in the log and had applied nearly the same: wheels
        // already turn in first rows.
        self.apply(&mut state, &self.log.rows[0]);
        let mut rows = self.log.rows.iter().peekable();
        for now_ms in 0..=self.log.duration_ms() {
            trace.angle_rad.push(angles(&state));
            trace.way_m.push(way_m);
            while let Some(row) = rows.next_if(|row| row.at_ms <= now_ms) {
                self.apply(&mut state, row);
            }
            way_m += self.drivetrain.step(&mut state, STEP_S, [0.0; 2]).forward_m;
        }
        trace
    }

    /// Speeds that the rows of the log would have shown in this trace, rad/s.
    #[must_use]
    pub(super) fn speeds(&self, trace: &Trace) -> Vec<[f64; 2]> {
        let speed = |row: &Row| {
            let end_ms = self.log.window_end_ms(row);
            window_speed(
                trace.angle_rad[end_ms.saturating_sub(WINDOW_MS)],
                trace.angle_rad[end_ms],
            )
        };
        self.log.rows.iter().map(speed).collect()
    }

    /// Predicts half a second from the measured speeds of row `index`: the row predicted and its speeds, rad/s.
    /// `None` near the end of the log.
    #[must_use]
    pub(super) fn ahead(&self, index: usize) -> Option<(usize, [f64; 2])> {
        let from_ms = self.log.window_end_ms(&self.log.rows[index]);
        let after = &self.log.rows[index..];
        let target = index
            + after
                .iter()
                .position(|row| self.log.window_end_ms(row) >= from_ms + AHEAD_MS)?;
        let until_ms = self.log.window_end_ms(&self.log.rows[target]);

        // The measured speed is that of the window's middle.
        let start_ms = from_ms.saturating_sub(WINDOW_MS / 2);
        let mut state = self.drivetrain.start();
        for i in 0..2 {
            state.wheels[i].speed_rad_s = self.log.rows[index].speed_rad_s[i];
            state.wheels[i].remembered_rad_s = self.remembered_rad_s[index][i];
        }
        let first = self.log.rows[..index]
            .iter()
            .rposition(|row| row.at_ms <= start_ms)
            .unwrap_or(0);
        let mut rows = self.log.rows[first..].iter().peekable();
        let mut window_start = angles(&state);
        for now_ms in start_ms..until_ms {
            if now_ms + WINDOW_MS == until_ms {
                window_start = angles(&state);
            }
            while let Some(row) = rows.next_if(|row| row.at_ms <= now_ms) {
                self.apply(&mut state, row);
            }
            self.drivetrain.step(&mut state, STEP_S, [0.0; 2]);
        }
        Some((target, window_speed(window_start, angles(&state))))
    }

    fn apply(&self, state: &mut State, row: &Row) {
        for side in [Side::Left, Side::Right] {
            let duty = row.duty[side.index()];
            let bridge = if duty > 0.0 {
                Bridge::Forward(duty)
            } else if duty < 0.0 {
                Bridge::Backward(-duty)
            } else {
                Bridge::Released
            };
            self.drivetrain.set_bridge(state, side, bridge);
        }
    }
}

/// The measured speeds as each wheel's friction remembers them, from rest.
fn remembered_rad_s(log: &DriveLog, params: &Params) -> Vec<[f64; 2]> {
    let memory_s = [
        params.wheels.left.friction_memory_s,
        params.wheels.right.friction_memory_s,
    ];
    let (mut remembered, mut before_ms) = ([0.0; 2], 0);
    let follow = |row: &Row| {
        let passed_s = (row.at_ms - before_ms) as f64 / 1000.0;
        before_ms = row.at_ms;
        for i in 0..2 {
            remembered[i] += (row.speed_rad_s[i].abs() - remembered[i])
                * (1.0 - (-passed_s / memory_s[i]).exp());
        }
        remembered
    };
    log.rows.iter().map(follow).collect()
}

fn angles(state: &State) -> [f64; 2] {
    state.wheels.map(|wheel| wheel.angle_rad)
}

fn window_speed(from_rad: [f64; 2], to_rad: [f64; 2]) -> [f64; 2] {
    let speed = |i: usize| (to_rad[i] - from_rad[i]) * 1000.0 / WINDOW_MS as f64;
    [speed(0), speed(1)]
}
