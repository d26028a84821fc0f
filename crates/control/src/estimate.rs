//! What the robot knows about itself and what is around it, from what latched at the tick.
//!
//! edges -> wheel speeds ([`crate::speed`]) and distances -> pose ([`crate::odometry`]); echoes -> ranges ([`crate::range`]),
//! moved along with the distance in between.

use crate::drive::Direction;
use crate::odometry::Geometry;
use crate::params::{ParamId, Params};
use crate::range::{RangeFilter, range_from_echo};
use crate::speed::{EDGE_RAD, SpeedEstimator, WheelMotion};
use crate::types::{AgedRange, Inputs, Pose, SIDES, SonarId, Wheels};

/// Memory of the estimators.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimator {
    speed: Wheels<SpeedEstimator>,
    pose: Pose,
    ranges: [RangeFilter; 3],
}

/// What the estimators say at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// What the edges say, without sign.
    pub motion: Wheels<WheelMotion>,
    /// Signed wheel speeds [rad/s].
    pub wheel_rad_s: Wheels<f32>,
    /// Forward speed [m/s].
    pub forward_m_s: f32,
    /// Pose by odometry.
    pub pose: Pose,
    /// Filtered ranges by `SonarId` number.
    pub ranges: [AgedRange; 3],
}

impl Estimate {
    /// The range of one sonar.
    pub fn range(&self, sonar: SonarId) -> AgedRange {
        self.ranges.get(sonar as usize).copied().unwrap_or_default()
    }
}

impl Estimator {
    /// One tick; `directions` are those in which the wheels turn if they turn.
    pub fn step(
        &mut self,
        params: &Params,
        inputs: &Inputs,
        directions: Wheels<Direction>,
    ) -> Estimate {
        let mut estimate = Estimate::default();
        let mut turned_rad = Wheels::both(0.0);
        for side in SIDES {
            let motion = self.speed[side].step(&inputs.encoders[side], inputs.now);
            let direction = directions[side];
            estimate.motion[side] = motion;
            estimate.wheel_rad_s[side] = direction.sign(motion.speed_rad_s);
            turned_rad[side] = direction.sign(f32::from(motion.edges) * EDGE_RAD);
        }
        let geometry: Geometry = params.geometry();
        geometry.advance(&mut self.pose, turned_rad);
        estimate.pose = self.pose;
        (estimate.forward_m_s, _) = geometry.body_from_wheels(estimate.wheel_rad_s);

        let (rolled_m, _) = geometry.body_from_wheels(turned_rad);
        self.step_ranges(params, inputs, rolled_m);
        for (range, filter) in estimate.ranges.iter_mut().zip(&self.ranges) {
            *range = filter.range(inputs.now);
        }
        estimate
    }

    fn step_ranges(&mut self, params: &Params, inputs: &Inputs, rolled_m: f32) {
        for (sonar, filter) in SonarId::ALL.into_iter().zip(&mut self.ranges) {
            // Rolling forward brings the front sonar nearer to what it sees; what the others see slides by.
            filter.predict(if sonar == SonarId::Front {
                rolled_m
            } else {
                0.0
            });
            if let Some((pinged, echo)) = inputs.echo
                && pinged == sonar
            {
                filter.take(
                    range_from_echo(echo, params.get(ParamId::SoundSpeed)),
                    inputs.now,
                );
            }
            filter.hold_age(inputs.now);
        }
    }

    /// Calls the present place the origin.
    pub fn reset_pose(&mut self) {
        self.pose = Pose::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::{Echo, Edges, Micros, Range};

    #[test]
    fn backward_edges_count_backward() {
        let (mut estimator, params) = (Estimator::default(), Params::default());
        let mut inputs = Inputs::default();
        let backward = Wheels::both(Direction::Backward);
        estimator.step(&params, &inputs, backward);
        for tick in 1..=96u16 {
            let now = Micros(u32::from(tick) * 10_000);
            inputs.now = now;
            inputs.encoders = Wheels::both(Edges {
                count: tick * 4,
                last: now,
                turn_us: 20_000,
            });
            estimator.step(&params, &inputs, backward);
        }
        let estimate = estimator.step(&params, &inputs, backward);
        let turn_m = core::f32::consts::TAU * 0.0325;
        assert!(
            (estimate.pose.x_m + turn_m).abs() < 1e-4,
            "{:?}",
            estimate.pose
        );
        assert!((estimate.wheel_rad_s.left + 400.0 * EDGE_RAD).abs() < 1e-3);
        assert!(estimate.forward_m_s < 0.0);
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
            estimator.step(&params, &inputs, Wheels::default());
        }
        let estimate = estimator.step(
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
        assert_eq!(estimate.range(SonarId::Front), AgedRange::default());
    }
}
