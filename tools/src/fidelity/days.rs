//! Battery and floor of the days on which the runs were recorded, as `rumbo identify --check` finds them.

use crate::fidelity::figures::Experiment;
use rumbo_experiment::files::FileError;
use rumbo_identify::{DriveLog, Nuisance, check};
use rumbo_plant::params::Params;
use std::collections::BTreeMap;
use std::path::Path;

pub(crate) struct Days {
    plant: Params,
    nuisances: BTreeMap<String, Nuisance>,
}

impl Days {
    /// Repeats each recorded run on the plant.
    pub(crate) fn read(
        folder: &Path,
        experiments: &[Experiment],
        plant: &Params,
    ) -> Result<Self, FileError> {
        let mut nuisances = BTreeMap::new();
        for name in experiments.iter().filter_map(|one| one.recording.as_ref()) {
            let log = DriveLog::read(&folder.join(name));
            let log = log.map_err(|error| FileError::Setting(error.to_string()))?;
            // A run that does not show the drive does not show its day either.
            if let Ok(runs) = check(std::slice::from_ref(&log), plant)
                && let Some(run) = runs.first()
            {
                eprintln!("{run}");
                nuisances.insert(log.name, run.nuisance);
            }
        }
        Ok(Self {
            plant: *plant,
            nuisances,
        })
    }

    /// Numbers of the plant on the day of this experiment, where its recording shows them.
    pub(crate) fn of(&self, experiment: &Experiment) -> Option<Vec<(String, f64)>> {
        let day = self.nuisances.get(experiment.recording.as_ref()?)?;
        Some(vec![
            ("battery.open_circuit_v".to_owned(), day.battery_v),
            (
                "floor.friction_scale".to_owned(),
                day.floor_scale * self.plant.floor.friction_scale,
            ),
        ])
    }
}
