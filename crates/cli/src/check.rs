//! `rumbo check`: the claims of a file, each tried with the program on its emulated board.

use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::junit;
use crate::mark::Mark;
use crate::output;
use crate::place::{self, Guard};
use crate::run::set_threads;
use crate::sketch;
use rayon::prelude::*;
use rumbo_experiment::batch::Robot;
use rumbo_experiment::claims::{Broken, Suite, Test, TestProgram, TestVerdict};
use rumbo_experiment::files::{Library, Overrides, Setup};
use rumbo_lab::run_log::RunSource;
use rumbo_log::LogKind;
use rumbo_report::FileStamp;
use rumbo_session::headless::record_run;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Does the tests, prints a line for each, and writes what is wanted.
pub(crate) fn check(args: &CheckArgs) -> Result<(), Failure> {
    let mut suite = Suite::read(&output::shown(&args.file))?;
    choose(&mut suite, &args.only)?;
    let stamp = FileStamp::of("check", &[suite.path.clone()]);
    let guard = Guard::new([args.file.clone()], args.overwrite.force);
    if let Some(path) = &args.junit {
        guard.check(path, &Mark::of(&stamp))?;
        place::try_file(path)?;
    }
    set_threads(args.threads)?;
    let image = image(&suite, args)?;
    let setup = Arc::new(suite.setup(image.clone())?);
    let overrides = Overrides {
        firmware: Some(image),
        ..suite.overrides.clone()
    };
    let recorded = args.out.is_some();
    let tried: Vec<(&Test, TestVerdict)> = (suite.tests.par_iter())
        .map(|test| Ok((test, test.drive(&setup, recorded)?)))
        .collect::<Result<_, Failure>>()?;
    let mut cases = Vec::new();
    for (number, (test, verdict)) in (1..).zip(&tried) {
        let broken = verdict.broken.as_ref();
        let failure = broken.map(|(broken, _)| said(&suite, broken));
        match &failure {
            None => output::line(&format!("passed  {}  ({:.2} s)", test.name, verdict.took_s))?,
            Some(why) => {
                output::line(&format!("FAILED  {}", test.name))?;
                output::line(&format!("        {why}"))?;
            }
        }
        if let (Some(folder), Some((_, robot))) = (&args.out, broken) {
            let stem = folder.join(format!("test{number}"));
            leave(&stem, robot, (&suite, &setup, &overrides), &guard, &stamp)?;
        }
        cases.push(junit::Case {
            class: suite.path.clone(),
            name: test.name.clone(),
            failure,
        });
    }
    let failed = cases.iter().filter(|case| case.failure.is_some()).count();
    let count = output::counted(cases.len(), "test");
    if let Some(path) = &args.junit {
        let suites = [junit::Suite {
            name: suite.path.clone(),
            cases,
        }];
        place::write(path, junit::document(&suite.path, &suites, &stamp))?;
    }
    output::remark(&match failed {
        0 => format!("{count}: all passed"),
        failed => format!("{count}: {failed} failed"),
    })?;
    match failed {
        0 => Ok(()),
        _ => Err(Failure::LimitMissed),
    }
}

/// The image that is tested.
fn image(suite: &Suite, args: &CheckArgs) -> Result<PathBuf, Failure> {
    match &suite.program {
        TestProgram::Image(path) => Ok(path.clone()),
        TestProgram::Sketch(name) => {
            sketch::take_libraries(&args.libraries)?;
            let robot = match &suite.overrides.robot {
                Some(robot) => robot.clone(),
                None => beside(suite).scenario(&suite.scenario)?.robot,
            };
            sketch::image(name, beside(suite).robot(&robot)?.board)
        }
    }
}

/// Files as the suite names them.
fn beside(suite: &Suite) -> Library {
    Library::new().beside(&suite.path)
}

/// Leaves only the tests whose names have one of these texts.
fn choose(suite: &mut Suite, only: &[String]) -> Result<(), Failure> {
    for text in only {
        if !suite.tests.iter().any(|test| test.name.contains(text)) {
            let names: Vec<&str> = suite.tests.iter().map(|test| test.name.as_str()).collect();
            return Err(Failure::Input(format!(
                "--only {text}: no test is called so; there are: {}",
                names.join("; ")
            )));
        }
    }
    let is_chosen = |test: &Test| only.is_empty() || only.iter().any(|it| test.name.contains(it));
    suite.tests.retain(is_chosen);
    Ok(())
}

fn said(suite: &Suite, broken: &Broken) -> String {
    let Broken { number, line, why } = broken;
    format!("step {number} ({}:{line}): {why}", suite.path)
}

/// Writes log and waveform of a failed test, and says where.
fn leave(
    stem: &Path,
    robot: &Robot,
    (suite, setup, overrides): (&Suite, &Setup, &Overrides),
    guard: &Guard,
    stamp: &FileStamp,
) -> Result<(), Failure> {
    let [log, waves]: [PathBuf; 2] = ["mcap", "vcd"].map(|ending| stem.with_extension(ending));
    if let Some(parent) = stem.parent() {
        place::folder(parent)?;
    }
    guard.check(&log, &Mark::run(setup, overrides, robot.seed()))?;
    guard.check(&waves, &Mark::of(stamp))?;
    let library = beside(suite);
    let source = RunSource {
        kind: LogKind::Run,
        library: &library,
        overrides,
    };
    place::make(&log, |place| {
        let unwritable = |error: std::io::Error| place::unwritable(&log, &error);
        let file = BufWriter::new(File::create(place).map_err(unwritable)?);
        let written = source.episode(setup, robot, |manifest, run| {
            record_run(file, manifest, run)
        })?;
        match written {
            Some(written) => written.map(drop).map_err(Failure::input),
            None => Ok(()),
        }
    })?;
    if let Some(probe) = robot.probed() {
        let mut bytes = format!("$comment {} $end\n", stamp.text()).into_bytes();
        let written = probe.write_vcd(robot.sim(), &mut bytes);
        written.map_err(|error| place::unwritable(&waves, &error))?;
        place::write(&waves, bytes)?;
    }
    let [log, waves] = [log, waves].map(|path| output::quoted(&path));
    output::line(&format!("        rumbo replay {log}; gtkwave {waves}"))
}
