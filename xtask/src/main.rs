//! The project's chores, run as `cargo xtask <command>`.
//!
//! [`test`] is everything that must hold before a change is merged, [`tidy`] the rules that no compiler checks,
//! [`bench`] the measured figures of docs/figures.md, [`campaign`] the requirements over thousands of seeds,
//! [`sketches`] the images that tests and examples run, [`figures`] the figures and tables of docs/theory, [`fuzz`] the
//! fuzz targets. Each prints what it does; none needs anything but cargo to start.

use std::io::Write as _;
use std::process::ExitCode;

mod bench;
mod campaign;
mod cost;
mod deny;
mod fidelity;
mod figures;
mod firmware;
mod fuzz;
mod gradescope;
mod lab;
mod markdown;
mod memoria;
mod project;
mod release;
mod site;
mod sketches;
mod test;
mod tidy;
mod tools;

use project::Project;

const HELP: &str = include_str!("../help.txt");

/// The command line.
#[derive(Debug, PartialEq)]
enum Request {
    Help(Option<String>),
    Run(Task),
}

/// Commands without options.
const WHOLE: [&str; 5] = ["firmware", "release", "site", "sketches", "tidy"];

#[derive(Debug, Default, PartialEq)]
struct Task {
    command: String,
    only: Vec<String>,
    seeds: Option<u32>,
    seconds: Option<u32>,
    full: bool,
}

fn main() -> ExitCode {
    let task = match parse(lexopt::Parser::from_env()) {
        Ok(Request::Run(task)) => task,
        Ok(Request::Help(command)) => {
            // A reader that has seen enough, as `head`, is no error.
            let _ = writeln!(std::io::stdout(), "{}", help(command.as_deref()));
            return ExitCode::SUCCESS;
        }
        Err(error) => return usage(&error.to_string()),
    };
    let Task {
        command,
        only,
        seeds,
        seconds,
        full,
    } = task;
    let project = match Project::find() {
        Ok(project) => Project { full, ..project },
        Err(error) => return failure(&error),
    };
    if seeds.is_some() && !matches!(command.as_str(), "campaign" | "fidelity" | "memoria") {
        return usage("--seeds is for campaign, fidelity and memoria");
    }
    if full && command != "test" {
        return usage("--full is for test");
    }
    if seconds.is_some() && command != "fuzz" {
        return usage("--seconds is for fuzz");
    }
    if !only.is_empty() && WHOLE.contains(&command.as_str()) {
        return usage(&format!("{command} takes no options"));
    }
    let outcome = match command.as_str() {
        "test" => test::run(&project, &only),
        "tidy" => tidy::run(&project),
        "bench" => bench::run(&project, &only),
        "campaign" => campaign::run(&project, seeds, &only),
        "fuzz" => fuzz::campaign(&project, seconds, &only),
        "figures" => figures::run(&project, &only),
        "fidelity" => fidelity::run(&project, seeds, &only),
        "memoria" => memoria::run(&project, seeds, &only),
        "firmware" => firmware::run(&project),
        "site" => site::run(&project),
        "release" => release::run(&project),
        "sketches" => sketches::run(&project),
        other => return usage(&format!("unknown command `{other}`")),
    };
    match outcome {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => failure(&error),
    }
}

fn parse(mut args: lexopt::Parser) -> Result<Request, lexopt::Error> {
    use lexopt::prelude::{Long, Short, Value, ValueExt};
    let (mut task, mut help) = (Task::default(), false);
    while let Some(arg) = args.next()? {
        match arg {
            Long("full") => task.full = true,
            Long("help") | Short('h') => help = true,
            Long("seeds") => task.seeds = Some(args.value()?.parse()?),
            Long("seconds") => task.seconds = Some(args.value()?.parse()?),
            Long("only") => task.only.push(args.value()?.string()?),
            Value(value) if task.command.is_empty() => task.command = value.string()?,
            _ => return Err(arg.unexpected()),
        }
    }
    let Task { command, .. } = &task;
    Ok(match help || command.is_empty() {
        true => Request::Help((!command.is_empty()).then(|| command.clone())),
        false => Request::Run(task),
    })
}

fn help(command: Option<&str>) -> String {
    match command {
        Some("test") => test::help(),
        Some("bench") => bench::help(),
        _ => HELP.trim_end().to_owned(),
    }
}

fn usage(error: &str) -> ExitCode {
    eprintln!("xtask: {error}; see `cargo xtask --help`");
    ExitCode::from(2)
}

fn failure(error: &str) -> ExitCode {
    eprintln!("xtask: {error}");
    ExitCode::FAILURE
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request(args: &[&str]) -> Result<Request, String> {
        parse(lexopt::Parser::from_args(args)).map_err(|error| error.to_string())
    }

    #[test]
    fn several_steps_may_be_chosen() {
        let chosen = request(&["test", "--only", "fmt", "--only=clippy"]);
        let only = vec!["fmt".to_owned(), "clippy".to_owned()];
        assert_eq!(
            chosen,
            Ok(Request::Run(Task {
                command: "test".to_owned(),
                only,
                ..Task::default()
            }))
        );
    }

    #[test]
    fn a_campaign_may_have_fewer_seeds() {
        let chosen = request(&["campaign", "--seeds", "50"]);
        assert_eq!(
            chosen,
            Ok(Request::Run(Task {
                command: "campaign".to_owned(),
                seeds: Some(50),
                ..Task::default()
            }))
        );
        assert!(request(&["campaign", "--seeds", "many"]).is_err());
    }

    #[test]
    fn no_command_and_the_help_flag_ask_for_help() {
        assert_eq!(request(&[]), Ok(Request::Help(None)));
        assert_eq!(
            request(&["bench", "-h"]),
            Ok(Request::Help(Some("bench".to_owned())))
        );
    }

    #[test]
    fn an_unknown_option_is_an_error() {
        assert!(request(&["test", "--fast"]).is_err_and(|error| error.contains("--fast")));
    }

    #[test]
    fn every_command_of_the_documents_is_known() {
        let tree = tidy::Tree::read(&Project::find().unwrap()).unwrap();
        let mut seen = 0;
        for (path, text) in tree.texts(|path| path.ends_with(".md") && path != "CHANGELOG.md") {
            for (at, name) in text.match_indices("cargo xtask ") {
                // Between backquotes it may go on in the next line; in a block it ends with the line, or before a comment.
                let ends: &[char] = match text[..at].ends_with('\n') {
                    true => &['`', '#', '\n'],
                    false => &['`', '#'],
                };
                let words = text[at + name.len()..].split(ends).next().unwrap();
                let found = request(&words.split_whitespace().collect::<Vec<_>>());
                let Ok(Request::Run(Task { command, .. })) = &found else {
                    assert!(matches!(found, Ok(Request::Help(_))), "{path}: {words}");
                    continue;
                };
                let known = HELP.contains(&format!("\n  {command} "));
                // In a sentence it stands for any of them.
                assert!(
                    known || command == "<command>",
                    "{path}: cargo xtask {words}"
                );
                seen += 1;
            }
        }
        assert!(seen > 40, "{seen}");
    }
}
