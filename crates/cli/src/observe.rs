//! `rumbo run` with `--profile`, `--vcd` or `--gdb`: one run whose program is looked at.

use crate::args::RunArgs;
use crate::failure::Failure;
use rumbo_scenario::files::Setup;
use rumbo_scenario::observe::{self, Wanted};
use rumbo_scenario::run::{RunResult, run_by};
use std::io::Write;
use std::net::{Ipv4Addr, TcpListener, TcpStream};

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
    let wanted = Wanted {
        profile: args.profile.clone(),
        vcd: args.vcd.clone(),
        debugger,
    };
    let mut seen = observe::Seen::default();
    let result = run_by(setup, *seed, |run| {
        seen = observe::go_on(run, wanted)?;
        Ok::<(), Failure>(())
    })?;
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

fn wait_for_debugger(port: u16, args: &RunArgs) -> Result<TcpStream, Failure> {
    let refused = |error: std::io::Error| {
        Failure::Input(format!(
            "--gdb {port}: cannot listen there ({error}); choose another port, or 0 for any"
        ))
    };
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
    let port = listener.local_addr().map_err(refused)?.port();
    let image = args
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
