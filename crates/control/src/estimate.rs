//! The robot's estimate of itself and its surroundings, from the latched inputs of the tick.
//!
//! edges -> wheel speeds ([`crate::speed`]) and distances -> pose ([`crate::odometry`]); echoes -> ranges ([`crate::range`]),
//! predicted by the distance rolled in between. The servo has no feedback: its angle is estimated from its commands and
//! its speed.

use crate::drive::WheelDirection;
use crate::math::{abs, clamp, wrap_angle};
use crate::odometry::advance;
use crate::params::{ParamId, Params};
use crate::range::{RangeFilter, range_from_echo};
use crate::speed::{EDGE_RAD, SpeedEstimator, WheelMotion};
use crate::types::{
    AgedRange, Inputs, Pose, SIDES, ServoAngle, SonarId, SonarReading, SonarView, TICK_S,
    Transform, Wheels,
};

/// The front sonar looks ahead when the servo is within this of it [rad].
const AHEAD_RAD: f32 = 0.06;
/// A range ahead older than this is not used: three pings, of which one may be lost and one rejected [ticks].
const SHOWN_TICKS: u16 = 20;

/// State of the estimators.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimator {
    speed: Wheels<SpeedEstimator>,
    place: Transform,
    servo_rad: f32,
    servo_target_rad: f32,
    /// The pings with a pending echo, by `SonarId` number: a late one may end after the next one has left.
    pings: [Option<Ping>; 3],
    ranges: [RangeFilter; 3],
    /// The front sonar's last reading off the middle.
    aside: AgedRange,
}

/// A ping with a pending echo.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ping {
    place: Transform,
    servo_rad: f32,
}

/// The estimate at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// Pose by odometry.
    pub pose: Pose,
    /// Sine and cosine of its heading.
    pub facing: (f32, f32),
    /// Forward speed [m/s].
    pub forward_m_s: f32,
    /// Yaw rate [rad/s].
    pub yaw_rad_s: f32,
    /// Distance rolled since the last tick, signed [m].
    pub rolled_m: f32,
    /// Angle turned since the last tick [rad].
    pub turned_rad: f32,
    /// Signed wheel speeds [rad/s].
    pub wheel_rad_s: Wheels<f32>,
    /// Motion measured from the edges, without sign.
    pub motion: Wheels<WheelMotion>,
    /// Where the servo points [rad].
    pub servo_rad: f32,
    /// The servo has reached its setpoint.
    pub servo_arrived: bool,
    /// A sonar's reading of this tick, unfiltered; its view is for modes, after [`Estimate::face_reading`].
    pub reading: Option<SonarReading>,
    /// Filtered ranges by `SonarId` number; for a sonar on the servo only readings ahead.
    pub ranges: [AgedRange; 3],
}

impl Estimate {
    /// The range of one sonar.
    pub fn range(&self, sonar: SonarId) -> &AgedRange {
        &self.ranges[sonar as usize]
    }

    /// The robot in the world: its pose with sine and cosine of the heading.
    pub fn transform(&self) -> Transform {
        let (sin, cos) = self.facing;
        Transform {
            pose: self.pose,
            sin,
            cos,
        }
    }

    /// Turns the view of this tick's reading, which [`Estimator::step`] leaves in the world, with an axis that is not wrapped,
    /// to the robot. Once, before a mode looks: the outputs do not wait for it.
    pub fn face_reading(&mut self) {
        let robot = self.transform();
        if let Some(SonarReading { view, .. }) = &mut self.reading {
            (view.x_m, view.y_m) = robot.to_local(view.x_m, view.y_m);
            view.axis_rad = wrap_angle(view.axis_rad);
        }
    }

    /// Both wheels stand.
    pub fn standing(&self) -> bool {
        self.motion.left.standing && self.motion.right.standing
    }
}

impl Estimator {
    /// One tick, into `estimate`; `directions` are those in which the wheels turn if they turn.
    pub fn step(
        &mut self,
        params: &Params,
        inputs: &Inputs,
        directions: Wheels<WheelDirection>,
        estimate: &mut Estimate,
    ) {
        let geometry = params.geometry();
        let mut wheel_rad = Wheels::both(0.0);
        for &side in &SIDES {
            let motion = self.speed[side].step(&inputs.encoders[side], inputs.now);
            let direction = directions[side];
            estimate.motion[side] = motion;
            estimate.wheel_rad_s[side] = direction.sign(motion.speed_rad_s);
            wheel_rad[side] = direction.sign(f32::from(motion.edges) * EDGE_RAD);
        }
        let wheel_m = geometry.ways_of_wheels(wheel_rad);
        (estimate.forward_m_s, estimate.yaw_rad_s) =
            geometry.body_from_wheels(estimate.wheel_rad_s);
        (estimate.rolled_m, estimate.turned_rad) = geometry.body_from_ways(wheel_m);
        advance(&mut self.place, estimate.rolled_m, estimate.turned_rad);
        estimate.pose = self.place.pose;
        estimate.facing = (self.place.sin, self.place.cos);

        self.step_servo(params.get(ParamId::ServoSpeed));
        estimate.servo_rad = self.servo_rad;
        estimate.servo_arrived = self.servo_rad == self.servo_target_rad;
        estimate.reading = self.reading(params, inputs);
        self.step_ranges(params, estimate);
    }

