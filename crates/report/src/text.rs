//! Texts of the report in both languages: words by their names.

use crate::words::words;
use rumbo_plot::Words;

pub use crate::language::Language;
pub(crate) use rumbo_plot::{escape, put};

/// Label of a panel without values: nothing was in range, or the program does not report it.
const NO_VALUE: Text = word("no-value");

/// A text of figures, tables and messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Text {
    /// A word of the content, by its name.
    Word(&'static str),
    /// What is the same in both languages: names, symbols.
    Same(&'static str),
}

/// The word of this name in `words.md` of both languages.
pub(crate) const fn word(name: &'static str) -> Text {
    Text::Word(name)
}

/// What is the same in both languages.
pub(crate) const fn same(text: &'static str) -> Text {
    Text::Same(text)
}

impl Text {
    /// The text in one language; of a word that is missing its name, which no test lets through.
    #[must_use]
    pub fn of(self, language: Language) -> &'static str {
        match self {
            Self::Same(text) => text,
            Self::Word(name) => words(language)
                .ok()
                .and_then(|words| words.get(name))
                .map_or(name, String::as_str),
        }
    }

    /// The text in one language, with values at its places `{{name}}`.
    pub(crate) fn with(self, language: Language, values: &[(&str, impl AsRef<str>)]) -> String {
        with(self.of(language), values)
    }
}

/// A text with values at its places `{{name}}`.
pub(crate) fn with(text: &str, values: &[(&str, impl AsRef<str>)]) -> String {
    let mut text = text.to_owned();
    for (name, value) in values {
        text = text.replace(&format!("{{{{{name}}}}}"), value.as_ref());
    }
    text
}

/// The text as HTML, with names of the program, which stand between backquotes, as such.
pub(crate) fn quoted(text: &str) -> String {
    let pieces = text.split('`').enumerate();
    let html = pieces.map(|(index, piece)| match index % 2 {
        0 => escape(piece),
        _ => format!("<code translate=\"no\">{}</code>", escape(piece)),
    });
    html.collect()
}

impl From<Language> for Words<'static> {
    fn from(language: Language) -> Self {
        Self {
            comma: language == Language::Spanish,
            no_value: NO_VALUE.of(language),
        }
    }
}

/// A text with a capital letter.
pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

/// A value with its unit.
pub(crate) fn with_unit(value: String, unit: &str) -> String {
    match unit {
        "" => value,
        "°" => format!("{value}°"),
        _ => format!("{value}\u{a0}{unit}"),
    }
}
