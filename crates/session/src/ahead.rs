//! Notices that the robot does not drive ahead, although its wheels count that it does.
//!
//! An encoder of one channel counts the same whichever way its wheel turns: the pose of a robot with a reversed motor
//! runs straight on while it turns on the spot, or drives backward. The sonar ahead sees it. On a straight way what is
//! ahead comes nearer, or leaves the beam now and then; what goes away again and again is what a robot sees that turns,
//! and what goes away steadily what one sees that backs off. Nothing within reach tells nothing.
//!
//! Of 350 sound runs (modes 1 to 9, 25 seeds) none got beyond 0.42 m. Of 36 with one or two motors reversed, in the world
//! `room` in modes 6 and 7, all got beyond 0.6 m, in the median 3.4 s after they began to drive.

use rumbo_control::math::wrap_angle;
use rumbo_control::range::REACH_M;
use rumbo_control::{Pose, Range, SonarId};
use rumbo_wire::Telemetry;

/// By how much what is ahead has to go away, all in all \[m\].
const AWAY_M: f32 = 0.6;
/// The most that counts at once \[m\]: something else has come into sight.
const AT_ONCE_M: f32 = 0.15;
/// Less is noise \[m\].
const NOISE_M: f32 = 0.05;
/// Of it this much is forgiven for a metre driven.
const FORGIVEN: f32 = 0.3;
/// Least and most between two frames on a way ahead \[m\]: slower it stands, further away it counts from elsewhere.
const STEP_M: core::ops::Range<f32> = 0.003..0.1;
/// A way that turns by more is not straight, and a servo that looks further to a side not ahead \[rad\].
const TURNED_RAD: f32 = 0.1;
const ASIDE_RAD: f32 = 0.15;

/// What has been seen ahead since the robot began to drive straight.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ahead {
    before: Option<Pose>,
    heading_rad: f32,
    /// The nearest since then, and since it went away last.
    nearest_m: Option<f32>,
    away_m: f32,
}

