//! Mode 4: follow a wall at a commanded distance (memoria 3.2).
//!
//! distance error e [m] -> angle towards the wall a [rad] -> yaw rate [rad/s] -> wheel-speed loops:
//!
//! ```text
//! e = d - d_ref                                 a_ref = kp e / cruise + integral(ki e)  within +-heading limit
//! yaw = side (heading_kp (a_ref - a)) - damping yaw_enc                                  within +-yaw limit
//! forward = cruise, less where the outer wheel or the path ahead requires it
//! ```
//!
//! d is the distance from the middle of the side sonars (`sonar_side_x_m`, +-`sonar_side_y_m`) to the wall, along its normal. a is
//! positive when the robot drives towards the wall, on either side; `side` is 1 for a wall on the left, -1 on the right. Too far is a
//! positive error and turns the robot towards the wall. Both are estimated by [`crate::wall`] from the pair, or from one sonar and the
//! encoders on the final rig, which follows the wall that is nearer at the start and looks ahead with its front sonar.
//!
//! The integral is frozen while the angle or the yaw rate is limited; steering has priority over speed where a wheel is
//! at its limit. The mode stops with a fault when the wall ends (wall lost), a sonar is silent or stale, or, on the
//! final rig, something is ahead (blocked).
//!
//! The report closes the same cascade with PI controllers that act on the PWM of one wheel. Ours regulates the yaw rate, damped by the
//! encoders, and estimates angle and distance with the encoders' help. Worst of 20 simulated robots against the real one, to within
//! 2 cm: 59 -> 50 cm in 1.6 s instead of 7.1, 50 -> 30 cm in 3.2 s instead of 6.3, 30 -> 40 cm in 1.6 s instead of 9.0
//! (`rumbo run mode4 --runs 20`). Derivation and margins: docs/theory/wall_follow.md.

use super::description::{FEEDFORWARD, SPEED, SPEED_LOOPS, TWIST, WHEEL_RAMPS, states};
use super::{
    Action, DEFAULT_WALL_M, Description, Law, MAX_WALL_M, MIN_WALL_M, MetricGroup, Mode, ModePlot,
    ParamGroup, Reference, ReferenceDescription, ReferenceKind, SetpointError,
};
#[cfg(not(target_arch = "avr"))]
use super::{ModeTerms, WallTerms};
use crate::beside::Beside;
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, sqrt, wrap_angle};
use crate::params::{ParamId, Params};
use crate::range::{MIN_RANGE_M, REACH_M};
use crate::rig::{Rig, Rigs};
use crate::types::{Drive, Fault, Range, Side, SonarId, TICK_S};
use crate::unrest::Unrest;
use crate::wall::{WallEstimate, WallFilter};
use core::f32::consts::FRAC_PI_2;

