//! What a text of the report has places for: values, tables and figures of the runs, by their names.

use crate::content::{ContentError, Source};
use crate::text::{Language, Text};
use crate::words::words;
use std::collections::{BTreeMap, BTreeSet};

/// What fills a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Words or a number: `{{name}}` anywhere in a text.
    Value(String),
    /// HTML, such as a table: `{{name}}` alone in its paragraph.
    Block(String),
    /// SVG: `![caption](run:name)` alone in its paragraph.
    Figure(String),
    /// Nothing, in this run: the paragraph is left out.
    Nothing,
}

/// The places of a text, and which of its sections are shown.
#[derive(Debug)]
pub(crate) struct Places {
    pub(crate) language: Language,
    named: BTreeMap<String, Place>,
    sections: BTreeMap<String, bool>,
}

impl Places {
    pub(crate) fn new(language: Language) -> Self {
        Self {
            language,
            named: BTreeMap::new(),
            sections: BTreeMap::new(),
        }
    }

    /// A text of the content with its words at their places; these places come first. A word is one line, so lines
    /// keep their numbers.
    pub(crate) fn source(&self, name: &str) -> Result<Source, ContentError> {
        let Source { file, text } = Source::text(self.language, name)?;
        let words = words(self.language)?;
        let mut pieces = text.split("{{");
        let mut filled = pieces.next().unwrap_or_default().to_owned();
        for piece in pieces {
            let word = piece
                .split_once("}}")
                .filter(|(name, _)| self.get(name).is_none())
                .and_then(|(name, rest)| Some([words.get(name)?, rest]));
            filled += &match word {
                Some(word) => word.concat(),
                None => format!("{{{{{piece}"),
            };
        }
        Ok(Source {
            file,
            text: filled.into(),
        })
    }

    /// A text in the language of these places.
    pub(crate) fn text(&self, text: Text) -> &'static str {
        text.of(self.language)
    }

    pub(crate) fn value(&mut self, name: &str, value: impl Into<String>) {
        self.named.insert(name.into(), Place::Value(value.into()));
    }

    pub(crate) fn block(&mut self, name: &str, html: impl Into<String>) {
        self.named.insert(name.into(), Place::Block(html.into()));
    }

    /// A figure; none in a run that has nothing to show there.
    pub(crate) fn figure(&mut self, name: &str, svg: Option<String>) {
        let place = svg.map_or(Place::Nothing, Place::Figure);
        self.named.insert(name.into(), place);
    }

    /// A place that this run leaves empty.
    pub(crate) fn nothing(&mut self, name: &str) {
        self.named.insert(name.into(), Place::Nothing);
    }

    /// Whether sections `## Title {.name}` are shown.
    pub(crate) fn section(&mut self, name: &str, shown: bool) {
        self.sections.insert(name.into(), shown);
    }

    pub(crate) fn get(&self, name: &str) -> Option<&Place> {
        self.named.get(name)
    }

    pub(crate) fn shown(&self, section: &str) -> Option<bool> {
        self.sections.get(section).copied()
    }

    /// A name that a text has used none of.
    pub(crate) fn left<'a>(&'a self, used: &BTreeSet<String>) -> Option<&'a str> {
        let mut left = self.named.keys().filter(|name| !used.contains(*name));
        left.next().map(String::as_str)
    }

    /// All names, for a message.
    pub(crate) fn names(&self) -> String {
        let names: Vec<&str> = self.named.keys().map(String::as_str).collect();
        names.join(", ")
    }
}
