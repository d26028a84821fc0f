//! PID controller: gains in seconds, limits, back-calculation anti-windup, derivative on the measurement.
//!
//! ```text
//! u_free = feedforward + kp e + integral - kd d(measurement)/dt        u = u_free within the limits
//! integral <- integral + (ki e + (u - u_free) / tracking) dt
//! ```
//!
//! The integral is kept in units of the output, so new gains take effect without a bump. The derivative acts on the measurement:
//! a step of the reference gives no kick. Source: Astrom & Hagglund, *Advanced PID Control*, 2006, chapters 3 and 13.

use crate::math::{clamp, is_finite};

/// Gains of a PID controller; the output's unit per the error's unit, and seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains {
    /// Proportional gain.
    pub kp: f32,
    /// Integral gain [1/s].
    pub ki: f32,
    /// Derivative gain [s].
    pub kd: f32,
}

/// Configuration of a PID controller; its state is [`PidState`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pid {
    /// Gains; may change between steps.
    pub gains: Gains,
    /// Smallest output.
    pub min: f32,
    /// Largest output.
    pub max: f32,
    /// Time in which the integral follows a limited output [s]; greater than 0.
    pub tracking_s: f32,
}

/// State of a PID controller. The default is a controller that has just been reset.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PidState {
    integral: f32,
    measurement: Option<f32>,
}

/// The terms of a PID controller, in units of its output.
#[cfg(not(target_arch = "avr"))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// Of the error.
    pub proportional: f32,
    /// Of the past errors.
    pub integral: f32,
    /// Of the measurement's slope.
    pub derivative: f32,
}

/// An input of a step was not a finite number, or the period was not positive. The state is unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotFinite;

impl Pid {
    /// One step of `dt_s` seconds. `feedforward` is added to the output before it is limited.
    ///
    /// # Errors
    /// [`NotFinite`], and the state stays as it was.
    pub fn step(
        &self,
        state: &mut PidState,
        reference: f32,
        measurement: f32,
        feedforward: f32,
        dt_s: f32,
    ) -> Result<f32, NotFinite> {
        let error = reference - measurement;
        let finite = is_finite(error) && is_finite(feedforward) && is_finite(dt_s) && dt_s > 0.0;
        if !finite {
            return Err(NotFinite);
        }
        let Gains { kp, ki, kd } = self.gains;
        let mut free = feedforward + kp * error + state.integral;
        if kd != 0.0
            && let Some(last) = state.measurement
        {
            free -= kd * ((measurement - last) / dt_s);
        }
        let output = clamp(free, self.min, self.max);
        let mut grows = ki * error;
        if output != free {
            grows += (output - free) / self.tracking_s;
        }
        let integral = state.integral + grows * dt_s;
        if !is_finite(output) || !is_finite(integral) {
            return Err(NotFinite);
        }
        // However strong the tracking, the integral alone never demands more than the whole span.
        let span = self.max - self.min;
        state.integral = clamp(integral, -span, span);
        state.measurement = Some(measurement);
        Ok(output)
    }

    /// What the next step adds up, beside its feedforward: for people to see. The chip has no use for it.
    #[cfg(not(target_arch = "avr"))]
    pub fn terms(&self, state: &PidState, reference: f32, measurement: f32, dt_s: f32) -> Terms {
        let Gains { kp, ki: _, kd } = self.gains;
        let rate = |last: f32| (measurement - last) / dt_s;
        Terms {
            proportional: kp * (reference - measurement),
            integral: state.integral,
            derivative: -kd * state.measurement.map_or(0.0, rate),
        }
    }

    /// Sets the state so that the next step, given the same inputs, gives `output`: a bumpless transfer.
    pub fn transfer(
        &self,
        state: &mut PidState,
        output: f32,
        reference: f32,
        measurement: f32,
        feedforward: f32,
    ) {
        let integral = output - feedforward - self.gains.kp * (reference - measurement);
        if is_finite(integral) {
            *state = PidState {
                integral,
                measurement: Some(measurement),
            };
        }
    }
}

