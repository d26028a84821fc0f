//! Metrics of a response to a step of the reference.
//!
//! A step lasts from the command that sets the reference (or arms the robot) until the next one. *Settling* is the time
//! after which the signal stays within the band; the band is 5 % of the step for distances, 3.2 rpm (the resolution of
//! the original) for speeds. A distance *rests* if at the end of its step it varies by no more than the band has room
//! for, wherever that is: what swings about the reference has a mean there, and no steady error. Wheels turn, and how
//! evenly, their ripple says.

use super::Metrics;
use crate::files::{Setup, TimedCommand};
use rumbo_control::SonarId;
use rumbo_sim::Sim;
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::Command;

/// Band in which a wheel's speed counts as settled [rad/s]: 3.2 rpm.
const SPEED_BAND_RAD_S: f64 = 3.2 * std::f64::consts::TAU / 60.0;
/// Share of a distance step that is its band.
pub(super) const DISTANCE_BAND: f64 = 0.05;
/// Share of a step, at its end, over which steady error and ripple are taken.
pub(super) const STEADY_SHARE: f64 = 0.4;
/// Speed of sound assumed by the robot [m/s]: 20 degrees.
const SOUND_M_S: f64 = 331.3 + 0.606 * 20.0;

/// A step of a reference.
pub(super) struct Step {
    pub(super) from_s: f64,
    pub(super) until_s: f64,
    pub(super) reference: [f64; 2],
}

impl Step {
    /// How a signal responded; the reference is that of `wheel`, the band in the signal's unit. `None` without samples.
    pub(super) fn response(
        &self,
        trace: &Trace,
        wheel: usize,
        band: f64,
        signal: impl Fn(&TruthSample) -> f64,
    ) -> Option<Response> {
        let samples = trace.between(self.from_s, self.until_s);
        let start = signal(samples.first()?);
        let reference = self.reference[wheel];
        Some(response(
            samples,
            self.from_s,
            start,
            reference,
            band,
            signal,
        ))
    }
}

/// The steps of a scenario: each time the reference in force changes while the robot is armed.
pub(super) fn steps(commands: &[TimedCommand], duration_s: f64) -> Vec<Step> {
    let (mut armed, mut reference) = (false, None);
    let mut steps: Vec<Step> = Vec::new();
    for TimedCommand { at_s, command, .. } in commands {
        match command {
            Command::Arm => armed = true,
            Command::Disarm | Command::Stop => armed = false,
            Command::Reference(value) => reference = Some([f64::from(*value); 2]),
            Command::WheelReference(wheels) => {
                reference = Some([f64::from(wheels.left), f64::from(wheels.right)])
            }
            _ => continue,
        }
        if let Some(last) = steps.last_mut()
            && last.until_s > *at_s
        {
            last.until_s = *at_s;
        }
        if let (true, Some(reference)) = (armed, reference) {
            steps.push(Step {
                from_s: *at_s,
                until_s: duration_s,
                reference,
            });
        }
    }
    steps
}

/// A signal's response to one step.
pub(super) struct Response {
    pub(super) settling_s: f64,
    pub(super) rise_s: f64,
    pub(super) overshoot: f64,
    /// Of the mean.
    pub(super) steady_error: f64,
    /// It varies little there.
    pub(super) rests: bool,
    pub(super) rms: f64,
    pub(super) ripple: f64,
}

impl Response {
    /// The response of a signal without a value at the start, such as the distance to a missing wall.
    const NONE: Self = Self {
        settling_s: f64::NAN,
        rise_s: f64::NAN,
        overshoot: f64::NAN,
        steady_error: f64::NAN,
        rests: false,
        rms: f64::NAN,
        ripple: f64::NAN,
    };

    /// The steady error of what rests.
    pub(super) fn resting_error(&self) -> f64 {
        match self.rests {
            true => self.steady_error,
            false => f64::NAN,
        }
    }
}

