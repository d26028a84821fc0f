//! What is to be simulated: a scenario with its robot and world, checked.

use crate::guard::exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rumbo_control::params::ParamId;
use rumbo_experiment::files::parameters;
use rumbo_experiment::files::{
    Kind, Library, NativeProgram, Overrides, ScenarioFile, SeedSpread, Setup as Files,
};
use rumbo_plant::params::Params;
use std::path::PathBuf;

/// A scenario ready to run.
#[pyclass(frozen, module = "rumbo._rumbo")]
pub(crate) struct Setup {
    pub(crate) files: Files,
    /// The files it was chosen from.
    pub(crate) library: Library,
    /// The scenario as its file has it.
    pub(crate) own: ScenarioFile,
    pub(crate) overrides: Overrides,
    randomize: Option<bool>,
}

/// The value of a parameter, a switch's or a choice's by its name.
#[derive(FromPyObject)]
enum Value {
    Number(f64),
    Name(String),
}

impl Value {
    fn of(self, parameter: &str) -> PyResult<f64> {
        match self {
            Self::Number(value) => Ok(value),
            Self::Name(name) => parameters::parse(parameter, &name).map_err(|error| {
                PyValueError::new_err(format!("parameter {parameter} = {name:?}: {error}"))
            }),
        }
    }
}

#[pymethods]
impl Setup {
    /// `held` are files given as text, as for [`library`].
    #[new]
    #[pyo3(signature = (scenario, *, held, robot, world, policy, rig, parameters, program, firmware, randomize))]
    #[allow(clippy::too_many_arguments, reason = "keywords of one Python call")]
    fn new(
        scenario: &str,
        held: Vec<(String, String, String)>,
        robot: Option<String>,
        world: Option<String>,
        policy: Option<String>,
        rig: Option<String>,
        parameters: Vec<(String, Value)>,
        program: &str,
        firmware: Option<PathBuf>,
        randomize: Option<bool>,
    ) -> PyResult<Self> {
        let library = library(held)?;
        let known = [NativeProgram::Rumbo, NativeProgram::Baseline];
        let program = match known.into_iter().find(|known| word(*known) == program) {
            Some(known) => known,
            None => {
                return Err(PyValueError::new_err(format!(
                    "program = {program:?}: must be \"rumbo\" or \"baseline\"; an image is given by firmware="
                )));
            }
        };
        let parameters = parameters
            .into_iter()
            .map(|(name, value)| value.of(&name).map(|value| (name, value)))
            .collect::<PyResult<_>>()?;
        let overrides = Overrides {
            robot,
            rig,
            world,
            policy,
            parameters,
            program,
            firmware,
            ..Overrides::default()
        };
        let own = library
            .scenario(scenario)
            .map_err(|error| exception(&error))?;
        let mut files = library
            .setup(scenario, &overrides)
            .map_err(|error| exception(&error))?;
        match randomize {
            Some(true) => files.scenario.spread = SeedSpread::Drawn,
            Some(false) => files.scenario.spread = SeedSpread::None,
            None => {}
        }
        Ok(Self {
            files,
            library,
            own,
            overrides,
            randomize,
        })
    }

    /// The arguments that make it anywhere: with the texts of its files, except that of an image.
    fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Files {
            scenario,
            robot,
            world,
            policy,
            ..
        } = &self.files;
        let mut held = vec![
            (Kind::Scenario, &scenario.name, &scenario.text),
            (Kind::Robot, &robot.name, &robot.text),
            (Kind::World, &world.name, &world.text),
        ];
        held.extend(
            policy
                .as_ref()
                .map(|file| (Kind::Policy, &file.name, &file.text)),
        );
        let arguments = PyDict::new(py);
        arguments.set_item("scenario", &scenario.name)?;
        arguments.set_item(
            "held",
            held.iter()
                .map(|(kind, name, text)| (kind.word(), name, text))
                .collect::<Vec<_>>(),
        )?;
        arguments.set_item("robot", &robot.name)?;
        arguments.set_item("world", &world.name)?;
        let policy = policy.as_ref().map(|file| &file.name);
        arguments.set_item("policy", policy)?;
        arguments.set_item("rig", &self.overrides.rig)?;
        arguments.set_item("parameters", &self.overrides.parameters)?;
        arguments.set_item("program", word(self.overrides.program))?;
        arguments.set_item("firmware", &self.overrides.firmware)?;
        arguments.set_item("randomize", self.randomize)?;
        Ok(arguments)
    }

    /// Nothing of it changes.
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// The scenario's name.
    #[getter]
    fn name(&self) -> &str {
        &self.files.scenario.name
    }

    /// The names of its robots; of a single one the scenario's.
    #[getter]
    fn robots(&self) -> Vec<&str> {
        let robots = self.files.robots().iter();
        robots.map(|robot| robot.scenario.name.as_str()).collect()
    }

    /// How long the scenario lasts [s].
    #[getter]
    fn duration_s(&self) -> f64 {
        self.files.scenario.duration_s
    }
}

/// Files by their names, and those `held`: kind (`robot`, `world`, `scenario`), name, TOML.
pub(crate) fn library(held: Vec<(String, String, String)>) -> PyResult<Library> {
    let mut library = Library::new();
    for (kind, name, text) in held {
        library = library.holding(find_kind(&kind)?, &name, &text);
    }
    Ok(library)
}

/// The word for a program.
fn word(program: NativeProgram) -> &'static str {
    match program {
        NativeProgram::Rumbo => "rumbo",
        NativeProgram::Baseline => "baseline",
    }
}

/// Names of the built-in files of a kind, or of all parameters.
#[pyfunction]
pub(crate) fn names(kind: &str) -> PyResult<Vec<String>> {
    if kind == "parameter" {
        let of_control = ParamId::ALL.iter().map(|id| id.name().to_owned());
        let of_plant = Params::limits().into_iter().map(|limit| limit.key);
        return Ok(of_control.chain(of_plant).collect());
    }
    Ok(Library::new().list(find_kind(kind)?))
}

/// The names of the values 0, 1 and so on of a parameter; a number has none.
#[pyfunction]
pub(crate) fn value_names(parameter: &str) -> Vec<&'static str> {
    let id = ParamId::from_name(parameter);
    id.map(|id| id.kind().names().to_vec()).unwrap_or_default()
}

/// The content of a file as JSON, if nothing is wrong with it.
#[pyfunction]
pub(crate) fn load(kind: &str, name_or_path: &str) -> PyResult<String> {
    let library = Library::new();
    let text = match find_kind(kind)? {
        Kind::Robot => library.robot(name_or_path).map(|file| file.text),
        Kind::World => library.world(name_or_path).map(|file| file.text),
        Kind::Scenario => library.scenario(name_or_path).map(|file| file.text),
        Kind::Policy => library.policy(name_or_path).map(|file| file.text),
    }
    .map_err(|error| exception(&error))?;
    let content: toml::Table =
        toml::from_str(&text).map_err(|error| PyValueError::new_err(error.to_string()))?;
    serde_json::to_string(&content).map_err(|error| PyValueError::new_err(error.to_string()))
}

fn find_kind(kind: &str) -> PyResult<Kind> {
    let known = [Kind::Robot, Kind::World, Kind::Scenario, Kind::Policy];
    let found = known.into_iter().find(|known| known.word() == kind);
    found.ok_or_else(|| {
        PyValueError::new_err(format!(
            "kind = {kind:?}: must be \"robot\", \"world\", \"scenario\", \"policy\" or \"parameter\""
        ))
    })
}
