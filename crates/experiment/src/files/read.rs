//! Reads a TOML text key by key, collecting every problem with its line instead of stopping at the first.
//!
//! Each loader asks a [`Table`] for the keys it knows, with what is allowed; [`Table::finish`] then reports the
//! remaining keys. A missing or wrong value is recorded and the loader continues with a placeholder, so that one pass
//! reports everything that is wrong; [`Source::verdict`] turns the collection into an error.

use super::error::{About, FileError, FileProblem};
use super::near;
pub(crate) use super::value::{Allowed, Placed};
use super::value::{number_of, shown};
use std::cell::RefCell;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The text of one file and the problems found in it so far.
pub(crate) struct Source<'t> {
    file: String,
    text: &'t str,
    /// Where each line of the text ends.
    line_ends: Vec<usize>,
    problems: RefCell<Vec<FileProblem>>,
}

impl<'t> Source<'t> {
    /// A file, with its name for error messages.
    pub(crate) fn new(file: &str, text: &'t str) -> Self {
        Self {
            file: file.into(),
            text,
            line_ends: text.match_indices('\n').map(|(at, _)| at).collect(),
            problems: RefCell::default(),
        }
    }

    /// The whole file as a table.
    ///
    /// # Errors
    /// A text that is not TOML.
    pub(crate) fn parse(&self) -> Result<Spanned<DeTable<'t>>, FileError> {
        DeTable::parse(self.text).map_err(|error| {
            let line = error.span().map_or(0, |span| self.line_of(span.start));
            let text = format!(
                "not valid TOML: {}{}",
                error.message().trim().replace('\n', "; "),
                self.decimal_comma(line)
            );
            FileError::Invalid(vec![FileProblem {
                file: self.file.clone(),
                line,
                about: About::File,
                text,
            }])
        })
    }

    /// The root of the parsed file.
    pub(crate) fn root<'a>(&'a self, parsed: &'a Spanned<DeTable<'t>>) -> Table<'a, 't> {
        Table {
            source: self,
            path: String::new(),
            line: 0,
            entries: Some(parsed.get_ref()),
            known: RefCell::default(),
        }
    }

    /// Records a problem.
    fn complain(&self, line: usize, about: About, text: &str) {
        self.problems.borrow_mut().push(FileProblem {
            file: self.file.clone(),
            line,
            about,
            text: text.to_owned(),
        });
    }

    /// Nothing if no problem was found.
    ///
    /// # Errors
    /// All problems, in the order of lines.
    pub(crate) fn verdict(self) -> Result<(), FileError> {
        let mut problems = self.problems.into_inner();
        problems.sort_by_key(|problem| problem.line);
        if problems.is_empty() {
            Ok(())
        } else {
            Err(FileError::Invalid(problems))
        }
    }

    /// What to do about a line such as `at_s = 0,5`.
    fn decimal_comma(&self, line: usize) -> &'static str {
        let text = self
            .text
            .lines()
            .nth(line.wrapping_sub(1))
            .unwrap_or_default();
        let value = text.split_once('=').map_or("", |(_, value)| value.trim());
        match value.replacen(',', ".", 1).parse::<f64>() {
            Ok(_) => "; write decimals with a point",
            Err(_) => "",
        }
    }

    fn line_of(&self, offset: usize) -> usize {
        1 + self.line_ends.partition_point(|end| *end < offset)
    }
}

/// One table of a file.
pub(crate) struct Table<'a, 't> {
    source: &'a Source<'t>,
    path: String,
    line: usize,
    /// `None`: the table is missing or was no table, and all its keys count as missing without further problems.
    entries: Option<&'a DeTable<'t>>,
    known: RefCell<Vec<String>>,
}

impl<'a, 't> Table<'a, 't> {
    /// Records a problem with one of its keys: `key = value: remedy`.
    pub(crate) fn complain(&self, key: &str, line: usize, value: &str, remedy: &str) {
        let about = About::Key(self.path_of(key), value.to_owned());
        self.source.complain(line, about, remedy);
    }

    /// Records a problem with the table itself.
    pub(crate) fn complain_here(&self, text: &str) {
        let about = match self.path.is_empty() {
            true => About::File,
            false => About::Table(self.path.clone()),
        };
        self.source.complain(self.line, about, text);
    }

    /// A number, if the key is there.
    pub(crate) fn number(&self, key: &str, allowed: Allowed) -> Option<f64> {
        self.placed_number(key, allowed).map(|placed| placed.value)
    }

