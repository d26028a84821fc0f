//! A recorded run once more on the plant: the recorded duty in, what the original would have measured out.
//!
//! The plant runs without its random parts (slip, rough floor). Speeds are taken as the original takes them, over 50 ms
//! windows, but from the angle instead of whole edges: where the edges were no log tells, and the angle is their mean.
//!
//! A prediction half a second ahead starts from an observed state: the same plant runs along with the log, and each
//! completed window corrects it by fixed gains, first the speed and, if asked, the resistance of the floor where the
//! wheel is. Battery and friction memory are those of the plant that runs along. No row after the start is used, but
//! for the duty, which is the prediction's input.

use crate::log::{DriveLog, RobotProgram};
use crate::row::{LogRow, Window};
use crate::shown::Angles;
use rumbo_plant::drivetrain::{Bridge, Drivetrain, Side, State};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::Params;

const STEP_S: f64 = 0.001;
/// Horizon of the short prediction, ms.
pub(crate) const AHEAD_MS: usize = 500;

/// A slope is that over twice this time, ms.
const SHIFT_MS: usize = 4;

/// Share of the speed's error that a window corrects.
const SPEED_GAIN: f64 = 0.7;
/// Resistance that a window's error adds, N m per rad/s. Both gains are the best compromise on the runs of modes 5 and 7.
const RESISTANCE_GAIN_N_M_S: f64 = 0.002;
/// Slower wheels stick and slip, and three counts per window tell no resistance, rad/s: the floor's mean is assumed.
const SLOWEST_TELLING_RAD_S: f64 = 1.0;

/// What the measurements correct in the plant that runs along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Correct {
    /// The wheels' speeds alone: errors of the parameters stay visible, as a fit needs them.
    Speeds,
    /// Also the floor's resistance, as a prediction wants it.
    SpeedsAndFloor,
}

/// The state of the robot as the measurements up to a row tell it.
#[derive(Clone, Copy)]
pub(crate) struct Observed {
    state: State,
    /// Dry resistance of the floor here beyond the mean, each wheel, N m.
    resist_n_m: [f64; 2],
}

/// What a row would have shown.
pub(crate) struct Predicted {
    /// Its number.
    pub(crate) row: usize,
    /// Its speeds, rad/s.
    pub(crate) speed_rad_s: [f64; 2],
    /// How they change with time, rad/s2.
    pub(crate) slope_rad_s2: [f64; 2],
}

/// What differs from run to run and no log says.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Nuisance {
    /// Open-circuit voltage of the battery, V.
    pub battery_v: f64,
    /// Friction of the floor relative to the robot file's.
    pub floor_scale: f64,
    /// What it adds when turning on the spot relative to the robot file's, beside that.
    pub scrub_scale: f64,
}

/// The plant of one run.
pub(crate) struct Replay<'a> {
    log: &'a DriveLog,
    drivetrain: Drivetrain,
    /// Share of the floor's resistance that is another one after each radian rolled.
    forgetting_per_rad: [f64; 2],
}

/// Angles and way on the millisecond grid.
pub(crate) struct Trace {
    /// Both wheels' angles at each millisecond, rad.
    pub angle_rad: Vec<[f64; 2]>,
    /// Way of the body at each millisecond, m.
    pub way_m: Vec<f64>,
    /// Its heading at each millisecond, counter-clockwise from the start, rad.
    pub heading_rad: Vec<f64>,
}

impl<'a> Replay<'a> {
    /// The run of this log on a plant with these parameters.
    pub(crate) fn new(log: &'a DriveLog, params: &Params, nuisance: Nuisance) -> Self {
        let mut params = *params;
        params.battery.open_circuit_v = nuisance.battery_v;
        params.floor.friction_scale *= nuisance.floor_scale;
        params.floor.scrub_n_m *= nuisance.scrub_scale;
        params.floor.roughness = 0.0;
        params.floor.slip = 0.0;
        let drivetrain = Drivetrain::new(&params, Noise::new(0, 0), log.on_floor);
        Self {
            log,
            drivetrain,
            forgetting_per_rad: [params.wheels.left, params.wheels.right]
                .map(|wheel| wheel.radius_m / params.floor.roughness_length_m),
        }
    }

