//! Mode 2: stop at a distance from the wall in front, square to it (memoria 2.2).
//!
//! ```text
//! wall: distance d from the wheels' axis along its normal, bearing b of the normal (from the sonars and the encoders: crate::wall)
//! e = d - (reference + sonars' place ahead of the axis)     |v| = as in mode 1, sign of e      yaw rate = kp b, limited
//! ```
//!
//! Too far is a positive error and drives forward; a normal to the left is a positive bearing and turns left. Turning
//! on the spot does not change d, so the two loops do not disturb each other: the robot squares up on the way, and
//! turns off any remaining angle on the spot. The reference is the distance from the sonars to the wall once the robot
//! is square to it.
//!
//! Rigs: the pair in front, or the final one, whose front sonar then looks ahead and aside in turn ([`crate::sweep`]).
//! The robot does not drive at anything that a sonar detects nearer than the wall.
//!
//! The report adds a PI of the angle to the PWM of one wheel, and computes the angle from the two latest readings
//! alone, with the old distance when they are equal. Ours tracks the angle with the encoders between the readings, so
//! it can drive at mode 1's speed and square up at the same time: 119 -> 30 cm in 2.2 s from 20 degrees askew instead
//! of 3.4, within a degree (`rumbo run mode2 --runs 20`). Derivation and figures: docs/theory/front_align.md.

use super::description::{
    FEEDFORWARD, SPEED, SPEED_LOOPS, TURNS, TWIST, WHEEL_RAMPS, states, turning,
};
use super::front_distance::{self, FrontDistance};
use super::{
    Action, Description, Law, MetricGroup, Mode, ModePlot, ParamGroup, Reference, SetpointError,
};
use crate::ahead::{Ahead, AheadState};
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, wrap_angle};
use crate::motion::{Turn, TurnState};
use crate::params::{ParamId, Params};
use crate::rig::{Rig, Rigs};
use crate::types::{Drive, Fault, TICK_S};
use crate::unrest::Unrest;
use crate::wall::WallEstimate;

/// Description of mode 2.
pub const DESCRIPTION: Description = Description {
    number: 2,
    name: "front_align",
    about: "stop square to the wall ahead, at a distance from it",
    states: STATES,
    idle: None,
    reference: Some(front_distance::REFERENCE),
    heading: true,
    takes: None,
    rigs: Rigs::of(&[Rig::FrontPair, Rig::Final]),
    parameters: &[
        ParamGroup::new(
            "angle to the wall",
            &[
                ParamId::AlignKp,
                ParamId::AlignTolerance,
                ParamId::SweepAside,
            ],
        ),
        front_distance::APPROACH,
        TURNS,
        SPEED_LOOPS,
        FEEDFORWARD,
        WHEEL_RAMPS,
    ],
    laws: &[LAWS, TWIST, SPEED],
    plots: &[ModePlot::Distance, ModePlot::Heading, ModePlot::Wheels],
    metrics: &[MetricGroup::Alignment],
};

/// [`FrontAlign::drive`], of the pair, whose readings are the wall's distance once it is square to it.
const LAWS: &[Law] = &[
    Law::new(
        "error_m",
        "(range_left_m + range_right_m) / 2 - reference_m",
    )
    .only_in(DRIVES),
    front_distance::SPEED_LAW.only_in(DRIVES),
    Law::new("most_rad_s", "min(abs(forward_ref_m_s) / base_m, 1.5)").only_in(DRIVES),
    Law::new(
        "yaw_ref_rad_s",
        "clamp(align_kp * heading_error_rad, -most_rad_s, most_rad_s)",
    )
    .only_in(DRIVES),
    turning(&[Phase::Turn as u8]),
];
const DRIVES: &[u8] = &[Phase::Approach as u8, Phase::Settle as u8];

states! {
    /// States of mode 2.
    enum Phase {
        /// Final rig: stands and looks to both sides.
        #[default]
        Look = "look" { Approach: "the bearing is known" }
        /// Drives, far from the reference.
        Approach = "approach" { Settle: "within 5 cm" }
        /// Drives, near the reference.
        Settle = "settle" {
            Approach: "beyond 6 cm",
            Turn: "within the tolerance, askew",
            Hold: "within the tolerance",
        }
        /// Turns on the spot.
        Turn = "turn" { Settle: "square" }
        /// Wheels released.
        Hold = "hold" {
            Approach: "beyond 6 cm",
            Settle: "beyond twice the tolerance for 0.15 s",
            Turn: "askew for 0.3 s",
        }
    }
}

/// Share of the tolerance beyond which a lasting angle is turned again.
const ASKEW_SHARE: f32 = 1.5;
/// How long the angle must be off to turn again [s].
const ASKEW_S: f32 = 0.3;
/// A sonar may measure the wall this much nearer than the reference [m], since the robot may be askew.
const NEARER_M: f32 = 0.03;
/// Largest yaw rate on the way [rad/s].
const YAW_RAD_S: f32 = 1.5;
/// Largest share of the wheels' speed for steering.
const STEERING_SHARE: f32 = 0.5;

