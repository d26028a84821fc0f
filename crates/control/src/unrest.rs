//! How far a sonar can be trusted: a score of its outliers.
//!
//! The range filter ([`crate::range`]) rejects single spikes, and the rest is good to drive on. A sonar that spikes all
//! the time is not: it slows the robot first, then stops it.

use crate::estimate::Estimate;
use crate::math::abs;
use crate::types::{Fault, Range, SonarReading};

/// A reading farther than this plus [`WILD_SHARE`] of the range from the filtered range is an outlier [m]: a weak echo
/// errs by less.
const WILD_M: f32 = 0.05;
/// Share of the range that a reading may err.
const WILD_SHARE: f32 = 0.2;
/// Where nothing was in sight, a distance beyond this is no outlier [m]: something comes into range.
const COMES_INTO_SIGHT_M: f32 = 1.0;
/// What an outlier adds to a sonar's score.
const WILD: u8 = 8;
/// What an impossible answer adds.
const IMPOSSIBLE: u8 = 16;
/// Score that slows the robot: four outliers.
const UNEASY: u8 = 32;
/// Score from which another fault is attributed to the sonar.
const SUSPECT: u8 = 52;
/// Score that makes a sonar faulty: eight outliers, or every fourth reading for two seconds.
const FAULTY: u8 = 64;

/// Outlier score of each sonar's recent readings. A good reading subtracts one, an outlier adds eight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unrest([u8; 3]);

impl Unrest {
    /// Updates with the reading of this tick, of a relevant sonar.
    ///
    /// # Errors
    /// The sonar has so many outliers that it is faulty.
    pub fn update(&mut self, estimate: &Estimate, reading: &SonarReading) -> Result<(), Fault> {
        let unrest = &mut self.0[reading.sonar as usize];
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

    /// The cause of a stop: the sonars where they had outliers, else `fault`.
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
    use crate::types::{SonarId, SonarView};

    fn unrest_after(readings: impl IntoIterator<Item = Range>) -> (Unrest, Result<(), Fault>) {
        let mut unrest = Unrest::default();
        let mut estimate = Estimate::default();
        estimate.ranges[SonarId::Left as usize].range = Range::Valid(0.5);
        for range in readings {
            let reading = SonarReading {
                sonar: SonarId::Left,
                range,
                view: SonarView::default(),
                servo_rad: 0.0,
            };
            if let Err(fault) = unrest.update(&estimate, &reading) {
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
        // What no sonar can answer weighs twice as much.
        assert_eq!(unrest_after([Range::Faulty; 3]).1, Ok(()));
        assert_eq!(unrest_after([Range::Faulty; 4]).1, Err(Fault::SonarFaulty));
        assert_eq!(unrest_after([Range::Clear; 7]).1, Ok(()));
        assert_eq!(unrest_after([Range::Clear; 8]).1, Err(Fault::SonarFaulty));
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
