//! Mode 6: straight on at a commanded wheel speed, by regulating the difference of distance travelled (memoria 4.2).
//!
//! ```text
//! distance of a wheel = angle x its radius          d = sum of (right - left) [m], the heading times the base
//! offset y = sum of (distance x d / base) [m]       d_ref = -base x ky x y, backward with the other sign, limited
//! yaw rate = kp (d_ref - d) / base                  at most a share of the speed
//! ```
//!
//! A positive d means that the right wheel has gone farther: the robot has turned left, a negative yaw rate takes it back, forward and
//! backward alike. The speed goes to its reference along a ramp that friction alone can follow downward, so that the wheels
//! stay regulated, and the robot straight, until it stands; a change of sign goes through zero.
//!
//! The report adds its correction, at most 5 rpm, to one wheel and uses one radius for both: wheels that differ by 1 %
//! drive an arc of 10 m radius. Ours scales each distance by the wheel's radius (`rumbo calibrate` finds their ratio),
//! corrects both wheels against each other so that their mean stays as commanded, and returns the robot to its line,
//! not only to its heading. Figures: docs/theory/straight_line.md.

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, TWIST, WHEEL_RAMPS, states};
use super::{
    Action, Description, Law, MAX_WHEEL_RAD_S, MetricGroup, Mode, ModePlot, ParamGroup, Reference,
    ReferenceDescription, ReferenceKind, SetpointError,
};
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min};
use crate::params::{ParamId, Params};
use crate::rig::Rigs;
use crate::types::{Drive, Fault, TICK_S, Wheels};
use core::f32::consts::TAU;

/// Description of mode 6.
pub const DESCRIPTION: Description = Description {
    number: 6,
    name: "straight_line",
    about: "straight on at a commanded speed",
    states: STATES,
    idle: None,
    reference: Some(REFERENCE),
    heading: true,
    takes: None,
    rigs: Rigs::ANY,
    parameters: &[
        ParamGroup::new(
            "straightening",
            &[ParamId::StraightKp, ParamId::StraightOffset],
        ),
        ParamGroup::new("ramp", &[ParamId::StraightAccel, ParamId::StraightDecel]),
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[LAWS, TWIST, SPEED],
    plots: &[ModePlot::Wheels, ModePlot::Heading, ModePlot::Position],
    metrics: &[MetricGroup::Drift],
};

/// Of the heading since it was armed, by the distances that the wheels rolled.
const LAWS: &[Law] = &[Law::new(
    "yaw_ref_rad_s",
    "clamp(straight_kp * (heading_ref_rad - heading_since_on_rad), \
     -0.6 * abs(forward_ref_m_s) / base_m, 0.6 * abs(forward_ref_m_s) / base_m)",
)
.with(&[ParamId::StraightOffset])
.only_in(&[Phase::Drive as u8, Phase::Stop as u8])];

/// Of both wheels; 40 rpm by default.
const REFERENCE: ReferenceDescription = ReferenceDescription::commanded(
    ReferenceKind::Speed,
    -MAX_WHEEL_RAD_S,
    MAX_WHEEL_RAD_S,
    TAU * 40.0 / 60.0,
);

states! {
    /// States of mode 6.
    enum Phase {
        /// Wheels released.
        #[default]
        Rest = "at rest" { Drive: "both wheels stand and the setpoint is not zero" }
        /// Ramp towards the setpoint.
        Drive = "drive" { Stop: "the setpoint is zero or has the other sign" }
        /// Ramp to zero, released below a creep.
        Stop = "stop" { Rest: "slow enough", Drive: "the setpoint has the old sign again" }
    }
}

/// Below this the wheels are released on the way to zero [rad/s]: 8 rpm, from where they roll out within millimetres.
const CREEP_RAD_S: f32 = 0.8;
/// Largest share of the wheels' speed for steering.
const STEERING_SHARE: f32 = 0.3;
/// Largest heading towards the line [rad].
const MOST_HEADING_RAD: f32 = 0.15;

/// Configuration of mode 6.
#[derive(Clone, Copy, Debug)]
pub struct StraightLine<'a> {
    /// Reference of both wheels [rad/s].
    speed_rad_s: f32,
    /// Distance between the wheels [m].
    base_m: f32,
    params: &'a Params,
}

