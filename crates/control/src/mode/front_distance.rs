//! Mode 1: stop at a distance from the wall in front (memoria 2.1).
//!
//! distance error e [m] -> forward speed [m/s] -> wheel-speed loops. Too far is a positive error: drive forward.
//!
//! ```text
//! |v| = min(cruise, sqrt(2 a |e|), kp |e|), at least the slowest steady speed       v has the sign of e
//! ```
//!
//! The root is the speed from which the planned deceleration `a` stops at the reference; near it, where the root is
//! steep, the proportional law is slower and takes over. Within the tolerance the wheels are released; friction, not
//! power, holds the robot, and only a lasting error restarts it. A heading loop on the odometry keeps it straight.
//!
//! The report controls the PWM by the distance, proportional far and PI near, around a PWM at which the robot just
//! moves. Ours has inner speed loops, so the same approach works on any floor and battery, and brakes as late as
//! friction allows. Worst of 20 simulated robots against the real one: 107 -> 30 cm in 2.0 s instead of 3.0, 30 -> 50
//! cm in 1.03 s instead of 1.2 (`rumbo run mode1 --runs 20`).
//!
//! A sonar with many outliers slows the robot, then stops it ([`crate::unrest`]). Derivation, margins and figures:
//! docs/theory/front_distance.md.

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, TWIST, WHEEL_RAMPS, states};
use super::{
    Action, Description, Law, MAX_DISTANCE_M, MIN_DISTANCE_M, MetricGroup, Mode, ModePlot,
    ParamGroup, Reference, ReferenceDescription, ReferenceKind, SetpointError,
};
use crate::ahead::drivable_m;
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, sqrt};
use crate::params::{ParamId, Params};
use crate::rig::{Rig, Rigs};
use crate::types::{Drive, Fault, Look, SonarId, TICK_S};
use crate::unrest::Unrest;

/// Description of mode 1.
pub const DESCRIPTION: Description = Description {
    number: 1,
    name: "front_distance",
    about: "stop at a distance from the wall ahead",
    states: STATES,
    idle: None,
    reference: Some(REFERENCE),
    heading: false,
    takes: None,
    rigs: Rigs::of(&[Rig::FrontSingle, Rig::Final]),
    parameters: &[
        APPROACH,
        ParamGroup::new("straightening", &[ParamId::FrontHeading]),
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[LAWS, TWIST, SPEED],
    plots: &[ModePlot::Distance, ModePlot::Wheels, ModePlot::Pwm],
    metrics: &[MetricGroup::DistanceSteps],
};

/// Of the distance, in mode 2 too.
pub(super) const REFERENCE: ReferenceDescription = ReferenceDescription::commanded(
    ReferenceKind::Distance,
    MIN_DISTANCE_M,
    MAX_DISTANCE_M,
    DEFAULT_M,
);

/// Approach to the distance, in mode 2 too.
pub(super) const APPROACH: ParamGroup = ParamGroup::new(
    "approach to the wall",
    &[
        ParamId::FrontCruise,
        ParamId::FrontKp,
        ParamId::FrontBrake,
        ParamId::FrontTolerance,
    ],
);

/// [`FrontDistance::speed_m_s`]; a sonar in doubt makes it slower.
const LAWS: &[Law] = &[
    Law::new("error_m", "range_front_m - reference_m"),
    SPEED_LAW,
];
/// In mode 2 too.
pub(super) const SPEED_LAW: Law = Law::new(
    "forward_ref_m_s",
    "sign(error_m) * max(0.03, min(front_cruise_m_s, \
     sqrt(2 * front_brake_m_s2 * abs(error_m)), front_kp * abs(error_m)))",
);

states! {
    /// States of mode 1.
    enum Phase {
        /// Drives, far from the reference.
        #[default]
        Approach = "approach" { Settle: "within 5 cm" }
        /// Drives, near the reference.
        Settle = "settle" { Approach: "beyond 6 cm", Hold: "within the tolerance" }
        /// Wheels released.
        Hold = "hold" { Approach: "beyond 6 cm", Settle: "beyond twice the tolerance for 0.15 s" }
    }
}

/// Reference before the first command [m], as in the report.
pub const DEFAULT_M: f32 = 0.30;
/// Distance error at which *near* begins [m].
pub(super) const NEAR_M: f32 = 0.05;
/// Distance error at which it ends again [m].
pub(super) const FAR_M: f32 = 0.06;
/// Slowest speed that the wheels hold steadily [m/s].
const CREEP_M_S: f32 = 0.03;
/// How long an error must last to start the robot again [s].
pub(super) const RESTART_S: f32 = 0.15;
/// Share of the cruise speed with a sonar that has many outliers ([`crate::unrest`]).
const UNEASY_SHARE: f32 = 0.3;
/// Largest share of the wheels' speed for straightening.
const STEERING_SHARE: f32 = 0.3;

/// Configuration of mode 1.
#[derive(Clone, Copy, Debug)]
pub struct FrontDistance<'a> {
    /// Reference [m].
    pub distance_m: f32,
    /// Error within which the wheels are released [m].
    pub tolerance_m: f32,
    params: &'a Params,
}