/// Configuration of mode 2.
#[derive(Clone, Copy, Debug)]
pub struct FrontAlign<'a> {
    /// The speed towards the reference, as in mode 1.
    approach: FrontDistance<'a>,
    /// The sonars.
    ahead: Ahead<'a>,
    params: &'a Params,
}

/// State of mode 2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    phase: Phase,
    ahead: AheadState,
    turn: TurnState,
    /// How long distance and angle have been too far off to hold [s].
    off_s: f32,
    askew_s: f32,
    unrest: Unrest,
}

impl FrontAlign<'_> {
    /// The nearest thing and the wall.
    fn see(
        &self,
        state: &mut AheadState,
        estimate: &Estimate,
    ) -> Result<(f32, WallEstimate), Fault> {
        let nearest_m = self.ahead.nearest_m(estimate)?;
        Ok((nearest_m, self.ahead.wall(state, estimate)?))
    }

    fn next_phase(&self, state: &mut State, error_m: f32, bearing_rad: f32, turned: bool) -> Phase {
        let (off, askew) = (abs(error_m), abs(bearing_rad));
        let tolerance_rad = self.params.get(ParamId::AlignTolerance);
        let lasting = |time_s: f32, too_far: bool| if too_far { time_s + TICK_S } else { 0.0 };
        state.off_s = lasting(state.off_s, off > 2.0 * self.approach.tolerance_m);
        state.askew_s = lasting(state.askew_s, askew > ASKEW_SHARE * tolerance_rad);
        match state.phase {
            _ if !state.ahead.is_known() => Phase::Look,
            Phase::Look => Phase::Approach,
            Phase::Approach if off < front_distance::NEAR_M => Phase::Settle,
            Phase::Settle | Phase::Hold if off > front_distance::FAR_M => Phase::Approach,
            Phase::Settle if off < self.approach.tolerance_m => {
                if askew > tolerance_rad {
                    Phase::Turn
                } else {
                    Phase::Hold
                }
            }
            Phase::Turn if turned => Phase::Settle,
            Phase::Hold if state.off_s > front_distance::RESTART_S => Phase::Settle,
            Phase::Hold if state.askew_s > ASKEW_S => Phase::Turn,
            phase => phase,
        }
    }

    /// Drives towards the reference, turning to the wall's normal on the way; `free_m` is the clear distance ahead.
    fn drive(&self, error_m: f32, bearing_rad: f32, free_m: f32, uneasy: bool) -> Drive {
        let error_m = min(error_m, max(free_m, 0.0));
        if error_m == 0.0 {
            return Drive::Release;
        }
        let forward_m_s = self.approach.speed_m_s(error_m, uneasy);
        let most = min(
            STEERING_SHARE * abs(forward_m_s) / (0.5 * self.params.get(ParamId::Base)),
            YAW_RAD_S,
        );
        Drive::Twist {
            forward_m_s,
            yaw_rad_s: clamp(self.params.get(ParamId::AlignKp) * bearing_rad, -most, most),
        }
    }
}