/// Measures `signal` over the samples of a step, from `start` to `reference`. `NaN` where it never arrives: a signal
/// that rests elsewhere has neither settled nor overshot, nor is it steady. A signal at its reference from the start
/// does not respond.
fn response(
    samples: &[TruthSample],
    from_s: f64,
    start: f64,
    reference: f64,
    band: f64,
    signal: impl FnMut(&TruthSample) -> f64,
) -> Response {
    if !start.is_finite() {
        return Response::NONE;
    }
    let direction = if reference < start { -1.0 } else { 1.0 };
    let span = (reference - start).abs();
    // Once: a range costs a query of the world.
    let values: Vec<f64> = samples.iter().map(signal).collect();
    let progress = |value: f64| direction * (value - start);
    let first = |level: f64| {
        let at = values
            .iter()
            .position(|value| progress(*value) >= level * span);
        at.map(|at| samples[at].t_s)
    };
    let within = |value: &f64| (value - reference).abs() <= band;
    let responds = (start - reference).abs() > band;
    let arrives = values
        .iter()
        .any(|value| within(value) || progress(*value) >= span);
    let if_so = |so: bool, value: f64| if so { value } else { f64::NAN };
    let last_outside = values.iter().rposition(|value| !within(value));
    let settled = values.last().is_some_and(within);
    let steady = &values[(values.len() as f64 * (1.0 - STEADY_SHARE)) as usize..];
    let (least, most) = steady.iter().fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), value| (least.min(*value), most.max(*value)),
    );
    let mean_square = |of: &[f64], from: f64| {
        of.iter().map(|value| (value - from).powi(2)).sum::<f64>() / of.len() as f64
    };
    let mean = steady.iter().sum::<f64>() / steady.len() as f64;
    let variance = mean_square(steady, mean);
    let square = mean_square(&values, reference);
    Response {
        settling_s: if settled && responds {
            last_outside.map_or(0.0, |at| samples[at].t_s - from_s)
        } else {
            f64::NAN
        },
        rise_s: match (first(0.1), first(0.9)) {
            (Some(low), Some(high)) if responds => high - low,
            _ => f64::NAN,
        },
        overshoot: if_so(
            arrives,
            values
                .iter()
                .map(|value| progress(*value) - span)
                .fold(0.0, f64::max),
        ),
        steady_error: (mean - reference).abs(),
        rests: most - least <= 2.0 * band,
        rms: square.sqrt(),
        ripple: if_so(arrives, variance.sqrt()),
    }
}

/// The robot's reading of one metre in this run: it assumes another speed of sound than the air's.
pub(super) fn sound_scale(sim: &Sim) -> f64 {
    SOUND_M_S / (331.3 + 0.606 * sim.params().sonar.temperature_c)
}

/// Steps of the distance to the wall in front. The run's scale of the speed of sound is removed: the robot cannot know
/// it.
pub(super) fn distance_steps(setup: &Setup, sim: &Sim, trace: &Trace, metrics: &mut Metrics) {
    let scale = sound_scale(sim);
    let mut range_m = trace.ranges_m(SonarId::Front as usize);
    let mut distance = |sample: &TruthSample| range_m(sample) * scale;
    for (index, step) in steps(&setup.scenario.commands, setup.scenario.duration_s)
        .iter()
        .enumerate()
    {
        let samples = trace.between(step.from_s, step.until_s);
        let Some(start) = samples.first().map(&mut distance) else {
            continue;
        };
        let [reference, _] = step.reference;
        let band = DISTANCE_BAND * (reference - start).abs();
        let response = response(samples, step.from_s, start, reference, band, &mut distance);
        let mut put =
            |name: &str, value| metrics.insert(format!("step{}.{name}", index + 1), value);
        put("settling_s", response.settling_s);
        put("rise_s", response.rise_s);
        put("overshoot_m", response.overshoot);
        put("steady_error_m", response.resting_error());
        put("rms_m", response.rms);
        put("ripple_m", response.ripple);
    }
}

