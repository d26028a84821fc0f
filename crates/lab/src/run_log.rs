//! What a run's log contains: the manifest, and the records of each robot.

use crate::{manifest, others, scene};
use rumbo_control::Wheels;
use rumbo_experiment::batch::Robot;
use rumbo_experiment::files::{FileError, Library, Overrides, Setup};
use rumbo_experiment::note::Note;
use rumbo_experiment::run::RunResult;
use rumbo_log::{
    Burst, Choice, LogKind, Manifest, MapPose, Other, Outcome, ReadingSource, Said, Scene, Truth,
};
use rumbo_session::Shown;
use rumbo_session::headless::RunRecords;
use rumbo_sim::trace::{SAMPLE_US, Trace, TruthSample};
use rumbo_sim::{READING_US, loop_signals};
use rumbo_wire::FromRobot;

/// How the runs were set up.
pub struct RunSource<'a> {
    /// The kind of runs.
    pub kind: LogKind,
    /// The files.
    pub library: &'a Library,
    /// What is in place of the scenario's.
    pub overrides: &'a Overrides,
}

impl RunSource<'_> {
    /// Passes the contents of a run's logs to `write`, one for each robot.
    ///
    /// # Errors
    /// The world's shapes are none, or that of `write`.
    pub fn each_robot<E: From<FileError>>(
        &self,
        setup: &Setup,
        result: &RunResult,
        mut write: impl FnMut(&Manifest, RunRecords<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        let manifest = self.manifest(setup, result.seed);
        if result.robots.is_empty() {
            let alone = Around::none(&result.scenario);
            return self.with_run(setup, &Records::of(result), alone, |run| {
                write(&manifest, run)
            })?;
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
            self.with_run(own, &Records::of(robot), around, |run| {
                write(&manifest, run)
            })??;
        }
        Ok(())
    }

    /// Passes the content of the log of a robot that its caller steps to `write`; `None` if nothing was recorded.
    ///
    /// # Errors
    /// The world's shapes are none.
    pub fn episode<T>(
        &self,
        setup: &Setup,
        robot: &Robot,
        write: impl FnOnce(&Manifest, RunRecords<'_>) -> T,
    ) -> Result<Option<T>, FileError> {
        let Some(trace) = robot.trace().filter(|trace| !trace.samples.is_empty()) else {
            return Ok(None);
        };
        let records = Records {
            seed: robot.seed(),
            trace,
            goal_m: robot.goal_m(),
            outcome: None,
        };
        let manifest = self.manifest(setup, records.seed);
        let alone = Around::none(&setup.scenario.name);
        self.with_run(setup, &records, alone, |run| write(&manifest, run))
            .map(Some)
    }

    fn manifest(&self, setup: &Setup, seed: u64) -> Manifest {
        Manifest {
            step_us: SAMPLE_US,
            baud: 9_600,
            ..manifest::of(self.kind, setup, self.overrides, seed)
        }
    }

    /// Passes the contents of a robot's log to `write`.
    fn with_run<T>(
        &self,
        setup: &Setup,
        records: &Records<'_>,
        around: Around<'_>,
        write: impl FnOnce(RunRecords<'_>) -> T,
    ) -> Result<T, FileError> {
        let Records {
            seed,
            trace,
            goal_m,
            outcome,
        } = records;
        let choice = Choice {
            scenario: around.scenario.to_owned(),
            world: self.overrides.world.clone(),
            rig: self.overrides.rig.clone(),
            seed: *seed,
        };
        let of_seed = &*setup.of_seed(*seed)?;
        let link: Vec<_> = trace.link.iter().map(burst).collect();
        let mut shown = shown(trace);
        shown.extend(around.places);
        let scene = Scene {
            others: around.others,
            ..scene(self.library, of_seed, choice)?
        };
        Ok(write(RunRecords {
            scene: Some(scene),
            parameters: trace.parameters,
            goal_m: *goal_m,
            truths: &trace
                .samples
                .iter()
                .map(|sample| truth(trace, sample))
                .collect::<Vec<_>>(),
            messages: &messages(trace),
            said: &trace.consoles.iter().map(said).collect::<Vec<_>>(),
            shown: &shown,
            link: &link,
            outcome: outcome.clone(),
        }))
    }
}

/// What is recorded of a robot.
struct Records<'a> {
    seed: u64,
    trace: &'a Trace,
    /// The goal of a robot that got none by a command.
    goal_m: Option<[f32; 2]>,
    outcome: Option<Outcome>,
}

impl<'a> Records<'a> {
    fn of(result: &'a RunResult) -> Self {
        Self {
            seed: result.seed,
            trace: &result.trace,
            goal_m: None,
            outcome: Some(Outcome {
                pass: result.pass,
                metrics: result.metrics.clone().into_iter().collect(),
                failures: result.failures.iter().map(Note::to_string).collect(),
            }),
        }
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

impl<'a> Around<'a> {
    /// Of a robot alone in its world.
    fn none(scenario: &'a str) -> Self {
        Self {
            scenario,
            others: Vec::new(),
            places: Vec::new(),
        }
    }
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
            let at = pose(robot.trace.samples.get(index)?);
            Some(Other::signals(&robot.scenario, at))
        });
        (t_us, (ReadingSource::Others, poses.flatten().collect()))
    };
    (0..samples).step_by(every).map(at).collect()
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

/// Bytes that crossed the link, as a log has them.
#[must_use]
pub fn burst(burst: rumbo_sim::LinkBurst<'_>) -> Burst {
    Burst {
        t_us: burst.t_us,
        to_robot: burst.to_robot,
        bytes: burst.bytes.to_vec(),
    }
}

/// What a USART of an emulated Mega has sent, as a log has it.
#[must_use]
pub fn said(said: &rumbo_sim::trace::UsartOutput) -> Said {
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
    let instruments =
        instruments.map(|each| (each.t_us, (ReadingSource::Truth, each.signals.clone())));
    let loops = trace.loops.iter();
    let loops = loops.map(|(t_us, loops)| (*t_us, (ReadingSource::Loops, loop_signals(loops))));
    instruments.chain(loops).collect()
}

fn pose(sample: &TruthSample) -> MapPose {
    MapPose {
        x_m: sample.x_m,
        y_m: sample.y_m,
        heading_rad: sample.heading_rad,
    }
}

fn truth(trace: &Trace, sample: &TruthSample) -> (u64, Truth) {
    let [left, right] = sample.wheel_rad_s;
    let truth = Truth {
        pose: pose(sample),
        wheel_rad_s: Wheels { left, right },
        range_m: [0, 1, 2].map(|sonar| {
            let range_m = trace.range_m(sample, sonar);
            (!range_m.is_nan()).then_some(range_m)
        }),
        servo_rad: sample.servo_rad,
        contact: sample.touching,
        battery_v: sample.battery_v,
    };
    (micros(sample.t_s), truth)
}
