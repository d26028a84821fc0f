//! Mode 3: follow a wall at the distance at which the robot starts (memoria 3.1).
//!
//! The robot stands until each sonar that sees the wall has given five readings. The mean of their medians, the
//! distance of the sonars' midpoint, becomes the reference of mode 4, which does the rest: scheme, signs and states are
//! in [`super::wall_follow`].
//!
//! The report also uses the median of the first readings, to reject outliers. Worst of 20 simulated robots against the
//! real one over 27 s: 0.16 cm rms instead of 1.2, 0.35 cm at most instead of 4.6 (`rumbo run mode3 --runs 20`).

use super::wall_follow::{self, Phase, WallFollow};
use super::{Action, Description, MAX_WALL_M, MIN_WALL_M, Mode, Reference, ReferenceDescription};
use crate::estimate::Estimate;
use crate::math::{clamp, max};
use crate::params::Params;
use crate::types::{Fault, Range, SonarId, TICK_S};

/// Description of mode 3.
pub const DESCRIPTION: Description = Description {
    number: 3,
    name: "wall_hold",
    about: "follow a wall at the distance at which the robot starts",
    reference: Some(ReferenceDescription {
        commanded: false,
        ..wall_follow::REFERENCE
    }),
    ..wall_follow::DESCRIPTION
};

/// Readings of each sonar that the reference is computed from.
const READINGS: usize = 5;
const HALF: u8 = READINGS as u8 / 2;
/// Longest time to wait for them [s]; they take 0.3 s.
const PATIENCE_S: f32 = 1.5;

/// Configuration of mode 3: that of mode 4 but for its reference.
#[derive(Clone, Copy, Debug)]
pub struct WallHold<'a>(WallFollow<'a>);

/// State of mode 3.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// First readings of the sonars `Left` and `Right` [m], and their number.
    first_m: [[f32; READINGS]; 2],
    count: [u8; 2],
    waited_s: f32,
    /// The distance to hold [m].
    reference_m: Option<f32>,
    follow: wall_follow::State,
}

impl State {
    /// The distance that it holds [m]; 0 before it is known.
    pub fn reference_m(&self) -> f32 {
        self.reference_m.unwrap_or(0.0)
    }

    fn add_reading(&mut self, sonar: SonarId, range_m: f32) {
        let slot = sonar as usize;
        if let (Some(first_m), Some(count)) = (self.first_m.get_mut(slot), self.count.get_mut(slot))
            && let Some(place) = first_m.get_mut(usize::from(*count))
        {
            *place = range_m;
            *count += 1;
        }
    }

    /// The median of a sonar's first readings [m], once all are there.
    fn median_m(&self, sonar: SonarId) -> Option<f32> {
        let slot = sonar as usize;
        let all = self
            .count
            .get(slot)
            .is_some_and(|count| usize::from(*count) == READINGS);
        let first_m = self.first_m.get(slot).filter(|_| all)?;
        for candidate in first_m {
            let (mut below, mut above) = (0, 0);
            for other in first_m {
                below += u8::from(other < candidate);
                above += u8::from(other > candidate);
            }
            if below <= HALF && above <= HALF {
                return Some(*candidate);
            }
        }
        None
    }
}

impl WallHold<'_> {
    /// Ingests this tick's reading; returns the reference, once it is known.
    fn measure(&self, state: &mut State, estimate: &Estimate) -> Result<Option<f32>, Fault> {
        let sonars = &self.0.sonars;
        let side = sonars
            .side(estimate, self.0.stale_s)
            .ok_or(Fault::WallLost)?;
        if let Some(reading) = estimate.reading
            && let Range::Valid(range_m) = reading.range
            && sonars.watches(side, reading.sonar)
        {
            state.add_reading(reading.sonar, range_m);
        }
        state.waited_s += TICK_S;
        let (mut sum_m, mut count) = (0.0, 0.0);
        for &sonar in &[SonarId::Left, SonarId::Right] {
            if sonars.watches(side, sonar) {
                let Some(median_m) = state.median_m(sonar) else {
                    return if state.waited_s > PATIENCE_S {
                        Err(Fault::SonarStale)
                    } else {
                        Ok(None)
                    };
                };
                sum_m += median_m;
                count += 1.0;
            }
        }
        Ok(Some(clamp(sum_m / max(count, 1.0), MIN_WALL_M, MAX_WALL_M)))
    }
}

