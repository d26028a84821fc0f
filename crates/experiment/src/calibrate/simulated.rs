//! The calibration of a simulated robot, in the world made for it.

use super::{CalibrateError, Calibration, calibrate};
use crate::files::{FileError, Library, Setup};
use rumbo_sim::{Config, Sim};

/// The built-in world of a calibration.
pub const WORLD: &str = "calibration";
/// The built-in scenario that only sets the start: along the wall on its right, free floor ahead.
pub(crate) const PLAN: &str = "calibration";

/// Calibrates the robot that `seed` draws in `setup`, on its rig in the world of calibrations (or `setup`'s own with
/// `here`), always from the same pose. Floor, slip and noise differ from those of the run itself. Returns the
/// calibration and the simulation at its end.
///
/// # Errors
/// A mistake in the files; the inner one: why the calibration failed.
pub fn calibrate_simulated(
    setup: &Setup,
    seed: u64,
    here: bool,
) -> Result<(Result<Calibration, CalibrateError>, Sim), FileError> {
    let mut own = setup.clone();
    own.scenario.wheels_in_air = false;
    own.scenario.sonar_faults.clear();
    own.scenario.wire_faults.clear();
    let library = Library::new();
    own.scenario.start = library.scenario(PLAN)?.start;
    if !here {
        own.world = library.world(WORLD)?;
        own.scenario.world.clone_from(&own.world.name);
    }
    let mut sim = robot(&own, seed)?;
    let found = calibrate(&mut sim);
    Ok((found, sim))
}

/// The robot of a seed on another day: floor, slip and noise differ from those of its runs.
pub(crate) fn robot(setup: &Setup, seed: u64) -> Result<Sim, FileError> {
    let config = setup.config(seed)?;
    Ok(Sim::new(Config { day: 1, ..config })?)
}
