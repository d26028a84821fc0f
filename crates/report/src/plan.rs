//! What a report needs to be run, and the running of it on all threads.

use crate::chapters::EXPERIMENTS;
use crate::data::Data;
use crate::data::Experiment;
use crate::real::{Real, RealRun};
use crate::signals::ReportedRun;
use crate::stamp::FileStamp;
use crate::text::Language;
#[cfg(feature = "host")]
use rayon::prelude::*;
use rumbo_experiment::files::{FileError, Library, Overrides, Setup, TimedCommand};
use rumbo_experiment::run::run;
use rumbo_wire::Command;

/// The request.
#[derive(Debug, Default)]
pub struct Request {
    /// Names of experiments or of their scenarios; none: all.
    pub only: Vec<String>,
    /// Seed of all runs.
    pub seed: u64,
    /// Robot and program in place of the scenarios' own.
    pub overrides: Overrides,
    /// Recorded runs to be put beside ours.
    pub real: Real,
}

/// Runs that are ready to begin.
pub struct Plan {
    request: Request,
    experiments: Vec<&'static Experiment>,
    jobs: Vec<Job>,
}

struct Job {
    setup: Setup,
    as_recorded: bool,
}

/// Longest recorded run that is run again [s].
const LONGEST_S: f64 = 600.0;

impl Plan {
    /// Reads all setups.
    ///
    /// # Errors
    /// A name that is no experiment, or a mistake in a file.
    pub fn new(library: &Library, request: Request) -> Result<Self, FileError> {
        let experiments = chosen(&request.only)?;
        let mut jobs = Vec::new();
        for name in experiments
            .iter()
            .flat_map(|experiment| experiment.scenarios)
        {
            let setup = library.setup(name, &request.overrides)?;
            if let Some(recording) = request.real.runs.get(name)
                && let Some(setup) = as_recorded(&setup, recording)
            {
                jobs.push(Job {
                    setup,
                    as_recorded: true,
                });
            }
            jobs.push(Job {
                setup,
                as_recorded: false,
            });
        }
        // The longest first, so that no thread begins one when the others are done.
        jobs.sort_by(|one, other| {
            other
                .setup
                .scenario
                .duration_s
                .total_cmp(&one.setup.scenario.duration_s)
        });
        Ok(Self {
            request,
            experiments,
            jobs,
        })
    }

    /// What the report in this language is known by.
    #[must_use]
    pub fn stamp(&self, language: Language) -> FileStamp {
        let Request {
            only,
            seed,
            overrides,
            ..
        } = &self.request;
        let image = overrides.firmware.as_ref();
        let about = [
            language.tag().into(),
            seed.to_string(),
            overrides.robot.clone().unwrap_or_default(),
            image.map_or(String::new(), |path| path.display().to_string()),
        ];
        FileStamp::of("experiments", &[&about[..], only].concat())
    }

    /// The scenarios that are run as they are, not with the references of a recorded run.
    pub fn setups(&self) -> impl Iterator<Item = &Setup> {
        let as_they_are = self.jobs.iter().filter(|job| !job.as_recorded);
        as_they_are.map(|job| &job.setup)
    }

    /// How many runs there are.
    pub fn runs(&self) -> usize {
        self.jobs.len()
    }

    /// How long they are together, calibrations not counted [s].
    pub fn simulated_s(&self) -> f64 {
        self.jobs
            .iter()
            .map(|job| job.setup.scenario.duration_s)
            .sum()
    }

    /// Runs everything; calls `done` with the length [s] of each finished run.
    ///
    /// # Errors
    /// A setup that does not fit together, or a program that cannot be run at all.
    pub fn run(self, done: impl Fn(f64) + Sync) -> Result<Data, FileError> {
        let Self {
            request,
            experiments,
            jobs,
        } = self;
        let mut data = Data {
            experiments,
            seed: request.seed,
            real: request.real,
            ..Data::default()
        };
        if let Some(job) = jobs.first() {
            data.robot = [job.setup.robot.name.clone(), job.setup.robot.title.clone()];
        }
        // One at a time from a common heap: a split in halves would leave one thread without work.
        #[cfg(feature = "host")]
        let jobs = jobs.into_par_iter().with_max_len(1);
        #[cfg(not(feature = "host"))]
        let jobs = jobs.into_iter();
        let results: Vec<_> = jobs
            .map(|Job { setup, as_recorded }| {
                let result = run(&setup, request.seed)?;
                done(setup.scenario.duration_s);
                Ok((as_recorded, ReportedRun { setup, result }))
            })
            .collect::<Result<_, FileError>>()?;
        for (as_recorded, outcome) in results {
            let into = if as_recorded {
                &mut data.as_recorded
            } else {
                &mut data.outcomes
            };
            into.insert(outcome.result.scenario.clone(), outcome);
        }
        Ok(data)
    }
}

/// The requested experiments, in the report's order.
fn chosen(only: &[String]) -> Result<Vec<&'static Experiment>, FileError> {
    let has = |experiment: &Experiment, name: &String| {
        experiment.name == name || experiment.scenarios.contains(&name.as_str())
    };
    for name in only {
        if !EXPERIMENTS.iter().any(|experiment| has(experiment, name)) {
            let known: Vec<_> = EXPERIMENTS
                .iter()
                .map(|experiment| experiment.name)
                .collect();
            return Err(FileError::Setting(format!(
                "--only {name}: no such experiment; there are {}",
                known.join(", ")
            )));
        }
    }
    Ok(EXPERIMENTS
        .iter()
        .filter(|experiment| only.is_empty() || only.iter().any(|name| has(experiment, name)))
        .collect())
}

/// The setup with the references of a recorded run at its times; `None` where the experiment has none.
fn as_recorded(setup: &Setup, recording: &RealRun) -> Option<Setup> {
    let mut own = setup.clone();
    let scenario = &mut own.scenario;
    let armed_s = scenario
        .commands
        .iter()
        .find(|timed| timed.command == Command::Arm)?
        .at_s;
    if scenario.name == "mode3" {
        scenario.duration_s = (recording.duration_s() + armed_s).min(LONGEST_S);
        return Some(own);
    }
    let references = recording.references();
    let first = scenario
        .commands
        .iter()
        .position(|timed| is_reference(&timed.command))?;
    let pattern = scenario.commands[first];
    let (_, value) = references.first()?;
    scenario
        .commands
        .retain(|timed| !is_reference(&timed.command));
    let mut set = |at_s: f64, value: f64| {
        let command = with_value(&pattern.command, value as f32);
        let place = scenario
            .commands
            .partition_point(|timed| timed.at_s <= at_s);
        scenario.commands.insert(
            place,
            TimedCommand {
                at_s,
                command,
                ..pattern
            },
        );
    };
    set(pattern.at_s, *value);
    for (t_s, value) in &references[1..] {
        set(armed_s + t_s, *value);
    }
    scenario.duration_s = (recording.duration_s() + armed_s).min(LONGEST_S);
    Some(own)
}

fn is_reference(command: &Command) -> bool {
    matches!(command, Command::Reference(_) | Command::WheelReference(_))
}

fn with_value(pattern: &Command, value: f32) -> Command {
    match pattern {
        Command::WheelReference(_) => Command::WheelReference(rumbo_control::Wheels::both(value)),
        _ => Command::Reference(value),
    }
}