    /// A number and its line, if the key is there.
    pub(crate) fn placed_number(&self, key: &str, allowed: Allowed) -> Option<Placed<f64>> {
        let (line, value) = self.value(key)?;
        let value = self.judge_number(key, line, value, allowed)?;
        Some(Placed { value, line })
    }

    /// A required number. A placeholder within the limits where it is missing or wrong.
    pub(crate) fn required_number(&self, key: &str, allowed: Allowed) -> f64 {
        self.require(key, &allowed.remedy());
        self.number(key, allowed).unwrap_or(allowed.min)
    }

    /// Two numbers `[x, y]`, if the key is there.
    pub(crate) fn pair(&self, key: &str, allowed: Allowed) -> Option<[f64; 2]> {
        let (line, value) = self.value(key)?;
        let items: Vec<&DeValue<'t>> = value
            .as_array()
            .map(|array| array.iter().map(|item| item.get_ref()).collect())
            .unwrap_or_default();
        let [first, second] = items[..] else {
            let remedy = format!("must be two numbers [x, y] in {}", allowed.unit);
            self.complain(key, line, &shown(value), &remedy);
            return None;
        };
        Some([
            self.judge_number(key, line, first, allowed)?,
            self.judge_number(key, line, second, allowed)?,
        ])
    }

    /// The items of a list with their lines, and the line of the list, if the key is there.
    pub(crate) fn items(
        &self,
        key: &str,
        what: &str,
    ) -> Option<(usize, Vec<Placed<&'a DeValue<'t>>>)> {
        let (line, value) = self.value(key)?;
        let Some(array) = value.as_array() else {
            self.complain(key, line, &shown(value), &format!("must be {what}"));
            return None;
        };
        let placed = |item: &'a Spanned<DeValue<'t>>| Placed {
            value: item.get_ref(),
            line: self.source.line_of(item.span().start),
        };
        Some((line, array.iter().map(placed).collect()))
    }

    /// Two required numbers.
    pub(crate) fn required_pair(&self, key: &str, allowed: Allowed) -> [f64; 2] {
        self.require(
            key,
            &format!("two numbers [x, y], each {}", allowed.remedy()),
        );
        self.pair(key, allowed).unwrap_or([allowed.min; 2])
    }

    /// A text, if the key is there.
    pub(crate) fn text(&self, key: &str) -> Option<Placed<String>> {
        let (line, value) = self.value(key)?;
        match value.as_str() {
            Some(text) => Some(Placed {
                value: text.to_owned(),
                line,
            }),
            None => {
                self.complain(key, line, &shown(value), "must be text in quotes");
                None
            }
        }
    }

    /// A name in quotes or a whole number, as text, if the key is there.
    pub(crate) fn word(&self, key: &str) -> Option<Placed<String>> {
        let (line, value) = self.value(key)?;
        match value {
            DeValue::String(text) => Some(Placed {
                value: text.as_ref().to_owned(),
                line,
            }),
            DeValue::Integer(integer) => Some(Placed {
                value: integer.as_str().to_owned(),
                line,
            }),
            _ => {
                self.complain(
                    key,
                    line,
                    &shown(value),
                    "must be a name in quotes or a whole number",
                );
                None
            }
        }
    }

    /// A required text; empty where it is missing or wrong.
    pub(crate) fn required_text(&self, key: &str, what: &str) -> Placed<String> {
        self.require(key, what);
        self.text(key).unwrap_or(Placed {
            value: String::new(),
            line: self.line,
        })
    }

    /// `true` or `false`, if the key is there.
    pub(crate) fn flag(&self, key: &str) -> Option<Placed<bool>> {
        let (line, value) = self.value(key)?;
        match value.as_bool() {
            Some(value) => Some(Placed { value, line }),
            None => {
                self.complain(key, line, &shown(value), "must be true or false");
                None
            }
        }
    }

    /// The raw value of a key, with its line; marks the key as known.
    pub(crate) fn value(&self, key: &str) -> Option<(usize, &'a DeValue<'t>)> {
        let mut known = self.known.borrow_mut();
        if known.iter().all(|own| own != key) {
            known.push(key.to_owned());
        }
        let (_, value) = self.entries?.iter().find(|(own, _)| own.get_ref() == key)?;
        Some((self.source.line_of(value.span().start), value.get_ref()))
    }

    /// A table below this one. A missing one is empty, and nothing in it is required.
    pub(crate) fn table(&self, key: &str) -> Table<'a, 't> {
        let found = self.value(key);
        let entries = found.and_then(|(_, value)| value.as_table());
        if let (Some((line, value)), None) = (found, entries) {
            self.complain(key, line, &shown(value), "must be a table");
        }
        self.below(
            self.path_of(key),
            found.map_or(self.line, |(line, _)| line),
            entries,
        )
    }

