//! How far a sonar can be trusted: the share of its readings that are wild.
//!
//! The range filter ([`crate::range`]) throws single spikes away, and what is left may be driven on. A sonar that spikes all the time is not
//! to be driven on all the same: it slows the robot first, then stops it.

use crate::estimate::Estimate;
use crate::math::abs;
use crate::types::{Fault, Range, Reading};

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
    /// Takes the reading of this tick, of a sonar that matters.
    ///
    /// # Errors
    /// The sonar's readings are so wild that it is faulty.
    pub fn take(&mut self, estimate: &Estimate, reading: &Reading) -> Result<(), Fault> {
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
    use crate::rig::View;
    use crate::types::SonarId;

    fn unrest_after(readings: impl IntoIterator<Item = Range>) -> (Unrest, Result<(), Fault>) {
        let mut unrest = Unrest::default();
        let mut estimate = Estimate::default();
        estimate.ranges[SonarId::Left as usize].range = Range::Valid(0.5);
        for range in readings {
            let reading = Reading {
                sonar: SonarId::Left,
                range,
                view: View::default(),
                servo_rad: 0.0,
            };
            if let Err(fault) = unrest.take(&estimate, &reading) {
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
