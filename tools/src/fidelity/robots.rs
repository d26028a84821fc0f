//! The robots of the comparison, as scenarios draw them.

use crate::fidelity::arguments::Arguments;
use rumbo_experiment::files::{FileError, Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run_all};
use rumbo_plant::params::Params;

pub(crate) struct Robots {
    library: Library,
    overrides: Overrides,
    plant: Params,
    seeds: u64,
}

impl Robots {
    pub(crate) fn new(arguments: &Arguments) -> Result<Self, FileError> {
        let library = Library::new();
        let mut plant = library.robot(&arguments.robot)?.plant;
        for (key, value) in &arguments.parameters {
            let set = plant.set(key, *value);
            set.map_err(|error| FileError::Setting(error.to_string()))?;
        }
        let overrides = Overrides {
            robot: Some(arguments.robot.clone()),
            program: NativeProgram::Baseline,
            parameters: arguments.parameters.clone(),
            ..Overrides::default()
        };
        Ok(Self {
            library,
            overrides,
            plant,
            seeds: arguments.seeds,
        })
    }

    /// The robot in the middle of them.
    pub(crate) fn plant(&self) -> &Params {
        &self.plant
    }

    /// A scenario that the report's program drives, with these numbers of the plant.
    pub(crate) fn setup(
        &self,
        scenario: &str,
        plant: &[(String, f64)],
    ) -> Result<Setup, FileError> {
        let mut overrides = self.overrides.clone();
        overrides.parameters.extend_from_slice(plant);
        self.library.setup(scenario, &overrides)
    }

    /// Each robot in this setup.
    pub(crate) fn run(
        &self,
        setup: &Setup,
        mut each: impl FnMut(&RunResult),
    ) -> Result<(), FileError> {
        let jobs: Vec<(&Setup, u64)> = (1..=self.seeds).map(|seed| (setup, seed)).collect();
        run_all(&jobs, |_, result| {
            each(&result);
            Ok(())
        })
    }
}
