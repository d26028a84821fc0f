//! The manifest of a run: what is needed to run it again.

use rumbo_experiment::MODEL;
use rumbo_experiment::files::firmware;
use rumbo_experiment::files::{NativeProgram, Overrides, Setup, TimedText, TypedPort};
use rumbo_log::{LogKind, Manifest};
use std::collections::BTreeMap;
use std::path::Path;

/// The names of the robots' files begin with it where there are several robots.
pub const OF_FLEET: &str = "robot ";

/// So does that of a policy.
pub const OF_POLICY: &str = "policy ";

/// The manifest of a setup as these overrides made it; `step_us` and the time are left to the caller.
#[must_use]
pub fn of(kind: LogKind, setup: &Setup, overrides: &Overrides, seed: u64) -> Manifest {
    // Of several robots each may have a program of its own, which the scenario says.
    let program = match setup.fleet.len() {
        0 => setup.program,
        _ => overrides.program,
    };
    let program = match (&overrides.firmware, program) {
        (Some(image), _) => image.display().to_string(),
        (None, NativeProgram::Rumbo) => "rumbo".into(),
        (None, NativeProgram::Baseline) => "baseline".into(),
    };
    let files = [
        ("scenario", &setup.scenario.text),
        ("robot", &setup.robot.text),
        ("world", &setup.world.text),
    ];
    let own = |(name, text): (&str, &String)| (name.to_owned(), text.clone());
    let mut files: BTreeMap<String, String> = files.map(own).into();
    for robot in setup.fleet.iter().map(|each| &each.robot) {
        files.insert(format!("{OF_FLEET}{}", robot.name), robot.text.clone());
    }
    let robots = setup.robots().iter();
    let policies: Vec<_> = robots.filter_map(|robot| robot.policy.as_ref()).collect();
    for policy in &policies {
        files.insert(format!("{OF_POLICY}{}", policy.name), policy.text.clone());
    }
    Manifest {
        kind,
        version: env!("CARGO_PKG_VERSION").into(),
        model: Some(MODEL),
        scenario: Some(setup.scenario.name.clone()),
        robot: Some(setup.robot.name.clone()),
        world: Some(setup.world.name.clone()),
        rig: match setup.fleet.len() {
            0 => Some(setup.scenario.rig.clone()),
            _ => overrides.rig.clone(),
        },
        wiring: overrides.wiring.clone(),
        policy: match (&overrides.policy, &policies[..]) {
            (Some(_), [policy, ..]) => Some(policy.name.clone()),
            _ => None,
        },
        program,
        image: overrides.firmware.as_deref().and_then(hash),
        seed: Some(seed),
        duration_s: overrides.duration_s,
        parameters: overrides.parameters.clone(),
        texts: lines(&overrides.texts, TypedPort::Link),
        usb_texts: lines(&overrides.texts, TypedPort::Usb),
        part_texts: lines(&overrides.texts, TypedPort::Parts),
        hand_texts: lines(&overrides.texts, TypedPort::Hand),
        // One for all of a command.
        line_ending: overrides
            .texts
            .iter()
            .find(|timed| matches!(timed.port, TypedPort::Link | TypedPort::Usb))
            .map(|timed| timed.ending.name().to_owned()),
        files,
        ..Manifest::default()
    }
}

/// The lines for a port: time \[s\] and text of each.
#[must_use]
pub fn lines(texts: &[TimedText], port: TypedPort) -> Vec<(f64, String)> {
    let of_it = texts.iter().filter(|timed| timed.port == port);
    of_it
        .map(|timed| (timed.at_s, timed.text.clone()))
        .collect()
}

/// CRC-32 of a program image's file, as hexadecimal digits; `None` if it cannot be read.
#[must_use]
pub fn hash(path: &Path) -> Option<String> {
    Some(hash_of(&firmware::bytes(path).ok()?))
}

/// The same of its bytes.
#[must_use]
pub fn hash_of(image: &[u8]) -> String {
    format!("{:08x}", crc32(image))
}

/// CRC-32 as PNG, MCAP and zip have it.
#[must_use]
pub fn crc32(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}
