//! The files of a run in the requested folder: its result, the true signals, the log, and the output of an emulated
//! chip's USARTs.

use crate::failure::Failure;
use crate::mark::Mark;
use crate::place::{self, Guard};
use crate::run_log::{self, RunSource};
use rumbo_experiment::files::{Overrides, ScenarioFile, Setup};
use rumbo_experiment::run::RunResult;
use rumbo_session::readable;
use rumbo_sim::mega::{CONSOLES, ON_PINS, PARTS};
use rumbo_sim::trace::Trace;
use std::path::{Path, PathBuf};

/// The paths of a run's files.
pub(crate) struct Results {
    folder: PathBuf,
    stem: String,
}

impl Results {
    /// Of a scenario with a seed.
    pub(crate) fn of(folder: &Path, scenario: &str, seed: u64) -> Self {
        Self {
            folder: folder.to_owned(),
            stem: format!("{scenario}-{seed}"),
        }
    }

    /// The mark of the result.
    pub(crate) fn json(&self) -> PathBuf {
        self.file(".json")
    }

    fn file(&self, ending: &str) -> PathBuf {
        self.folder.join(format!("{}{ending}", self.stem))
    }

    fn usart(&self, usart: u8) -> PathBuf {
        match usart {
            ON_PINS => self.file("-bluetooth.txt"),
            PARTS => self.file("-displays.txt"),
            usart => self.file(&format!("-usart{usart}.txt")),
        }
    }

    /// Whether all files of a run of this setup, as these overrides made it, may be written.
    pub(crate) fn check(
        &self,
        guard: &Guard,
        setup: &Setup,
        overrides: &Overrides,
        seed: u64,
    ) -> Result<(), Failure> {
        let result = mark(&setup.scenario, seed)?;
        let log = Mark::run(setup, overrides, seed);
        let robots = setup.fleet.iter();
        let mut of_robots: Vec<Self> = robots
            .map(|robot| self.of_robot(&robot.scenario.name))
            .collect();
        if of_robots.is_empty() {
            of_robots.push(Self::of(&self.folder, &setup.scenario.name, seed));
        }
        // The log says of all beside it with which options it was made; a program's output can look like anything.
        let logs = of_robots.iter().map(|files| files.file(".mcap"));
        let mut logs = logs.filter(|path| path.is_file()).peekable();
        let is_own = logs.peek().is_some()
            && logs.all(|path| log.is_on(&path))
            && (!self.json().is_file() || result.is_on(&self.json()));
        guard.check_own(&self.json(), is_own)?;
        of_robots.iter().try_for_each(|files| {
            guard.check_own(&files.file(".mcap"), is_own)?;
            let truth = files.file(".truth.csv");
            let is_truth = Mark::table(&Trace::default().csv()).is_on(&truth);
            guard.check_own(&truth, is_own && is_truth)?;
            (0..CONSOLES).try_for_each(|usart| guard.check_own(&files.usart(usart), is_own))
        })
    }

    /// Writes all of them.
    pub(crate) fn write(
        &self,
        source: &RunSource<'_>,
        setup: &Setup,
        result: &RunResult,
    ) -> Result<(), Failure> {
        // First the log, without which a result could not be replaced by its own run.
        let log = |robot: Option<&str>| match robot {
            Some(robot) => self.of_robot(robot).file(".mcap"),
            None => self.file(".mcap"),
        };
        run_log::write(source, log, setup, result)?;
        let text = serde_json::to_string(result).map_err(Failure::input)?;
        place::write(&self.json(), text + "\n")?;
        self.write_signals(result)?;
        for robot in &result.robots {
            self.of_robot(&robot.scenario).write_signals(robot)?;
        }
        Ok(())
    }

    /// The files of one of several robots.
    fn of_robot(&self, robot: &str) -> Self {
        Self {
            folder: self.folder.clone(),
            stem: format!("{}-{robot}", self.stem),
        }
    }

    /// Writes the true signals of a robot, and the output of its USARTs; of several, each has its own.
    fn write_signals(&self, result: &RunResult) -> Result<(), Failure> {
        for usart in 0..CONSOLES {
            let said = result.trace.console(usart);
            if !said.is_empty() {
                place::write(&self.usart(usart), readable(&said))?;
            }
        }
        if !result.robots.is_empty() {
            return Ok(());
        }
        place::write(&self.file(".truth.csv"), result.trace.csv())
    }
}

/// How the result of a run begins.
fn mark(scenario: &ScenarioFile, seed: u64) -> Result<Mark, Failure> {
    let text = |value: &String| serde_json::to_string(value).map_err(Failure::input);
    let next = match &scenario.path {
        Some(path) => format!("\"path\":{},", text(path)?),
        None => "\"passed\":".into(),
    };
    let name = text(&scenario.name)?;
    Ok(Mark::Text(format!(
        "{{\"scenario\":{name},\"seed\":{seed},{next}"
    )))
}
