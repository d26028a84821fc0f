//! The dashboard in Chromium: from starting `rumbo` to plotted telemetry, the lab's CPU meanwhile, the age of what is drawn, STOP, frames.

use std::time::{Duration, Instant};

use super::{Figure, process};
use crate::lab::Lab;
use crate::project::{Project, find_program};
use crate::tools::installed_chromium;

/// Duration of the CPU measurement.
const WATCH: Duration = Duration::from_secs(10);

/// The link's own time for STOP: 9 bytes at 9600 baud, and 8 ms latency of the module.
const LINK_MS: u32 = 17;
/// The browser is gone.
const ENDED: &str = "the browser ended; are the packages of web/ installed (`npm ci`)?";

/// Drives the browser: each request, a word and an address, gets one line as its answer.
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
    browser.expect_of(&format!("open {}", lab.url()), "live")?;
    let live = begin.elapsed();
    let watched = process::cpu_percent(lab.pid(), WATCH)?;
    let age_ms = browser.ask("age")?;
    let stop_ms = browser.ask("stop")?;
    drop(lab);
    let mut start = project.command(project.release_binary_path());
    start.args(["lab", "--scenario", "mode8-lane", "--speed", "100"]);
    start.args(["--robots", "4"]);
    let fast = Lab::start(start)?;
    let frames = browser.ask(&format!("frames {}", fast.url()))?;
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
        Figure::new(
            "page: last byte of a frame to the frame after it was drawn, p95",
            format!("{age_ms} ms"),
            "50 ms",
        ),
        Figure::new(
            format!("page: STOP to PWM zero, p95, the link's {LINK_MS} ms included"),
            format!("{stop_ms} ms"),
            "30 ms + the link's",
        ),
        Figure::new(
            "page: frames/s, 4 robots, 20 ghosts, 8 plots x 4 signals x 10 min",
            frames,
            "30",
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

    /// The script's answer.
    fn ask(&mut self, what: &str) -> Result<String, String> {
        use std::io::Write;
        let stdin = self.child.stdin.as_mut().ok_or("node has no input")?;
        writeln!(stdin, "{what}").map_err(|error| format!("node: {error}"))?;
        match self.answers.next() {
            Some(Ok(line)) if !line.starts_with("failed") => Ok(line),
            Some(Ok(line)) => Err(format!("the browser says `{line}`")),
            _ => Err(ENDED.to_owned()),
        }
    }

    fn expect_of(&mut self, what: &str, word: &str) -> Result<(), String> {
        match self.ask(what)? {
            line if line == word => Ok(()),
            line => Err(format!("the browser says `{line}`")),
        }
    }

    fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.answers.next() {
            Some(Ok(line)) if line == word => Ok(()),
            Some(Ok(line)) => Err(format!("the browser says `{line}`")),
            _ => Err(ENDED.to_owned()),
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