/// Description of mode 4.
pub const DESCRIPTION: Description = Description {
    number: 4,
    name: "wall_follow",
    about: "follow a wall at a commanded distance",
    states: STATES,
    idle: None,
    reference: Some(REFERENCE),
    heading: true,
    takes: None,
    rigs: Rigs::of(&[Rig::SidePairLeft, Rig::SidePairRight, Rig::Final]),
    parameters: &[
        ParamGroup::new("along the wall", &[ParamId::WallCruise, ParamId::WallStop]),
        ParamGroup::new(
            "distance to the wall",
            &[ParamId::WallKp, ParamId::WallKi, ParamId::WallHeadingLimit],
        ),
        ParamGroup::new(
            "angle to the wall",
            &[
                ParamId::WallHeadingKp,
                ParamId::WallDamping,
                ParamId::WallYawLimit,
            ],
        ),
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[LAWS, TWIST, SPEED],
    plots: &[ModePlot::Distance, ModePlot::Heading, ModePlot::Wheels],
    metrics: &[MetricGroup::Wall],
};

/// Of the distance.
pub(super) const REFERENCE: ReferenceDescription = ReferenceDescription::commanded(
    ReferenceKind::Distance,
    MIN_WALL_M,
    MAX_WALL_M,
    DEFAULT_WALL_M,
);

/// The angle is limited more where the wall's is poorly known, the yaw rate where the inner wheel would stick.
pub(super) const LAWS: &[Law] = &[
    Law::new(
        "heading_ref_rad",
        "clamp(distance_p_rad + distance_i_rad, -wall_heading_limit_rad, wall_heading_limit_rad)",
    )
    .with(&[ParamId::WallKp, ParamId::WallKi, ParamId::WallCruise]),
    Law::new(
        "yaw_ref_rad_s",
        "clamp(heading_p_rad_s + heading_d_rad_s, -wall_yaw_limit_rad_s, wall_yaw_limit_rad_s)",
    )
    .with(&[ParamId::WallHeadingKp, ParamId::WallDamping]),
];

states! {
    /// States of modes 3 and 4.
    pub(super) enum Phase {
        /// Mode 3 only: stands and measures the distance.
        #[default]
        Measure = "measure" { Approach: "the distance is known, far from it", Follow: "the distance is known" }
        /// Drives at the angle limit, on the way to another distance.
        Approach = "approach" { Follow: "near the distance", Slow: "something ahead, or a sonar in doubt" }
        /// Keeps the distance.
        Follow = "follow" { Approach: "far from the distance", Slow: "something ahead, or a sonar in doubt" }
        /// The same, slower: something stands ahead, or a sonar is in doubt.
        Slow = "slow" { Approach: "clear again, far from the distance", Follow: "clear again" }
    }
}

/// How far off parallel the robot may start, one standard deviation [rad].
const ASKEW_RAD: f32 = 0.2;
/// Slowest that the inner wheel turns in a bend [m/s]: below, friction makes it stick.
const INNER_M_S: f32 = 0.02;
/// Share of the angle limit given up per standard deviation of the angle: it does not turn far towards a poorly known
/// wall.
const DOUBT: f32 = 2.0;
/// Largest wheel speed requested [m/s].
const OUTER_M_S: f32 = 0.6;
/// Limit of the integral [rad].
const INTEGRAL_RAD: f32 = 0.1;
/// Distance error within which the integral acts [m].
const INTEGRAL_M: f32 = 0.03;
/// Deceleration planned before something ahead [m/s^2].
const BRAKE_M_S2: f32 = 0.15;
/// Slowest approach of something ahead [m/s].
const CREEP_M_S: f32 = 0.03;
/// Error and angle within which the reference counts as reached [m], [rad].
const REACHED: (f32, f32) = (0.01, 0.06);

/// Configuration of mode 4.
#[derive(Clone, Copy, Debug)]
pub struct WallFollow<'a> {
    /// Reference [m].
    distance_m: f32,
    /// Speed along the wall [m/s].
    cruise_m_s: f32,
    /// Oldest range to drive on [s].
    pub(super) stale_s: f32,
    /// The sonars.
    pub(super) sonars: Beside<'a>,
    params: &'a Params,
}

/// State of mode 4.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    side: Option<Side>,
    wall: WallFilter,
    integral_rad: f32,
    unrest: Unrest,
}

/// 1 for the left, -1 for the right.
fn sign(side: Side) -> f32 {
    match side {
        Side::Left => 1.0,
        Side::Right => -1.0,
    }
}

