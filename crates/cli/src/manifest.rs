//! The manifest of a log, converted back into a run.

use crate::failure::Failure;
use rumbo_experiment::files::{
    Kind, Library, NativeProgram, Overrides, Setup, TimedText, TypedPort,
};
use rumbo_lab::manifest::{OF_FLEET, OF_POLICY, hash};
use rumbo_log::Manifest;
use rumbo_wire::LineEnding;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// How far a simulation advances at once [us].
const MIN_STEP_US: u64 = 1_000;
const MAX_STEP_US: u64 = 100_000;
/// Lines of text beside a scenario's commands, and when the last may come [s].
const MOST_TEXTS: usize = 10_000;
pub(crate) const LONGEST_S: f64 = 3_600.0;
/// Of the ATmega2560 [bytes].
const EEPROM: usize = 4_096;

fn typed(manifest: &Manifest) -> Vec<TimedText> {
    let ending = manifest.line_ending.as_deref();
    let ending = ending.and_then(LineEnding::named).unwrap_or_default();
    let lines = |texts: &[(f64, String)], port: TypedPort| -> Vec<TimedText> {
        let timed = texts.iter().map(|(at_s, text)| TimedText {
            at_s: *at_s,
            text: text.clone(),
            ending,
            port,
        });
        timed.collect()
    };
    let mut texts = lines(&manifest.texts, TypedPort::Link);
    texts.extend(lines(&manifest.usb_texts, TypedPort::Usb));
    let parts = lines(&manifest.part_texts, TypedPort::Parts).into_iter();
    let parts = parts.chain(lines(&manifest.hand_texts, TypedPort::Hand));
    texts.extend(parts.map(|text| TimedText {
        ending: LineEnding::None,
        ..text
    }));
    texts
}

/// Rejects values that no recorded run can have had.
fn check_ranges(log: &Path, manifest: &Manifest) -> Result<(), Failure> {
    let wrong = |key: &str, value: &dyn Display, range: &str| {
        let log = log.display();
        Failure::Input(format!(
            "{log}: {key} = {value} in its manifest: must be {range}; the log is damaged or forged"
        ))
    };
    let step_us = manifest.step_us;
    if !(MIN_STEP_US..=MAX_STEP_US).contains(&step_us) {
        let range = format!("within {MIN_STEP_US}..{MAX_STEP_US}");
        return Err(wrong("step_us", &step_us, &range));
    }
    if let Some(duration_s) = manifest.duration_s
        && !(0.0..=LONGEST_S).contains(&duration_s)
    {
        let range = format!("within 0..{LONGEST_S} s");
        return Err(wrong("duration_s", &duration_s, &range));
    }
    for (key, texts) in [
        ("texts", &manifest.texts),
        ("usb_texts", &manifest.usb_texts),
        ("part_texts", &manifest.part_texts),
        ("hand_texts", &manifest.hand_texts),
    ] {
        if texts.len() > MOST_TEXTS {
            let range = format!("at most {MOST_TEXTS} lines");
            return Err(wrong(key, &texts.len(), &range));
        }
        let is_late = |(at_s, _): &&(f64, String)| !(0.0..=LONGEST_S).contains(at_s);
        if let Some((at_s, _)) = texts.iter().find(is_late) {
            return Err(wrong(key, at_s, &format!("within 0..{LONGEST_S} s")));
        }
    }
    let eeprom = manifest
        .eeprom
        .as_ref()
        .map_or(0, |digits| digits.len() / 2);
    if eeprom > EEPROM {
        return Err(wrong("eeprom", &eeprom, &format!("at most {EEPROM} bytes")));
    }
    Ok(())
}

/// Its files by what follows this prefix in their names.
fn kept<'a>(
    manifest: &'a Manifest,
    prefix: &'static str,
) -> impl Iterator<Item = (&'a str, &'a str)> {
    let files = manifest.files.iter();
    files.filter_map(move |(file, text)| Some((file.strip_prefix(prefix)?, text.as_str())))
}

/// The library with its files: of scenario, robot and world by these names. An error is the one that it lacks.
fn library(manifest: &Manifest, names: [&String; 3]) -> Result<Library, &'static str> {
    let kinds = [
        (Kind::Scenario, "scenario"),
        (Kind::Robot, "robot"),
        (Kind::World, "world"),
    ];
    let mut library = Library::new();
    for ((kind, file), name) in std::iter::zip(kinds, names) {
        library = library.holding(kind, name, manifest.files.get(file).ok_or(file)?);
    }
    for (kind, prefix) in [(Kind::Robot, OF_FLEET), (Kind::Policy, OF_POLICY)] {
        for (name, text) in kept(manifest, prefix) {
            library = library.holding(kind, name, text);
        }
    }
    Ok(library)
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
    check_ranges(log, manifest)?;
    let names = [scenario, robot, world];
    let library = library(manifest, names)
        .map_err(|file| wrong(&format!("its {file} is missing; the log is damaged")))?;
    let robots = kept(manifest, OF_FLEET).count();
    let policy = kept(manifest, OF_POLICY).last();
    let (program, firmware) = match manifest.program.as_str() {
        "rumbo" => (NativeProgram::Rumbo, None),
        "baseline" => (NativeProgram::Baseline, None),
        image => (NativeProgram::default(), Some(PathBuf::from(image))),
    };
    // A log may name any file: one that is not the recorded program is rejected.
    if let Some(image) = &firmware
        && (manifest.image.is_none() || hash(image) != manifest.image)
    {
        return Err(wrong(&format!(
            "its program {} is gone or is another one now; put it back there",
            manifest.program
        )));
    }
    let overrides = Overrides {
        // Several robots of several kinds are those of the scenario.
        robot: (robots < 2).then(|| robot.clone()),
        rig: manifest.rig.clone(),
        world: Some(world.clone()),
        policy: policy.map(|(name, _)| name.to_owned()),
        duration_s: manifest.duration_s,
        parameters: manifest.parameters.clone(),
        program,
        firmware,
        wiring: manifest.wiring.clone(),
        texts: typed(manifest),
        ground_truth: false,
    };
    Ok((library.setup(scenario, &overrides)?, seed))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_lab::manifest::{lines, of};
    use rumbo_log::LogKind;

    #[test]
    fn a_line_for_the_usb_port_is_read_from_its_own_list_with_its_ending() {
        let timed = |text: &str, port: TypedPort| TimedText {
            at_s: 2.0,
            text: text.into(),
            ending: LineEnding::Cr,
            port,
        };
        let texts = vec![
            timed("REF 30", TypedPort::Link),
            timed("go", TypedPort::Usb),
        ];
        let manifest = Manifest {
            texts: lines(&texts, TypedPort::Link),
            usb_texts: lines(&texts, TypedPort::Usb),
            line_ending: Some("cr".into()),
            ..Manifest::default()
        };
        assert_eq!(manifest.usb_texts, [(2.0, "go".to_owned())]);
        assert_eq!(typed(&manifest), texts);
    }

    #[test]
    fn a_log_of_the_baseline_is_run_again_under_its_name() {
        let overrides = Overrides {
            program: NativeProgram::Baseline,
            ..Overrides::default()
        };
        let made = Library::new().setup("mode1", &overrides).unwrap();
        let manifest = Manifest {
            step_us: MIN_STEP_US,
            ..of(LogKind::Lab, &made, &overrides, 3)
        };
        assert_eq!(manifest.program, "baseline");
        let (again, seed) = setup(Path::new("a.mcap"), &manifest).unwrap();
        assert_eq!((again.program, seed), (NativeProgram::Baseline, 3));
    }
}
