//! Schedules the sonars: one at a time, so that none receives another's echo.
//!
//! The HC-SR04 needs 60 ms between its pings; two sonars are kept 20 ms apart. Of the wanted ones the one that has
//! waited longest goes first.

use rumbo_control::SonarId;

/// Ticks between two pings of any sonars: 20 ms.
const APART_TICKS: u8 = 2;
/// Ticks between two pings of the same sonar: 60 ms.
const OWN_TICKS: u8 = 6;

/// Times since the last pings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PingSchedule {
    /// Ticks since each sonar's ping, by `SonarId` number; saturates.
    since: [u8; 3],
}

impl Default for PingSchedule {
    fn default() -> Self {
        Self {
            since: [OWN_TICKS; 3],
        }
    }
}

impl PingSchedule {
    /// The sonar to ping at this tick, of those that are `wanted` (by `SonarId` number).
    pub(crate) fn next(&mut self, wanted: [bool; 3]) -> Option<SonarId> {
        let mut near = false;
        for ticks in &mut self.since {
            *ticks = ticks.saturating_add(1);
            near |= *ticks < APART_TICKS;
        }
        if near {
            return None;
        }
        let mut longest = OWN_TICKS - 1;
        let mut chosen = None;
        for &sonar in &SonarId::ALL {
            let ticks = self.since[sonar as usize];
            if wanted[sonar as usize] && ticks > longest {
                longest = ticks;
                chosen = Some(sonar);
            }
        }
        if let Some(sonar) = chosen {
            self.since[sonar as usize] = 0;
        }
        chosen
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    fn pings(wanted: [bool; 3]) -> Vec<(usize, SonarId)> {
        let mut schedule = PingSchedule::default();
        (0..60)
            .filter_map(|tick| Some((tick, schedule.next(wanted)?)))
            .collect()
    }

    #[test]
    fn one_sonar_pings_every_60_ms() {
        let pings = pings([false, false, true]);
        assert_eq!(pings.len(), 10);
        assert!(pings.iter().all(|(_, sonar)| *sonar == SonarId::Front));
        assert!(pings.windows(2).all(|two| two[1].0 - two[0].0 == 6));
    }

    #[test]
    fn three_sonars_take_turns_20_ms_apart() {
        let pings = pings([true; 3]);
        assert_eq!(pings.len(), 30);
        assert!(pings.windows(2).all(|two| two[1].0 - two[0].0 == 2));
        assert!(
            pings
                .windows(4)
                .all(|four| four[0].1 == four[3].1 && four[0].1 != four[1].1)
        );
    }

    #[test]
    fn none_pings_unasked() {
        assert!(pings([false; 3]).is_empty());
    }
}
