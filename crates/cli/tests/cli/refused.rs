//! Wrong input, as `refused/commands.txt` lists it beside the files that it reads.
#![cfg(unix)]

use crate::support::{program, stderr, stdout};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// As a shell does: what is quoted is one word.
fn words(line: &str) -> Vec<&str> {
    let parts = line.split('\'').enumerate();
    let words = parts.flat_map(|(part, text)| match part % 2 {
        0 => text.split_whitespace().collect(),
        _ => vec![text],
    });
    words.collect()
}

#[test]
fn wrong_input_gets_one_line_with_the_remedy_and_status_2() {
    let folder = tempfile::tempdir().unwrap();
    let names = |folder: &Path| -> BTreeSet<_> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name()).collect()
    };
    let given = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/refused");
    for name in names(&given) {
        fs::copy(given.join(&name), folder.path().join(name)).unwrap();
    }
    let listed = fs::read_to_string(given.join("commands.txt")).unwrap();
    let commands: Vec<&str> = listed.split("\n$ rumbo ").skip(1).collect();
    assert!(commands.len() >= 100, "{}", commands.len());
    for command in commands {
        let (line, expected) = command.split_once('\n').unwrap();
        let mut rumbo = program();
        let output = rumbo.current_dir(&folder).args(words(line)).output();
        let output = output.unwrap();
        let said = stderr(&output);
        match expected.trim_end().strip_suffix("...") {
            Some(begin) => assert!(said.starts_with(begin), "{line}: {said}"),
            None => assert_eq!(said.trim_end(), expected.trim_end(), "{line}"),
        }
        assert_eq!(stdout(&output), "", "{line}");
        assert_eq!(output.status.code(), Some(2), "{line}");
    }
    assert_eq!(names(folder.path()), names(&given), "something is written");
}