impl<'a> Mode<'a> for WallHold<'a> {
    type Setpoint = ();
    type State = State;

    fn first() {}

    fn new(params: &'a Params, (): &()) -> Self {
        Self(WallFollow::new(params, &0.0))
    }

    fn is_ready(&self, estimate: &Estimate) -> bool {
        let WallFollow {
            sonars, stale_s, ..
        } = &self.0;
        sonars.is_ready(estimate, *stale_s, (MIN_WALL_M, MAX_WALL_M))
    }

    fn reference((): &(), state: &State) -> Reference {
        Reference::Distance(state.reference_m())
    }

    fn step(&self, state: &mut State, estimate: &Estimate) -> Result<Action, Fault> {
        if state.reference_m.is_none() {
            state.reference_m = self.measure(state, estimate)?;
        }
        match state.reference_m {
            Some(distance_m) => self.0.keep(&mut state.follow, estimate, distance_m),
            None => Ok(Action {
                state: Phase::Measure as u8,
                ..Action::default()
            }),
        }
    }

    #[cfg(not(target_arch = "avr"))]
    fn terms(&self, state: &State, estimate: &Estimate) -> Option<super::ModeTerms> {
        self.0.terms_at(&state.follow, estimate, state.reference_m?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::ParamId;
    use crate::rig::Rig;
    use crate::types::{AgedRange, Drive, SonarReading, SonarView};

    /// A robot with a pair of sonars on its left; returns the tick's action for a reading of one of them.
    fn step_with(state: &mut State, sonar: SonarId, range_m: f32) -> Result<Action, Fault> {
        let mut params = Params::default();
        let pair = f32::from(Rig::SidePairLeft as u8);
        params.set(ParamId::Rig, pair).unwrap();
        let mut estimate = Estimate::default();
        for slot in &mut estimate.ranges[..2] {
            *slot = AgedRange {
                range: Range::Valid(0.5),
                age_ticks: 0,
            };
        }
        estimate.reading = Some(SonarReading {
            sonar,
            range: Range::Valid(range_m),
            view: SonarView::default(),
            servo_rad: 0.0,
        });
        WallHold::new(&params, &()).step(state, &estimate)
    }

    #[test]
    fn the_reference_is_the_mean_of_both_medians_and_a_wrong_first_reading_does_not_count() {
        let mut state = State::default();
        for (left_m, right_m) in [
            (0.1, 0.52),
            (0.5, 0.52),
            (0.49, 2.0),
            (0.5, 0.53),
            (0.5, 0.5),
        ] {
            assert_eq!(state.reference_m(), 0.0);
            let stands = step_with(&mut state, SonarId::Left, left_m).unwrap();
            assert_eq!((stands.drive, stands.state), (Drive::Release, 0));
            step_with(&mut state, SonarId::Right, right_m).unwrap();
        }
        assert!((state.reference_m() - 0.51).abs() < 1e-6, "{state:?}");
        let drives = step_with(&mut state, SonarId::Left, 0.5).unwrap();
        assert!(drives.state > 0 && drives.drive != Drive::Release);
    }

    #[test]
    fn it_does_not_wait_for_readings_for_ever() {
        let mut state = State::default();
        let stopped = (0..1_000).find_map(|_| step_with(&mut state, SonarId::Left, 0.5).err());
        assert_eq!(stopped, Some(Fault::SonarStale));
    }

    #[test]
    fn the_memory_of_a_mode_fits_the_chip() {
        assert!(size_of::<State>() <= 128, "{}", size_of::<State>());
    }
}