    /// The whole run from rest.
    pub(crate) fn whole(&self) -> Trace {
        let mut trace = Trace {
            angle_rad: Vec::new(),
            way_m: Vec::new(),
            heading_rad: Vec::new(),
        };
        let (mut state, mut way_m, mut heading_rad) = (self.start(), 0.0, 0.0);
        let mut rows = self.log.rows.iter().peekable();
        for now_ms in 0..=self.log.duration_ms() + SHIFT_MS {
            trace.angle_rad.push(angles(&state));
            trace.way_m.push(way_m);
            trace.heading_rad.push(heading_rad);
            while let Some(row) = rows.next_if(|row| row.at_ms <= now_ms) {
                self.apply(&mut state, row);
            }
            let motion = self.drivetrain.step(&mut state, STEP_S, [0.0; 2]);
            way_m += motion.forward_m;
            heading_rad += motion.yaw_rad;
        }
        trace
    }

    /// Speeds that the rows of the log would have shown in this trace, rad/s.
    pub(crate) fn speeds(&self, trace: &Trace) -> Vec<[f64; 2]> {
        let speed = |row: &LogRow| self.shown(&row.window, &trace.angle_rad, 0);
        self.log.rows.iter().map(speed).collect()
    }

    /// The state before the first row.
    fn start(&self) -> State {
        let mut state = self.drivetrain.start();
        let first = &self.log.rows[0];
        if self.log.program == RobotProgram::Rumbo {
            // A stretch may begin in motion.
            for (wheel, speed_rad_s) in state.wheels.iter_mut().zip(first.speed_rad_s) {
                wheel.speed_rad_s = speed_rad_s;
                wheel.remembered_rad_s = speed_rad_s.abs();
            }
        }
        // The first row reports the time since a pass that is not in the log and had applied nearly the same: wheels
        // already turn in first rows.
        self.apply(&mut state, first);
        state
    }

    /// The state at the end of each row's window.
    pub(crate) fn observe(&self, correct: Correct) -> Vec<Observed> {
        let mut now = Observed {
            state: self.start(),
            resist_n_m: [0.0; 2],
        };
        let (mut angle_rad, mut observed, mut shown_ms) = (Vec::new(), Vec::new(), None);
        let mut rows = self.log.rows.iter().peekable();
        let mut windows = self.log.rows.iter().peekable();
        for now_ms in 0..=self.log.duration_ms() {
            angle_rad.push(angles(&now.state));
            while let Some(row) = windows.next_if(|row| row.measured_ms() <= now_ms) {
                // Rows between two windows' ends show the same window again.
                if shown_ms != Some(now_ms) {
                    shown_ms = Some(now_ms);
                    now.correct(correct, row, self.shown(&row.window, &angle_rad, 0));
                }
                observed.push(now);
            }
            while let Some(row) = rows.next_if(|row| row.at_ms <= now_ms) {
                self.apply(&mut now.state, row);
            }
            self.roll(&mut now);
        }
        observed
    }

    /// Predicts half a second from the state `observed` at row `index`: the row predicted and its speeds, rad/s.
    /// `None` near the end of the log.
    pub(crate) fn ahead(&self, index: usize, observed: &Observed) -> Option<(usize, [f64; 2])> {
        let target = self.row_after(index, AHEAD_MS)?;
        let (angle_rad, from_ms) = self.run_on(index, observed, target);
        Some((
            target,
            self.shown(&self.log.rows[target].window, &angle_rad, from_ms),
        ))
    }

    /// Predicts all rows after row `index` up to row `last`, from the state `observed` at it. Windows that begin before
    /// are left out.
    pub(crate) fn span(&self, index: usize, observed: &Observed, last: usize) -> Vec<Predicted> {
        let (angle_rad, from_ms) = self.run_on(index, observed, last);
        let within = |row: &LogRow| {
            // The simulated wheel's may be somewhat longer.
            let begins = |window: &Window| {
                window.end_ms >= from_ms + window.length_ms + window.length_ms / 4 + SHIFT_MS
            };
            row.window.iter().all(begins)
        };
        let rows = (index + 1..=last).filter(|&target| within(&self.log.rows[target]));
        rows.map(|target| self.predicted(target, &angle_rad, from_ms))
            .collect()
    }

    /// All rows as this trace shows them.
    pub(crate) fn series(&self, trace: &Trace) -> Vec<Predicted> {
        let rows = 0..self.log.rows.len();
        rows.map(|target| self.predicted(target, &trace.angle_rad, 0))
            .collect()
    }

