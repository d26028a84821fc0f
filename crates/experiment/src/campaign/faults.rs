//! Sensors and wires that fail in the middle of a drive, many times over: contacts, their speed, and whether the robot
//! reported the cause.
//!
//! Each [`Failure`] is injected into each drive of [`DRIVES`] at each of its instants, once per seed. Contacts and
//! their speed are ground truth; the fault is the one sent over the link. A front sonar stuck at "nothing in range",
//! after a second in which nothing was in range, looks like free floor: those runs are a separate class
//! ([`Class::FreeFloor`]). With an image the chip fails too ([`ChipFailure`]).

pub use super::failure::{ChipFailure, Failure};
use crate::files::{FileError, Library, Overrides, Setup};
use crate::run::{Run, prepare};
use rayon::prelude::*;
use rumbo_control::{Fault, SonarId};
use rumbo_sim::sonar_fault::SonarFault;
use rumbo_sim::trace::Trace;
use rumbo_wire::{EventKind, FromRobot};

/// Instants per drive.
pub const INSTANTS: usize = 5;
/// The drives, each with the instants at which something fails [s]: on the way, at a face, in a turn, between boxes.
pub const DRIVES: [(&str, [f64; INSTANTS]); 7] = [
    ("mode1", [0.8, 1.2, 1.6, 2.2, 5.7]),
    ("mode3", [1.0, 2.0, 5.0, 10.0, 20.0]),
    ("mode4-final", [1.0, 3.0, 7.8, 9.0, 15.0]),
    ("mode7", [1.5, 2.5, 4.0, 8.0, 12.0]),
    ("mode8-obstacles", [3.0, 4.5, 6.0, 8.0, 10.0]),
    ("mode8-lane", [1.5, 3.0, 5.0, 7.0, 10.0]),
    ("mode8-random", [2.0, 4.0, 6.0, 9.0, 14.0]),
];
/// A drive ends this long after the robot has reported a fault: it has rolled out [s].
const ROLLED_OUT_S: f64 = 3.0;
/// Or this long after it has reported its goal as reached or unreachable [s].
const ARRIVED_S: f64 = 1.0;
/// A front sonar with nothing in range for this long before it failed sees free floor [s].
const FREE_S: f64 = 1.0;
/// Fastest harmless contact [m/s].
pub const GENTLE_M_S: f64 = 0.1;
/// One run in this many may touch something.
pub const RUNS_PER_TOUCH: usize = 500;
/// One run in this many may touch something faster than [`GENTLE_M_S`]: what a sonar that has just fallen silent did not
/// show, or what stands beside a turn with an encoder that has just begun to lose most of its edges.
pub const RUNS_PER_HARD_TOUCH: usize = 5_000;

/// Which requirement applies to a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The robot can detect the failure.
    Knowable,
    /// The sonar's last second and its false answer are both "nothing in range".
    FreeFloor,
}

/// How a robot reports that something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Named {
    /// By a fault.
    Fault(Fault),
    /// By reporting a restart of its program.
    Restart,
}

/// The outcome of one drive.
#[derive(Clone, Debug)]
pub struct FaultDrive {
    /// Index into [`DRIVES`].
    pub drive: usize,
    /// Its seed.
    pub seed: u64,
    /// When it failed [s].
    pub at_s: f64,
    /// What failed.
    pub failure: Failure,
    /// The requirement that applies.
    pub class: Class,
    /// When something was first touched after the failure [s], and the fastest touch of the run [m/s].
    pub touch: Option<(f64, f64)>,
    /// When the robot reported the failure, and how.
    pub named: Option<(f64, Named)>,
}

impl FaultDrive {
    /// A contact faster than [`GENTLE_M_S`].
    #[must_use]
    pub fn touched_hard(&self) -> bool {
        self.touch.is_some_and(|(_, m_s)| m_s > GENTLE_M_S)
    }
}

/// Summary of the drives in which the robot could detect the failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DetectionSummary {
    /// How many there were.
    pub runs: usize,
    /// In how many something was touched.
    pub touches: usize,
    /// Of these, faster than [`GENTLE_M_S`].
    pub hard: usize,
}

impl DetectionSummary {
    /// Of these drives, without those of [`Class::FreeFloor`].
    #[must_use]
    pub fn of(drives: &[FaultDrive]) -> Self {
        let knowable = drives.iter().filter(|drive| drive.class == Class::Knowable);
        let touches: Vec<&FaultDrive> =
            knowable.clone().filter(|run| run.touch.is_some()).collect();
        let count = |of: &dyn Fn(&FaultDrive) -> bool| touches.iter().filter(|run| of(run)).count();
        Self {
            runs: knowable.count(),
            touches: touches.len(),
            hard: count(&FaultDrive::touched_hard),
        }
    }

    /// How many touches are allowed.
    #[must_use]
    pub fn allowed(&self) -> usize {
        self.runs / RUNS_PER_TOUCH
    }

