//! All runs of all hand-ins, on all cores.

use super::assignment::Assignment;
use super::mark::{GradedRun, Mark, RunError};
use super::program::{self, Seen};
use crate::files::{FileError, Setup, firmware};
use crate::note::Note;
use crate::run::{Run, RunResult, run_by};
use rayon::prelude::*;
use rumbo_emulator::image::Image;
use rumbo_sim::mega::{ACT, Mega};
use rumbo_sim::trace::Trace;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

/// Name of every hand-in's program in messages.
const NAME: &str = "sketch";

/// A hand-in.
#[derive(Debug)]
pub struct HandIn {
    /// The hand-in's name.
    pub name: String,
    /// The program, or why there is none, a line each.
    pub program: Result<Vec<u8>, Vec<String>>,
    /// Further notes for the reader.
    pub notes: Vec<Note>,
}

/// A hand-in whose program can be driven: the setup of each test with it.
type Ready = Result<Vec<Setup>, Vec<String>>;

/// The mark of each hand-in, in their order. `goes_on` is asked after each run; `None` where it says no.
pub fn grade(
    assignment: &Assignment,
    hand_ins: &[HandIn],
    goes_on: impl Fn() -> bool + Sync,
) -> Option<Vec<Mark>> {
    let ready: Vec<Ready> = hand_ins
        .par_iter()
        .map(|hand_in| ready(assignment, hand_in))
        .collect();
    let mut jobs = Vec::new();
    for (index, setups) in ready.iter().enumerate() {
        for (test, setup) in setups.iter().flatten().enumerate() {
            let seeds = assignment.tests[test].seeds();
            jobs.extend(seeds.map(|seed| (index, test, setup, seed)));
        }
    }
    let mut metrics = assignment.criteria.iter().map(|one| &one.metric);
    let watched = metrics.any(|metric| program::is_of_program(metric));
    let results: Option<Vec<(usize, GradedRun)>> = jobs
        .par_iter()
        .map(|(index, test, setup, seed)| {
            let drawn = assignment.tests[*test].public.first() == Some(seed);
            let mut seen = (drawn && watched).then(Seen::default);
            let result = one(setup, *seed, drawn, &mut seen);
            let run = GradedRun {
                test: *test,
                result,
                seen,
            };
            goes_on().then_some((*index, run))
        })
        .collect();
    let mut runs: Vec<Vec<GradedRun>> = hand_ins.iter().map(|_| Vec::new()).collect();
    for (index, run) in results? {
        runs[index].push(run);
    }
    let all = hand_ins.iter().zip(ready).zip(runs);
    let marks = all.map(|((hand_in, ready), runs)| {
        let mut mark = match ready {
            Ok(_) => Mark::of(assignment, &hand_in.name, runs),
            Err(why) => Mark::refused(assignment, &hand_in.name, why),
        };
        mark.notes.splice(..0, hand_in.notes.iter().cloned());
        mark
    });
    Some(marks.collect())
}

fn ready(assignment: &Assignment, hand_in: &HandIn) -> Ready {
    let bytes = hand_in.program.as_ref().map_err(Clone::clone)?;
    let image = Image::parse(bytes).map_err(|error| vec![error.to_string()])?;
    let setups = assignment.tests.iter().map(|test| {
        let Setup {
            robot, scenario, ..
        } = &test.setup;
        let wiring = test.wiring.as_deref();
        let firmware = firmware::wired(NAME, image.clone(), wiring, robot, scenario)?;
        Ok(Setup {
            firmware: Some(Arc::new(firmware)),
            ..test.setup.clone()
        })
    });
    let setups: Result<_, FileError> = setups.collect();
    setups.map_err(|error| vec![error.to_string()])
}

/// Budget of a program's outputs per second ([`Mega::toil`]): a pin that is switched 25,000 times.
const TOIL_PER_S: f64 = 250_000.0;

/// Runs to the end, or until the program exceeds its budget; the same program is ended at the same instant on every
/// machine. Returns whether it was.
fn go_on(run: &mut Run<'_>) -> bool {
    while !run.is_over() {
        run.advance();
        let now_s = run.sim().now_us() as f64 * 1e-6;
        let toil = run.sim().mega().map_or(0, Mega::toil);
        if toil as f64 > TOIL_PER_S * (now_s + 1.0) {
            return true;
        }
    }
    false
}

/// One run; a failure affects no other. Samples are kept only for runs that are plotted, and the program is watched where
/// there is room for what is seen.
fn one(
    setup: &Setup,
    seed: u64,
    drawn: bool,
    seen: &mut Option<Seen>,
) -> Result<RunResult, RunError> {
    let mut is_too_much = false;
    let result = catch_unwind(AssertUnwindSafe(|| {
        run_by(setup, seed, |run| {
            if let (Some(_), Some(mega)) = (&seen, run.sim().mega_mut()) {
                program::watch(mega);
            }
            is_too_much = go_on(run);
            if let (Some(seen), Some(mega)) = (seen, run.sim().mega()) {
                *seen = program::seen(mega);
            }
            Ok::<(), FileError>(())
        })
    }));
    let mut result = result
        .map_err(|_| RunError::Panicked)?
        .map_err(RunError::Setup)?;
    if is_too_much {
        let most = TOIL_PER_S / ACT as f64;
        result.ended = Some(Note::TooManyEdges { most });
    }
    let Trace {
        samples, sights, ..
    } = std::mem::take(&mut result.trace);
    let drove = samples.iter().find(|sample| sample.duty != [0; 2]).copied();
    result.trace = Trace {
        samples: match drawn {
            true => samples,
            // One says whether it drove.
            false => drove.into_iter().collect(),
        },
        sights,
        ..Trace::default()
    };
    Ok(result)
}
