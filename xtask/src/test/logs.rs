//! Logs as other programs read them: with MCAP's own Python library and Foxglove's own definitions, in an environment made for it.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use crate::lab::Lab;
use crate::project::{Project, run};
use crate::tools::{self, Stop};

/// Packages of PyPI; a log that these versions read is one.
const PACKAGES: [&str; 3] = [
    "mcap==1.6.0",
    "jsonschema==4.23.0",
    "foxglove-schemas-protobuf==0.4.0",
];

/// A recording of the original program.
const RECORDING: &str = "dt_ms,left_cm,right_cm,reference_cm,mode,pwm_a,pwm_b\n60,50,51,30,1,115,115\n61,49.5,50,30,1,112,112\n";

/// Makes logs of every kind and has them read.
pub(super) fn check(project: &Project) -> Result<(), Stop> {
    let python = tools::python_with(project, "python", &PACKAGES)?;
    let folder = project.target.join("tmp/logs-read-by-others");
    // Of an earlier time.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let rumbo = project.rumbo()?;
    for scenario in ["mode1", "mode8-lane"] {
        let mut command = project.command(&rumbo);
        command.args(["run", scenario, "--out"]).arg(&folder);
        // Missed limits do not matter here.
        let status = command.stdout(Stdio::null()).status();
        if !status.is_ok_and(|status| status.code().is_some_and(|code| code < 2)) {
            return Err(Stop::Failed(format!("`rumbo run {scenario}` failed")));
        }
    }
    let recording = folder.join("original.csv");
    std::fs::write(&recording, RECORDING).map_err(|error| error.to_string())?;
    let imported = folder.join("original.mcap");
    let mut command = project.command(&rumbo);
    run(command
        .arg("import")
        .arg(&recording)
        .arg("--out")
        .arg(&imported))?;
    let logs = [
        folder.join("mode1-1.mcap"),
        folder.join("mode8-lane-1.mcap"),
        imported,
    ];
    let killed = killed_session(project, &rumbo, &folder)?;
    let mut check = project.command(python);
    check
        .arg("xtask/src/test/check_log.py")
        .args(logs)
        .arg(killed);
    Ok(run(&mut check)?)
}

/// The log of a session that was killed, as the next command leaves it.
fn killed_session(project: &Project, rumbo: &Path, folder: &Path) -> Result<PathBuf, Stop> {
    let sessions = folder.join("sessions");
    let mut start = project.command(rumbo);
    start.arg("lab");
    let lab = Lab::start_in(start, &sessions)?;
    std::thread::sleep(Duration::from_secs(3));
    drop(lab);
    let mut list = project.command(rumbo);
    list.args(["list", "logs"]).env("RUMBO_LOGS", &sessions);
    run(list.stdout(Stdio::null()))?;
    let mut files = std::fs::read_dir(&sessions).map_err(|error| error.to_string())?;
    let file = files
        .next()
        .ok_or_else(|| "the lab recorded nothing".to_owned())?;
    Ok(file.map_err(|error| error.to_string())?.path())
}
