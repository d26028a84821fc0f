//! Files of earlier versions: they load and run, or the error names a key's successor.

#![cfg(test)]

use rumbo_experiment::files::{Kind, Library, Overrides, RobotFile};
use rumbo_experiment::run::run;

const ROBOT: &str = include_str!("../data/0.1.0/memoria.toml");
const SCENARIO: &str = include_str!("../data/0.1.0/mode8-goals.toml");

#[test]
fn a_robot_and_a_scenario_of_version_0_1_0_load_and_run() {
    let library = Library::new()
        .holding(Kind::Robot, "memoria", ROBOT)
        .holding(Kind::Scenario, "mode8-goals", SCENARIO);
    let setup = library.setup("mode8-goals", &Overrides::default()).unwrap();
    assert_eq!(
        (setup.robot.rigs.len(), setup.robot.text.as_str()),
        (5, ROBOT)
    );
    assert_eq!(setup.scenario.text, SCENARIO);
    let result = run(&setup, 1).unwrap();
    assert_eq!(result.failures, [""; 0]);
    assert_eq!(result.metrics["reached"], 4.0);
}

#[test]
fn a_dropped_key_names_its_successor() {
    let section = "[plant.sonar]\nnoise_rest_m = 0.0015\nnoise_rest = 1\n";
    let old = ROBOT.replace("[plant.sonar]\n", section);
    let error = RobotFile::parse("old", "old.toml", &old)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains(
            "plant.sonar.noise_rest_m = 0.0015: key of an earlier version; write `noise_m`, the deviation in motion, \
             and `rest_weakness`, its share at rest"
        ),
        "{error}"
    );
    assert!(
        error.contains("plant.sonar.noise_rest = 1: unknown key; did you mean"),
        "{error}"
    );
}
