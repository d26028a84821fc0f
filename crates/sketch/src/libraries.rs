//! Libraries that come with us, for sketches whose core lacks them: those in `libraries/`, and `RumboRobot`.

use crate::error::SketchError;
use rust_embed::RustEmbed;
use std::borrow::Cow;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(RustEmbed)]
#[folder = "libraries"]
struct Libraries;

/// The library for this robot, as the Arduino IDE installs it.
#[derive(RustEmbed)]
#[folder = "../../examples/arduino/RumboRobot/src"]
struct RumboRobot;

const RUMBO_ROBOT: &str = "RumboRobot";

/// The files of a library of ours, by name.
fn files(name: &str) -> Vec<(String, Cow<'static, [u8]>)> {
    let prefix = format!("{name}/");
    let embedded = Libraries::iter().filter_map(|file| {
        let own = file.strip_prefix(&prefix)?.to_owned();
        Some((own, Libraries::get(&file)?.data))
    });
    let own = RumboRobot::iter().filter(|_| name == RUMBO_ROBOT);
    let own = own.filter_map(|file| Some((file.to_string(), RumboRobot::get(&file)?.data)));
    embedded.chain(own).collect()
}

/// Writes a library of ours below a folder unless it is there; `None` if we have none of this name.
pub(crate) fn unpack(name: &str, below: &Path) -> Result<Option<PathBuf>, SketchError> {
    let folder = below.join(name);
    let files = files(name);
    for (file, data) in &files {
        let path = folder.join(file);
        if fs::read(&path).ok().as_deref() != Some(&**data) {
            fs::create_dir_all(&folder)
                .and_then(|()| fs::write(&path, data))
                .map_err(|error| SketchError::file(&path, error))?;
        }
    }
    Ok((!files.is_empty()).then_some(folder))
}
