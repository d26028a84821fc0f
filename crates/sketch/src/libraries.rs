//! Libraries that come with us, for sketches whose core lacks them: `libraries/*`.

use crate::error::SketchError;
use rust_embed::RustEmbed;
use std::fs;
use std::path::{Path, PathBuf};

#[derive(RustEmbed)]
#[folder = "libraries"]
struct Libraries;

/// Writes a library of ours below a folder unless it is there; `None` if we have none of this name.
pub(crate) fn unpack(name: &str, below: &Path) -> Result<Option<PathBuf>, SketchError> {
    let prefix = format!("{name}/");
    let folder = below.join(name);
    let mut any = false;
    for file in Libraries::iter().filter(|file| file.starts_with(&prefix)) {
        let (Some(embedded), path) = (Libraries::get(&file), below.join(&*file)) else {
            continue;
        };
        any = true;
        let write = || {
            fs::create_dir_all(&folder)?;
            fs::write(&path, &embedded.data)
        };
        if fs::read(&path).ok().as_deref() != Some(&*embedded.data) {
            write().map_err(|error| SketchError::file(&path, error))?;
        }
    }
    Ok(any.then_some(folder))
}
