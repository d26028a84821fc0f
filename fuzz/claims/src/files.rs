//! Any file is a scenario, a world, a robot, or a list of errors. For a valid scenario a seed can be drawn. The first
//! byte selects the kind.

use rumbo_experiment::files::{
    FileError, Kind, Library, Overrides, RobotFile, ScenarioFile, WorldFile,
};

/// The name of the file.
const NAME: &str = "fuzz";

fn or_errors<T>(read: Result<T, FileError>) -> Option<T> {
    read.map_err(|error| assert!(!error.to_string().is_empty()))
        .ok()
}

/// Panics if the claim does not hold.
pub fn check(bytes: &[u8]) {
    let Some((first, text)) = bytes.split_first() else {
        return;
    };
    // With a slash it could name files of this computer.
    let Ok(text) = std::str::from_utf8(text) else {
        return;
    };
    let mut overrides = Overrides::default();
    let (kind, scenario) = match first % 3 {
        0 => {
            or_errors(ScenarioFile::parse(NAME, NAME, text));
            (Kind::Scenario, NAME)
        }
        1 => {
            if let Some(world) = or_errors(WorldFile::parse(NAME, NAME, text)) {
                world.world().expect("a world that was read has shapes");
            }
            overrides.world = Some(NAME.into());
            (Kind::World, "free")
        }
        _ => {
            or_errors(RobotFile::parse(NAME, NAME, text));
            overrides.robot = Some(NAME.into());
            (Kind::Robot, "mode1")
        }
    };
    if text.contains(['/', '\\']) || text.contains(".toml") {
        return;
    }
    let library = Library::new().holding(kind, NAME, text);
    if let Some(setup) = or_errors(library.setup(scenario, &overrides)) {
        or_errors(setup.of_seed(1));
        or_errors(setup.control_parameters());
        or_errors(setup.rig_parameters());
    }
}
