//! `rumbo replay`: a log in the dashboard, or the page of a folder whose runs are replayed when they are clicked.

use crate::args::ReplayArgs;
use crate::browser;
use crate::export::warn_if_cut;
use crate::failure::Failure;
use crate::ghost;
use crate::logs;
use rumbo_station::log_file;

/// Serves the dashboard with the log, or the folder's page.
pub(crate) fn replay(args: &ReplayArgs) -> Result<(), Failure> {
    if args.log.is_dir() {
        return replay_folder(args);
    }
    let read = match args.ghost {
        Some(_) => log_file::read,
        None => log_file::read_replay,
    };
    logs::mend(&args.log);
    let mut log = read(&args.log).map_err(Failure::input)?;
    warn_if_cut(&args.log, &log)?;
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

fn replay_folder(args: &ReplayArgs) -> Result<(), Failure> {
    let folder = args.log.display();
    if !args.log.join("index.html").is_file() {
        return Err(Failure::Input(format!(
            "{folder}: is a folder without a page; give a log, or the folder of `rumbo sweep`"
        )));
    }
    if args.ghost.is_some() || args.serve.listen.is_some() {
        return Err(Failure::Input(format!(
            "{folder}: a folder's page is shown on this computer and without a ghost; give --ghost and --listen with a log"
        )));
    }
    let served = rumbo_station::serve_folder(args.serve.at(), args.log.clone());
    browser::show_folder(served.map_err(Failure::input)?, args.serve)
}