impl PidState {
    /// Resets the state.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// The integral, in units of the output.
    pub fn integral(&self) -> f32 {
        self.integral
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PID: Pid = Pid {
        gains: Gains {
            kp: 2.0,
            ki: 1.0,
            kd: 0.1,
        },
        min: -1.0,
        max: 1.0,
        tracking_s: 0.1,
    };

    fn run(pid: &Pid, state: &mut PidState, reference: f32, measurement: f32, steps: u32) -> f32 {
        let mut output = 0.0;
        for _ in 0..steps {
            output = pid.step(state, reference, measurement, 0.0, 0.01).unwrap();
        }
        output
    }

    #[test]
    fn an_integral_at_the_limit_leaves_it_as_soon_as_the_error_turns() {
        let mut state = PidState::default();
        assert_eq!(run(&PID, &mut state, 10.0, 0.0, 10_000), 1.0);
        let mut steps = 0;
        while PID.step(&mut state, 0.0, 0.5, 0.0, 0.01).unwrap() >= 0.0 {
            steps += 1;
            assert!(steps < 40, "still wound up after {steps} steps");
        }
    }

    #[test]
    fn the_integral_removes_a_steady_load() {
        // A first-order plant under a constant load that the proportional part alone cannot carry.
        let (mut state, mut y) = (PidState::default(), 0.0f32);
        for _ in 0..5_000 {
            let u = PID.step(&mut state, 0.3, y, 0.0, 0.01).unwrap();
            y += (u - 0.2 - y) * 0.01 / 0.5;
        }
        assert!((y - 0.3).abs() < 1e-4, "{y}");
    }

    #[test]
    fn a_step_of_the_reference_gives_no_derivative_kick() {
        let pid = Pid {
            gains: Gains {
                kp: 0.0,
                ki: 0.0,
                kd: 1.0,
            },
            ..PID
        };
        let mut state = PidState::default();
        run(&pid, &mut state, 0.0, 0.2, 3);
        assert_eq!(pid.step(&mut state, 5.0, 0.2, 0.0, 0.01), Ok(0.0));
        assert!(pid.step(&mut state, 5.0, 0.201, 0.0, 0.01).unwrap() < 0.0);
    }

    #[test]
    fn a_transfer_knows_the_measurement_that_the_derivative_goes_on_from() {
        let mut state = PidState::default();
        PID.transfer(&mut state, 0.3, 0.2, 0.2, 0.0);
        let output = PID.step(&mut state, 0.21, 0.21, 0.0, 0.01).unwrap();
        // 0.1 s times 1/s.
        assert!((output - 0.2).abs() < 1e-5, "{output}");
    }

    #[test]
    fn new_integral_and_derivative_gains_make_no_bump() {
        let mut state = PidState::default();
        run(&PID, &mut state, 0.1, 0.0, 50);
        let before = PID.step(&mut state.clone(), 0.1, 0.0, 0.0, 0.01).unwrap();
        let retuned = Pid {
            gains: Gains {
                ki: 5.0,
                kd: 0.5,
                ..PID.gains
            },
            ..PID
        };
        assert_eq!(retuned.step(&mut state, 0.1, 0.0, 0.0, 0.01), Ok(before));
    }

    #[test]
    fn a_transfer_continues_the_other_controllers_output() {
        let mut state = PidState::default();
        PID.transfer(&mut state, 0.35, 0.2, 0.1, 0.05);
        let output = PID.step(&mut state, 0.2, 0.1, 0.05, 0.01).unwrap();
        assert!((output - 0.35).abs() < 1e-6, "{output}");
    }

    #[test]
    fn what_is_not_finite_is_refused_and_changes_nothing() {
        let mut state = PidState::default();
        run(&PID, &mut state, 0.1, 0.0, 5);
        let before = state;
        for (reference, measurement, feedforward, dt_s) in [
            (f32::NAN, 0.0, 0.0, 0.01),
            (0.0, f32::INFINITY, 0.0, 0.01),
            (0.0, 0.0, f32::NAN, 0.01),
            (0.0, 0.0, 0.0, 0.0),
            (f32::MAX, -f32::MAX, 0.0, 0.01),
        ] {
            assert_eq!(
                PID.step(&mut state, reference, measurement, feedforward, dt_s),
                Err(NotFinite)
            );
            assert_eq!(state, before);
        }
    }

    proptest! {
        #[test]
        fn the_terms_add_up_to_the_output(
            inputs in prop::collection::vec((-1f32..1.0, -1f32..1.0, -0.5f32..0.5), 1..50)
        ) {
            let mut state = PidState::default();
            for (reference, measurement, feedforward) in inputs {
                let Terms { proportional, integral, derivative } =
                    PID.terms(&state, reference, measurement, 0.01);
                let sum = feedforward + proportional + integral + derivative;
                let output = PID.step(&mut state, reference, measurement, feedforward, 0.01);
                prop_assert!((output.unwrap() - sum.clamp(-1.0, 1.0)).abs() < 1e-5);
            }
        }

        #[test]
        fn the_output_never_leaves_its_limits(inputs in prop::collection::vec((-1e30f32..1e30, -1e30f32..1e30), 1..50)) {
            let mut state = PidState::default();
            for (reference, measurement) in inputs {
                if let Ok(output) = PID.step(&mut state, reference, measurement, 0.0, 0.01) {
                    prop_assert!((-1.0..=1.0).contains(&output));
                }
                prop_assert!(state.integral().is_finite());
            }
        }
    }
}
