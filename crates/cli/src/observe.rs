//! `rumbo run` with `--profile`, `--vcd` or `--gdb`: one run whose program is looked at.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::place;
use rumbo_scenario::files::Setup;
use rumbo_scenario::observe::{self, Seen, Wanted};
use rumbo_scenario::run::{RunResult, run_by};
use std::fs::File;
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::Path;

/// Something of the program is to be seen.
pub(crate) fn is_wanted(args: &RunArgs) -> bool {
    args.profile.is_some() || args.vcd.is_some() || args.gdb.is_some()
}

/// Does the one run.
pub(crate) fn run(args: &RunArgs, jobs: &[(&Setup, u64)]) -> Result<RunResult, Failure> {
    let [(setup, seed)] = jobs else {
        let runs = jobs.len();
        let what = format!(
            "--profile, --vcd and --gdb show one run, here are {runs}: name one scenario, without --runs"
        );
        return Err(Failure::Input(what));
    };
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
        let mut seen = Seen::default();
        let result = run_by(setup, *seed, |run| {
            seen = observe::go_on(run, wanted)?;
            Ok::<(), Failure>(())
        })?;
        Ok((result, seen))
    };
    let (result, seen) = match &args.vcd {
        Some(path) => drawn(path, look)?,
        None => look(None)?,
    };
    if let (Some(path), Some(folded)) = (&args.profile, seen.folded) {
        place::write(path, folded)?;
    }
    if let Some(profile) = seen.profile {
        tell(&profile);
    }
    if seen.ended {
        return Err(Failure::Input(
            "the debugger ended the run before its time".into(),
        ));
    }
    Ok(result)
}

/// Has the pins drawn into a file.
fn drawn<T>(
    path: &Path,
    look: impl FnOnce(Option<File>) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let mut seen = None;
    place::make(path, |place| {
        let file = File::create(place).map_err(|error| place::unwritable(path, &error))?;
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
    let image = args
        .image
        .firmware
        .as_ref()
        .map(|path| path.display().to_string());
    tell(&format!(
        "waiting for a debugger: avr-gdb {} -ex 'target remote :{port}'\n",
        image.unwrap_or_default()
    ));
    let (connection, _) = listener.accept().map_err(refused)?;
    Ok(connection)
}

/// On stderr, where it is in no result's way; a closed one leaves nobody to tell.
fn tell(text: &str) {
    let _ = std::io::stderr().write_all(text.as_bytes());
}
