//! The manifest of a run: what is needed to run it again.

use rumbo_experiment::MODEL;
use rumbo_experiment::files::firmware;
use rumbo_experiment::files::{NativeProgram, Overrides, Port, Setup, TimedText};
use rumbo_log::{Kind, Manifest};
use std::path::Path;

/// The manifest of a setup as these overrides made it; `step_us` and the time are for the one who runs it.
#[must_use]
pub fn of(kind: Kind, setup: &Setup, overrides: &Overrides, seed: u64) -> Manifest {
    let program = match (&overrides.firmware, setup.program) {
        (Some(image), _) => image.display().to_string(),
        (None, NativeProgram::Rumbo) => "rumbo".into(),
        (None, NativeProgram::Baseline) => "baseline".into(),
    };
    let files = [
        ("scenario", &setup.scenario.text),
        ("robot", &setup.robot.text),
        ("world", &setup.world.text),
    ];
    Manifest {
        kind,
        version: env!("CARGO_PKG_VERSION").into(),
        model: Some(MODEL),
        scenario: Some(setup.scenario.name.clone()),
        robot: Some(setup.robot.name.clone()),
        world: Some(setup.world.name.clone()),
        rig: Some(setup.scenario.rig.clone()),
        wiring: overrides.wiring.clone(),
        program,
        image: overrides.firmware.as_deref().and_then(hash),
        seed: Some(seed),
        parameters: overrides.parameters.clone(),
        texts: lines(&overrides.texts, Port::Link),
        usb_texts: lines(&overrides.texts, Port::Usb),
        files: files
            .map(|(name, text)| (name.to_owned(), text.clone()))
            .into(),
        ..Manifest::default()
    }
}

/// The lines for a port: time \[s\] and text of each.
#[must_use]
pub fn lines(texts: &[TimedText], port: Port) -> Vec<(f64, String)> {
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
