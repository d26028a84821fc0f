//! The README's own commands, run as a reader would type them.
//!
//! Every line of its `sh` blocks is a command: `cargo run --release` and `rumbo lab` must serve the dashboard's page
//! (on a free port, without opening a browser), other `rumbo` commands must succeed, `cargo xtask` commands must be
//! known. A line of any other kind is an error, since nothing would detect that it stops working. Blocks without `sh`
//! are not run: they need a file or a robot of the reader's. README.es.md has the same blocks, so its commands are
//! those.

use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

use crate::lab::Lab;
use crate::markdown::{Block, Markdown};
use crate::project::{Project, shown};
use crate::tools::Stop;

/// Longest time that one command of the README may take.
const LIMIT: Duration = Duration::from_secs(300);

/// The page in English, whose commands are run.
const ENGLISH: &str = "README.md";
/// The page in Spanish, which has the same commands.
const SPANISH: &str = "README.es.md";

/// Runs the commands of `README.md` with the program that the tests built.
pub(crate) fn check(project: &Project) -> Result<(), Stop> {
    run(project, &project.rumbo()?, false)
}

/// The same as a reader would: `cargo run --release` is that, and `rumbo` what it built.
pub(crate) fn check_release(project: &Project) -> Result<(), Stop> {
    run(project, &project.release_binary()?, true)
}

/// The page's server and the exit statuses decide.
fn run(project: &Project, rumbo: &Path, with_cargo: bool) -> Result<(), Stop> {
    let read = |name: &str| {
        std::fs::read_to_string(project.root.join(name)).map_err(|error| format!("{name}: {error}"))
    };
    let text = read(ENGLISH)?;
    if let Some(what) = difference(&text, &read(SPANISH)?) {
        return Err(Stop::Failed(what));
    }
    let commands = commands(&text);
    if !commands.iter().any(|(_, command)| {
        matches!(
            command,
            Command::Lab {
                through_cargo: true,
                ..
            }
        )
    }) {
        return Err(Stop::Failed(
            "README.md: no `cargo run --release` in a `sh` block".to_owned(),
        ));
    }
    let mut wrong = Vec::new();
    for (line, command) in commands {
        println!("README.md:{line}: {command:?}");
        if let Err(error) = try_command(project, rumbo, &command, with_cargo) {
            println!("README.md:{line}: {error}");
            wrong.push(line.to_string());
        }
    }
    if wrong.is_empty() {
        Ok(())
    } else {
        Err(Stop::Failed(format!(
            "README.md, line {}",
            wrong.join(", ")
        )))
    }
}

/// The first command that differs between the pages, of all blocks; comments may.
fn difference(english: &str, spanish: &str) -> Option<String> {
    let [english, spanish] = [english, spanish].map(|page| {
        let blocks = Markdown::parse(page).blocks;
        lines(blocks).collect::<Vec<_>>()
    });
    let shown = |page: &[Line], index: usize| match page.get(index) {
        Some(Line { number, words, .. }) => format!("line {number} is `{}`", words.join(" ")),
        None => "has no further command".to_owned(),
    };
    let meaning = |line: &Line| (line.language.clone(), line.words.clone());
    let count = english.len().max(spanish.len());
    let index = (0..count)
        .find(|&index| english.get(index).map(meaning) != spanish.get(index).map(meaning))?;
    Some(format!(
        "the commands differ: {ENGLISH} {}, {SPANISH} {}; change either, or the language of its block",
        shown(&english, index),
        shown(&spanish, index)
    ))
}

/// The kind of a line of the README.
#[derive(Debug, PartialEq)]
enum Command {
    /// Serves the dashboard.
    Lab {
        through_cargo: bool,
        args: Vec<String>,
    },
    /// Any other `rumbo` command, by its arguments.
    Rumbo(Vec<String>),
    /// A chore, by its arguments.
    Xtask(Vec<String>),
    /// Unknown to this check.
    Unknown(String),
}

/// The commands of the `sh` blocks, with their line.
fn commands(readme: &str) -> Vec<(usize, Command)> {
    lines(Markdown::parse(readme).blocks)
        .filter(|line| line.language == "sh")
        .map(|line| (line.number, classify(&line.words, &line.text)))
        .collect()
}

/// A line of a block that is more than a comment.
struct Line {
    language: String,
    number: usize,
    text: String,
    words: Vec<String>,
}

fn lines(blocks: Vec<Block>) -> impl Iterator<Item = Line> {
    let split = |block: Block| {
        let line = |(offset, text): (usize, &str)| Line {
            language: block.language.clone(),
            number: block.line + offset,
            text: text.to_owned(),
            words: words(text),
        };
        block.text.lines().enumerate().map(line).collect::<Vec<_>>()
    };
    blocks
        .into_iter()
        .flat_map(split)
        .filter(|line| !line.words.is_empty())
}

