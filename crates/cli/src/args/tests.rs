use super::Cli;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use std::path::{Path, PathBuf};

#[test]
fn the_version_is_that_of_the_rumbo_command() {
    let version = concat!("rumbo ", env!("CARGO_PKG_VERSION"), "\n");
    assert_eq!(Cli::command().render_version(), version);
}

#[test]
fn no_mark_of_the_source_is_in_the_help() {
    let mut command = Cli::command();
    for subcommand in command.get_subcommands_mut() {
        let help = subcommand.render_long_help().to_string();
        for mark in ["\\[", "\\]", "\\\\"] {
            assert!(!help.contains(mark), "{}: {mark}", subcommand.get_name());
        }
    }
}

#[test]
fn every_example_of_the_help_is_a_valid_command() {
    let mut command = Cli::command();
    let helps: Vec<String> = command
        .get_subcommands_mut()
        .map(|subcommand| subcommand.render_help().to_string())
        .chain([Cli::command().render_help().to_string()])
        .collect();
    let mut seen = 0;
    for help in helps {
        let (_, examples) = help.split_once("Examples:").unwrap();
        for example in examples
            .lines()
            .map(str::trim)
            .filter(|line| line.starts_with("rumbo"))
        {
            // A description may follow, set off by blanks.
            let line = example.split_once("  ").map_or(example, |(line, _)| line);
            let words = words(line);
            Cli::try_parse_from(words).unwrap_or_else(|error| panic!("{line}: {error}"));
            seen += 1;
        }
    }
    assert!(seen > 10);
}

/// As a shell does: what is quoted is one word, and a comment none.
fn words(line: &str) -> Vec<&str> {
    let line = line.split_once(" #").map_or(line, |(line, _)| line);
    let parts = line.split('\'').enumerate();
    let words = parts.flat_map(|(part, text)| match part % 2 {
        0 => text.split_whitespace().collect(),
        _ => vec![text],
    });
    words.collect()
}

/// The Markdown files of the project's documents, with their paths.
fn documents() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders = vec![root.join("docs"), root.join("examples")];
    let mut files = Vec::new();
    let root_files = std::fs::read_dir(&root).unwrap();
    files.extend(root_files.map(|entry| entry.unwrap().path()));
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => folders.push(path),
                false => files.push(path),
            }
        }
    }
    files.retain(|path| path.extension().is_some_and(|ending| ending == "md"));
    let read = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        (path, text)
    };
    files.into_iter().map(read).collect()
}

#[test]
fn every_command_in_a_block_of_the_documents_is_valid() {
    let mut seen = 0;
    for (path, text) in documents() {
        let joined = text.replace("\\\n", " ");
        let mut in_block = false;
        for line in joined.lines().map(str::trim) {
            in_block ^= line.starts_with("```");
            if !in_block || !line.starts_with("rumbo ") {
                continue;
            }
            let place = path.display();
            if let Err(error) = Cli::try_parse_from(words(line)) {
                panic!("{place}: {line}: {error}");
            }
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen}");
}

#[test]
fn every_command_in_the_sentences_of_the_documents_has_known_words() {
    let mut seen = 0;
    for (path, text) in documents() {
        // A change of that time may be of a command that is gone.
        if path.ends_with("CHANGELOG.md") {
            continue;
        }
        for rest in text.split("`rumbo ").skip(1) {
            let line = format!("rumbo {}", rest.split('`').next().unwrap());
            // What is left out or stands for something is the reader's.
            let known = Cli::try_parse_from(words(&line)).map_err(|error| error.kind());
            let unknown = [ErrorKind::InvalidSubcommand, ErrorKind::UnknownArgument];
            let place = path.display();
            assert!(
                !known.is_err_and(|kind| unknown.contains(&kind)),
                "{place}: {line}"
            );
            seen += 1;
        }
    }
    assert!(seen > 60, "{seen}");
}
