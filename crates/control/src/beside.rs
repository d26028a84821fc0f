//! The sonars that see a wall beside the robot, on any rig: which ones, from where, and whether they can be trusted.
//!
//! A pair looks to its own side. On the final rig each side has one, and the front one looks ahead meanwhile.

use crate::estimate::Estimate;
use crate::math::{abs, max, min};
use crate::params::Params;
use crate::rig::{Rig, View};
use crate::types::{Fault, Range, SIDES, Side, SonarId};

/// Which sonars see a wall beside the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    rig: Rig,
    /// Where the sonars `Left` and `Right` sit.
    views: [View; 2],
}

impl Beside {
    /// From the parameters.
    pub fn new(params: &Params) -> Self {
        let view = |sonar| params.view(sonar, 0.0).unwrap_or_default();
        Self {
            rig: params.rig(),
            views: [view(SonarId::Left), view(SonarId::Right)],
        }
    }

    /// The sonars that look to this side.
    pub fn sonars(&self, side: Side) -> impl Iterator<Item = (SonarId, View)> + use<> {
        let (own, pair) = match side {
            Side::Left => (SonarId::Left, self.rig.paired_side() == Some(side)),
            Side::Right => (SonarId::Right, self.rig.paired_side() == Some(side)),
        };
        [SonarId::Left, SonarId::Right]
            .into_iter()
            .zip(self.views)
            .filter(move |(sonar, _)| pair || *sonar == own)
    }

    /// The point from which distances to a wall on this side are measured, ahead and left [m].
    pub fn point_m(&self, side: Side) -> (f32, f32) {
        let (mut x_m, mut y_m, mut count) = (0.0, 0.0, 0.0);
        for (_, view) in self.sonars(side) {
            x_m += view.x_m;
            y_m += view.y_m;
            count += 1.0;
        }
        (x_m / max(count, 1.0), y_m / max(count, 1.0))
    }

    /// Whether a sonar is one of those that look to this side.
    pub fn watches(&self, side: Side, sonar: SonarId) -> bool {
        self.sonars(side).any(|(own, _)| own == sonar)
    }

