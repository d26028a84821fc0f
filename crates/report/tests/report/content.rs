//! The content's files: both languages alike, every word and drawing used, none missing.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

const LANGUAGES: [&str; 2] = ["en", "es"];

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Path and text of the files below a folder whose names end so.
fn files(name: &str, ending: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut folders = vec![folder(name)];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.to_string_lossy().ends_with(ending) {
                let text = fs::read_to_string(&path).unwrap();
                found.push((path, text));
            }
        }
    }
    found.sort();
    found
}

/// What stands between each `open` and the next `close`, with its line.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<(usize, &'a str)> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices(open) {
        let rest = &text[at + open.len()..];
        if let Some(end) = rest.find(close) {
            found.push((1 + text[..at].matches('\n').count(), &rest[..end]));
        }
    }
    found
}

/// The words of a language, each with its line and the places in it.
fn words(language: &str) -> BTreeMap<String, (usize, Vec<String>)> {
    let text = fs::read_to_string(folder(&format!("content/{language}/words.md"))).unwrap();
    let entries = text.split("\n- `").skip(1);
    let mut line = 1 + text.split("\n- `").next().unwrap().matches('\n').count();
    let mut words = BTreeMap::new();
    for entry in entries {
        line += 1;
        let (name, rest) = entry.split_once("`: ").unwrap();
        let rest = rest.split("\n\n").next().unwrap();
        let mut places: Vec<_> = between(rest, "{{", "}}")
            .into_iter()
            .map(|(_, name)| name.to_owned())
            .collect();
        places.sort();
        words.insert(name.to_owned(), (line, places));
        line += entry.matches('\n').count();
    }
    words
}

/// Texts of a language but its words, and the program's own English messages.
fn texts(language: &str) -> Vec<(PathBuf, String)> {
    let mut texts = files(&format!("content/{language}"), ".md");
    texts.retain(|(path, _)| !path.ends_with("words.md") && !path.ends_with("messages.md"));
    texts
}

#[test]
fn both_languages_have_the_same_words_with_the_same_places() {
    let [english, spanish] = LANGUAGES.map(words);
    for (language, one, other) in [("en", &english, &spanish), ("es", &spanish, &english)] {
        for (name, (line, places)) in one {
            let found = other.get(name).map(|(_, places)| places);
            assert_eq!(
                found,
                Some(places),
                "content/{language}/words.md:{line}: `{name}` is not the same in the other language"
            );
        }
    }
}

#[test]
fn every_word_that_is_used_exists_and_every_word_is_used() {
    let known = words("en");
    let mut used = BTreeSet::new();
    for (path, text) in files("src", ".rs") {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for (line, name) in between(code, "word(\"", "\")") {
            let documented = name == "name";
            assert!(
                documented || known.contains_key(name),
                "{}:{line}: content/en/words.md lacks `{name}`",
                path.display()
            );
            used.insert(name.to_owned());
        }
    }
    for (_, text) in texts("en")
        .into_iter()
        .chain(files("content/drawings", ".svg"))
    {
        used.extend(
            between(&text, "{{", "}}")
                .into_iter()
                .map(|(_, name)| name.to_owned()),
        );
    }
    for (name, (line, _)) in &known {
        assert!(
            used.contains(name),
            "content/en/words.md:{line}: nothing uses `{name}`"
        );
    }
}

/// What of a text is the same in every language: levels and conditions of headings, places, figures, kinds of lines.
fn skeleton(text: &str) -> Vec<(usize, String)> {
    let mut parts = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.starts_with('#') {
            let level = line.chars().take_while(|letter| *letter == '#').count();
            let condition = line.split_once(" {").map_or("", |(_, condition)| condition);
            parts.push((index + 1, format!("heading {level} {condition}")));
        }
        if line.starts_with("- ") {
            parts.push((index + 1, "item".into()));
        }
        for (_, figure) in between(line, "](", ")") {
            parts.push((index + 1, format!("figure {figure}")));
        }
    }
    parts
}

#[test]
fn both_languages_have_the_same_texts_headings_and_figures_in_one_order() {
    let [english, spanish] = LANGUAGES.map(texts);
    let names = |texts: &[(PathBuf, String)]| -> Vec<_> {
        texts
            .iter()
            .map(|(path, _)| path.file_name().unwrap().to_owned())
            .collect()
    };
    assert_eq!(names(&english), names(&spanish));
    for ((path, english), (other, spanish)) in english.iter().zip(&spanish) {
        let (english, spanish) = (skeleton(english), skeleton(spanish));
        for ((line, one), (other_line, two)) in english.iter().zip(&spanish) {
            assert_eq!(
                one,
                two,
                "{}:{line} and {}:{other_line}",
                path.display(),
                other.display()
            );
        }
        assert_eq!(english.len(), spanish.len(), "{}", path.display());
    }
}

#[test]
fn both_languages_have_the_same_places_in_each_text() {
    let [english, spanish] = LANGUAGES.map(texts);
    for ((path, english), (other, spanish)) in english.iter().zip(&spanish) {
        let places = |text: &str| -> BTreeMap<String, usize> {
            between(text, "{{", "}}")
                .into_iter()
                .map(|(line, name)| (name.to_owned(), line))
                .collect()
        };
        let (english, spanish) = (places(english), places(spanish));
        for (file, one, in_file, two) in [
            (path, &english, other, &spanish),
            (other, &spanish, path, &english),
        ] {
            for (name, line) in one {
                assert!(
                    two.contains_key(name),
                    "{} lacks {{{{{name}}}}} of {}:{line}",
                    in_file.display(),
                    file.display()
                );
            }
        }
    }
}

#[test]
fn every_drawing_is_shown() {
    let shown: String = texts("en").into_iter().map(|(_, text)| text).collect();
    for (path, _) in files("content/drawings", ".svg") {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(
            shown.contains(&format!("](../drawings/{name})")),
            "{name} is in no text"
        );
    }
}