impl WallFollow<'_> {
    /// Half angle of a sonar's beam [rad].
    fn beam_rad(&self) -> f32 {
        self.params.get(ParamId::Beam)
    }

    /// Predicts the wall and corrects it by the reading of this tick.
    fn estimate(
        &self,
        state: &mut State,
        side: Side,
        at: &Estimate,
    ) -> Result<WallEstimate, Fault> {
        if !state.wall.is_known() {
            self.begin(state, side, at)?;
        } else {
            state.wall.predict(at.rolled_m, at.turned_rad);
            if let Some(reading) = at.reading
                && let Range::Valid(range_m) = reading.range
                && self.sonars.watches(side, reading.sonar)
            {
                state.wall.update(&reading.view, self.beam_rad(), range_m);
            }
        }
        state.wall.wall().ok_or(Fault::WallLost)
    }

    /// Starts the estimate from the ranges that were filtered while the robot stood.
    fn begin(&self, state: &mut State, side: Side, at: &Estimate) -> Result<(), Fault> {
        let mut started = false;
        for &sonar in &[SonarId::Left, SonarId::Right] {
            if !self.sonars.watches(side, sonar) {
                continue;
            }
            let view = self.sonars.view(sonar);
            let Range::Valid(range_m) = at.range(sonar).range else {
                return Err(Fault::WallLost);
            };
            if started {
                state.wall.update(&view, self.beam_rad(), range_m);
            } else {
                let parallel_rad = sign(side) * FRAC_PI_2;
                state.wall.start(&view, range_m, parallel_rad, ASKEW_RAD);
                started = true;
            }
        }
        Ok(())
    }

    /// Distance of the measuring point from the wall [m] and the angle towards the wall [rad].
    fn distance_and_angle(&self, side: Side, wall: &WallEstimate) -> (f32, f32) {
        let (x_m, y_m) = self.sonars.point_m(side);
        let (sin, cos) = wall.facing;
        let angle_rad = wrap_angle(FRAC_PI_2 - sign(side) * wall.bearing_rad);
        (wall.distance_m - x_m * cos - y_m * sin, angle_rad)
    }

    /// The largest speed that the path ahead and the sonars allow [m/s].
    fn free_m_s(&self, state: &State, at: &Estimate) -> Result<f32, Fault> {
        let cruise_m_s = if state.unrest.is_uneasy() {
            0.5 * self.cruise_m_s
        } else {
            self.cruise_m_s
        };
        if !self.sonars.looks_ahead() {
            return Ok(cruise_m_s);
        }
        let ahead = at.range(SonarId::Front);
        let stop_m = self.params.get(ParamId::WallStop);
        match ahead.range {
            _ if ahead.is_older(self.stale_s) => Err(Fault::SonarStale),
            Range::Faulty => Err(Fault::SonarFaulty),
            Range::Clear => Ok(cruise_m_s),
            Range::Valid(ahead_m) if ahead_m <= stop_m => Err(Fault::Blocked),
            Range::Valid(ahead_m) => {
                let free = sqrt(2.0 * BRAKE_M_S2 * (ahead_m - stop_m));
                Ok(min(max(free, CREEP_M_S), cruise_m_s))
            }
        }
    }

    /// The angle towards the wall that the distance error calls for [rad], and whether it is limited.
    fn angle_ref_rad(&self, state: &State, error_m: f32, angle_sd_rad: f32) -> (f32, bool) {
        let free_rad =
            self.params.get(ParamId::WallKp) / self.cruise_m_s * error_m + state.integral_rad;
        let most_rad = self.params.get(ParamId::WallHeadingLimit);
        let limit_rad = max(most_rad - DOUBT * angle_sd_rad, 0.0);
        (
            clamp(free_rad, -limit_rad, limit_rad),
            abs(free_rad) > limit_rad,
        )
    }
}

#[cfg(not(target_arch = "avr"))]
impl WallFollow<'_> {
    /// What both loops add up at this distance [m], with the integral as the next tick adds it.
    pub(super) fn terms_at(
        &self,
        state: &State,
        at: &Estimate,
        reference_m: f32,
    ) -> Option<ModeTerms> {
        let (side, wall) = (state.side?, state.wall.wall()?);
        let gain = |id| self.params.get(id);
        let (distance_m, angle_rad) = self.distance_and_angle(side, &wall);
        let error_m = distance_m - reference_m;
        let (angle_ref_rad, _) = self.angle_ref_rad(state, error_m, wall.bearing_sd_rad());
        let off_rad = angle_ref_rad - angle_rad;
        Some(ModeTerms::Wall(WallTerms {
            distance_p_rad: sign(side) * gain(ParamId::WallKp) / self.cruise_m_s * error_m,
            distance_i_rad: sign(side) * state.integral_rad,
            heading_p_rad_s: sign(side) * gain(ParamId::WallHeadingKp) * off_rad,
            heading_d_rad_s: -gain(ParamId::WallDamping) * at.yaw_rad_s,
        }))
    }
}

/// Setpoints relative to the wall.
struct Aim {
    /// Distance minus its reference [m].
    error_m: f32,
    /// Angle to turn towards the wall [rad].
    off_rad: f32,
    /// The angle is limited.
    far: bool,
}