    /// The side with a wall, the nearer one where there are two; `None` without one in sight of all sonars of that side.
    pub fn side(&self, estimate: &Estimate, stale_s: f32) -> Option<Side> {
        let mut best: Option<(Side, f32)> = None;
        for side in SIDES {
            let possible = match self.rig {
                Rig::Final => true,
                rig => rig.paired_side() == Some(side),
            };
            if !possible {
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
        for (sonar, _) in self.sonars(side) {
            let range = estimate.range(sonar);
            match range.range {
                Range::Valid(_) if range.age_s > stale_s => return Err(Fault::SonarStale),
                Range::Valid(range_m) => nearest_m = min(nearest_m, range_m),
                Range::Clear => return Err(Fault::WallLost),
                Range::Faulty => return Err(Fault::SonarFaulty),
            }
        }
        Ok(nearest_m)
    }

    /// Whether the robot looks ahead while it follows a wall.
    pub fn looks_ahead(&self) -> bool {
        self.rig == Rig::Final
    }

    /// Whether the mode may start: a wall beside the robot within `reach`, and a front sonar that works where there is one.
    pub fn is_ready(&self, estimate: &Estimate, stale_s: f32, reach: (f32, f32)) -> bool {
        let ahead = estimate.range(SonarId::Front);
        let sees_ahead =
            !self.looks_ahead() || (ahead.range != Range::Faulty && ahead.age_s <= stale_s);
        let beside = self
            .side(estimate, stale_s)
            .and_then(|side| self.nearest_m(side, estimate, stale_s).ok());
        sees_ahead && beside.is_some_and(|range_m| range_m >= reach.0 && range_m <= reach.1)
    }
}

/// A reading further than this from the filtered range, and [`WILD_SHARE`] of that range, is wild [m]: a weak echo errs by less.
const WILD_M: f32 = 0.05;
/// Share of the range that a reading may err.
const WILD_SHARE: f32 = 0.2;
/// Where nothing was in sight, a distance beyond this is not wild [m]: something comes into reach.
const COMES_INTO_SIGHT_M: f32 = 1.0;
/// What a wild reading adds to a sonar's unrest.
const WILD: u8 = 8;
/// What an answer adds that no sound sonar gives.
const IMPOSSIBLE: u8 = 16;
/// Unrest that slows the robot: four wild readings.
const UNEASY: u8 = 32;
/// Unrest from which another fault is put down to the sonar.
const SUSPECT: u8 = 52;
/// Unrest that makes a sonar faulty: eight wild readings, or every fourth one for two seconds.
const FAULTY: u8 = 64;

/// How wild each sonar's readings have been lately. A calm reading takes one off, a wild one adds eight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unrest([u8; 3]);

impl Unrest {
    /// Takes the reading of this tick, if it is of a sonar that matters.
    ///
    /// # Errors
    /// The sonar's readings are so wild that it is faulty.
    pub fn take(
        &mut self,
        estimate: &Estimate,
        matters: impl Fn(SonarId) -> bool,
    ) -> Result<(), Fault> {
        let Some(reading) = estimate.reading.filter(|reading| matters(reading.sonar)) else {
            return Ok(());
        };
        let Some(unrest) = self.0.get_mut(reading.sonar as usize) else {
            return Ok(());
        };
        let wild = match (estimate.range(reading.sonar).range, reading.range) {
            (_, Range::Faulty) => IMPOSSIBLE,
            (Range::Valid(expected_m), Range::Valid(range_m))
                if abs(range_m - expected_m) > WILD_M + WILD_SHARE * expected_m =>
            {
                WILD
            }
            (Range::Valid(_), Range::Clear) => WILD,
            (Range::Clear, Range::Valid(range_m)) if range_m < COMES_INTO_SIGHT_M => WILD,
            _ => 0,
        };
        *unrest = if wild == 0 {
            unrest.saturating_sub(1)
        } else {
            unrest.saturating_add(wild)
        };
        if *unrest >= FAULTY {
            Err(Fault::SonarFaulty)
        } else {
            Ok(())
        }
    }

    /// Some sonar is in doubt.
    pub fn is_uneasy(&self) -> bool {
        self.0.iter().any(|unrest| *unrest >= UNEASY)
    }

    /// The cause of a stop: the sonars where they have been wild, else `fault`.
    pub fn cause(&self, fault: Fault) -> Fault {
        if self.0.iter().any(|unrest| *unrest >= SUSPECT) {
            Fault::SonarFaulty
        } else {
            fault
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::ParamId;
    use crate::types::{AgedRange, Reading};

    fn beside(rig: Rig) -> Beside {
        let mut params = Params::default();
        params.set(ParamId::Rig, f32::from(rig as u8)).unwrap();
        Beside::new(&params)
    }

    /// What the sonars left, right and front say; 0 is nothing in sight.
    fn seeing(ranges_m: [f32; 3]) -> Estimate {
        let mut estimate = Estimate::default();
        for (slot, range_m) in estimate.ranges.iter_mut().zip(ranges_m) {
            let range = if range_m > 0.0 {
                Range::Valid(range_m)
            } else {
                Range::Clear
            };
            *slot = AgedRange { range, age_s: 0.0 };
        }
        estimate
    }

    #[test]
    fn a_pair_looks_to_its_own_side_and_the_final_rig_to_the_nearer_wall() {
        let side = |rig, ranges_m| beside(rig).side(&seeing(ranges_m), 0.5);
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
            let (ahead_m, left_m) = beside(rig).point_m(side);
            assert!((ahead_m - 0.03).abs() < 1e-6 && left_m == y_m, "{rig:?}");
        }
    }

    #[test]
    fn it_is_ready_with_a_wall_in_reach_and_on_the_final_rig_with_eyes_ahead() {
        let ready = |rig, ranges_m| beside(rig).is_ready(&seeing(ranges_m), 0.5, (0.1, 1.5));
        assert!(ready(Rig::SidePairLeft, [0.5, 0.5, 0.0]));
        assert!(!ready(Rig::SidePairLeft, [0.5, 0.05, 0.0]));
        assert!(!ready(Rig::SidePairLeft, [1.7, 1.7, 0.0]));
        assert!(ready(Rig::Final, [0.5, 0.0, 0.0]));
        let mut blind = seeing([0.5, 0.0, 0.0]);
        blind.ranges[2].range = Range::Faulty;
        assert!(!beside(Rig::Final).is_ready(&blind, 0.5, (0.1, 1.5)));
    }

    fn unrest_after(readings: impl IntoIterator<Item = Range>) -> (Unrest, Result<(), Fault>) {
        let mut unrest = Unrest::default();
        let mut estimate = seeing([0.5, 0.5, 0.0]);
        for range in readings {
            estimate.reading = Some(Reading {
                sonar: SonarId::Left,
                range,
                view: View::default(),
                servo_rad: 0.0,
            });
            if let Err(fault) = unrest.take(&estimate, |_| true) {
                return (unrest, Err(fault));
            }
        }
        (unrest, Ok(()))
    }

    #[test]
    fn every_third_reading_wild_is_a_faulty_sonar_and_a_wall_that_ends_is_not() {
        let spiking = (0..60u8).map(|n| Range::Valid(if n % 3 == 0 { 1.5 } else { 0.5 }));
        assert_eq!(unrest_after(spiking).1, Err(Fault::SonarFaulty));
        let rare = (0..600u16).map(|n| Range::Valid(if n % 20 == 0 { 0.2 } else { 0.5 }));
        assert_eq!(unrest_after(rare).1, Ok(()));
        let (unrest, end) = unrest_after([Range::Clear; 3]);
        assert_eq!(
            (end, unrest.cause(Fault::WallLost)),
            (Ok(()), Fault::WallLost)
        );
        let (unrest, _) = unrest_after([Range::Clear; 7]);
        assert!(unrest.is_uneasy());
        assert_eq!(unrest.cause(Fault::WallLost), Fault::SonarFaulty);
    }
}
