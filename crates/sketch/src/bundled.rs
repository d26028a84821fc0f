//! Libraries that come with us, for sketches whose core lacks them: those in `libraries/`, and `RumboRobot`.

use crate::error::SketchError;
use include_dir::{Dir, File, include_dir};
use std::fs;
use std::path::{Path, PathBuf};

static LIBRARIES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/libraries");

/// The library for this robot, as the Arduino IDE installs it.
static ROBOT: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../examples/arduino/RumboRobot/src");

const RUMBO_ROBOT: &str = "RumboRobot";

/// All files below a folder, each with its path from it.
pub(crate) fn files_below(folder: &'static Dir<'static>) -> Vec<(String, &'static [u8])> {
    fn collect(folder: &'static Dir<'static>, found: &mut Vec<&'static File<'static>>) {
        found.extend(folder.files());
        folder.dirs().for_each(|inner| collect(inner, found));
    }
    let mut found = Vec::new();
    collect(folder, &mut found);
    let named = found.into_iter().filter_map(|file| {
        let path = file.path().strip_prefix(folder.path()).ok()?;
        Some((path.to_str()?.replace('\\', "/"), file.contents()))
    });
    named.collect()
}

/// The files of a library of ours, by name.
fn files(name: &str) -> Vec<(String, &'static [u8])> {
    match name {
        RUMBO_ROBOT => files_below(&ROBOT),
        _ => LIBRARIES.get_dir(name).map(files_below).unwrap_or_default(),
    }
}

/// Writes a library of ours below a folder unless it is there; `None` if we have none of this name.
pub(crate) fn unpack(name: &str, below: &Path) -> Result<Option<PathBuf>, SketchError> {
    let folder = below.join(name);
    let files = files(name);
    for (file, data) in &files {
        let path = folder.join(file);
        if fs::read(&path).ok().as_deref() != Some(*data) {
            fs::create_dir_all(&folder)
                .and_then(|()| fs::write(&path, data))
                .map_err(|error| SketchError::file(&path, error))?;
        }
    }
    Ok((!files.is_empty()).then_some(folder))
}
