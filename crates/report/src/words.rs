//! Words of figures, tables and messages: `content/en/words.md` and its Spanish, a line for each.
//!
//! ```text
//! - `time-since-arming`: time since arming (s)
//! ```
//!
//! An indented line continues the one before. Texts of the content and drawings use a word as `{{name}}`, the
//! program as `word("name")`.

use crate::content::{ContentError, Source};
use crate::language::Language;
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// Each word by its name.
pub(crate) type Words = BTreeMap<String, String>;

/// The words of a language.
///
/// # Errors
/// A line that is none of a word, or a name that stands there twice.
pub(crate) fn words(language: Language) -> Result<&'static Words, ContentError> {
    static WORDS: [OnceLock<Result<Words, ContentError>>; 2] = [OnceLock::new(), OnceLock::new()];
    let read = || Source::text(language, "words").and_then(|source| parse(&source));
    WORDS[language as usize]
        .get_or_init(read)
        .as_ref()
        .map_err(Clone::clone)
}

/// Messages of robots and programs, in Spanish: `content/es/messages.md`, in the form of the words.
pub(crate) fn messages() -> Result<&'static Words, ContentError> {
    static MESSAGES: OnceLock<Result<Words, ContentError>> = OnceLock::new();
    let read = || Source::text(Language::Spanish, "messages").and_then(|source| parse(&source));
    MESSAGES.get_or_init(read).as_ref().map_err(Clone::clone)
}

fn parse(source: &Source) -> Result<Words, ContentError> {
    let mut words = Words::new();
    let mut last = None;
    let mut at = 0;
    for line in source.text.split_inclusive('\n') {
        let begin = at;
        at += line.len();
        if let Some(entry) = line.strip_prefix("- ") {
            let parts = entry
                .strip_prefix('`')
                .and_then(|entry| entry.split_once("`: "));
            let Some((name, text)) = parts else {
                return Err(source.error(begin, "is no word; write - `name`: text"));
            };
            if words.insert(name.into(), text.trim().into()).is_some() {
                return Err(source.error(begin, format!("`{name}` stands here twice")));
            }
            last = Some(name);
        } else if line.starts_with("  ") {
            let Some(text) = last.and_then(|name| words.get_mut(name)) else {
                return Err(source.error(begin, "goes on with no word; write - `name`: text"));
            };
            *text += " ";
            *text += line.trim();
        } else {
            last = None;
        }
    }
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Words, ContentError> {
        parse(&Source {
            file: "content/en/words.md".into(),
            text: text.to_owned().into(),
        })
    }

    #[test]
    fn a_word_may_go_on_in_the_next_line() {
        let words = read("# Words\n\n- `a`: one\n- `b`: two,\n  three\n\n## More\n").unwrap();
        assert_eq!(words["a"], "one");
        assert_eq!(words["b"], "two, three");
    }

    #[test]
    fn a_mistake_is_named_with_its_line() {
        for (text, expected) in [
            ("# Words\n\n- a: one\n", "words.md:3: is no word"),
            (
                "- `a`: one\n- `a`: two\n",
                "words.md:2: `a` stands here twice",
            ),
            ("# Words\n  on\n", "words.md:2: goes on with no word"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }
}