    fn predicted(&self, row: usize, angle_rad: &[[f64; 2]], from_ms: usize) -> Predicted {
        let shown = &self.log.rows[row];
        let later = |by_ms: usize| {
            let window = shown.window.map(|window| Window {
                end_ms: window.end_ms + by_ms,
                ..window
            });
            self.shown(&window, angle_rad, from_ms + SHIFT_MS)
        };
        let (before, after) = (later(0), later(2 * SHIFT_MS));
        Predicted {
            row,
            speed_rad_s: self.shown(&shown.window, angle_rad, from_ms),
            slope_rad_s2: [0, 1].map(|i| (after[i] - before[i]) / (2e-3 * SHIFT_MS as f64)),
        }
    }

    /// The first row measured at least so long after row `index`.
    pub(crate) fn row_after(&self, index: usize, later_ms: usize) -> Option<usize> {
        let after = &self.log.rows[index..];
        let due_ms = after.first()?.measured_ms() + later_ms;
        Some(index + after.iter().position(|row| row.measured_ms() >= due_ms)?)
    }

    /// Both wheels' angles at each millisecond from row `index`, where the state is `observed`, to row `target` and so much
    /// longer that its slope shows; and when the first one is.
    fn run_on(&self, index: usize, observed: &Observed, target: usize) -> (Vec<[f64; 2]>, usize) {
        let from_ms = self.log.rows[index].measured_ms();
        let until_ms = self.log.rows[target].measured_ms() + SHIFT_MS;
        let mut now = *observed;
        let applied = self.log.rows.partition_point(|row| row.at_ms < from_ms);
        let mut rows = self.log.rows[applied..].iter().peekable();
        let mut angle_rad = Vec::with_capacity(until_ms - from_ms + 1);
        for now_ms in from_ms..until_ms {
            angle_rad.push(angles(&now.state));
            while let Some(row) = rows.next_if(|row| row.at_ms <= now_ms) {
                self.apply(&mut now.state, row);
            }
            self.roll(&mut now);
        }
        angle_rad.push(angles(&now.state));
        (angle_rad, from_ms)
    }

    /// One step; the resistance is forgotten along the way, as the floor changes.
    fn roll(&self, now: &mut Observed) {
        let motion = self.drivetrain.step(&mut now.state, STEP_S, now.resist_n_m);
        for i in 0..2 {
            now.resist_n_m[i] *=
                (1.0 - motion.wheel_rad[i].abs() * self.forgetting_per_rad[i]).max(0.0);
        }
    }

    /// What the program would have shown with these windows, had the wheels' angles of each millisecond from `from_ms`
    /// on been these, rad/s.
    fn shown(&self, window: &[Window; 2], angle_rad: &[[f64; 2]], from_ms: usize) -> [f64; 2] {
        [0, 1].map(|wheel| {
            let angles = Angles {
                angle_rad,
                from_ms,
                wheel,
            };
            angles.shown(self.log.program, window[wheel])
        })
    }

    fn apply(&self, state: &mut State, row: &LogRow) {
        for side in [Side::Left, Side::Right] {
            let bridge = Bridge::driven(row.duty[side.index()]);
            self.drivetrain.set_bridge(state, side, bridge);
        }
    }
}

impl Observed {
    /// Takes in a measured window, given the speeds expected in it, rad/s.
    fn correct(&mut self, what: Correct, row: &LogRow, expected_rad_s: [f64; 2]) {
        for (i, expected_rad_s) in expected_rad_s.into_iter().enumerate() {
            let measured_rad_s = row.speed_rad_s[i];
            let error_rad_s = measured_rad_s - expected_rad_s;
            self.state.wheels[i].speed_rad_s += SPEED_GAIN * error_rad_s;
            let tells = expected_rad_s * measured_rad_s > 0.0
                && expected_rad_s.abs().min(measured_rad_s.abs()) > SLOWEST_TELLING_RAD_S;
            if !tells {
                self.resist_n_m[i] = 0.0;
            } else if what == Correct::SpeedsAndFloor {
                // Slower than expected, in whichever direction, is more resistance.
                self.resist_n_m[i] -= RESISTANCE_GAIN_N_M_S * error_rad_s * measured_rad_s.signum();
            }
        }
    }
}

fn angles(state: &State) -> [f64; 2] {
    state.wheels.map(|wheel| wheel.angle_rad)
}
