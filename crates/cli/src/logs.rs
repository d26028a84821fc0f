//! The folder of logs, and its content.

use crate::args::PruneArgs;
use crate::failure::Failure;
use crate::output::{self, figure, shown};
use crate::place;
use rumbo_station::{RecordingSetting, log_file};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The environment's variable that names another folder for logs.
const FOLDER: &str = "RUMBO_LOGS";

/// The log of a session. If it cannot be written, the session runs all the same, and page and terminal report it.
pub(crate) fn recording(given: Option<&Path>) -> Option<RecordingSetting> {
    let folder = folder(given)?;
    if let Err(why) = place::try_folder(&folder) {
        output::note(&format!("not recording: {why}"));
    }
    // What cannot be listed now is not shown later either.
    paths(&folder).iter().flatten().for_each(|path| mend(path));
    Some(RecordingSetting { folder })
}

/// Makes a log whole whose recording was killed, and says so.
pub(crate) fn mend(path: &Path) {
    if log_file::mend(path) {
        let path = path.display();
        output::note(&format!(
            "{path}: its recording had been killed; up to there it is a whole log now"
        ));
    }
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

/// What is in the default folder, in the order of the names, which begin with the time.
pub(crate) fn entries() -> Result<Vec<Value>, Failure> {
    let paths = usual_paths()?;
    paths.iter().for_each(|path| mend(path));
    Ok(paths.iter().map(|path| entry(path)).collect())
}

/// The logs in the default folder.
fn usual_paths() -> Result<Vec<PathBuf>, Failure> {
    folder(None).map_or(Ok(Vec::new()), |folder| paths(&folder))
}

fn paths(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let files = match std::fs::read_dir(folder) {
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
    Ok(paths)
}

/// Total size, and how to reduce it.
pub(crate) fn total(entries: &[Value]) -> String {
    let bytes = entries.iter().filter_map(|entry| entry["bytes"].as_u64());
    let (logs, size) = (
        output::counted(entries.len(), "log"),
        megabytes(bytes.sum()),
    );
    format!("{logs}, {size}; `rumbo prune --keep-days 30` removes those older than 30 days")
}

/// Removes the logs of the default folder beyond the given age, and lists them. Only logs of Rumbo are removed.
pub(crate) fn prune(args: &PruneArgs) -> Result<(), Failure> {
    let days = Duration::from_secs(u64::from(args.keep_days) * 86_400);
    let (mut count, mut bytes) = (0, 0);
    for path in usual_paths()? {
        let unwritable = |error: std::io::Error| {
            let path = path.display();
            Failure::Input(format!(
                "{path}: cannot be removed ({error}); check its permissions"
            ))
        };
        let about = std::fs::symlink_metadata(&path).map_err(unwritable)?;
        // By the last write: a log being recorded is always recent.
        let age = about.modified().ok().and_then(|time| time.elapsed().ok());
        let is_old = about.is_file() && age.is_some_and(|age| age > days);
        if !is_old || log_file::summary(&path).map_or(true, |log| log.manifest.is_none()) {
            continue;
        }
        if !args.dry_run {
            std::fs::remove_file(&path).map_err(unwritable)?;
        }
        output::line(&shown(&path))?;
        count += 1;
        bytes += about.len();
    }
    let what = if args.dry_run {
        "would be removed"
    } else {
        "removed"
    };
    output::line(&format!(
        "{} {what}, {}",
        output::counted(count, "log"),
        megabytes(bytes)
    ))
}

fn megabytes(bytes: u64) -> String {
    format!("{} MB", figure(bytes as f64 / 1e6))
}

fn entry(path: &Path) -> Value {
    let bytes = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
    match log_file::summary(path) {
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
    let size = megabytes(entry["bytes"].as_u64().unwrap_or_default());
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
