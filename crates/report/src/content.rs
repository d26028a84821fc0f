//! The report's content: Markdown texts of both languages and SVG drawings, files of `content/` that are built in.
//!
//! ```text
//! content/en/words.md, content/es/words.md   names of axes, curves, metrics: see `words`
//! content/en/mode1.md, content/es/mode1.md   a chapter: its prose, with places for what the runs gave
//! content/drawings/sonar-timing.svg          a drawing, one for both languages
//! ```
//!
//! What stands in them is wrong or right for every run alike: the tests find a mistake before a reader does.

use crate::language::Language;
use include_dir::{Dir, include_dir};
use std::borrow::Cow;
use thiserror::Error;

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/content");

/// What is wrong in a file of the report's content: which file, which line, what, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}:{line}: {what}")]
pub struct ContentError {
    /// Path from the project's folder.
    pub file: String,
    /// Counted from 1.
    pub line: usize,
    /// What is wrong, and the remedy.
    pub what: String,
}

/// A file of the content.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// Path from the project's folder.
    pub(crate) file: String,
    pub(crate) text: Cow<'static, str>,
}

impl Source {
    /// A text in one language.
    pub(crate) fn text(language: Language, name: &str) -> Result<Self, ContentError> {
        Self::read(&format!("{}/{name}.md", language.tag()))
    }

    /// A drawing: the file of this name.
    pub(crate) fn drawing(name: &str) -> Result<Self, ContentError> {
        Self::read(&format!("drawings/{name}"))
    }

    fn read(path: &str) -> Result<Self, ContentError> {
        let file = format!("crates/report/content/{path}");
        let wrong = |what: &str| ContentError {
            file: file.clone(),
            line: 1,
            what: what.into(),
        };
        let found = FILES.get_file(path);
        let found = found.ok_or_else(|| wrong("there is no such file"))?;
        let text = found.contents_utf8().map(Cow::Borrowed);
        let text = text.ok_or_else(|| wrong("is not UTF-8; save it as UTF-8"))?;
        Ok(Self { file, text })
    }

    /// What is wrong at a byte of the text.
    pub(crate) fn error(&self, at: usize, what: impl Into<String>) -> ContentError {
        let before = self.text.get(..at).unwrap_or_default();
        ContentError {
            file: self.file.clone(),
            line: 1 + before.matches('\n').count(),
            what: what.into(),
        }
    }
}

/// The title of a chapter's text: its first line. The name, where it has none.
pub(crate) fn title(language: Language, name: &str) -> String {
    let source = Source::text(language, name);
    let title = source.ok().and_then(|source| {
        let first = source.text.lines().next()?.strip_prefix("# ")?;
        Some(first.trim().to_owned())
    });
    title.unwrap_or_else(|| name.to_owned())
}
