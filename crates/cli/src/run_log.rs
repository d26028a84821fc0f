//! The logs of headless runs.
//!
//! With `--out` each run writes one to that folder, and it depends only on the run's inputs. Without, they are stored
//! among the logs of sessions, with the time of day; a command of many runs keeps only some there, since each can be
//! reproduced from its seed.

use crate::failure::Failure;
use crate::logs;
use crate::output;
use crate::place;
use rumbo_control::Wheels;
use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_experiment::run::RunResult;
use rumbo_lab::{manifest, others, scene};
use rumbo_log::{
    Burst, Choice, Kind, Manifest, MapPose, Other, Outcome, Said, Scene, Source as Origin, Truth,
};
use rumbo_session::Shown;
use rumbo_session::headless::Run;
use rumbo_sim::trace::{SAMPLE_US, Sample, Trace};
use rumbo_sim::{READING_US, loop_signals};
use rumbo_station::headless::{record_run, record_run_in};
use rumbo_wire::FromRobot;
use std::path::PathBuf;

/// Most runs of a command that are recorded by default: all of them, or the first that miss a limit.
const KEPT: usize = 20;

/// How the runs were set up.
pub(crate) struct Source<'a> {
    /// The kind of runs.
    pub(crate) kind: Kind,
    pub(crate) library: &'a Library,
    pub(crate) overrides: &'a Overrides,
}

impl Source<'_> {
    /// Passes the contents of a run's logs to `write`, one for each robot.
    fn each_robot(
        &self,
        setup: &Setup,
        result: &RunResult,
        mut write: impl FnMut(&Manifest, Run<'_>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let manifest = Manifest {
            step_us: SAMPLE_US,
            baud: 9_600,
            ..manifest::of(self.kind, setup, self.overrides, result.seed)
        };
        if result.robots.is_empty() {
            let alone = Around {
                scenario: &result.scenario,
                others: Vec::new(),
                places: Vec::new(),
            };
            return self.with_run(setup, result, alone, |run| write(&manifest, run));
        }
        for (number, (own, robot)) in std::iter::zip(&setup.fleet, &result.robots).enumerate() {
            let around = Around {
                scenario: &result.scenario,
                others: others(&setup.fleet, number),
                places: places(&result.robots, number),
            };
            let manifest = Manifest {
                member: Some(robot.scenario.clone()),
                ..manifest.clone()
            };
            self.with_run(own, robot, around, |run| write(&manifest, run))?;
        }
        Ok(())
    }

    /// Passes the contents of a robot's log to `write`.
    fn with_run<T>(
        &self,
        setup: &Setup,
        result: &RunResult,
        around: Around<'_>,
        write: impl FnOnce(Run<'_>) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let choice = Choice {
            scenario: around.scenario.to_owned(),
            world: self.overrides.world.clone(),
            rig: self.overrides.rig.clone(),
            seed: result.seed,
        };
        let of_seed = &*setup.of_seed(result.seed)?;
        let trace = &result.trace;
        let link: Vec<_> = trace.link.iter().map(burst).collect();
        let mut shown = shown(trace);
        shown.extend(around.places);
        let scene = Scene {
            others: around.others,
            ..scene(self.library, of_seed, choice)?
        };
        let run = Run {
            scene: Some(scene),
            parameters: trace.parameters,
            truths: &trace.samples.iter().map(truth).collect::<Vec<_>>(),
            messages: &messages(trace),
            said: &trace.consoles.iter().map(said).collect::<Vec<_>>(),
            shown: &shown,
            link: &link,
            outcome: Outcome {
                pass: result.pass,
                metrics: result.metrics.clone().into_iter().collect(),
                failures: result.failures.clone(),
            },
        };
        write(run)
    }

    /// Writes the log of a run, of several robots one for each, to the path that is requested for it.
    pub(crate) fn write(
        &self,
        path_of: impl Fn(Option<&str>) -> PathBuf,
        setup: &Setup,
        result: &RunResult,
    ) -> Result<(), Failure> {
        self.each_robot(setup, result, |manifest, run| {
            let path = &path_of(manifest.member.as_deref());
            place::make(path, |place| {
                record_run(place, manifest, run).map_err(|error| Failure::input(error.of(path)))
            })
        })
    }
}