impl<'a> Mode<'a> for FrontAlign<'a> {
    /// [m]
    type Setpoint = f32;
    type State = State;

    fn first() -> f32 {
        front_distance::DEFAULT_M
    }

    fn new(params: &'a Params, distance_m: &'a f32) -> Self {
        Self {
            approach: FrontDistance::new(params, distance_m),
            ahead: Ahead::new(params),
            params,
        }
    }

    fn is_ready(&self, estimate: &Estimate) -> bool {
        self.ahead.is_ready(estimate)
    }

    fn reference(distance_m: &f32, _: &State) -> Reference {
        Reference::Distance(*distance_m)
    }

    fn set_reference(distance_m: &mut f32, value: f32) -> Result<(), SetpointError> {
        FrontDistance::set_reference(distance_m, value)
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if let Some(reading) = &estimate.reading
            && self.ahead.watches(reading)
        {
            state.unrest.update(estimate, reading)?;
        }
        let (nearest_m, wall) = self
            .see(&mut state.ahead, estimate)
            .map_err(|fault| state.unrest.cause(fault))?;
        let error_m = wall.distance_m - self.ahead.ahead_m() - self.approach.distance_m;
        let free_m = nearest_m - self.approach.distance_m + NEARER_M;
        let heading_ref_rad = wrap_angle(estimate.pose.heading_rad + wall.bearing_rad);

        let turn = match state.phase {
            Phase::Turn => {
                let turn = Turn::new(self.params);
                Some(turn.step(&mut state.turn, estimate, heading_ref_rad))
            }
            _ => None,
        };
        let turned = turn.is_some_and(|turn| turn.done);
        let phase = self.next_phase(state, error_m, wall.bearing_rad, turned);
        if phase != state.phase {
            state.turn = TurnState::default();
            state.phase = phase;
        }
        let drive = match phase {
            Phase::Look | Phase::Hold => Drive::Release,
            Phase::Approach | Phase::Settle => {
                let uneasy = state.unrest.is_uneasy();
                self.drive(error_m, wall.bearing_rad, free_m, uneasy)
            }
            Phase::Turn => turn.map_or(Drive::Release, |turn| turn.drive),
        };
        let resting = phase == Phase::Hold;
        let look = self
            .ahead
            .look(&mut state.ahead, estimate, wall.bearing_rad, resting);
        Ok(Action {
            drive,
            look,
            state: phase as u8,
            heading_ref_rad,
            reached: resting,
            ..Action::default()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{params, twist, with_ranges_m};
    use crate::types::Range;

    /// A tick of the pair.
    fn step(state: &mut State, left_m: f32, right_m: f32) -> Result<Action, Fault> {
        let estimate = &with_ranges_m([left_m, right_m, 0.0]);
        FrontAlign::new(&params(Rig::FrontPair), &0.3).step(state, estimate)
    }

    #[test]
    fn too_far_drives_forward_too_near_backward_and_both_turn_to_the_walls_normal() {
        for (middle_m, sign) in [(1.0, 1.0), (0.2, -1.0)] {
            let left_nearer =
                step(&mut State::default(), middle_m - 0.01, middle_m + 0.01).unwrap();
            let (forward_m_s, yaw_rad_s) = twist(left_nearer.drive);
            assert!(
                sign * forward_m_s > 0.1 && yaw_rad_s > 0.1,
                "{left_nearer:?}"
            );
            let square = step(&mut State::default(), middle_m, middle_m).unwrap();
            assert_eq!(twist(square.drive).1, 0.0);
        }
    }

    #[test]
    fn at_the_distance_it_turns_on_the_spot_and_once_square_it_holds() {
        let mut state = State::default();
        step(&mut state, 0.31, 0.33).unwrap();
        step(&mut state, 0.31, 0.33).unwrap();
        state.ahead = AheadState::default();
        // 0.3 m from the axis plus the sonars' place, askew by 0.1 rad.
        let askew = (0.43 - 0.13 * 0.995, 0.06 * 0.1);
        let turning = step(&mut state, askew.0 - askew.1, askew.0 + askew.1).unwrap();
        assert_eq!(turning.state, Phase::Turn as u8);
        let turning = step(&mut state, askew.0 - askew.1, askew.0 + askew.1).unwrap();
        let (forward_m_s, yaw_rad_s) = twist(turning.drive);
        assert!(forward_m_s == 0.0 && yaw_rad_s > 0.3, "{turning:?}");
        let mut square = State {
            phase: Phase::Settle,
            ..State::default()
        };
        let held = step(&mut square, 0.3, 0.3).unwrap();
        assert_eq!((held.drive, held.reached), (Drive::Release, true));
    }

    #[test]
    fn what_stands_nearer_than_the_wall_is_not_driven_at() {
        let mut state = State::default();
        assert!(twist(step(&mut state, 1.0, 1.0).unwrap().drive).0 > 0.3);
        for left_m in [0.28, 0.2, 0.05] {
            let (forward_m_s, _) = twist(step(&mut state, left_m, 1.0).unwrap().drive);
            assert!(forward_m_s <= 0.1, "{forward_m_s} at {left_m}");
        }
        assert_eq!(step(&mut state, 0.2, 1.0).unwrap().drive, Drive::Release);
    }

    #[test]
    fn it_is_ready_only_when_every_sonar_it_needs_sees_the_wall() {
        let ready = |rig, ranges_m| Ahead::new(&params(rig)).is_ready(&with_ranges_m(ranges_m));
        assert!(ready(Rig::FrontPair, [1.0, 1.0, 0.0]));
        assert!(!ready(Rig::FrontPair, [1.0, 0.0, 1.0]));
        assert!(ready(Rig::Final, [0.0, 0.0, 1.0]));
        assert!(!ready(Rig::Final, [1.0, 1.0, 0.0]));
    }

    #[test]
    fn it_never_drives_on_a_stale_lost_or_silent_sonar() {
        let mut old = with_ranges_m([1.0, 1.0, 0.0]);
        old.ranges[1].age_ticks = 60;
        let mut silent = with_ranges_m([1.0, 1.0, 0.0]);
        silent.ranges[0].range = Range::Faulty;
        for (estimate, fault) in [
            (old, Fault::SonarStale),
            (with_ranges_m([1.0, 0.0, 0.0]), Fault::WallLost),
            (silent, Fault::SonarFaulty),
        ] {
            let stopped = FrontAlign::new(&params(Rig::FrontPair), &0.3)
                .step(&mut State::default(), &estimate);
            assert_eq!(stopped, Err(fault));
        }
    }

    #[test]
    fn with_one_sonar_on_the_servo_it_first_stands_and_looks_aside() {
        let params = params(Rig::Final);
        let (mut state, mode) = (State::default(), FrontAlign::new(&params, &0.3));
        let estimate = &with_ranges_m([0.0, 0.0, 1.0]);
        let first = mode.step(&mut state, estimate).unwrap();
        assert_eq!((first.drive, first.state), (Drive::Release, 0));
        assert!(first.look.servo.0.abs() > 0.5, "{:?}", first.look);
    }
}
