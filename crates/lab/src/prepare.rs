//! A simulation of the lab, before its first step.

use crate::manifest;
use crate::program::Held;
use crate::scene::{first_commands, others, scene};
use rumbo_control::mode::ModeId;
use rumbo_experiment::files::{FileError, Library, Overrides, Setup};
use rumbo_experiment::run;
use rumbo_log::{Choice, LogKind, Manifest, Scene};
use rumbo_sim::{Config, Sim};
use rumbo_wire::Command;

/// A robot at time 0 and its surroundings.
pub(crate) struct Prepared {
    pub(crate) sim: Sim,
    pub(crate) mode: ModeId,
    pub(crate) scene: Scene,
    pub(crate) first_commands: Vec<Command>,
    pub(crate) manifest: Manifest,
}

impl Prepared {
    /// What a scenario of several calls it.
    pub(crate) fn name(&self) -> &str {
        self.manifest.member.as_deref().unwrap_or_default()
    }
}

/// The overrides with the world and the rig of a choice.
pub(crate) fn chosen(overrides: &Overrides, choice: &Choice) -> Overrides {
    Overrides {
        world: choice.world.clone(),
        rig: choice.rig.clone(),
        ..overrides.clone()
    }
}

/// Prepares the robots of the page's choice, at least one, on emulated chips with an image; `memories` are what their EEPROMs hold, as
/// far as they hold any.
pub(crate) fn prepare(
    library: &Library,
    overrides: &Overrides,
    image: Option<&Held>,
    choice: &Choice,
    memories: &[Vec<u8>],
) -> Result<Vec<Prepared>, FileError> {
    let (setup, manifest) = set_up(library, overrides, image, choice)?;
    let robots = setup.robots().iter().enumerate().map(|(number, own)| {
        let memory = memories.get(number).map_or(&[][..], Vec::as_slice);
        let mut manifest = manifest.clone();
        manifest.member = (!setup.fleet.is_empty()).then(|| own.scenario.name.clone());
        manifest.remember(memory);
        let mut prepared = ready(library, own, choice.clone(), memory, manifest)?;
        prepared.scene.others = others(&setup.fleet, number);
        Ok(prepared)
    });
    robots.collect()
}

/// The setup of the page's choice, and its manifest.
pub(crate) fn set_up(
    library: &Library,
    overrides: &Overrides,
    image: Option<&Held>,
    choice: &Choice,
) -> Result<(Setup, Manifest), FileError> {
    let overrides = chosen(overrides, choice);
    let mut setup: Setup = library.setup(&choice.scenario, &overrides)?;
    let mut manifest = manifest::of(LogKind::Lab, &setup, &overrides, choice.seed);
    if let Some(held) = image {
        setup.firmware = Some(held.firmware(&setup, overrides.wiring.as_deref())?);
        manifest.program.clone_from(&held.name);
        manifest.image = Some(held.hash.clone());
    }
    Ok((setup, manifest))
}

fn ready(
    library: &Library,
    setup: &Setup,
    choice: Choice,
    memory: &[u8],
    manifest: Manifest,
) -> Result<Prepared, FileError> {
    let setup = run::prepare(setup, choice.seed)?;
    Ok(Prepared {
        sim: Sim::new(Config {
            memory: memory.to_vec(),
            ..setup.config(choice.seed)?
        })?,
        mode: setup.scenario.mode,
        scene: scene(library, &setup, choice)?,
        first_commands: first_words(&setup)?,
        manifest,
    })
}

/// The first commands to the robot. An image does not have its parameters yet, and one with the text protocol sets its
/// own mode.
fn first_words(setup: &Setup) -> Result<Vec<Command>, FileError> {
    let mut commands = first_commands(setup);
    if setup.firmware.is_none() {
        return Ok(commands);
    }
    if !setup.takes_parameters() {
        commands.retain(|command| !matches!(command, Command::Mode(_)));
        return Ok(commands);
    }
    let parameters = setup.control_parameters()?.into_iter();
    let parameters = parameters.map(|(id, value)| Command::SetParam {
        id: id as u8,
        value,
    });
    Ok(parameters.chain(commands).collect())
}