/// State of mode 6.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    phase: Phase,
    /// The ramp [rad/s], signed.
    ramp_rad_s: f32,
    /// Distance of the right wheel minus that of the left one [m].
    difference_m: f32,
    /// Offset from the line, to the left positive [m].
    offset_m: f32,
}

impl StraightLine<'_> {
    /// Adds the distances rolled since the last tick.
    fn count(&self, state: &mut State, estimate: &Estimate) {
        let before_m = state.difference_m;
        state.difference_m += estimate.turned_rad * self.base_m;
        let middle_rad = 0.5 * (before_m + state.difference_m) / self.base_m;
        state.offset_m += estimate.rolled_m * middle_rad;
    }

    fn next_phase(&self, state: &State, standing: bool) -> Phase {
        let wanted = self.speed_rad_s != 0.0;
        let onward = self.speed_rad_s * state.ramp_rad_s > 0.0;
        match state.phase {
            Phase::Rest if standing && wanted => Phase::Drive,
            Phase::Drive if state.ramp_rad_s != 0.0 && !onward => Phase::Stop,
            Phase::Stop if abs(state.ramp_rad_s) < CREEP_RAD_S => Phase::Rest,
            Phase::Stop if onward => Phase::Drive,
            phase => phase,
        }
    }

    fn ramp(&self, state: &State) -> f32 {
        let before = state.ramp_rad_s;
        let target = match state.phase {
            Phase::Rest => return 0.0,
            Phase::Drive => self.speed_rad_s,
            Phase::Stop => 0.0,
        };
        let slope = self.params.get(if abs(target) > abs(before) {
            ParamId::StraightAccel
        } else {
            ParamId::StraightDecel
        });
        before + clamp(target - before, -slope * TICK_S, slope * TICK_S)
    }

    /// Heading that leads back to the line [rad].
    fn heading_ref_rad(&self, state: &State) -> f32 {
        let towards = -self.params.get(ParamId::StraightOffset) * state.offset_m;
        let towards = clamp(towards, -MOST_HEADING_RAD, MOST_HEADING_RAD);
        if state.ramp_rad_s < 0.0 {
            -towards
        } else {
            towards
        }
    }
}