    /// How many of them may be fast.
    #[must_use]
    pub fn allowed_hard(&self) -> usize {
        self.runs.div_ceil(RUNS_PER_HARD_TOUCH)
    }

    /// Whether no more happened than is allowed.
    #[must_use]
    pub fn is_met(&self) -> bool {
        self.touches <= self.allowed() && self.hard <= self.allowed_hard()
    }
}

/// Drives with everything that fails, on all cores.
///
/// `seeds` are those of each drive; `keep` chooses among drives by name and among failures. On an image if `overrides` name one.
///
/// # Errors
/// A setup that does not fit together, or a robot that cannot be calibrated.
pub fn drive_all(
    overrides: &Overrides,
    seeds: std::ops::Range<u64>,
    instants: usize,
    keep: impl Fn(&str, Failure) -> bool + Sync,
) -> Result<Vec<FaultDrive>, FileError> {
    let library = Library::new();
    let setups = DRIVES.map(|(name, _)| library.setup(name, overrides));
    let mut jobs = Vec::new();
    for (drive, setup) in setups.into_iter().enumerate() {
        let setup = setup?;
        jobs.extend(seeds.clone().map(|seed| (drive, setup.clone(), seed)));
    }
    let drives: Result<Vec<Vec<FaultDrive>>, FileError> = jobs
        .into_par_iter()
        .map(|(drive, setup, seed)| {
            let (name, instants_s) = DRIVES[drive];
            let failures: Vec<_> = Failure::all()
                .into_iter()
                .filter(|failure| failure.befalls(&setup) && keep(name, *failure))
                .collect();
            if failures.is_empty() {
                return Ok(Vec::new());
            }
            let mut own = prepare(&setup, seed)?.into_owned();
            let mut done = Vec::new();
            for at_s in instants_s.into_iter().take(instants) {
                for failure in &failures {
                    failure.put_into(&mut own, at_s);
                    done.push(one(&own, (drive, seed), at_s, *failure)?);
                }
            }
            Ok(done)
        })
        .collect();
    Ok(drives?.into_iter().flatten().collect())
}

/// One drive, until the robot has rolled out, has arrived, or the time is over.
fn one(
    setup: &Setup,
    (drive, seed): (usize, u64),
    at_s: f64,
    failure: Failure,
) -> Result<FaultDrive, FileError> {
    let mut run = Run::new(setup, [setup], seed)?;
    let mut named = None;
    let mut end_s = f64::INFINITY;
    let mut read = 0;
    let mut pending = Some(failure);
    while !run.is_over() && run.sim().now_us() as f64 * 1e-6 < end_s {
        if run.sim().now_us() as f64 * 1e-6 >= at_s
            && let Some(failure) = pending.take()
        {
            failure.befall(run.sim());
            // A hung robot sends nothing.
            if matches!(failure, Failure::Chip(_)) {
                end_s = at_s + ROLLED_OUT_S;
            }
        }
        run.advance();
        let received = run.received();
        for message in received.get(read..).unwrap_or_default() {
            let kind = match message.what {
                FromRobot::Event(event) => event.kind,
                FromRobot::Hello(_) if message.t_s > at_s && named.is_none() => {
                    named = Some((message.t_s, Named::Restart));
                    continue;
                }
                _ => continue,
            };
            match kind {
                EventKind::Faulted(fault) if named.is_none() => {
                    named = Some((message.t_s, Named::Fault(fault)));
                    end_s = message.t_s + ROLLED_OUT_S;
                }
                EventKind::Reached | EventKind::Unreachable | EventKind::GaveUp { .. }
                    if message.t_s > at_s =>
                {
                    end_s = end_s.min(message.t_s + ARRIVED_S);
                }
                _ => {}
            }
        }
        read = received.len();
    }
    let trace = run.trace();
    let mut samples = trace.samples.iter();
    let touch = samples.find(|sample| sample.touching && sample.t_s >= at_s);
    let touch = touch.map(|sample| sample.t_s);
    let class = class(trace, at_s, failure);
    Ok(FaultDrive {
        drive,
        seed,
        at_s,
        failure,
        class,
        touch: touch.map(|touch_s| (touch_s, run.sim().worst_contact_m_s())),
        named,
    })
}

fn class(trace: &Trace, at_s: f64, failure: Failure) -> Class {
    let silent = matches!(
        failure,
        Failure::Sonar(SonarId::Front, SonarFault::Clear | SonarFault::Stuck)
    );
    let before = trace.between(at_s - FREE_S, at_s);
    let [_, _, front] = SonarId::ALL.map(|id| id as usize);
    let free = before
        .iter()
        .all(|sample| trace.range_m(sample, front).is_infinite());
    if silent && free {
        Class::FreeFloor
    } else {
        Class::Knowable
    }
}
