//! The sonars that look at a wall ahead of the robot, a pair or the one on the servo, and their estimate of the wall.
//!
//! A pair measures distance and bearing at once. A single sonar measures no bearing while it looks ahead, so the servo
//! sweeps ([`crate::sweep`]); and since its range does not change with the bearing within the beam, the first look to
//! each side only checks for an echo. Derivation: docs/theory/front_align.md.

use crate::estimate::Estimate;
use crate::math::min;
use crate::params::{ParamId, Params};
use crate::rig::Rig;
use crate::sweep::{Sweep, SweepState};
use crate::types::Look;
use crate::types::{AgedRange, Fault, Range, SonarId, SonarReading, SonarView, TICK_S};
use crate::wall::{WallEstimate, WallFilter};

/// Bearing of a wall that answers only where the servo looks to one side [rad].
const ONE_SIDED_RAD: f32 = 0.32;
/// Standard deviation of the bearing after the first look to both sides [rad].
const ASKEW_RAD: f32 = 0.15;
/// Looks aside after which the side of the wall is known, after which it is known well, and the maximum.
const LOOKS: [u8; 3] = [2, 4, 8];
/// Standard deviation of the bearing with which the robot may drive [rad].
const KNOWN_RAD: f32 = 0.08;
/// Pings ahead between two looks aside: at the start, driving, at rest.
const PINGS_AHEAD: [u8; 3] = [0, 2, 16];

/// Which sonars look ahead, and from where.
#[derive(Clone, Copy, Debug)]
pub struct Ahead<'a> {
    /// Two sonars in front; otherwise one on the servo.
    paired: bool,
    params: &'a Params,
}

/// Their state: the estimated wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AheadState {
    wall: WallFilter,
    sweep: SweepState,
    /// The bearing is known well enough to drive.
    known: bool,
    /// The first looks to the left and to the right gave an echo.
    echo: (bool, bool),
    /// Time since a reading was last accepted [s].
    deaf_s: f32,
}

impl AheadState {
    /// The bearing is known well enough to drive.
    pub fn is_known(&self) -> bool {
        self.known
    }
}

impl<'a> Ahead<'a> {
    /// From the parameters.
    pub fn new(params: &'a Params) -> Self {
        Self {
            paired: params.rig() == Rig::FrontPair,
            params,
        }
    }

    /// Sonars ahead of the wheels' axis [m].
    pub fn ahead_m(&self) -> f32 {
        self.params.get(ParamId::SonarFrontX)
    }

    /// Half angle of a sonar's beam [rad].
    fn beam_rad(&self) -> f32 {
        self.params.get(ParamId::Beam)
    }

    /// Oldest range to drive on [s].
    fn stale_s(&self) -> f32 {
        self.params.get(ParamId::StaleRange)
    }

    /// Whether a sonar is one of those that look ahead.
    fn has(&self, sonar: SonarId) -> bool {
        self.paired != (sonar == SonarId::Front)
    }

    /// Whether a reading is one of the way ahead.
    pub fn watches(&self, reading: &SonarReading) -> bool {
        self.has(reading.sonar) && (self.paired || reading.servo_rad == 0.0)
    }

    /// Whether all sonars that look ahead have a range.
    pub fn is_ready(&self, estimate: &Estimate) -> bool {
        self.nearest(estimate, true).is_ok()
    }

    /// The nearest thing ahead [m].
    ///
    /// # Errors
    /// Why one of the sonars has no range.
    pub fn nearest_m(&self, estimate: &Estimate) -> Result<f32, Fault> {
        self.nearest(estimate, false)
    }

    /// Unless `fresh`, a range may be old where the only sonar looks ahead now and then: readings aside count too, see
    /// `deaf_s`.
    fn nearest(&self, estimate: &Estimate, fresh: bool) -> Result<f32, Fault> {
        let mut nearest_m = f32::MAX;
        for &sonar in &SonarId::ALL {
            if !self.has(sonar) {
                continue;
            }
            let mut range = *estimate.range(sonar);
            if !self.paired && !fresh {
                range.age_ticks = 0;
            }
            nearest_m = min(nearest_m, drivable_m(&range, self.stale_s())?);
        }
        Ok(nearest_m)
    }

    /// The wall, predicted and then corrected by this tick's reading. Call it once a tick.
    ///
    /// # Errors
    /// There is no wall, or no accepted reading for too long.
    pub fn wall(&self, state: &mut AheadState, estimate: &Estimate) -> Result<WallEstimate, Fault> {
        state.wall.predict(estimate.rolled_m, estimate.turned_rad);
        state.deaf_s += TICK_S;
        if let Some(reading) = estimate.reading
            && self.has(reading.sonar)
            && (self.paired || state.sweep.is_from_here(reading.servo_rad))
            && let Range::Valid(range_m) = reading.range
            && self.correct(state, &reading, range_m)
        {
            state.deaf_s = 0.0;
        }
        let restart = (state.known || self.paired) && state.deaf_s > self.stale_s();
        if !state.wall.is_known() || restart {
            self.start(state, estimate).ok_or(Fault::WallLost)?;
        }
        if state.deaf_s > 2.0 * self.stale_s() {
            return Err(Fault::SonarStale);
        }
        if !self.paired && !state.known {
            self.look_first(state, estimate);
        }
        state.wall.wall().ok_or(Fault::WallLost)
    }

