//! Puts a scenario together with everything it names.

use super::error::{FileError, did_you_mean};
use super::fit::{has_its_goal, has_its_parts, has_its_sonars};
use super::kept::Calibrations;
use super::near::near_or_all;
use super::setup::{Overrides, Setup, apply};
use super::start::{stand_apart, stands_free};
use super::{Library, RobotFile, ScenarioFile, firmware};
use rumbo_plant::plant::Mounts;
use std::path::PathBuf;
use std::sync::Arc;

impl Library {
    /// Reads a scenario and what it names, with overrides. Paths in the scenario are relative to its own file, paths
    /// in the overrides to the current folder.
    ///
    /// # Errors
    /// The problems of any of them.
    pub fn setup(&self, name_or_path: &str, overrides: &Overrides) -> Result<Setup, FileError> {
        let mut scenario = self.scenario(name_or_path)?;
        let beside = self.beside(name_or_path);
        let members = std::mem::take(&mut scenario.fleet);
        if members.is_empty() {
            return self.assemble(scenario, &beside, overrides, true);
        }
        let fleet = (0..).zip(members).map(|(number, member)| {
            let own = overrides.of_member(&member, &beside);
            let setup = self.assemble(member.scenario, &beside, &own, false)?;
            Ok::<_, FileError>(Setup { number, ..setup })
        });
        let fleet = fleet.collect::<Result<Vec<_>, _>>()?;
        stand_apart(&scenario.name, &fleet)?;
        let mut first = fleet[0].clone();
        (first.scenario.name, first.scenario.path) = (scenario.name, scenario.path);
        (first.scenario.text, first.scenario.limits) = (scenario.text, scenario.limits);
        Ok(Setup { fleet, ..first })
    }

    /// Puts a robot's scenario together, whose paths are relative to `beside`. The start of a world is for a robot that
    /// is alone in it.
    fn assemble(
        &self,
        mut scenario: ScenarioFile,
        beside: &Self,
        overrides: &Overrides,
        alone: bool,
    ) -> Result<Setup, FileError> {
        let robot = match &overrides.robot {
            Some(robot) => self.robot(robot)?,
            None => beside.robot(&scenario.robot)?,
        };
        let world = match &overrides.world {
            Some(world) => self.world(world)?,
            None => beside.world(&scenario.world)?,
        };
        let policy = match (&overrides.policy, &scenario.policy) {
            (Some(policy), _) => Some(self.policy(policy)?),
            (None, Some(policy)) => Some(beside.policy(policy)?),
            (None, None) => None,
        };
        scenario.robot.clone_from(&robot.name);
        scenario.world.clone_from(&world.name);
        if let Some(rig) = &overrides.rig {
            scenario.rig.clone_from(rig);
        }
        set_parameters(&mut scenario, &overrides.parameters)?;
        if let Some(duration_s) = overrides.duration_s {
            last_for(&mut scenario, duration_s)?;
        }
        if let Some(start) = world.start.filter(|_| alone) {
            scenario.start = start;
        }
        stands_free(&scenario, &robot, &world, alone)?;
        has_its_goal(&scenario, &world)?;
        let whose = match alone {
            true => format!("scenario {}", scenario.name),
            false => format!("robot {}", scenario.name),
        };
        let rig = rig(&mut scenario, &robot, overrides, &whose)?;
        has_its_sonars(&whose, &scenario, &rig)?;
        let wiring = overrides.wiring.as_deref();
        let load = |path: &PathBuf| {
            let firmware = firmware::load(path, wiring, &robot, &scenario)?;
            firmware::beside(firmware, policy.as_ref()).map(Arc::new)
        };
        let firmware = overrides.firmware.as_ref().map(load).transpose()?;
        let mut texts = [&scenario.texts[..], &overrides.texts].concat();
        texts.sort_by(|one, other| one.at_s.total_cmp(&other.at_s));
        let parts = firmware.as_ref().map(|firmware| firmware.parts());
        has_its_parts(&whose, &texts, parts.unwrap_or_default())?;
        Ok(Setup {
            scenario,
            robot,
            rig,
            world,
            policy,
            program: overrides.program,
            firmware,
            texts,
            ground_truth: overrides.ground_truth,
            calibrations: Calibrations::default(),
            number: 0,
            fleet: Vec::new(),
        })
    }
}

/// Has a scenario last for another time, in which all of its commands are.
fn last_for(scenario: &mut ScenarioFile, duration_s: f64) -> Result<(), FileError> {
    let commands = scenario.commands.iter().map(|command| command.at_s);
    let texts = scenario.texts.iter().map(|text| text.at_s);
    scenario.duration_s = duration_s;
    match commands.chain(texts).find(|at_s| *at_s >= duration_s) {
        None => Ok(()),
        Some(at_s) => Err(FileError::Setting(format!(
            "scenario {}: has a command at {at_s} s, and --duration is {duration_s} s: it must be more",
            scenario.name
        ))),
    }
}

/// Where the sonars of a robot sit by the scenario's rig, or by that in its place.
fn rig(
    scenario: &mut ScenarioFile,
    robot: &RobotFile,
    overrides: &Overrides,
    whose: &str,
) -> Result<Mounts, FileError> {
    // A robot of one's own in a scenario for another has its own sonars; of several rigs the first where nothing is
    // asked of the robot.
    let is_own = overrides.robot.is_some();
    let is_free = is_own && scenario.commands.is_empty() && scenario.limits.is_empty();
    if overrides.rig.is_none()
        && (scenario.rig.is_empty() || is_own)
        && !robot.rigs.contains_key(&scenario.rig)
        && (robot.rigs.len() < 2 || is_free)
    {
        scenario.rig = robot.rigs.keys().next().cloned().unwrap_or_default();
    }
    let sonarless = scenario.rig.is_empty() && robot.rigs.is_empty();
    let rig = robot.rigs.get(&scenario.rig).copied();
    rig.or(sonarless.then(Mounts::default)).ok_or_else(|| {
        let near = near_or_all(&scenario.rig, robot.rigs.keys().map(String::as_str));
        match &overrides.rig {
            Some(name) => FileError::Unknown {
                kind: "rig",
                name: name.clone(),
                near,
            },
            None => FileError::Setting(format!(
                "{whose}: robot {} has no rig `{}`; {}",
                robot.name,
                scenario.rig,
                did_you_mean(&near)
            )),
        }
    })
}

/// Sets the parameters of the command line, each once.
fn set_parameters(scenario: &mut ScenarioFile, values: &[(String, f64)]) -> Result<(), FileError> {
    for (index, (name, value)) in values.iter().enumerate() {
        if values[..index].iter().any(|(other, _)| other == name) {
            return Err(FileError::Setting(format!(
                "parameter {name} is given twice; give it once, or compare both with `rumbo compare`"
            )));
        }
        apply(scenario, name, *value)?;
    }
    Ok(())
}