    /// Recomputes the heading's sine and cosine, which each tick only rotates. For a tick that has little else to do.
    pub fn refresh(&mut self) {
        self.place = Transform::of(self.place.pose);
    }

    /// Records the pilot's decision at this tick: the servo's setpoint and the sonar to ping.
    pub fn commanded(&mut self, servo: ServoAngle, ping: Option<SonarId>) {
        self.servo_target_rad = servo.0;
        if let Some(slot) = ping.and_then(|sonar| self.pings.get_mut(sonar as usize)) {
            *slot = Some(Ping {
                place: self.place,
                servo_rad: self.servo_rad,
            });
        }
    }

    fn step_servo(&mut self, speed_rad_s: f32) {
        if self.servo_rad == self.servo_target_rad {
            return;
        }
        let most = speed_rad_s * TICK_S;
        let left = self.servo_target_rad - self.servo_rad;
        self.servo_rad = if abs(left) <= most {
            self.servo_target_rad
        } else {
            self.servo_rad + clamp(left, -most, most)
        };
    }

    /// The echo of this tick, with the view from which it was pinged: in the world, but for the axis.
    fn reading(&mut self, params: &Params, inputs: &Inputs) -> Option<SonarReading> {
        let (sonar, echo) = inputs.echo?;
        let ping = self.pings.get_mut(sonar as usize)?.take()?;
        let mount = params.view(sonar, ping.servo_rad)?;
        let (x_m, y_m) = ping.place.to_world(mount.x_m, mount.y_m);
        let turned_rad = self.place.pose.heading_rad - ping.place.pose.heading_rad;
        let range = range_from_echo(echo, params.get(ParamId::SoundSpeed));
        if sonar == SonarId::Front {
            self.aside = AgedRange::fresh(range);
        }
        Some(SonarReading {
            sonar,
            range,
            view: SonarView {
                x_m,
                y_m,
                axis_rad: mount.axis_rad - turned_rad,
            },
            servo_rad: ping.servo_rad,
        })
    }

    fn step_ranges(&mut self, params: &Params, estimate: &mut Estimate) {
        let edges = estimate
            .motion
            .left
            .edges
            .wrapping_add(estimate.motion.right.edges);
        for &sonar in &SonarId::ALL {
            let (filter, range) = (
                &mut self.ranges[sonar as usize],
                &mut estimate.ranges[sonar as usize],
            );
            // Rolling forward brings a sonar that looks ahead nearer to its target; targets beside the robot slide by.
            let closer_m = if params.looks_ahead(sonar) {
                estimate.rolled_m
            } else {
                0.0
            };
            filter.predict(closer_m, edges);
            if let Some(reading) = &estimate.reading
                && reading.sonar == sonar
                && (sonar != SonarId::Front || abs(reading.servo_rad) < AHEAD_RAD)
            {
                filter.update(reading.range);
            }
            *range = filter.range();
        }
    }

    /// Each sonar's last range in its present direction, for people: the front one's last answer while the servo looks
    /// aside, and while it swings past the middle, where the last reading ahead has been predicted for too long.
    pub fn shown(&self, estimate: &Estimate) -> [AgedRange; 3] {
        let [left, right, front] = estimate.ranges;
        let aside = abs(self.servo_rad) >= AHEAD_RAD || front.age_ticks > SHOWN_TICKS;
        [left, right, if aside { self.aside } else { front }]
    }

    /// Sets the pose relative to the origin, for a simulated robot that is moved.
    #[cfg(not(target_arch = "avr"))]
    pub fn set_pose(&mut self, pose: Pose) {
        self.pings = Default::default();
        self.place = Transform::of(pose);
    }

