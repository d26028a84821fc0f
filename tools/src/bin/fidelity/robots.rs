//! The robots of the comparison: a robot file's, or those that the recordings leave possible.

use crate::arguments::Arguments;
use crate::days;
use rumbo_experiment::files::{FileError, Library, NativeProgram, Overrides, Setup};
use rumbo_experiment::run::{RunResult, run_all};
use rumbo_plant::noise::{Noise, source};
use rumbo_plant::params::Params;

/// Numbers of [`source::DRAW`] from here on draw a plant from the posterior.
const POSTERIOR: u32 = source::DRAW + 100;

pub(crate) struct Robots {
    library: Library,
    overrides: Overrides,
    plant: Params,
    /// One for each seed.
    drawn: Vec<Params>,
}

impl Robots {
    pub(crate) fn new(arguments: &Arguments) -> Result<Self, FileError> {
        let wrong = |error: &dyn std::fmt::Display| FileError::Setting(error.to_string());
        let library = Library::new();
        let mut plant = library.robot(&arguments.robot)?.plant;
        let seeds = 1..=arguments.seeds;
        let drawn = if arguments.identify {
            let logs = days::recordings(&arguments.recordings)?;
            eprintln!("fitting the plant to {} recordings", logs.len());
            let found = rumbo_identify::identify(&logs, &plant, 0, &|_| {});
            let found = found.map_err(|error| wrong(&error))?;
            eprintln!("{found}");
            plant = found.params;
            let drawn = |seed| {
                let (noise, mut index) = (Noise::new(seed, 0), POSTERIOR);
                found.posterior.plant(|| {
                    index += 1;
                    noise.normal(index, 0)
                })
            };
            seeds.map(drawn).collect()
        } else {
            seeds.map(|_| plant).collect()
        };
        for (key, value) in &arguments.parameters {
            plant.set(key, *value).map_err(|error| wrong(&error))?;
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
            drawn,
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
        let of_robot = |plant: &Params| {
            let mut setup = setup.clone();
            setup.robot.plant = *plant;
            setup
        };
        let setups: Vec<Setup> = self.drawn.iter().map(of_robot).collect();
        let jobs: Vec<(&Setup, u64)> = setups.iter().zip(1..).collect();
        run_all(&jobs, |_, result| {
            each(&result);
            Ok(())
        })
    }
}