/// What a robot's run is a part of.
struct Around<'a> {
    /// The scenario of all robots.
    scenario: &'a str,
    /// The other robots.
    others: Vec<Other>,
    /// Where they were.
    places: Vec<(u64, Shown)>,
}

/// Where the others of a robot were, as often as instruments are read.
fn places(robots: &[RunResult], number: usize) -> Vec<(u64, Shown)> {
    let samples = robots[number].trace.samples.len();
    let others = robots.iter().enumerate();
    let others: Vec<_> = others.filter(|(other, _)| *other != number).collect();
    let every = (READING_US / SAMPLE_US) as usize;
    let at = |index: usize| {
        let t_us = micros(robots[number].trace.samples[index].t_s);
        let poses = others.iter().filter_map(|(_, robot)| {
            let at = truth(robot.trace.samples.get(index)?).1.pose;
            Some(Other::signals(&robot.scenario, at))
        });
        (t_us, (Origin::Others, poses.flatten().collect()))
    };
    (0..samples).step_by(every).map(at).collect()
}

/// The logs that a command adds to those of sessions.
pub(crate) struct Kept {
    /// `None` where nothing is recorded, or no longer.
    folder: Option<PathBuf>,
    begun: Option<String>,
    /// There are more runs than are kept: only those that miss a limit are recorded.
    many: bool,
    logs: Vec<PathBuf>,
}

impl Kept {
    /// For a command of so many runs; `wanted`: whether it records at all.
    pub(crate) fn of(runs: usize, wanted: bool) -> Self {
        Self {
            folder: logs::folder(None).filter(|_| wanted),
            begun: Some(rumbo_station::now_utc()),
            many: runs > KEPT,
            logs: Vec::new(),
        }
    }

    /// Records a run, if it is one to keep. A failure to record does not fail the run; it is reported once.
    pub(crate) fn take(&mut self, source: &Source<'_>, setup: &Setup, result: &RunResult) {
        let Some(folder) = &self.folder else {
            return;
        };
        if self.logs.len() >= KEPT || (self.many && result.pass) {
            return;
        }
        let mut logs = Vec::new();
        let written = source.each_robot(setup, result, |manifest, run| {
            let manifest = Manifest {
                started: self.begun.clone(),
                ..manifest.clone()
            };
            logs.push(record_run_in(folder, &manifest, run).map_err(Failure::input)?);
            Ok(())
        });
        self.logs.extend(logs);
        if let Err(failure) = written {
            self.folder = None;
            output::note(&format!("not recording: {failure}"));
        }
    }

    /// Prints where they are.
    pub(crate) fn report(&self) {
        let which = if self.many {
            " of runs that miss a limit"
        } else {
            ""
        };
        match &self.logs[..] {
            [] => {}
            [only] => output::aside(&format!("recorded: {}", only.display())),
            [first, ..] => output::aside(&format!(
                "recorded: {} logs{which} in {}",
                self.logs.len(),
                first.parent().unwrap_or(first).display()
            )),
        }
    }
}

/// Messages of a program that does not use our link; those over the link are in its bytes.
fn messages(trace: &Trace) -> Vec<(u64, FromRobot)> {
    if !trace.link.is_empty() {
        return Vec::new();
    }
    trace
        .messages
        .iter()
        .map(|message| (micros(message.t_s), message.what))
        .collect()
}

fn micros(t_s: f64) -> u64 {
    (t_s * 1e6).round() as u64
}

pub(crate) fn burst(burst: &rumbo_sim::Burst) -> Burst {
    Burst {
        t_us: burst.t_us,
        to_robot: burst.to_robot,
        bytes: burst.bytes.clone(),
    }
}

pub(crate) fn said(said: &rumbo_sim::trace::Said) -> Said {
    Said {
        t_us: said.t_us,
        usart: said.usart,
        to_chip: false,
        bytes: said.bytes.clone(),
    }
}

/// Of a program there are either instruments or control loops.
fn shown(trace: &Trace) -> Vec<(u64, Shown)> {
    let instruments = trace.readings.iter();
    let instruments = instruments.map(|each| (each.t_us, (Origin::Truth, each.signals.clone())));
    let loops = trace.loops.iter();
    let loops = loops.map(|(t_us, loops)| (*t_us, (Origin::Loops, loop_signals(loops))));
    instruments.chain(loops).collect()
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
