//! Follow a lane of boxes: straight on, and a quarter turn to the open side before each face (memoria 5).
//!
//! | state | does | leaves when | to |
//! |---|---|---|---|
//! | straight on | holds the heading, slows down as a face comes nearer | stands at the safe distance from it | sweep right |
//! | sweep right | the servo steps to the right | the range jumps by 30 cm, twice in a row, or 90 degrees | sweep left |
//! | sweep left | the same to the left | the same | decide |
//! | decide | a quarter turn to the side whose opening is at the smaller angle; half a turn where there is none | at once | avoidance turn |
//! | avoidance turn | turns on the spot | stands and faces the heading | straight on |
//!
//! Nothing within the sonar's reach: straight on, for ever. Headings are multiples of a quarter turn from the one at
//! the start, so that errors of the turns do not add up. Positive is to the left.
//!
//! The report's robot drives at 50 rpm until it sees the face at 25 cm and sleeps 300 ms per 3 degrees of the sweep;
//! its sonars at the sides are not used. Here the stop is planned, the servo never blocks a tick, and walls at the
//! sides push the robot to the middle: docs/theory/lane.md.

use super::gaze::{LOOKS, Swing};
use super::{
    Action, DOUBT_M_S, Drive, FAR_M, Look, Mission, ParamId, Phase, Pose, SWEEP_RAD, Segment,
    ServoAngle, State, Turn, side_m,
};
use crate::estimate::Estimate;
use crate::math::{abs, clamp, max, min, wrap_angle};
use crate::motion::{CREEP_M_S, LineState, StopState, Stopping, TurnState};
use crate::types::{Fault, Range, SonarId, SonarReading};
use core::f32::consts::{FRAC_PI_2, PI};

/// The front sonar looks ahead within this of the middle [rad].
const AHEAD_RAD: f32 = 0.06;
/// It looks along the lane while the robot's heading is off by at most this: a little more than [`MOST_ASIDE_RAD`].
const ALONG_RAD: f32 = 0.2;
/// A range jumps when it is this much longer than that of the face [m].
const JUMP_M: f32 = 0.3;
/// From look to look of a sweep [rad].
const STEP_RAD: f32 = 0.15;
/// Looks in a row that make a jump: one may be an echo that was lost.
const SURE: u8 = 2;
/// What was seen as a face but is this much farther from the place where the robot stands was none [m].
const GONE_M: f32 = 0.1;
/// Two looks agree on a face within this [m].
const AGREE_M: f32 = 0.06;
/// Echoes in a row, each agreeing with the one before, that make a face of what is behind another.
const BEHIND: u8 = 3;
/// Walls at the sides count within this [m].
const BESIDE_M: f32 = 0.6;
/// A wall on one side only counts within this [m].
const CLOSE_M: f32 = 0.17;
/// Heading per difference of the ranges at the sides [rad/m], and the most of it [rad].
const MIDDLE_RAD_M: f32 = 0.5;
const MOST_ASIDE_RAD: f32 = 0.12;

/// Where a lane stands, by the numbers of the mission's states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
enum Stage {
    #[default]
    Start = Phase::Initialise as u8,
    SweepRight = Phase::SweepRight as u8,
    SweepLeft = Phase::SweepLeft as u8,
    Decide = Phase::Decide as u8,
    Turn = Phase::AvoidanceTurn as u8,
    Straight = Phase::StraightOn as u8,
}

/// What is ahead: the second nearest of the last five looks, moved along with the robot. One outlier brings nothing
/// nearer, and what was near is only gone after four looks without it.
///
/// A face that looks in a row have agreed on is not gone by silence, nor by looks that disagree: it is missing, until
/// it is seen again, looks agree on one behind it, or the robot has been where it was.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FaceAhead {
    last_m: [f32; 5],
    count: u8,
    /// Distance to the face that looks have agreed on; [`FAR_M`]: none.
    face_m: f32,
    /// Echoes in a row that agree with the one before.
    agreeing: u8,
}

