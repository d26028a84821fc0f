//! The second lane of CI: steps run by another process of this program, and shown when the steps beside them have ended.

use super::Outcome;
use crate::cost::Cost;
use crate::project::Project;
use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Child, Stdio};

/// A step's name, how it ended, and what it cost.
type Row = (&'static str, Outcome, Cost);

/// The running lane; it ends with this.
pub(super) struct Beside {
    lane: Child,
    steps: &'static [&'static str],
    output: PathBuf,
}

impl Beside {
    /// Starts the steps.
    pub(super) fn start(project: &Project, steps: &'static [&'static str]) -> Result<Self, String> {
        let program = std::env::current_exe().map_err(|error| error.to_string())?;
        let folder = project.target.join("tmp");
        let output = folder.join("beside.txt");
        let wrong = |error: std::io::Error| format!("{}: {error}", output.display());
        fs::create_dir_all(&folder).map_err(wrong)?;
        let file = File::create(&output).map_err(wrong)?;
        let mut lane = project.command(program);
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
        let (cost, why) = Cost::parse(rest)?;
        (found == name).then(|| (word, cost, why.trim().to_owned()))
    });
    let (outcome, cost) = match said {
        Some(("passed", cost, _)) => (Outcome::Passed, cost),
        Some(("skipped", cost, why)) => (Outcome::Skipped(why), cost),
        Some((_, cost, why)) => (Outcome::Failed(why), cost),
        None => (
            Outcome::Failed("did not come to its end".to_owned()),
            Cost::default(),
        ),
    };
    (name, outcome, cost)
}

#[cfg(test)]
mod tests {
    use super::super::line;
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_step_of_the_other_lane_ends_here_as_it_ended_there() {
        let cost = Cost {
            time: Duration::from_millis(12_300),
            processor: Duration::from_millis(20_100),
        };
        for outcome in [
            Outcome::Passed,
            Outcome::Failed("the image is 7 s late".to_owned()),
            Outcome::Skipped("install it".to_owned()),
        ] {
            let printed = format!("==> wasm: it\nhm\n<== {}\n", line("wasm", &outcome, cost));
            assert_eq!(row("wasm", &printed), ("wasm", outcome, cost));
        }
    }

    #[test]
    fn a_step_that_the_other_lane_did_not_reach_has_failed() {
        let printed = "==> wasm: it\n<== fuzz     passed    1.0 s, processor 2.0 s\n";
        assert!(matches!(row("wasm", printed).1, Outcome::Failed(_)));
    }
}
