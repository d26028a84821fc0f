//! The robots of the comparison, as scenarios draw them.

use rumbo_experiment::files::{FileError, Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run_all};
use rumbo_plant::params::Params;

pub(crate) struct Robots {
    library: Library,
    plant: Params,
    pub(crate) seeds: u64,
}

impl Robots {
    pub(crate) fn new(seeds: u64) -> Result<Self, FileError> {
        let library = Library::new();
        let plant = library.robot("memoria")?.plant;
        Ok(Self {
            library,
            plant,
            seeds,
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
        let overrides = Overrides {
            robot: Some("memoria".to_owned()),
            program: NativeProgram::Baseline,
            parameters: plant.to_vec(),
            ..Overrides::default()
        };
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
