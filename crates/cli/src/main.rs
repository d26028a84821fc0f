//! The `rumbo` command: reads the arguments, calls the crate that does the work, prints the result.
//!
//! Results go to stdout, progress and errors to stderr, one line per error. Exit status: 0 done, 1 a limit of a
//! scenario was missed, 2 wrong input, 130 interrupted. Each file here is one subcommand.

mod args;
mod browser;
mod by_option;
mod calibrate;
mod capture;
mod check;
mod column_names;
mod compare;
mod connect;
mod csv_rows;
mod debug;
mod experiments;
mod explain;
mod export;
mod export_policy;
mod failure;
mod figures;
mod flash;
mod fleet_table;
mod ghost;
mod grade;
mod identify;
mod import;
mod in_hand;
mod interrupt;
mod junit;
mod lab;
mod left_out;
mod list;
mod logs;
mod manifest;
mod manual;
mod mark;
mod new_robot;
mod observe;
mod output;
mod place;
#[cfg(unix)]
mod pty;
mod recorded;
mod replay;
mod rerun;
mod results;
mod ros2bag;
mod run;
mod run_log;
mod sketch;
mod sweep;
mod tune;
mod wired;
mod workshop;

use args::{Cli, Command, NewKind};
use failure::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let outcome = match Cli::of_process() {
        Ok(cli) => dispatch(cli),
        Err(error) => args::explain(&error),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => output::report(failure),
    }
}

fn dispatch(cli: Cli) -> Result<(), Failure> {
    match cli.command {
        Some(Command::Import(args)) => import::import(&args),
        Some(Command::List(args)) => list::list(&args),
        Some(Command::New(args)) => match args.what {
            NewKind::Sketch => sketch::begin(
                &args.folder,
                args.board.unwrap_or_default(),
                args.like.as_deref(),
            ),
            NewKind::Robot => new_robot::begin(&args),
        },
        Some(Command::Completions(args)) => manual::completions(&args),
        Some(Command::Manual(args)) => manual::manual(&args),
        Some(Command::Lab(mut args)) => lab::lab(&mut args),
        Some(Command::Connect(args)) => connect::connect(&args),
        Some(Command::Flash(args)) => flash::flash(&args),
        Some(Command::Run(mut args)) => {
            let scenario = args.scenarios.first().map(String::as_str);
            args.image
                .compile(args.setting.robot.as_deref(), scenario)?;
            run::run(&args)
        }
        Some(Command::Debug(args)) => debug::debug(&args),
        Some(Command::Sweep(mut args)) => {
            let robot = args.setting.robot.as_deref();
            args.image.compile(robot, Some(&args.scenario))?;
            sweep::sweep(&args)
        }
        Some(Command::Tune(args)) => tune::tune(&args),
        Some(Command::Experiments(mut args)) => {
            args.image.compile(args.robot.as_deref(), None)?;
            experiments::experiments(&args)
        }
        Some(Command::Check(args)) => check::check(&args),
        Some(Command::Grade(args)) => grade::grade(&args),
        Some(Command::Replay(args)) => replay::replay(&args),
        Some(Command::Export(args)) => export::export(&args),
        Some(Command::Explain(args)) => explain::explain(&args),
        Some(Command::ExportPolicy(args)) => export_policy::export_policy(&args),
        Some(Command::Compare(args)) => compare::compare(&args),
        Some(Command::Rerun(args)) => rerun::rerun(&args),
        Some(Command::Identify(args)) => identify::identify(&args),
        Some(Command::Calibrate(args)) => calibrate::calibrate(&args),
        Some(Command::Prune(args)) => logs::prune(&args),
        None => {
            let mut args = cli.lab;
            lab::lab(&mut args)
        }
    }
}
