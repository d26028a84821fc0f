//! Calibrations of simulated robots, kept: many runs need the same one.

use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Most that are kept; then all are dropped.
const MOST: usize = 10_000;

/// Calibrations by the seed of the robot. All are equal: which are kept makes no difference to what a setup is.
#[derive(Clone, Debug, Default)]
pub struct Calibrations(Arc<Mutex<HashMap<u64, Calibrated>>>);

/// A calibration, and what it depends on besides the seed.
#[derive(Clone, Debug)]
pub(crate) struct Calibrated {
    /// The robot, as drawn.
    pub(crate) robot: Params,
    /// The parameters of its program before.
    pub(crate) before: Vec<(ParamId, f32)>,
    /// The parameters found.
    pub(crate) found: Vec<(ParamId, f32)>,
}

impl PartialEq for Calibrations {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Calibrations {
    /// The parameters found for the robot of a seed, if it was this one.
    pub(crate) fn found(
        &self,
        seed: u64,
        robot: &Params,
        before: &[(ParamId, f32)],
    ) -> Option<Vec<(ParamId, f32)>> {
        let all = self.all();
        let one = all.get(&seed)?;
        (one.robot == *robot && one.before == before).then(|| one.found.clone())
    }

    pub(crate) fn keep(&self, seed: u64, calibrated: Calibrated) {
        let mut all = self.all();
        if all.len() >= MOST {
            all.clear();
        }
        all.insert(seed, calibrated);
    }

    fn all(&self) -> MutexGuard<'_, HashMap<u64, Calibrated>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
