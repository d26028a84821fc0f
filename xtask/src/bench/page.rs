//! The dashboard in Chromium: the time from starting `rumbo` to plotted telemetry, and the lab's CPU meanwhile.

use std::time::{Duration, Instant};

use super::{Figure, process};
use crate::lab::Lab;
use crate::project::{Project, find_program};
use crate::test::installed_chromium;

/// How long CPU time is watched.
const WATCH: Duration = Duration::from_secs(10);

/// Drives the browser: waits for a line with an address, opens it, and answers `live` when signals are plotted.
const SCRIPT: &str = include_str!("page.mjs");

/// Time to live plots, and CPU with the page open.
pub(crate) fn measure(project: &Project) -> Result<Vec<Figure>, String> {
    let node = find_program("node").ok_or("no node")?;
    let chromium = std::env::var_os("CHROMIUM")
        .map(Into::into)
        .or_else(installed_chromium)
        .ok_or("no Chromium")?;
    let mut script = project.command(node);
    script
        .args(["--input-type=module", "--eval", SCRIPT])
        .current_dir(project.root.join("web"));
    let mut browser = Browser::start(script.env("CHROMIUM", chromium))?;
    let mut start = project.command(project.release_binary_path());
    start.arg("lab");
    let begin = Instant::now();
    let lab = Lab::start(start)?;
    browser.open(lab.url())?;
    let live = begin.elapsed();
    let watched = process::cpu_percent(lab.pid(), WATCH)?;
    Ok(vec![
        Figure::new(
            "page: start of rumbo to live plots in Chromium",
            format!("{} ms", live.as_millis()),
            "1 s",
        ),
        Figure::new(
            "lab: CPU, page open in Chromium",
            format!("{watched:.1} % of a core"),
            "10 %",
        ),
    ])
}

/// A browser that is already running, so that its own start is not measured.
struct Browser {
    child: std::process::Child,
    answers: std::io::Lines<std::io::BufReader<std::process::ChildStdout>>,
}

impl Browser {
    fn start(command: &mut std::process::Command) -> Result<Self, String> {
        use std::io::BufRead;
        use std::process::Stdio;
        let spawned = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut child = spawned.map_err(|error| format!("node: {error}"))?;
        let stdout = child.stdout.take().ok_or("node has no output")?;
        let mut browser = Self {
            child,
            answers: std::io::BufReader::new(stdout).lines(),
        };
        browser.expect("ready")?;
        Ok(browser)
    }

    fn open(&mut self, url: &str) -> Result<(), String> {
        use std::io::Write;
        let stdin = self.child.stdin.as_mut().ok_or("node has no input")?;
        writeln!(stdin, "{url}").map_err(|error| format!("node: {error}"))?;
        self.expect("live")
    }

    fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.answers.next() {
            Some(Ok(line)) if line == word => Ok(()),
            Some(Ok(line)) => Err(format!("the browser says `{line}`")),
            _ => {
                Err("the browser ended; are the packages of web/ installed (`npm ci`)?".to_owned())
            }
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // The script closes the browser when its input ends.
        drop(self.child.stdin.take());
        let _ = self.child.wait();
    }
}
