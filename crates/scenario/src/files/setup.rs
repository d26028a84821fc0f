//! A scenario with everything it names, and what the command line changes about it.

use super::error::FileError;
use super::near::near_or_all;
use super::{Library, RobotFile, ScenarioFile, WorldFile, parameters};
use rumbo_plant::plant::Rig;

/// What the command line sets in place of the scenario's own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Another robot.
    pub robot: Option<String>,
    /// Another rig.
    pub rig: Option<String>,
    /// Another world.
    pub world: Option<String>,
    /// Parameters by name: those of the control core, or dotted ones of the plant such as `battery.open_circuit_v`.
    pub parameters: Vec<(String, f64)>,
}

/// A scenario ready to be run.
#[derive(Clone, Debug, PartialEq)]
pub struct Setup {
    /// The scenario, with the overrides applied.
    pub scenario: ScenarioFile,
    /// Its robot.
    pub robot: RobotFile,
    /// Where its sonars sit.
    pub rig: Rig,
    /// Its world.
    pub world: WorldFile,
}

impl Library {
    /// Reads a scenario and what it names, with overrides. Paths in the scenario are relative to its own file, paths
    /// in the overrides to the current folder.
    ///
    /// # Errors
    /// Whatever is wrong with any of them.
    pub fn setup(&self, name_or_path: &str, overrides: &Overrides) -> Result<Setup, FileError> {
        let mut scenario = self.scenario(name_or_path)?;
        let beside = self.beside(name_or_path);
        let robot = match &overrides.robot {
            Some(robot) => self.robot(robot)?,
            None => beside.robot(&scenario.robot)?,
        };
        let world = match &overrides.world {
            Some(world) => self.world(world)?,
            None => beside.world(&scenario.world)?,
        };
        scenario.robot.clone_from(&robot.name);
        scenario.world.clone_from(&world.name);
        if let Some(rig) = &overrides.rig {
            scenario.rig.clone_from(rig);
        }
        for (name, value) in &overrides.parameters {
            apply(&mut scenario, name, *value)?;
        }
        let rig = robot
            .rigs
            .get(&scenario.rig)
            .copied()
            .ok_or_else(|| FileError::Unknown {
                kind: "rig",
                name: scenario.rig.clone(),
                near: near_or_all(&scenario.rig, robot.rigs.keys().map(String::as_str)),
            })?;
        Ok(Setup {
            scenario,
            robot,
            rig,
            world,
        })
    }
}

/// Sets one parameter: of the plant if its name is dotted, of the control core otherwise.
fn apply(scenario: &mut ScenarioFile, name: &str, value: f64) -> Result<(), FileError> {
    let wrong =
        |remedy: String| FileError::Setting(format!("parameter {name} = {value}: {remedy}"));
    if name.contains('.') {
        let mut scratch = rumbo_plant::params::Params::default();
        scratch
            .set(name, value)
            .map_err(|error| wrong(error.to_string()))?;
        scenario.plant.insert(name.to_owned(), value);
        return Ok(());
    }
    let allowed = parameters::find(name).map_err(wrong)?.allowed();
    if !(allowed.min..=allowed.max).contains(&value) {
        return Err(wrong(allowed.remedy()));
    }
    scenario.parameters.insert(name.to_owned(), value as f32);
    Ok(())
}
