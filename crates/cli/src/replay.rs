//! `rumbo replay`: a log in the dashboard.

use crate::args::ReplayArgs;
use crate::browser;
use crate::export::warn_if_cut;
use crate::failure::Failure;
use crate::ghost;
use rumbo_station::log_file;

/// Serves the dashboard with the log.
pub(crate) fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    let read = match args.ghost {
        Some(_) => log_file::read,
        None => log_file::read_signals,
    };
    let mut log = read(&args.log).map_err(Failure::input)?;
    warn_if_cut(&args.log, &log)?;
    if log.speaks_text() {
        log = log_file::read(&args.log).map_err(Failure::input)?;
    }
    let ghost = match &args.ghost {
        Some(scenario) => Some(ghost::add_to(&mut log, &args.log, scenario.as_deref())?),
        None => None,
    };
    let name = args
        .log
        .file_stem()
        .unwrap_or(args.log.as_os_str())
        .to_string_lossy()
        .into_owned();
    let served = rumbo_station::serve_log(args.serve.at(), args.speed, name, log, ghost)
        .map_err(Failure::input)?;
    browser::show(served, args.serve)
}