/// Steps of the wheel speeds; each figure is the worse of the two wheels'.
pub(super) fn speed_steps(setup: &Setup, trace: &Trace, metrics: &mut Metrics) {
    for (index, step) in steps(&setup.scenario.commands, setup.scenario.duration_s)
        .iter()
        .enumerate()
    {
        let samples = trace.between(step.from_s, step.until_s);
        let Some(first) = samples.first() else {
            continue;
        };
        let [left, right] = [0, 1].map(|wheel| {
            let start = first.wheel_rad_s[wheel];
            response(
                samples,
                step.from_s,
                start,
                step.reference[wheel],
                SPEED_BAND_RAD_S,
                |sample| sample.wheel_rad_s[wheel],
            )
        });
        let mut put = |name: &str, left: f64, right: f64| {
            let worse = if left.is_nan() || right.is_nan() {
                f64::NAN
            } else {
                left.max(right)
            };
            metrics.insert(format!("step{}.{name}", index + 1), worse);
        };
        put("settling_s", left.settling_s, right.settling_s);
        put("rise_s", left.rise_s, right.rise_s);
        put("overshoot_rad_s", left.overshoot, right.overshoot);
        put("steady_error_rad_s", left.steady_error, right.steady_error);
        put("rms_rad_s", left.rms, right.rms);
        put("ripple_rad_s", left.ripple, right.ripple);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(signal: impl Fn(f64) -> f64) -> Vec<TruthSample> {
        (1..=400)
            .map(|n| f64::from(n) * 0.01)
            .map(|t_s| TruthSample {
                t_s,
                x_m: 0.0,
                y_m: 0.0,
                heading_rad: 0.0,
                wrapped_rad: 0.0,
                wheel_rad_s: [signal(t_s); 2],
                duty: [0; 2],
                seen_m: None,
                servo_rad: 0.0,
                battery_v: 7.4,
                touching: false,
            })
            .collect()
    }

    #[test]
    fn a_first_order_response_settles_after_three_time_constants() {
        let samples = samples(|t| 1.0 - 0.7 * (1.0 - (-t / 0.4).exp()));
        let response = response(&samples, 0.0, 1.0, 0.3, 0.05 * 0.7, |sample| {
            sample.wheel_rad_s[0]
        });
        assert!(
            (response.settling_s - 0.4 * 20f64.ln()).abs() < 0.02,
            "{}",
            response.settling_s
        );
        assert!(
            (response.rise_s - 0.4 * 9f64.ln()).abs() < 0.02,
            "{}",
            response.rise_s
        );
        assert!(response.overshoot < 1e-9 && response.steady_error < 0.01);
    }

    #[test]
    fn what_leaves_the_band_at_the_end_has_not_settled() {
        let samples = samples(|t| if t < 3.9 { 0.3 } else { 0.5 });
        assert!(
            response(&samples, 0.0, 1.0, 0.3, 0.035, |sample| {
                sample.wheel_rad_s[0]
            })
            .settling_s
            .is_nan()
        );
    }

    #[test]
    fn where_there_is_no_wall_nothing_has_settled() {
        let samples = samples(|_| f64::INFINITY);
        let band = DISTANCE_BAND * f64::INFINITY;
        let response = response(&samples, 0.0, f64::INFINITY, 0.3, band, |sample| {
            sample.wheel_rad_s[0]
        });
        let figures = [
            response.settling_s,
            response.rise_s,
            response.overshoot,
            response.resting_error(),
            response.rms,
            response.ripple,
        ];
        assert!(figures.iter().all(|figure| figure.is_nan()), "{figures:?}");
    }

    #[test]
    fn what_stands_still_far_away_has_no_overshoot_and_no_ripple() {
        let samples = samples(|_| 1.0);
        let response = response(&samples, 0.0, 1.0, 0.3, 0.035, |sample| {
            sample.wheel_rad_s[0]
        });
        let figures = [
            response.settling_s,
            response.rise_s,
            response.overshoot,
            response.ripple,
        ];
        assert!(figures.iter().all(|figure| figure.is_nan()), "{figures:?}");
        assert!((response.resting_error() - 0.7).abs() < 1e-9);
    }

    #[test]
    fn what_swings_about_the_reference_or_still_moves_has_no_steady_error() {
        let steady_error = |at_m: f64, swing_m: f64, moves_m_s: f64| {
            let samples = samples(|t| at_m + moves_m_s * t + swing_m * (9.0 * t).sin());
            response(&samples, 0.0, 1.0, 0.3, 0.035, |sample| {
                sample.wheel_rad_s[0]
            })
            .resting_error()
        };
        for swing_m in [0.04, 0.06, 0.12] {
            assert!(steady_error(0.3, swing_m, 0.0).is_nan());
        }
        assert!(steady_error(1.0, 0.0, -0.2).is_nan());
        // Within the band all the time, and at rest outside it.
        assert!(steady_error(0.3, 0.034, 0.0) < 0.01);
        assert!((steady_error(0.4, 0.01, 0.0) - 0.1).abs() < 0.005);
    }

    #[test]
    fn what_is_at_the_reference_when_the_step_begins_has_not_settled_in_no_time() {
        let samples = samples(|_| 0.3);
        let response = response(&samples, 0.0, 0.3, 0.3, 0.035, |sample| {
            sample.wheel_rad_s[0]
        });
        assert!(response.settling_s.is_nan() && response.rise_s.is_nan());
        assert!(response.steady_error < 1e-9);
    }

    #[test]
    fn overshoot_is_what_goes_beyond_the_reference_in_the_direction_of_the_step() {
        let samples = samples(|t| if t < 1.0 { 0.27 } else { 0.31 });
        let response = response(&samples, 0.0, 1.0, 0.3, 0.035, |sample| {
            sample.wheel_rad_s[0]
        });
        assert!((response.overshoot - 0.03).abs() < 1e-9);
        assert!((response.steady_error - 0.01).abs() < 1e-9 && response.ripple < 1e-9);
    }

    #[test]
    fn a_reference_set_before_arming_counts_from_the_arming() {
        let at = |at_s, command| TimedCommand {
            at_s,
            command,
            after_reached: false,
            goal_of_world: false,
        };
        let commands = [
            at(0.2, Command::Reference(0.3)),
            at(0.5, Command::Arm),
            at(5.0, Command::Reference(0.5)),
            at(8.0, Command::Stop),
        ];
        let steps = steps(&commands, 9.0);
        let times: Vec<_> = steps
            .iter()
            .map(|step| (step.from_s, step.until_s))
            .collect();
        assert_eq!(times, [(0.5, 5.0), (5.0, 8.0)]);
    }
}
