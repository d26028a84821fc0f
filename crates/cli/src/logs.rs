//! Where logs are, what there is, and the logs of runs without a window.

use crate::failure::Failure;
use crate::manifest;
use crate::output::{figure, shown};
use crate::place;
use crate::scene::scene;
use rumbo_control::Wheels;
use rumbo_scenario::files::{Library, Overrides, Setup};
use rumbo_scenario::run::RunResult;
use rumbo_scenario::trace::{SAMPLE_US, Sample};
use rumbo_station::log::{
    Burst, Kind, Manifest, Outcome, Recording, Run, Said, Summary, record_run,
};
use rumbo_station::{Choice, MapPose, Truth};
use rumbo_wire::FromRobot;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Where a session is recorded. One that cannot be is driven all the same: the page says so, and so does the terminal.
pub(crate) fn recording(given: Option<&Path>) -> Option<Recording> {
    let folder = folder(given)?;
    if let Err(Failure::Input(why)) = place::try_folder(&folder) {
        // A closed stderr leaves nobody to tell.
        let _ = writeln!(std::io::stderr(), "note: not recording: {why}");
    }
    Some(Recording { folder })
}

/// The folder for the logs of sessions: the one given, or `rumbo/logs` where this system keeps a user's data.
pub(crate) fn folder(given: Option<&Path>) -> Option<PathBuf> {
    match given {
        Some(folder) => Some(folder.into()),
        None => dirs::data_dir().map(|data| data.join("rumbo").join("logs")),
    }
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

/// Writes the log of a run into a folder.
pub(crate) fn write_run(
    folder: &Path,
    library: &Library,
    setup: &Setup,
    overrides: &Overrides,
    result: &RunResult,
) -> Result<(), Failure> {
    let choice = Choice {
        scenario: result.scenario.clone(),
        world: overrides.world.clone(),
        rig: overrides.rig.clone(),
        seed: result.seed,
    };
    let scene = scene(library, &*setup.of_seed(result.seed)?, choice)?;
    let manifest = Manifest {
        step_us: SAMPLE_US,
        baud: 9_600,
        ..manifest::of(Kind::Run, setup, overrides, result.seed)
    };
    let trace = &result.trace;
    let truths: Vec<_> = trace.samples.iter().map(truth).collect();
    let link: Vec<_> = trace.link.iter().map(burst).collect();
    // What came over the link is in its bytes.
    let told: Vec<(u64, FromRobot)> = match link.is_empty() {
        true => trace
            .heard
            .iter()
            .map(|heard| (micros(heard.t_s), heard.what))
            .collect(),
        false => Vec::new(),
    };
    let said: Vec<Said> = trace.consoles.iter().map(said).collect();
    let run = Run {
        said: &said,
        scene: Some(scene),
        truths: &truths,
        link: &link,
        told: &told,
        outcome: Outcome {
            pass: result.pass,
            metrics: result.metrics.clone().into_iter().collect(),
            failures: result.failures.clone(),
        },
    };
    let path = folder.join(format!("{}-{}.mcap", result.scenario, result.seed));
    place::make(&path, |place| {
        record_run(place, &manifest, run).map_err(|error| Failure::Input(error.of(&path)))
    })
}

fn micros(t_s: f64) -> u64 {
    (t_s * 1e6).round() as u64
}

pub(crate) fn burst(burst: &rumbo_scenario::trace::Burst) -> Burst {
    Burst {
        t_us: burst.t_us,
        to_robot: burst.to_robot,
        bytes: burst.bytes.clone(),
    }
}

pub(crate) fn said(said: &rumbo_scenario::trace::Said) -> Said {
    Said {
        t_us: said.t_us,
        usart: said.usart,
        to_chip: false,
        bytes: said.bytes.clone(),
    }
}

fn truth(sample: &Sample) -> (u64, Truth) {
    let [left, right] = sample.wheel_rad_s;
    let truth = Truth {
        pose: MapPose {
            x_m: sample.x_m,
            y_m: sample.y_m,
            heading_rad: sample.heading_rad,
        },
        wheel_rad_s: Wheels { left, right },
        range_m: sample
            .range_m
            .map(|range_m| range_m.is_finite().then_some(range_m)),
        servo_rad: sample.servo_rad,
        contact: sample.touching,
        battery_v: sample.battery_v,
    };
    (micros(sample.t_s), truth)
}