    /// The tables `[[key]]`, in the order of the file, up to a maximum number.
    pub(crate) fn tables(&self, key: &str, most: usize) -> Vec<Table<'a, 't>> {
        let Some((line, value)) = self.value(key) else {
            return Vec::new();
        };
        let Some(array) = value.as_array() else {
            self.complain(
                key,
                line,
                &shown(value),
                &format!("must be tables [[{key}]]"),
            );
            return Vec::new();
        };
        if array.len() > most {
            let remedy = format!("at most {most} of them are read");
            self.complain(key, line, &format!("{} tables", array.len()), &remedy);
            return Vec::new();
        }
        let mut tables = Vec::new();
        for (index, item) in array.iter().enumerate() {
            let line = self.source.line_of(item.span().start);
            let path = format!("{}[{}]", self.path_of(key), index + 1);
            match item.get_ref().as_table() {
                Some(entries) => tables.push(self.below(path, line, Some(entries))),
                None => {
                    let text = format!("{path}: must be a table [[{key}]]");
                    self.source.complain(line, About::File, &text);
                }
            }
        }
        tables
    }

    /// All keys with their lines, for tables whose keys are names; none of them counts as known yet.
    pub(crate) fn keys(&self) -> Vec<Placed<&'a str>> {
        let mut keys: Vec<Placed<&'a str>> = self
            .entries
            .into_iter()
            .flatten()
            .map(|(key, _)| Placed {
                value: key.get_ref().as_ref(),
                line: self.source.line_of(key.span().start),
            })
            .collect();
        keys.sort_by_key(|key| key.line);
        keys
    }

    /// Whether the file holds this key.
    pub(crate) fn has(&self, key: &str) -> bool {
        self.entries
            .is_some_and(|entries| entries.iter().any(|(own, _)| own.get_ref() == key))
    }

    /// Whether the value of a key is text.
    pub(crate) fn is_text(&self, key: &str) -> bool {
        self.entries.is_some_and(|entries| {
            entries
                .iter()
                .any(|(own, value)| own.get_ref() == key && value.get_ref().is_str())
        })
    }

    /// Whether the value of a key is a table.
    pub(crate) fn holds_table(&self, key: &str) -> bool {
        self.entries.is_some_and(|entries| {
            entries
                .iter()
                .any(|(own, value)| own.get_ref() == key && value.get_ref().is_table())
        })
    }

    /// Reports the unknown keys.
    pub(crate) fn finish(&self) {
        let known = self.known.borrow();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        for key in self.keys() {
            if !known.contains(&key.value) {
                let value = self
                    .entries
                    .and_then(|entries| entries.iter().find(|(own, _)| own.get_ref() == key.value));
                let number = value.and_then(|(_, value)| number_of(value.get_ref()));
                let shown = value
                    .map(|(_, value)| shown(value.get_ref()))
                    .unwrap_or_default();
                let remedy = near::remedy_for_key(key.value, number, &known);
                self.complain(
                    key.value,
                    key.line,
                    &shown,
                    &format!("unknown key; {remedy}"),
                );
            }
        }
    }

    fn below(&self, path: String, line: usize, entries: Option<&'a DeTable<'t>>) -> Table<'a, 't> {
        Table {
            source: self.source,
            path,
            line,
            entries,
            known: RefCell::default(),
        }
    }

    /// Reports a missing key.
    pub(crate) fn require(&self, key: &str, what: &str) {
        if self.has(key) || self.entries.is_none() {
            return;
        }
        let about = About::Missing(self.path_of(key));
        self.source.complain(self.line, about, what);
    }

    /// A value as an allowed number; reports a problem if it is not.
    pub(crate) fn judge_number(
        &self,
        key: &str,
        line: usize,
        value: &DeValue<'_>,
        allowed: Allowed,
    ) -> Option<f64> {
        let Some(number) = number_of(value) else {
            let kind = if allowed.unit.is_empty() {
                String::new()
            } else {
                format!(" in {}", allowed.unit)
            };
            self.complain(
                key,
                line,
                &shown(value),
                &format!("must be a number{kind}, without quotes"),
            );
            return None;
        };
        if allowed.admits(number) {
            return Some(number);
        }
        self.complain(key, line, &shown(value), &allowed.remedy());
        None
    }

    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.into()
        } else {
            format!("{}.{key}", self.path)
        }
    }
}
