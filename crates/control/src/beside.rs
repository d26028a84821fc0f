//! The sonars that look at a wall beside the robot, on any rig: which ones, from where, and whether they can be
//! trusted.
//!
//! A pair looks to its own side. On the final rig each side has one, and the front one looks ahead meanwhile.

use crate::ahead::drivable_m;
use crate::estimate::Estimate;
use crate::math::min;
use crate::params::Params;
use crate::rig::Rig;
use crate::types::{Fault, Range, SIDES, Side, SonarId, SonarView};

/// Which sonars see a wall beside the robot.
#[derive(Clone, Copy, Debug)]
pub struct Beside<'a> {
    params: &'a Params,
}

/// The sonar on this side of the final rig.
fn own(side: Side) -> SonarId {
    match side {
        Side::Left => SonarId::Left,
        Side::Right => SonarId::Right,
    }
}

impl<'a> Beside<'a> {
    /// From the parameters.
    pub fn new(params: &'a Params) -> Self {
        Self { params }
    }

    fn paired(&self, side: Side) -> bool {
        self.params.rig().paired_side() == Some(side)
    }

    /// Position and direction of a sonar at a side.
    pub fn view(&self, sonar: SonarId) -> SonarView {
        self.params.view(sonar, 0.0).unwrap_or_default()
    }

    /// The point from which distances to a wall on this side are measured, ahead and left [m].
    pub fn point_m(&self, side: Side) -> (f32, f32) {
        if self.paired(side) {
            let (left, right) = (self.view(SonarId::Left), self.view(SonarId::Right));
            return (0.5 * (left.x_m + right.x_m), 0.5 * (left.y_m + right.y_m));
        }
        let own = self.view(own(side));
        (own.x_m, own.y_m)
    }

    /// Whether a sonar is one of those that look to this side.
    pub fn watches(&self, side: Side, sonar: SonarId) -> bool {
        sonar == own(side) || (sonar != SonarId::Front && self.paired(side))
    }

    /// The side with a wall, the nearer one where there are two; `None` without one in sight of all sonars of that side.
    pub fn side(&self, estimate: &Estimate, stale_s: f32) -> Option<Side> {
        let mut best: Option<(Side, f32)> = None;
        for &side in &SIDES {
            if !self.looks_ahead() && !self.paired(side) {
                continue;
            }
            let Ok(range_m) = self.nearest_m(side, estimate, stale_s) else {
                continue;
            };
            if best.is_none_or(|(_, best_m)| range_m < best_m) {
                best = Some((side, range_m));
            }
        }
        best.map(|(side, _)| side)
    }

    /// The shortest range of the sonars of a side, if all of them see the wall.
    ///
    /// # Errors
    /// Why one of them does not.
    pub fn nearest_m(&self, side: Side, estimate: &Estimate, stale_s: f32) -> Result<f32, Fault> {
        let mut nearest_m = f32::MAX;
        for &sonar in &[SonarId::Left, SonarId::Right] {
            if self.watches(side, sonar) {
                nearest_m = min(nearest_m, drivable_m(estimate.range(sonar), stale_s)?);
            }
        }
        Ok(nearest_m)
    }

    /// Whether the robot looks ahead while it follows a wall.
    pub fn looks_ahead(&self) -> bool {
        self.params.rig() == Rig::Final
    }

    /// Whether the mode may start: a wall beside the robot within `reach`, and a front sonar that works where there is one.
    pub fn is_ready(&self, estimate: &Estimate, stale_s: f32, reach: (f32, f32)) -> bool {
        let ahead = estimate.range(SonarId::Front);
        let sees_ahead =
            !self.looks_ahead() || (ahead.range != Range::Faulty && !ahead.is_older(stale_s));
        let beside = self
            .side(estimate, stale_s)
            .and_then(|side| self.nearest_m(side, estimate, stale_s).ok());
        sees_ahead && beside.is_some_and(|range_m| range_m >= reach.0 && range_m <= reach.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{params, with_ranges_m};

    #[test]
    fn a_pair_looks_to_its_own_side_and_the_final_rig_to_the_nearer_wall() {
        let side = |rig, ranges_m| Beside::new(&params(rig)).side(&with_ranges_m(ranges_m), 0.5);
        assert_eq!(side(Rig::SidePairLeft, [0.5, 0.5, 0.0]), Some(Side::Left));
        assert_eq!(side(Rig::SidePairRight, [0.5, 0.5, 0.0]), Some(Side::Right));
        assert_eq!(side(Rig::SidePairRight, [0.5, 0.0, 0.0]), None);
        assert_eq!(side(Rig::Final, [0.5, 0.4, 0.0]), Some(Side::Right));
        assert_eq!(side(Rig::Final, [0.5, 0.0, 0.0]), Some(Side::Left));
        assert_eq!(side(Rig::Final, [0.0, 0.0, 1.0]), None);
        assert_eq!(side(Rig::FrontPair, [0.5, 0.5, 0.0]), None);
    }

    #[test]
    fn distances_count_from_the_middle_of_the_side_sonars_on_every_rig() {
        for (rig, side, y_m) in [
            (Rig::SidePairLeft, Side::Left, 0.075),
            (Rig::SidePairRight, Side::Right, -0.075),
            (Rig::Final, Side::Left, 0.075),
            (Rig::Final, Side::Right, -0.075),
        ] {
            let (ahead_m, left_m) = Beside::new(&params(rig)).point_m(side);
            assert!((ahead_m - 0.03).abs() < 1e-6 && left_m == y_m, "{rig:?}");
        }
    }

    #[test]
    fn it_is_ready_with_a_wall_in_reach_and_on_the_final_rig_with_eyes_ahead() {
        let ready = |rig, ranges_m| {
            Beside::new(&params(rig)).is_ready(&with_ranges_m(ranges_m), 0.5, (0.1, 1.5))
        };
        assert!(ready(Rig::SidePairLeft, [0.5, 0.5, 0.0]));
        assert!(!ready(Rig::SidePairLeft, [0.5, 0.05, 0.0]));
        assert!(!ready(Rig::SidePairLeft, [1.7, 1.7, 0.0]));
        assert!(ready(Rig::Final, [0.5, 0.0, 0.0]));
        let mut blind = with_ranges_m([0.5, 0.0, 0.0]);
        blind.ranges[2].range = Range::Faulty;
        assert!(!Beside::new(&params(Rig::Final)).is_ready(&blind, 0.5, (0.1, 1.5)));
    }
}