/// State of mode 1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    phase: Phase,
    /// Heading at the start [rad].
    heading_rad: Option<f32>,
    /// How long the error has been too large to hold [s].
    off_s: f32,
    unrest: Unrest,
}

impl FrontDistance<'_> {
    fn range_m(&self, estimate: &Estimate) -> Result<f32, Fault> {
        let stale_s = self.params.get(ParamId::StaleRange);
        drivable_m(estimate.range(SonarId::Front), stale_s)
    }

    fn next_phase(&self, state: &mut State, error_m: f32) -> Phase {
        let off = abs(error_m);
        state.off_s = if off > 2.0 * self.tolerance_m {
            state.off_s + TICK_S
        } else {
            0.0
        };
        match state.phase {
            Phase::Approach if off < NEAR_M => Phase::Settle,
            Phase::Settle | Phase::Hold if off > FAR_M => Phase::Approach,
            Phase::Settle if off < self.tolerance_m => Phase::Hold,
            Phase::Hold if state.off_s > RESTART_S => Phase::Settle,
            phase => phase,
        }
    }

    /// The speed at a distance error, slow while a sonar has many outliers (`uneasy`).
    pub(super) fn speed_m_s(&self, error_m: f32, uneasy: bool) -> f32 {
        let off = abs(error_m);
        let braking = sqrt(2.0 * self.params.get(ParamId::FrontBrake) * off);
        let share = if uneasy { UNEASY_SHARE } else { 1.0 };
        let cruise = share * self.params.get(ParamId::FrontCruise);
        let near = self.params.get(ParamId::FrontKp) * off;
        let speed = max(min(min(cruise, braking), near), CREEP_M_S);
        if error_m < 0.0 { -speed } else { speed }
    }
}

