//! Where logs are, and what there is.

use crate::failure::Failure;
use crate::output::{figure, shown};
use crate::place;
use rumbo_station::log::{Recording, Summary};
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The environment's variable that names another folder for logs.
const FOLDER: &str = "RUMBO_LOGS";

/// Where a session is recorded. One that cannot be is driven all the same: the page says so, and so does the terminal.
pub(crate) fn recording(given: Option<&Path>) -> Option<Recording> {
    let folder = folder(given)?;
    if let Err(Failure::Input(why)) = place::try_folder(&folder) {
        // A closed stderr leaves nobody to tell.
        let _ = writeln!(std::io::stderr(), "note: not recording: {why}");
    }
    Some(Recording { folder })
}

/// The folder for logs: the one given, else the one that the environment names, else `rumbo/logs` where this system keeps a user's data.
pub(crate) fn folder(given: Option<&Path>) -> Option<PathBuf> {
    let named = || std::env::var_os(FOLDER).filter(|folder| !folder.is_empty());
    let usual = || dirs::data_dir().map(|data| data.join("rumbo").join("logs"));
    given
        .map(Path::to_owned)
        .or_else(|| named().map(PathBuf::from))
        .or_else(usual)
}

/// The logs in the default folder, in the order of their names, which begin with the time.
pub(crate) fn entries() -> Result<Vec<Value>, Failure> {
    let Some(folder) = folder(None) else {
        return Ok(Vec::new());
    };
    let files = match std::fs::read_dir(&folder) {
        Ok(files) => files,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => {
            return Err(Failure::Input(format!(
                "{}: cannot be read ({error}); check its permissions",
                folder.display()
            )));
        }
    };
    let mut paths: Vec<PathBuf> = files
        .filter_map(|file| Some(file.ok()?.path()))
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "mcap")
        })
        .collect();
    paths.sort();
    Ok(paths.iter().map(|path| entry(path)).collect())
}

fn entry(path: &Path) -> Value {
    let bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    match Summary::read(path) {
        Ok(log) => {
            let manifest = log.manifest.unwrap_or_default();
            json!({ "name": shown(path), "bytes": bytes, "duration_s": log.duration_s, "started": manifest.started,
                "scenario": manifest.scenario, "seed": manifest.seed, "complete": log.complete })
        }
        Err(error) => json!({ "name": shown(path), "bytes": bytes, "error": error.to_string() }),
    }
}

/// A log as a row: its path, length, size, what ran, and whether it was ended properly.
pub(crate) fn row(entry: &Value) -> Vec<String> {
    let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    let size = format!(
        "{} MB",
        figure(entry["bytes"].as_f64().unwrap_or_default() / 1e6)
    );
    let Some(duration_s) = entry["duration_s"].as_f64() else {
        return vec![text("name"), size, "unreadable".into()];
    };
    let seed = entry["seed"].as_u64().map(|seed| format!("seed {seed}"));
    let whole = if entry["complete"] == true {
        ""
    } else {
        "cut off"
    };
    vec![
        text("name"),
        size,
        format!("{duration_s:.1} s"),
        text("scenario"),
        seed.unwrap_or_default(),
        whole.into(),
    ]
}