fn classify(words: &[String], text: &str) -> Command {
    let borrowed: Vec<&str> = words.iter().map(String::as_str).collect();
    let (through_cargo, args) = match borrowed.as_slice() {
        ["cargo", "run", "--release"] => (true, &words[3..]),
        ["cargo", "run", "--release", "--", ..] => (true, &words[4..]),
        ["rumbo", ..] => (false, &words[1..]),
        ["cargo", "xtask", ..] => return Command::Xtask(words[2..].to_vec()),
        _ => return Command::Unknown(text.to_owned()),
    };
    match args.first().map(String::as_str) {
        None | Some("lab") => Command::Lab {
            through_cargo,
            args: args.get(1..).unwrap_or_default().to_vec(),
        },
        Some(_) => Command::Rumbo(args.to_vec()),
    }
}

/// Splits a line as a shell would, as far as the README needs it: spaces, both quotes, and comments.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in line.chars() {
        match (quote, c) {
            (Some(q), c) if c == q => quote = None,
            (None, '\'' | '"') => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (None, '#') if word.is_none() => break,
            (None, c) if c.is_whitespace() => words.extend(word.take()),
            (_, c) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

fn try_command(
    project: &Project,
    rumbo: &Path,
    command: &Command,
    with_cargo: bool,
) -> Result<(), String> {
    match command {
        Command::Lab {
            through_cargo,
            args,
        } => {
            let mut start = if *through_cargo && with_cargo {
                project.cargo(&["run", "--release", "--locked", "--", "lab"])
            } else {
                let mut start = project.command(rumbo);
                start.arg("lab");
                start
            };
            start.args(args);
            let mut lab = Lab::start(start)?;
            let page = lab.page()?;
            if page.to_lowercase().contains("<html") {
                Ok(())
            } else {
                Err("the page is not HTML".to_owned())
            }
        }
        Command::Rumbo(args) => run_limited(project.command(rumbo).args(args)),
        Command::Xtask(args) => {
            let name = args.first().map(String::as_str).unwrap_or_default();
            let known = ["test", "tidy", "bench", "--help"].contains(&name);
            if known {
                Ok(())
            } else {
                Err(format!("there is no `cargo xtask {name}`"))
            }
        }
        Command::Unknown(text) => Err(format!(
            "`{text}` cannot be checked; if it is no command, do not mark the block `sh`"
        )),
    }
}

/// Runs a command with its output shown, but not for ever.
fn run_limited(command: &mut std::process::Command) -> Result<(), String> {
    let name = shown(command);
    let mut child = command
        .stdin(Stdio::null())
        .spawn()
        .map_err(|error| format!("`{name}`: {error}"))?;
    let end = Instant::now() + LIMIT;
    loop {
        match child.try_wait() {
            Ok(Some(status)) if status.success() => return Ok(()),
            Ok(Some(status)) => return Err(format!("`{name}` failed: {status}")),
            Ok(None) if Instant::now() < end => std::thread::sleep(Duration::from_millis(20)),
            Ok(None) => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("`{name}` still ran after {} s", LIMIT.as_secs()));
            }
            Err(error) => return Err(format!("`{name}`: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strings(words: &[&str]) -> Vec<String> {
        words.iter().map(|&word| word.to_owned()).collect()
    }

    #[test]
    fn only_shell_blocks_are_commands_and_they_keep_their_line() {
        let readme = "# R\n\n```text\nrumbo nothing\n```\n\n```sh\n# comment\ncargo run --release\nrumbo run mode1 # why\n```\n";
        let lab = Command::Lab {
            through_cargo: true,
            args: Vec::new(),
        };
        assert_eq!(
            commands(readme),
            [(9, lab), (10, Command::Rumbo(strings(&["run", "mode1"])))]
        );
    }

    #[test]
    fn a_translation_has_the_same_commands_and_comments_of_its_own() {
        let english = "Text\n\n```sh\nrumbo list # all\n```\n\n```text\nrumbo connect PORT\n```\n";
        let spanish = english
            .replace("Text", "Texto\n\nmás")
            .replace("# all", "# todo");
        assert_eq!(difference(english, &spanish), None);
        for (now, then) in [
            ("PORT", "PUERTO"),
            ("```sh", "```text"),
            ("rumbo list", "# nada"),
        ] {
            assert!(
                difference(english, &spanish.replace(now, then)).is_some(),
                "{then}"
            );
        }
        let longer = format!("{spanish}\n```sh\nrumbo run mode1\n```\n");
        let what = difference(english, &longer).unwrap_or_default();
        assert!(
            what.contains(
                "README.md has no further command, README.es.md line 14 is `rumbo run mode1`"
            ),
            "{what}"
        );
    }

    #[test]
    fn quoted_words_stay_together() {
        assert_eq!(
            words("rumbo run --command 'REF 50@5' \"\""),
            strings(&["rumbo", "run", "--command", "REF 50@5", ""])
        );
    }

    #[test]
    fn a_line_that_nothing_checks_is_reported() {
        assert_eq!(
            classify(&words("make it so"), "make it so"),
            Command::Unknown("make it so".to_owned())
        );
    }

    #[test]
    fn the_lab_keeps_its_arguments() {
        let args = strings(&["--scenario", "mode5"]);
        assert_eq!(
            classify(&words("rumbo lab --scenario mode5"), ""),
            Command::Lab {
                through_cargo: false,
                args
            }
        );
    }
}