    /// Corrects by a reading; returns whether it was accepted. The first looks to both sides only show on which side
    /// the wall's normal is.
    fn correct(&self, state: &mut AheadState, reading: &SonarReading, range_m: f32) -> bool {
        let [sides, ..] = LOOKS;
        let first = !state.known && state.sweep.looks_aside() < sides;
        if self.paired || !first || reading.servo_rad == 0.0 {
            return state.wall.update(&reading.view, self.beam_rad(), range_m);
        }
        let (left, right) = &mut state.echo;
        *left |= reading.servo_rad > 0.0;
        *right |= reading.servo_rad < 0.0;
        true
    }

    /// Initialises the wall from the ranges alone.
    fn start(&self, state: &mut AheadState, estimate: &Estimate) -> Option<()> {
        if self.paired {
            let ranges_m = [
                valid_m(estimate, SonarId::Left)?,
                valid_m(estimate, SonarId::Right)?,
            ];
            let gap_m = self.params.get(ParamId::FrontGap);
            state
                .wall
                .start_pair(self.ahead_m(), gap_m, self.beam_rad(), ranges_m);
            state.known = true;
            return Some(());
        }
        // A wall known a moment ago is searched where it was; any other on both sides.
        let [sides, ..] = LOOKS;
        let (bearing_rad, looks) = match state.wall.wall() {
            Some(wall) => (wall.bearing_rad, sides),
            None => (0.0, 0),
        };
        self.start_ahead(state, valid_m(estimate, SonarId::Front)?, bearing_rad);
        *state = AheadState {
            wall: state.wall,
            sweep: SweepState::after(looks),
            ..AheadState::default()
        };
        Some(())
    }

    fn start_ahead(&self, state: &mut AheadState, range_m: f32, bearing_rad: f32) {
        let ahead = SonarView {
            x_m: self.ahead_m(),
            ..SonarView::default()
        };
        state.wall.start(&ahead, range_m, bearing_rad, ASKEW_RAD);
    }

    /// One sonar, standing: looks to both sides, then again from the bearing that this gave.
    fn look_first(&self, state: &mut AheadState, estimate: &Estimate) {
        let [sides, well, most] = LOOKS;
        let looks = state.sweep.looks_aside();
        if looks == sides
            && state.echo != (false, false)
            && let Some(range_m) = valid_m(estimate, SonarId::Front)
        {
            match state.echo {
                (true, false) => self.start_ahead(state, range_m, ONE_SIDED_RAD),
                (false, true) => self.start_ahead(state, range_m, -ONE_SIDED_RAD),
                _ => {}
            }
            state.echo = (false, false);
        }
        let sure = |wall: WallEstimate| wall.bearing_variance < KNOWN_RAD * KNOWN_RAD;
        state.known = looks >= most || (looks >= well && state.wall.wall().is_some_and(sure));
    }

    /// Where to look next, from the bearing of the wall's normal.
    pub fn look(
        &self,
        state: &mut AheadState,
        estimate: &Estimate,
        bearing_rad: f32,
        resting: bool,
    ) -> Look {
        if self.paired {
            return Look {
                sonars: [true, true, false],
                ..Look::default()
            };
        }
        let [starting, driving, at_rest] = PINGS_AHEAD;
        let sweep = Sweep {
            aside_rad: self.params.get(ParamId::SweepAside),
            pings_ahead: match (state.known, resting) {
                (false, _) => starting,
                (true, false) => driving,
                (true, true) => at_rest,
            },
        };
        sweep.step(&mut state.sweep, estimate, bearing_rad)
    }
}

/// A range good enough to drive on.
///
/// # Errors
/// It is too old, there is nothing, or the sonar is faulty.
pub fn drivable_m(range: &AgedRange, stale_s: f32) -> Result<f32, Fault> {
    match range.range {
        Range::Valid(_) if range.is_older(stale_s) => Err(Fault::SonarStale),
        Range::Valid(range_m) => Ok(range_m),
        Range::Clear => Err(Fault::WallLost),
        Range::Faulty => Err(Fault::SonarFaulty),
    }
}

fn valid_m(estimate: &Estimate, sonar: SonarId) -> Option<f32> {
    match estimate.range(sonar).range {
        Range::Valid(range_m) => Some(range_m),
        Range::Clear | Range::Faulty => None,
    }
}