impl Default for FaceAhead {
    #[inline]
    fn default() -> Self {
        Self {
            last_m: [FAR_M; 5],
            count: 0,
            face_m: FAR_M,
            agreeing: 0,
        }
    }
}

impl FaceAhead {
    /// One tick of a lane in this direction.
    fn step(&mut self, estimate: &Estimate, heading_rad: f32) {
        for range_m in &mut self.last_m {
            *range_m -= estimate.rolled_m;
        }
        if self.face_m < FAR_M {
            self.face_m -= estimate.rolled_m;
        }
        if self.face_m < -GONE_M {
            self.face_m = FAR_M;
        }
        let Some(reading) = front(estimate) else {
            return;
        };
        let off_rad = wrap_angle(estimate.pose.heading_rad - heading_rad);
        if abs(reading.servo_rad) > AHEAD_RAD || abs(off_rad) > ALONG_RAD {
            return;
        }
        let range_m = range_m(reading);
        let agrees = |before_m: &f32| range_m < FAR_M && abs(range_m - before_m) < AGREE_M;
        self.agreeing = match self.last_m.last().is_some_and(agrees) {
            true => self.agreeing.saturating_add(1),
            false => 0,
        };
        self.last_m.rotate_left(1);
        if let Some(newest_m) = self.last_m.last_mut() {
            *newest_m = range_m;
        }
        if self.agreeing >= BEHIND || (self.agreeing > 0 && range_m < self.face_m + AGREE_M) {
            self.face_m = range_m;
        }
        self.count = self.count.saturating_add(1);
    }

    /// The face that looks have agreed on is not seen any more.
    fn is_missing(&self) -> bool {
        let behind_m = |range_m: f32| range_m > self.face_m + AGREE_M;
        self.range_m().is_some_and(behind_m)
    }

    /// Distance from the sonar; none before three looks.
    fn range_m(&self) -> Option<f32> {
        let (mut nearest_m, mut second_m) = (FAR_M, FAR_M);
        for range_m in self.last_m {
            second_m = min(second_m, max(nearest_m, range_m));
            nearest_m = min(nearest_m, range_m);
        }
        (self.count >= 3).then_some(second_m)
    }
}

/// One side of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct SweepSide {
    /// Looks in a row beyond the jump.
    beyond: u8,
    /// Where the first of them was, without sign [rad].
    from_rad: f32,
    /// Where the servo is to look, without sign [rad].
    target_rad: f32,
}

/// What a side of a sweep has come to.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Swept {
    Going,
    Open(f32),
    Closed,
}

impl SweepSide {
    /// One tick towards `sign`; `jump_m` is the range that is beyond the face.
    fn step(&mut self, estimate: &Estimate, sign: f32, jump_m: f32) -> Swept {
        if self.target_rad == 0.0 {
            self.target_rad = STEP_RAD;
        }
        let Some(reading) = front(estimate) else {
            return Swept::Going;
        };
        let at_rad = sign * reading.servo_rad;
        // A look of before the servo got there.
        if abs(at_rad - self.target_rad) > 0.5 * STEP_RAD {
            return Swept::Going;
        }
        if range_m(reading) < jump_m {
            self.beyond = 0;
        } else {
            if self.beyond == 0 {
                self.from_rad = at_rad;
            }
            self.beyond += 1;
            if self.beyond >= SURE {
                return Swept::Open(self.from_rad);
            }
        }
        self.target_rad += STEP_RAD;
        if self.target_rad > SWEEP_RAD {
            return Swept::Closed;
        }
        Swept::Going
    }
}

/// Memory of a lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Lane {
    stage: Stage,
    heading_rad: f32,
    ahead: FaceAhead,
    stop: StopState,
    line: LineState,
    turn: TurnState,
    sweep: SweepSide,
    face_m: f32,
    right_rad: Option<f32>,
    left_rad: Option<f32>,
}

