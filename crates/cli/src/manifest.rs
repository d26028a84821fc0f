//! What a run was made of, as its log says it, and the same made into a run again.

use crate::failure::Failure;
use rumbo_scenario::files::{Kind as File, Library, Overrides, Program, Setup, TimedText};
use rumbo_station::log::{Kind, Manifest};
use std::path::{Path, PathBuf};

/// The manifest of a setup as the command line made it; `step_us` and the time are for the one who runs it.
pub(crate) fn of(kind: Kind, setup: &Setup, overrides: &Overrides, seed: u64) -> Manifest {
    let program = match (&overrides.firmware, setup.program) {
        (Some(image), _) => image.display().to_string(),
        (None, Program::Rumbo) => "rumbo".into(),
        (None, Program::Original) => "original".into(),
    };
    let files = [
        ("scenario", &setup.scenario.text),
        ("robot", &setup.robot.text),
        ("world", &setup.world.text),
    ];
    Manifest {
        kind,
        version: env!("CARGO_PKG_VERSION").into(),
        scenario: Some(setup.scenario.name.clone()),
        robot: Some(setup.robot.name.clone()),
        world: Some(setup.world.name.clone()),
        rig: Some(setup.scenario.rig.clone()),
        wiring: overrides.wiring.clone(),
        program,
        image: overrides.firmware.as_deref().and_then(hash),
        seed: Some(seed),
        parameters: overrides.parameters.clone(),
        texts: overrides
            .texts
            .iter()
            .map(|timed| (timed.at_s, timed.text.clone()))
            .collect(),
        files: files
            .map(|(name, text)| (name.to_owned(), text.clone()))
            .into(),
        ..Manifest::default()
    }
}

/// CRC-32 of a file, as hexadecimal digits.
pub(crate) fn hash(path: &Path) -> Option<String> {
    let bytes = std::fs::read(path).ok()?;
    let crc = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
    Some(format!("{:08x}", crc.checksum(&bytes)))
}

/// The setup that a manifest describes, and its seed.
pub(crate) fn setup(log: &Path, manifest: &Manifest) -> Result<(Setup, u64), Failure> {
    let wrong = |what: &str| Failure::Input(format!("{}: {what}", log.display()));
    let (Some(scenario), Some(robot), Some(world), Some(seed)) = (
        &manifest.scenario,
        &manifest.robot,
        &manifest.world,
        manifest.seed,
    ) else {
        return Err(wrong(
            "holds no simulated run; only logs of `rumbo lab`, `rumbo run` and `rumbo calibrate` can be run again",
        ));
    };
    let mut library = Library::new();
    for (kind, file, name) in [
        (File::Scenario, "scenario", scenario),
        (File::Robot, "robot", robot),
        (File::World, "world", world),
    ] {
        let text = manifest
            .files
            .get(file)
            .ok_or_else(|| wrong(&format!("its {file} is missing; the log is damaged")))?;
        library = library.holding(kind, name, text);
    }
    let firmware = (!["rumbo", "original"].contains(&manifest.program.as_str()))
        .then(|| PathBuf::from(&manifest.program));
    if let Some(image) = &firmware
        && hash(image) != manifest.image
    {
        return Err(wrong(&format!(
            "its program {} is gone or is another one now; put it back there",
            manifest.program
        )));
    }
    let overrides = Overrides {
        robot: Some(robot.clone()),
        rig: manifest.rig.clone(),
        world: Some(world.clone()),
        parameters: manifest.parameters.clone(),
        program: if manifest.program == "original" {
            Program::Original
        } else {
            Program::Rumbo
        },
        firmware,
        wiring: manifest.wiring.clone(),
        texts: manifest
            .texts
            .iter()
            .map(|(at_s, text)| TimedText {
                at_s: *at_s,
                text: text.clone(),
            })
            .collect(),
    };
    Ok((library.setup(scenario, &overrides)?, seed))
}
