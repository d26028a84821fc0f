//! The second lane of CI: steps run by another process of this program, and shown when the steps beside them have ended.

use super::{Lane, Outcome};
use crate::project::Project;
use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::time::Duration;

/// A step's name, how it ended, and its time.
type Row = (&'static str, Outcome, Duration);

/// The running lane; it ends with this.
pub(super) struct Beside {
    lane: Child,
    steps: &'static [&'static str],
    output: PathBuf,
}

impl Beside {
    /// Starts the steps.
    pub(super) fn start(project: &Project, lane: &Lane) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let folder = project.target.join("tmp");
        let output = folder.join("beside.txt");
        let wrong = |error: std::io::Error| format!("{}: {error}", output.display());
        fs::create_dir_all(&folder).map_err(wrong)?;
        let file = File::create(&output).map_err(wrong)?;
        let steps = lane.steps;
        let mut lane = if lane.nice && cfg!(unix) {
            let mut nice = project.command("nice");
            nice.arg(program);
            nice
        } else {
            project.command(program)
        };
        lane.arg("test");
        lane.args(steps.iter().flat_map(|name| ["--only", name]));
        lane.stdin(Stdio::null());
        lane.stdout(file.try_clone().map_err(wrong)?).stderr(file);
        let lane = lane.spawn().map_err(|error| error.to_string())?;
        Ok(Self {
            lane,
            steps,
            output,
        })
    }

    /// Waits, shows what the steps printed, and gives how they ended.
    pub(super) fn end(mut self) -> Result<Vec<Row>, String> {
        self.lane.wait().map_err(|error| error.to_string())?;
        let bytes = fs::read(&self.output).map_err(|error| error.to_string())?;
        let text = String::from_utf8_lossy(&bytes);
        // Its own summary is part of the whole one.
        let (steps, _) = text.rsplit_once("\nSummary\n").unwrap_or((&text, ""));
        println!("{steps}");
        Ok(self.steps.iter().map(|name| row(name, steps)).collect())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.lane.kill();
        let _ = self.lane.wait();
    }
}

/// How a step ended by what was printed.
fn row(name: &'static str, output: &str) -> Row {
    let said = output.lines().find_map(|line| {
        let (found, rest) = line.strip_prefix("<== ")?.split_once(' ')?;
        let (word, rest) = rest.trim_start().split_once(' ')?;
        let (seconds, why) = rest
            .trim_start()
            .split_once(" s")
            .filter(|_| found == name)?;
        Some((word, seconds.parse().ok()?, why.trim().to_owned()))
    });
    let (outcome, seconds) = match said {
        Some(("passed", seconds, _)) => (Outcome::Passed, seconds),
        Some(("skipped", seconds, why)) => (Outcome::Skipped(why), seconds),
        Some((_, seconds, why)) => (Outcome::Failed(why), seconds),
        None => (Outcome::Failed("did not come to its end".to_owned()), 0.0),
    };
    let time = Duration::try_from_secs_f64(seconds).unwrap_or_default();
    (name, outcome, time)
}

#[cfg(test)]
mod tests {
    use super::super::line;
    use super::*;

    #[test]
    fn a_step_of_the_other_lane_ends_here_as_it_ended_there() {
        let time = Duration::from_millis(12_300);
        for outcome in [
            Outcome::Passed,
            Outcome::Failed("the image is 7 s late".to_owned()),
            Outcome::Skipped("install it".to_owned()),
        ] {
            let printed = format!("==> wasm: it\nhm\n<== {}\n", line("wasm", &outcome, time));
            assert_eq!(row("wasm", &printed), ("wasm", outcome, time));
        }
    }

    #[test]
    fn a_step_that_the_other_lane_did_not_reach_has_failed() {
        let printed = "==> wasm: it\n<== fuzz     passed    1.0 s\n";
        assert!(matches!(row("wasm", printed).1, Outcome::Failed(_)));
    }
}
