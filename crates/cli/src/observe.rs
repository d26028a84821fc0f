//! `rumbo run` with `--profile`, `--vcd` or `--gdb`: one run with its program observed.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::mark::Mark;
use crate::output;
use crate::place::{self, Guard};
use rumbo_experiment::files::{Overrides, Setup};
use rumbo_experiment::observe::{self, Observations, Wanted};
use rumbo_experiment::run::{RunResult, run_by};
use rumbo_report::FileStamp;
use std::fs::File;
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;

/// Whether anything is to be observed.
pub(crate) fn is_wanted(args: &RunArgs) -> bool {
    args.profile.is_some() || args.vcd.is_some() || args.gdb.is_some()
}

/// Checks that the requested files may be written.
pub(crate) fn check_places(
    args: &RunArgs,
    guard: &Guard,
    setups: &[Setup],
    overrides: &Overrides,
) -> Result<(), Failure> {
    let mut results = Vec::new();
    for (path, option) in [(&args.vcd, "--vcd"), (&args.profile, "--profile")] {
        if let (Some(path), Some(setup)) = (path, setups.first()) {
            guard.check(path, &Mark::of(&stamp(setup, overrides, args.seed.seed)))?;
            place::try_file(path)?;
            results.push((path.clone(), option.to_owned()));
        }
    }
    place::distinct(&results)
}

/// What the files of a run are known by.
fn stamp(setup: &Setup, overrides: &Overrides, seed: u64) -> FileStamp {
    Mark::stamp("run", setup, overrides, seed)
}

/// Does the one run.
pub(crate) fn run(
    args: &RunArgs,
    jobs: &[(&Setup, u64)],
    overrides: &Overrides,
) -> Result<RunResult, Failure> {
    let [(setup, seed)] = jobs else {
        let runs = jobs.len();
        let what = format!(
            "--profile, --vcd and --gdb show one run, here are {runs}: name one scenario, without --runs"
        );
        return Err(Failure::Input(what));
    };
    let stamp = &stamp(setup, overrides, *seed);
    let debugger = args
        .gdb
        .map(|port| wait_for_debugger(port, args))
        .transpose()?;
    let look = |vcd: Option<File>| {
        let wanted = Wanted {
            profile: args.profile.is_some(),
            vcd,
            debugger,
        };
        let mut seen = Observations::default();
        let result = run_by(setup, *seed, |run| {
            seen = observe::go_on(run, wanted)?;
            Ok::<(), Failure>(())
        })?;
        Ok((result, seen))
    };
    let (result, seen) = match &args.vcd {
        Some(path) => drawn(path, stamp, look)?,
        None => look(None)?,
    };
    if let (Some(path), Some(folded)) = (&args.profile, seen.folded) {
        // What draws flame graphs passes over it.
        place::write(
            path,
            format!("# {}, cycles by call stack\n{folded}", stamp.text()),
        )?;
    }
    if let Some(profile) = seen.profile {
        profile.lines().for_each(output::aside);
    }
    if seen.ended {
        return Err(Failure::Input(
            "the debugger ended the run before its time".into(),
        ));
    }
    Ok(result)
}

/// Records the pins' waveforms to a file.
fn drawn<T>(
    path: &Path,
    stamp: &FileStamp,
    look: impl FnOnce(Option<File>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut seen = None;
    place::make(path, |place| {
        let unwritable = |error: std::io::Error| place::unwritable(path, &error);
        let mut file = File::create(place).map_err(unwritable)?;
        writeln!(file, "$comment {} $end", stamp.text()).map_err(unwritable)?;
        seen = Some(look(Some(file))?);
        Ok(())
    })?;
    seen.ok_or_else(|| Failure::Input(format!("{}: nothing was drawn", path.display())))
}

fn wait_for_debugger(port: u16, args: &RunArgs) -> Result<TcpStream, Failure> {
    let refused = |error: std::io::Error| {
        Failure::Input(format!(
            "--gdb {port}: cannot listen there ({error}); choose another port, or 0 for any"
        ))
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
    let port = listener.local_addr().map_err(refused)?.port();
    let image = args.image.firmware.as_deref().map(output::quoted);
    output::aside(&format!(
        "waiting for a debugger: avr-gdb {} -ex 'target remote :{port}'",
        image.unwrap_or_default()
    ));
    let (connection, _) = listener.accept().map_err(refused)?;
    Ok(connection)
}
