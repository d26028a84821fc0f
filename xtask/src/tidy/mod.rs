//! `cargo xtask tidy`: the rules that no compiler checks, each with the place and the remedy.
//!
//! [`dependencies`] keeps the diagram of ARCHITECTURE.md true, [`circles`] that modules of a crate depend one way,
//! [`ceilings`] that the house does not grow by itself, [`source`] guarantees of the crates' code, [`documents`] links and numbering, [`presence`] required files. Rules are
//! functions of a [`Tree`], so that they can be tested on small made-up trees.

pub(crate) mod ceilings;
mod circles;
mod dependencies;
mod documents;
mod presence;
mod source;

use std::collections::BTreeMap;
use std::fmt;

pub(crate) use documents::{broken_links, resolve};

use crate::project::{Project, metadata};

/// The project's files by path relative to the root, with `/` between folders; no text for binary files.
pub(crate) struct Tree {
    files: BTreeMap<String, Option<String>>,
}

impl Tree {
    pub(crate) fn read(project: &Project) -> Result<Self, String> {
        let mut files = BTreeMap::new();
        for path in project.files()? {
            let bytes = std::fs::read(project.root.join(&path))
                .map_err(|error| format!("{}: {error}", path.display()))?;
            files.insert(
                path.to_string_lossy().replace('\\', "/"),
                String::from_utf8(bytes).ok(),
            );
        }
        Ok(Self { files })
    }

    /// The text files whose path satisfies `wanted`, in order of their paths.
    pub(crate) fn texts(
        &self,
        wanted: impl Fn(&str) -> bool,
    ) -> impl Iterator<Item = (&str, &str)> {
        let texts = self
            .files
            .iter()
            .filter_map(|(path, text)| Some((path.as_str(), text.as_deref()?)));
        texts.filter(move |(path, _)| wanted(path))
    }

    fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path)?.as_deref()
    }

    fn has_file(&self, path: &str) -> bool {
        self.files.contains_key(path)
    }

    fn has_folder(&self, path: &str) -> bool {
        let prefix = format!("{}/", path.trim_end_matches('/'));
        self.files
            .range(prefix.clone()..)
            .next()
            .is_some_and(|(first, _)| first.starts_with(&prefix))
    }

    /// A made-up tree for tests.
    #[cfg(test)]
    fn of(files: &[(&str, &str)]) -> Self {
        Self {
            files: files
                .iter()
                .map(|(path, text)| ((*path).to_owned(), Some((*text).to_owned())))
                .collect(),
        }
    }
}

/// A broken rule.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Finding {
    path: String,
    line: usize,
    /// The problem, and the remedy.
    text: String,
    /// Does not fail the check.
    hint: bool,
}

impl Finding {
    fn error(path: &str, line: usize, text: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            line,
            text: text.into(),
            hint: false,
        }
    }

    fn hint(path: &str, line: usize, text: impl Into<String>) -> Self {
        Self {
            hint: true,
            ..Self::error(path, line, text)
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let hint = if self.hint { "hint: " } else { "" };
        write!(f, "{}:{}: {hint}{}", self.path, self.line, self.text)
    }
}

/// Checks every rule and prints what is found; true if nothing but hints.
pub(crate) fn run(project: &Project) -> Result<bool, String> {
    let tree = Tree::read(project)?;
    let mut findings = dependencies::check(&project.metadata);
    // Workspaces of their own.
    for other in ["firmware/Cargo.toml", "ros/Cargo.toml"] {
        let manifest = project.root.join(other);
        if manifest.is_file() {
            findings.extend(dependencies::check(&metadata(&manifest)?));
        }
    }
    for rule in [
        source::check,
        documents::check,
        presence::check,
        circles::check,
    ] {
        findings.extend(rule(&tree));
    }
    findings.extend(ceilings::check(project, &tree)?);
    findings.sort_by(|a, b| (a.hint, &a.path, a.line).cmp(&(b.hint, &b.path, b.line)));
    for finding in &findings {
        println!("{finding}");
    }
    let errors = findings.iter().filter(|finding| !finding.hint).count();
    println!(
        "tidy: {} files, {errors} errors, {} hints",
        tree.files.len(),
        findings.len() - errors
    );
    Ok(errors == 0)
}