impl Ahead {
    /// Takes what is new; true if the robot cannot be driving ahead.
    pub(crate) fn contradicts(&mut self, telemetry: &Telemetry) -> bool {
        let at = telemetry.pose;
        let Some(before) = self.before.replace(at).filter(|_| telemetry.armed) else {
            *self = Self {
                before: Some(at),
                heading_rad: at.heading_rad,
                ..Self::default()
            };
            return false;
        };
        let (sin, cos) = at.heading_rad.sin_cos();
        let step_m = cos * (at.x_m - before.x_m) + sin * (at.y_m - before.y_m);
        let turned_rad = wrap_angle(at.heading_rad - self.heading_rad);
        let is_straight = STEP_M.contains(&step_m) && turned_rad.abs() < TURNED_RAD;
        if !is_straight || telemetry.servo_rad.abs() > ASIDE_RAD {
            *self = Self {
                before: Some(at),
                heading_rad: at.heading_rad,
                ..Self::default()
            };
            return false;
        }
        self.away_m = (self.away_m - FORGIVEN * step_m).max(0.0);
        let range_m = match telemetry.ranges[SonarId::Front as usize].range {
            Range::Valid(range_m) => range_m,
            Range::Clear => REACH_M,
            Range::Faulty => return false,
        };
        let nearest_m = *self.nearest_m.get_or_insert(range_m);
        if range_m < nearest_m {
            self.nearest_m = Some(range_m);
        } else if range_m > nearest_m + NOISE_M {
            self.away_m += (range_m - nearest_m).min(AT_ONCE_M);
            self.nearest_m = Some(range_m);
        }
        self.away_m >= AWAY_M
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::AgedRange;
    use std::f32::consts::{PI, TAU};

    /// The frame after which a robot is known that counts 8 mm ahead in each, and sees this at it \[m\]; infinite: clear.
    fn known(ranges_m: impl Iterator<Item = f32>) -> Option<usize> {
        let mut ahead = Ahead::default();
        let mut frames = ranges_m.enumerate();
        frames.find_map(|(frame, range_m)| {
            let mut telemetry = Telemetry {
                armed: true,
                ..Telemetry::default()
            };
            telemetry.pose.x_m = 0.008 * frame as f32;
            telemetry.ranges[SonarId::Front as usize] = AgedRange {
                range: match range_m.is_finite() {
                    true => Range::Valid(range_m),
                    false => Range::Clear,
                },
                age_ticks: 0,
            };
            ahead.contradicts(&telemetry).then_some(frame)
        })
    }

    /// What a sonar sees from a place in a room of 4 x 3 m, along its axis \[m\].
    fn in_room([x_m, y_m]: [f32; 2], heading_rad: f32) -> f32 {
        let (sin, cos) = heading_rad.sin_cos();
        let to = |from_m: f32, speed: f32, [low_m, high_m]: [f32; 2]| match speed {
            0.0 => f32::INFINITY,
            _ if speed > 0.0 => (high_m - from_m) / speed,
            _ => (low_m - from_m) / speed,
        };
        to(x_m, cos, [-2.0, 2.0]).min(to(y_m, sin, [-1.5, 1.5]))
    }

    #[test]
    fn a_robot_that_turns_on_the_spot_is_known_within_two_turns() {
        // 1.8 rad/s: the wheels go opposite ways at 0.2 m/s.
        for place in [[0.0, 0.0], [0.7, 0.4], [-1.0, -0.9]] {
            let frame = known((0..).map(|frame| in_room(place, 0.072 * frame as f32)));
            let turns = 0.072 * frame.unwrap() as f32 / TAU;
            assert!(turns < 2.0, "{place:?}: {turns}");
        }
    }

    #[test]
    fn a_robot_that_backs_off_is_known_after_a_metre() {
        let frame = known((0..).map(|frame| in_room([1.5 - 0.008 * frame as f32, 0.0], 0.0)));
        let backward_m = 0.008 * frame.unwrap() as f32;
        assert!(backward_m < 1.0, "{backward_m}");
    }

    #[test]
    fn a_robot_that_drives_ahead_is_not_whatever_leaves_its_beam() {
        let wall_m = |frame: i32| 2.4 - 0.008 * frame as f32;
        let noise_m = |frame: i32| 0.02 * (frame as f32 * 1.7).sin();
        assert_eq!(
            known((0..280).map(|frame| wall_m(frame) + noise_m(frame))),
            None
        );
        // A box comes into the beam and leaves it, three times.
        let boxes = |frame: i32| match frame % 90 {
            0..40 => wall_m(frame).min(0.9 - 0.008 * (frame % 90) as f32),
            _ => wall_m(frame),
        };
        assert_eq!(known((0..280).map(boxes)), None);
        assert_eq!(
            known(std::iter::repeat_n(f32::INFINITY, 1_000)),
            None,
            "nothing is there"
        );
    }

    #[test]
    fn a_turn_a_rest_a_look_aside_and_off_begin_anew() {
        let frame = |x_m: f32, range_m: f32| {
            let mut telemetry = Telemetry {
                armed: true,
                ..Telemetry::default()
            };
            telemetry.pose.x_m = x_m;
            telemetry.ranges[SonarId::Front as usize].range = Range::Valid(range_m);
            telemetry
        };
        let spoilt: [fn(&mut Telemetry); 4] = [
            |telemetry| telemetry.pose.heading_rad = PI,
            |telemetry| telemetry.pose.x_m -= 0.01,
            |telemetry| telemetry.servo_rad = 0.5,
            |telemetry| telemetry.armed = false,
        ];
        for spoil in spoilt {
            let mut ahead = Ahead::default();
            for step in 0..600 {
                // It backs off by half a metre between two such frames.
                let mut telemetry = frame(0.01 * step as f32, 0.5 + 0.01 * (step % 50) as f32);
                if step % 50 == 0 {
                    spoil(&mut telemetry);
                }
                assert!(!ahead.contradicts(&telemetry), "{step}");
            }
        }
    }
}