    /// Makes the present pose the origin.
    pub fn reset_pose(&mut self) {
        for slot in &mut self.pings {
            let Some(ping) = slot else { continue };
            let then = ping.place.pose;
            let (x_m, y_m) = self.place.to_local(then.x_m, then.y_m);
            let heading_rad = wrap_angle(then.heading_rad - self.place.pose.heading_rad);
            ping.place = Transform::of(Pose {
                x_m,
                y_m,
                heading_rad,
            });
        }
        self.place = Transform::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::{Echo, Edges, Micros, Range};

    /// One tick: what is estimated.
    fn step(
        estimator: &mut Estimator,
        params: &Params,
        inputs: &Inputs,
        directions: Wheels<WheelDirection>,
    ) -> Estimate {
        let mut estimate = Estimate::default();
        estimator.step(params, inputs, directions, &mut estimate);
        estimate
    }

    #[test]
    fn backward_edges_count_backward() {
        let (mut estimator, params) = (Estimator::default(), Params::default());
        let mut inputs = Inputs::default();
        let backward = Wheels::both(WheelDirection::Backward);
        step(&mut estimator, &params, &inputs, backward);
        for tick in 1..=96u16 {
            let now = Micros(u32::from(tick) * 10_000);
            inputs.now = now;
            inputs.encoders = Wheels::both(Edges {
                count: tick * 4,
                last: now,
                turn_us: 20_000,
            });
            step(&mut estimator, &params, &inputs, backward);
        }
        let estimate = step(&mut estimator, &params, &inputs, backward);
        let turn_m = core::f32::consts::TAU * 0.0325;
        assert!(
            (estimate.pose.x_m + turn_m).abs() < 1e-4,
            "{:?}",
            estimate.pose
        );
        assert!((estimate.wheel_rad_s.left + 400.0 * EDGE_RAD).abs() < 1e-3);
        assert!(estimate.forward_m_s < 0.0);
    }

    /// Ticks with the front sonar pinging every sixth, and the servo's setpoint at `servo_rad`.
    fn looking(estimator: &mut Estimator, servo_rad: f32, ticks: u32) -> Estimate {
        let mut last = Estimate::default();
        for tick in 0..ticks {
            let answered = tick % 6 == 2;
            let inputs = Inputs {
                now: Micros(tick * 10_000),
                echo: answered.then_some((SonarId::Front, Echo::Pulse(3_000))),
                ..Inputs::default()
            };
            last = step(estimator, &Params::default(), &inputs, Wheels::default());
            let ping = (tick % 6 == 0).then_some(SonarId::Front);
            estimator.commanded(ServoAngle(servo_rad), ping);
        }
        last
    }

    #[test]
    fn the_servo_takes_its_time_and_what_it_sees_aside_is_not_ahead() {
        let mut estimator = Estimator::default();
        let soon = looking(&mut estimator, 1.2, 10);
        assert!(!soon.servo_arrived && soon.servo_rad < 0.6);
        let mut estimator = Estimator::default();
        looking(&mut estimator, 1.2, 24);
        let later = looking(&mut estimator, 1.2, 60);
        assert!(later.servo_arrived && later.servo_rad == 1.2);
        let Range::Valid(then_m) = estimator.shown(&later)[2].range else {
            panic!("nothing shown");
        };
        let swung = Estimate {
            ranges: [AgedRange {
                range: Range::Valid(0.0),
                age_ticks: 90,
            }; 3],
            ..later
        };
        estimator.servo_rad = 0.0;
        assert_eq!(
            estimator.shown(&swung)[2].range,
            Range::Valid(then_m),
            "what was ahead long ago is not what is there now"
        );
        let ahead = looking(&mut Estimator::default(), 0.0, 60);
        assert!(matches!(ahead.range(SonarId::Front).range, Range::Valid(_)));
    }

    #[test]
    fn a_reading_comes_with_the_place_from_which_it_was_taken() {
        let (mut estimator, params) = (Estimator::default(), Params::default());
        estimator.commanded(ServoAngle(0.0), Some(SonarId::Left));
        estimator.place = Transform::of(Pose {
            x_m: 0.1,
            y_m: 0.0,
            heading_rad: 0.2,
        });
        let inputs = Inputs {
            echo: Some((SonarId::Left, Echo::Pulse(3_000))),
            ..Inputs::default()
        };
        let mut estimate = step(&mut estimator, &params, &inputs, Wheels::default());
        estimate.face_reading();
        let reading = estimate.reading.unwrap();
        let half_pi = core::f32::consts::FRAC_PI_2;
        assert!((reading.view.axis_rad - (half_pi - 0.2)).abs() < 1e-5);
        let (x_m, y_m) = estimator
            .place
            .pose
            .to_world(reading.view.x_m, reading.view.y_m);
        assert!((x_m - 0.03).abs() < 1e-5 && (y_m - 0.075).abs() < 1e-5);
    }

    #[test]
    fn an_echo_reaches_its_own_sonar_only() {
        let (mut estimator, params) = (Estimator::default(), Params::default());
        let mut inputs = Inputs {
            echo: Some((SonarId::Right, Echo::Pulse(3_000))),
            ..Inputs::default()
        };
        for tick in 1..=4u32 {
            inputs.now = Micros(tick * 60_000);
            estimator.commanded(ServoAngle::default(), Some(SonarId::Right));
            step(&mut estimator, &params, &inputs, Wheels::default());
        }
        let estimate = step(
            &mut estimator,
            &params,
            &Inputs {
                echo: None,
                ..inputs
            },
            Wheels::default(),
        );
        assert!(matches!(
            estimate.range(SonarId::Right).range,
            Range::Valid(_)
        ));
        assert_eq!(*estimate.range(SonarId::Front), AgedRange::default());
    }
}