impl<'a> Mode<'a> for FrontDistance<'a> {
    /// [m]
    type Setpoint = f32;
    type State = State;

    const LOOK: Look = Look::only(SonarId::Front);

    fn first() -> f32 {
        DEFAULT_M
    }

    fn new(params: &'a Params, distance_m: &f32) -> Self {
        Self {
            distance_m: *distance_m,
            tolerance_m: params.get(ParamId::FrontTolerance),
            params,
        }
    }

    fn is_ready(&self, estimate: &Estimate) -> bool {
        self.range_m(estimate).is_ok()
    }

    fn reference(distance_m: &f32, _: &State) -> Reference {
        Reference::Distance(*distance_m)
    }

    fn set_reference(distance_m: &mut f32, value: f32) -> Result<(), SetpointError> {
        REFERENCE.check(value)?;
        *distance_m = value;
        Ok(())
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if let Some(reading) = &estimate.reading
            && reading.sonar == SonarId::Front
        {
            state.unrest.update(estimate, reading)?;
        }
        let range_m = self
            .range_m(estimate)
            .map_err(|fault| state.unrest.cause(fault))?;
        let error_m = range_m - self.distance_m;
        state.phase = self.next_phase(state, error_m);

        let heading_rad = estimate.pose.heading_rad;
        let start_rad = *state.heading_rad.get_or_insert(heading_rad);
        let drive = match state.phase {
            Phase::Hold => Drive::Release,
            Phase::Approach | Phase::Settle => {
                let forward_m_s = self.speed_m_s(error_m, state.unrest.is_uneasy());
                let half_base_m = 0.5 * self.params.get(ParamId::Base);
                let most = STEERING_SHARE * abs(forward_m_s) / half_base_m;
                let error_rad = crate::math::wrap_angle(start_rad - heading_rad);
                Drive::Twist {
                    forward_m_s,
                    yaw_rad_s: clamp(
                        self.params.get(ParamId::FrontHeading) * error_rad,
                        -most,
                        most,
                    ),
                }
            }
        };
        Ok(Action {
            drive,
            look: Self::LOOK,
            state: state.phase as u8,
            reached: state.phase == Phase::Hold,
            ..Action::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::{AgedRange, Range};

    fn estimate(range: Range, age_ticks: u16) -> Estimate {
        let mut estimate = Estimate::default();
        estimate.ranges[SonarId::Front as usize] = AgedRange { range, age_ticks };
        estimate
    }

    fn step(state: &mut State, range: Range, age_ticks: u16) -> Result<Action, Fault> {
        let params = Params::default();
        let mode = FrontDistance::new(&params, &0.3);
        mode.step(state, &estimate(range, age_ticks))
    }

    fn forward(state: &mut State, range_m: f32) -> f32 {
        match step(state, Range::Valid(range_m), 0).unwrap().drive {
            Drive::Twist { forward_m_s, .. } => forward_m_s,
            _ => 0.0,
        }
    }

    #[test]
    fn too_far_drives_forward_and_too_near_backward() {
        assert!(forward(&mut State::default(), 1.0) > 0.3);
        assert!(forward(&mut State::default(), 0.15) < -0.2);
    }

    #[test]
    fn the_planned_speed_can_be_braked_before_the_reference() {
        let params = Params::default();
        let brake = params.get(ParamId::FrontBrake);
        for millimetres in 2..700u16 {
            let error_m = f32::from(millimetres) * 1e-3;
            let v = forward(&mut State::default(), 0.3 + error_m);
            assert!(
                v <= CREEP_M_S || v * v / (2.0 * brake) <= error_m * 1.000_1,
                "{v} m/s at {error_m} m"
            );
        }
    }

    #[test]
    fn at_the_reference_the_wheels_are_released_and_only_a_lasting_error_starts_them() {
        let mut state = State::default();
        step(&mut state, Range::Valid(0.34), 0).unwrap();
        let held = step(&mut state, Range::Valid(0.3005), 0).unwrap();
        assert_eq!(
            (held.drive, held.reached, held.state),
            (Drive::Release, true, 2)
        );
        for _ in 0..10 {
            assert_eq!(forward(&mut state, 0.305), 0.0);
        }
        assert_eq!(forward(&mut state, 0.3), 0.0);
        let moved = (0..30).any(|_| forward(&mut state, 0.305) > 0.0);
        assert!(moved);
    }

    #[test]
    fn it_never_drives_on_a_stale_lost_or_absurd_range() {
        let mut state = State::default();
        assert_eq!(
            step(&mut state, Range::Valid(1.0), 60),
            Err(Fault::SonarStale)
        );
        assert_eq!(step(&mut state, Range::Clear, 0), Err(Fault::WallLost));
        assert_eq!(step(&mut state, Range::Faulty, 0), Err(Fault::SonarFaulty));
    }

    #[test]
    fn it_steers_back_to_the_heading_it_started_with() {
        let params = Params::default();
        let mode = FrontDistance::new(&params, &0.3);
        let mut state = State::default();
        let mut estimate = estimate(Range::Valid(1.0), 0);
        mode.step(&mut state, &estimate).unwrap();
        estimate.pose.heading_rad = 0.1;
        match mode.step(&mut state, &estimate).unwrap().drive {
            Drive::Twist { yaw_rad_s, .. } => assert!(yaw_rad_s < 0.0),
            other => panic!("{other:?}"),
        }
    }
}