impl<'a> Mode<'a> for StraightLine<'a> {
    /// [rad/s]
    type Setpoint = f32;
    type State = State;

    fn first() -> f32 {
        0.0
    }

    fn new(params: &'a Params, speed_rad_s: &f32) -> Self {
        Self {
            speed_rad_s: *speed_rad_s,
            base_m: params.geometry().base_m(),
            params,
        }
    }

    fn reference(speed_rad_s: &f32, _: &State) -> Reference {
        Reference::Wheels(Wheels::both(*speed_rad_s))
    }

    fn set_reference(speed_rad_s: &mut f32, value: f32) -> Result<(), SetpointError> {
        REFERENCE.check(value)?;
        *speed_rad_s = value;
        Ok(())
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        self.count(state, estimate);
        state.phase = self.next_phase(state, estimate.standing());
        state.ramp_rad_s = self.ramp(state);
        let heading_ref_rad = self.heading_ref_rad(state);
        let drive = match state.phase {
            Phase::Rest => Drive::Release,
            Phase::Drive | Phase::Stop => {
                let forward_m_s = self.params.geometry().mean_radius_m() * state.ramp_rad_s;
                let most = STEERING_SHARE * abs(forward_m_s) / (0.5 * self.base_m);
                let kp = self.params.get(ParamId::StraightKp);
                let yaw_rad_s = kp * (heading_ref_rad - state.difference_m / self.base_m);
                Drive::Twist {
                    forward_m_s,
                    yaw_rad_s: max(min(yaw_rad_s, most), -most),
                }
            }
        };
        Ok(Action {
            drive,
            state: state.phase as u8,
            heading_ref_rad,
            ..Action::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::speed::WheelMotion;
    use crate::types::Wheels;

    fn estimate(rolled_m: f32, turned_rad: f32, standing: bool) -> Estimate {
        Estimate {
            rolled_m,
            turned_rad,
            motion: Wheels::both(WheelMotion {
                standing,
                ..WheelMotion::default()
            }),
            ..Estimate::default()
        }
    }

    /// Ticks with the reference `speed_rad_s`; returns forward speed and yaw rate of the last one.
    fn run(state: &mut State, speed_rad_s: f32, estimate: &Estimate, ticks: u32) -> (f32, f32) {
        let params = Params::default();
        let mode = StraightLine::new(&params, &speed_rad_s);
        let mut last = (0.0, 0.0);
        for _ in 0..ticks {
            last = match mode.step(state, estimate).unwrap().drive {
                Drive::Twist {
                    forward_m_s,
                    yaw_rad_s,
                } => (forward_m_s, yaw_rad_s),
                _ => (0.0, 0.0),
            };
        }
        last
    }

    #[test]
    fn a_robot_that_has_turned_left_is_turned_right_forward_and_backward() {
        for speed_rad_s in [4.0, -4.0] {
            let mut state = State::default();
            run(&mut state, speed_rad_s, &estimate(0.0, 0.0, true), 100);
            let (forward, yaw) = run(&mut state, speed_rad_s, &estimate(0.0, 0.02, false), 1);
            assert!((forward - 0.0325 * speed_rad_s).abs() < 1e-4);
            assert!(yaw < 0.0, "{yaw}");
        }
    }

    #[test]
    fn a_robot_left_of_its_line_is_led_back_to_it_forward_and_backward() {
        for speed_rad_s in [4.0, -4.0] {
            let mut state = State::default();
            run(&mut state, speed_rad_s, &estimate(0.0, 0.0, true), 100);
            state.offset_m = 0.05;
            let (_, yaw) = run(&mut state, speed_rad_s, &estimate(0.0, 0.0, false), 1);
            assert!(yaw * speed_rad_s < 0.0, "{yaw} at {speed_rad_s}");
        }
    }

    #[test]
    fn both_wheels_go_as_far_as_each_other_not_as_fast() {
        // The difference of 1 cm remains until it is driven back, although the wheels have long been equally fast.
        let mut state = State::default();
        run(&mut state, 4.0, &estimate(0.0, 0.0, true), 100);
        run(&mut state, 4.0, &estimate(0.0, 0.1, false), 1);
        let (_, yaw) = run(&mut state, 4.0, &estimate(0.0, 0.0, false), 500);
        assert!(yaw < -0.1, "{yaw}");
    }

    #[test]
    fn a_reversal_slows_down_waits_for_rest_and_goes_the_other_way() {
        let mut state = State::default();
        run(&mut state, 4.0, &estimate(0.0, 0.0, true), 100);
        let rolling = estimate(0.001, 0.0, false);
        let (forward, _) = run(&mut state, -4.0, &rolling, 10);
        assert!(forward > 0.05 && forward < 0.13, "{forward}");
        assert_eq!(run(&mut state, -4.0, &rolling, 500), (0.0, 0.0));
        let (forward, _) = run(&mut state, -4.0, &estimate(0.0, 0.0, true), 100);
        assert!(forward < -0.12, "{forward}");
    }

    #[test]
    fn a_reference_taken_back_in_time_goes_on_without_a_stop() {
        let mut state = State::default();
        run(&mut state, 6.0, &estimate(0.0, 0.0, true), 100);
        let rolling = estimate(0.001, 0.0, false);
        let (slower, _) = run(&mut state, 0.0, &rolling, 20);
        let (faster, _) = run(&mut state, 6.0, &rolling, 20);
        assert!(slower > 0.0 && faster > slower, "{slower} {faster}");
    }

    #[test]
    fn steering_takes_a_share_of_the_speed_and_no_more() {
        let mut state = State::default();
        run(&mut state, 4.0, &estimate(0.0, 0.0, true), 100);
        let (forward, yaw) = run(&mut state, 4.0, &estimate(0.0, -3.0, false), 1);
        assert!(yaw > 0.0 && yaw * 0.05 <= 0.301 * forward, "{yaw}");
    }
}