impl Mission<'_> {
    pub(super) fn lane(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if state.watch.is_wild() {
            return Err(Fault::SonarFaulty);
        }
        let proving = state.proof.is_some();
        let proof = self.prove(state, estimate)?;
        let doubts = state.watch.doubts() || !state.watch.landmarks.is_alive();
        let lane = &mut state.lane;
        if state.fresh {
            state.fresh = false;
            *lane = Lane::default();
        }
        lane.ahead.step(estimate, lane.heading_rad);
        if proving && proof.is_none() {
            // On from where the robot stands now.
            lane.stage = Stage::Turn;
            lane.turn = TurnState::default();
        }
        let mut heading_ref_rad = lane.heading_rad;
        let drive = match lane.stage {
            _ if let Some(drive) = proof => drive,
            Stage::Start => {
                lane.heading_rad = estimate.pose.heading_rad;
                lane.stage = Stage::Straight;
                Drive::Release
            }
            Stage::Straight => {
                heading_ref_rad = wrap_angle(lane.heading_rad + aside_rad(estimate));
                self.straight(lane, estimate, heading_ref_rad, doubts)
            }
            Stage::SweepRight | Stage::SweepLeft => {
                lane.look_around(estimate);
                Drive::Release
            }
            Stage::Decide => {
                lane.decide(estimate);
                Drive::Release
            }
            Stage::Turn => {
                let turn = Turn::new(self.params);
                let step = turn.step(&mut lane.turn, estimate, lane.heading_rad);
                if step.done {
                    lane.go_on();
                }
                step.drive
            }
        };
        // Ahead, and to what must answer while nothing does.
        let straight = Swing {
            right_rad: 0.0,
            left_rad: 0.0,
            looks: LOOKS,
            proves: true,
            front_m: self.params.get(ParamId::SonarFrontX),
        };
        let swing = match &state.proof {
            Some(proof) => Some(proof.swing(estimate, &straight)),
            None => (lane.stage == Stage::Straight).then_some(straight),
        };
        let servo = match lane.stage {
            _ if let Some(swing) = swing => {
                state.gaze.step(&state.watch, estimate, &swing);
                state.gaze.servo()
            }
            Stage::SweepRight => ServoAngle(-lane.sweep.target_rad),
            Stage::SweepLeft => ServoAngle(lane.sweep.target_rad),
            _ => ServoAngle(0.0),
        };
        let stage = lane.stage as u8;
        Ok(Action {
            drive,
            look: Look {
                servo,
                ..Look::AHEAD
            },
            state: state.shown(stage),
            heading_ref_rad,
            ..Action::default()
        })
    }

    /// On to the next face. Nothing is driven at before three looks ahead.
    fn straight(
        &self,
        lane: &mut Lane,
        estimate: &Estimate,
        heading_rad: f32,
        doubts: bool,
    ) -> Drive {
        let Some(range_m) = lane.ahead.range_m() else {
            return Drive::Release;
        };
        let left_m = range_m - self.params.get(ParamId::LaneSafe);
        let v_m_s = estimate.forward_m_s;
        let stop = &self.line.stop;
        match stop.step(&mut lane.stop, left_m, v_m_s, estimate.standing()) {
            Stopping::Drive => {}
            Stopping::Coast => return Drive::Release,
            Stopping::Done if left_m > GONE_M => {
                lane.stop = StopState::default();
                return Drive::Release;
            }
            Stopping::Done => {
                lane.stage = Stage::SweepRight;
                lane.sweep = SweepSide::default();
                lane.face_m = range_m;
                return Drive::Release;
            }
        }
        let cruise_m_s = if doubts || lane.ahead.is_missing() {
            DOUBT_M_S
        } else {
            self.params.get(ParamId::MissionCruise)
        };
        let limit_m_s = max(min(cruise_m_s, stop.speed(left_m, v_m_s)), CREEP_M_S);
        let pose = Pose {
            heading_rad,
            ..estimate.pose
        };
        // A line that begins where the robot is: the heading is held, what slid to the side is not taken back.
        let segment = Segment::ahead(&pose, FAR_M);
        self.line
            .step(&mut lane.line, estimate, &segment, limit_m_s)
            .drive
    }
}