impl WallFollow<'_> {
    /// The state for a distance error, and the speed limit in it.
    fn drive(
        &self,
        state: &mut State,
        side: Side,
        at: &Estimate,
        reference_m: f32,
    ) -> Result<Action, Fault> {
        self.sonars.nearest_m(side, at, self.stale_s)?;
        let wall = self.estimate(state, side, at)?;
        let free_m_s = self.free_m_s(state, at)?;
        let (distance_m, angle_rad) = self.distance_and_angle(side, &wall);
        let error_m = distance_m - reference_m;
        let (angle_ref_rad, far) = self.angle_ref_rad(state, error_m, wall.bearing_sd_rad());
        let aim = Aim {
            error_m,
            off_rad: angle_ref_rad - angle_rad,
            far,
        };
        let drive = self.steer(state, side, at, &aim, free_m_s);
        let phase = match (free_m_s < self.cruise_m_s, far) {
            (true, _) => Phase::Slow,
            (false, true) => Phase::Approach,
            (false, false) => Phase::Follow,
        };
        Ok(Action {
            drive,
            state: phase as u8,
            heading_ref_rad: sign(side) * angle_ref_rad,
            reached: abs(error_m) < REACHED.0 && abs(angle_rad) < REACHED.1,
            ..Action::default()
        })
    }

    fn steer(
        &self,
        state: &mut State,
        side: Side,
        at: &Estimate,
        aim: &Aim,
        free_m_s: f32,
    ) -> Drive {
        let turn_rad_s = self.params.get(ParamId::WallHeadingKp) * aim.off_rad;
        let damping = self.params.get(ParamId::WallDamping);
        let wanted_rad_s = sign(side) * turn_rad_s - damping * at.yaw_rad_s;
        let half_base_m = 0.5 * self.params.get(ParamId::Base);
        let bend_rad_s = max(free_m_s - INNER_M_S, 0.0) / half_base_m;
        let most_rad_s = min(self.params.get(ParamId::WallYawLimit), bend_rad_s);
        let yaw_rad_s = clamp(wanted_rad_s, -most_rad_s, most_rad_s);
        if !aim.far && abs(wanted_rad_s) <= most_rad_s && abs(aim.error_m) < INTEGRAL_M {
            let integral_rad =
                state.integral_rad + self.params.get(ParamId::WallKi) * aim.error_m * TICK_S;
            state.integral_rad = clamp(integral_rad, -INTEGRAL_RAD, INTEGRAL_RAD);
        }
        let steerable_m_s = max(OUTER_M_S - half_base_m * abs(yaw_rad_s), 0.0);
        Drive::Twist {
            forward_m_s: min(free_m_s, steerable_m_s),
            yaw_rad_s,
        }
    }
}

impl WallFollow<'_> {
    /// One tick at this distance [m].
    pub(super) fn keep(
        &self,
        state: &mut State,
        estimate: &Estimate,
        reference_m: f32,
    ) -> Result<Action, Fault> {
        let side = match state.side {
            Some(side) => side,
            None => {
                let nearer = self.sonars.side(estimate, self.stale_s);
                nearer.ok_or(Fault::WallLost)?
            }
        };
        state.side = Some(side);
        if let Some(reading) = &estimate.reading
            && (reading.sonar == SonarId::Front || self.sonars.watches(side, reading.sonar))
        {
            state.unrest.update(estimate, reading)?;
        }
        self.drive(state, side, estimate, reference_m)
            .map_err(|fault| state.unrest.cause(fault))
    }
}

impl<'a> Mode<'a> for WallFollow<'a> {
    /// [m]
    type Setpoint = f32;
    type State = State;

    fn first() -> f32 {
        DEFAULT_WALL_M
    }

    fn new(params: &'a Params, distance_m: &f32) -> Self {
        Self {
            distance_m: *distance_m,
            cruise_m_s: params.get(ParamId::WallCruise),
            stale_s: params.get(ParamId::StaleRange),
            sonars: Beside::new(params),
            params,
        }
    }

    fn is_ready(&self, estimate: &Estimate) -> bool {
        let reach = (MIN_RANGE_M, REACH_M);
        self.sonars.is_ready(estimate, self.stale_s, reach)
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
        self.keep(state, estimate, self.distance_m)
    }

    #[cfg(not(target_arch = "avr"))]
    fn terms(&self, state: &State, estimate: &Estimate) -> Option<ModeTerms> {
        self.terms_at(state, estimate, self.distance_m)
    }
}

#[cfg(test)]
mod tests;
