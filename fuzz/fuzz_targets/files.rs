//! Any file is a scenario, a world, a robot, or a list of errors. For a valid scenario a seed can be drawn. The first
//! byte selects the kind.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rumbo_experiment::files::{
    FileError, Kind, Library, Overrides, RobotFile, ScenarioFile, WorldFile,
};

/// The name of the file.
const NAME: &str = "fuzz";

fn check<T>(read: Result<T, FileError>) -> Option<T> {
    read.map_err(|error| assert!(!error.to_string().is_empty()))
        .ok()
}

fuzz_target!(|bytes: &[u8]| {
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
            check(ScenarioFile::parse(NAME, NAME, text));
            (Kind::Scenario, NAME)
        }
        1 => {
            if let Some(world) = check(WorldFile::parse(NAME, NAME, text)) {
                world.world().expect("a world that was read has shapes");
            }
            overrides.world = Some(NAME.into());
            (Kind::World, "free")
        }
        _ => {
            check(RobotFile::parse(NAME, NAME, text));
            overrides.robot = Some(NAME.into());
            (Kind::Robot, "mode1")
        }
    };
    if text.contains(['/', '\\']) || text.contains(".toml") {
        return;
    }
    let library = Library::new().holding(kind, NAME, text);
    if let Some(setup) = check(library.setup(scenario, &overrides)) {
        check(setup.of_seed(1));
        check(setup.control_parameters());
        check(setup.rig_parameters());
    }
});