impl Lane {
    /// It has begun.
    pub(super) fn is_driving(&self) -> bool {
        self.stage != Stage::Start
    }

    fn go_on(&mut self) {
        self.stage = Stage::Straight;
        self.stop = StopState::default();
        self.line = LineState::default();
    }

    fn look_around(&mut self, estimate: &Estimate) {
        let right = self.stage == Stage::SweepRight;
        let sign = if right { -1.0 } else { 1.0 };
        let found = match self.sweep.step(estimate, sign, self.face_m + JUMP_M) {
            Swept::Going => return,
            Swept::Open(angle_rad) => Some(angle_rad),
            Swept::Closed => None,
        };
        self.sweep = SweepSide::default();
        if right {
            self.right_rad = found;
            self.stage = Stage::SweepLeft;
        } else {
            self.left_rad = found;
            self.stage = Stage::Decide;
        }
    }

    fn decide(&mut self, estimate: &Estimate) {
        // A gap between two boxes at a corner looks like an opening to the sweep, and corners that echo far around hide
        // one: the sonars at the sides look where the robot would go.
        let room_m = self.face_m + JUMP_M;
        let right = side_m(estimate, SonarId::Right) > room_m;
        let left = side_m(estimate, SonarId::Left) > room_m;
        let (right_rad, left_rad) = if right || left {
            let or_aside = |found: Option<f32>| found.unwrap_or(FRAC_PI_2);
            (
                right.then_some(or_aside(self.right_rad)),
                left.then_some(or_aside(self.left_rad)),
            )
        } else {
            (self.right_rad, self.left_rad)
        };
        let change_rad = match (right_rad, left_rad) {
            (Some(right_rad), Some(left_rad)) if abs(right_rad - left_rad) < 0.5 * STEP_RAD => {
                // The same to both sides: where there is more room.
                if side_m(estimate, SonarId::Left) < side_m(estimate, SonarId::Right) {
                    -FRAC_PI_2
                } else {
                    FRAC_PI_2
                }
            }
            (Some(right_rad), Some(left_rad)) if right_rad > left_rad => FRAC_PI_2,
            (Some(_), _) => -FRAC_PI_2,
            (None, Some(_)) => FRAC_PI_2,
            (None, None) => PI,
        };
        self.heading_rad = wrap_angle(self.heading_rad + change_rad);
        self.ahead = FaceAhead::default();
        self.turn = TurnState::default();
        self.stage = Stage::Turn;
    }
}

/// The front sonar's answer of this tick.
fn front(estimate: &Estimate) -> Option<&SonarReading> {
    let reading = estimate.reading.as_ref()?;
    (reading.sonar == SonarId::Front && reading.range != Range::Faulty).then_some(reading)
}

fn range_m(reading: &SonarReading) -> f32 {
    match reading.range {
        Range::Valid(range_m) => range_m,
        Range::Clear | Range::Faulty => FAR_M,
    }
}

/// Heading off the lane's, to the middle between two walls or away from one that is close.
fn aside_rad(estimate: &Estimate) -> f32 {
    let left_m = side_m(estimate, SonarId::Left);
    let right_m = side_m(estimate, SonarId::Right);
    let off_m = if max(left_m, right_m) < BESIDE_M {
        left_m - right_m
    } else {
        max(CLOSE_M - right_m, 0.0) - max(CLOSE_M - left_m, 0.0)
    };
    clamp(MIDDLE_RAD_M * off_m, -MOST_ASIDE_RAD, MOST_ASIDE_RAD)
}

#[cfg(test)]
mod tests;
