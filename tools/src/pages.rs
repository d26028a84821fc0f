//! Build products that the tools use, and pages of the project with generated tables.

use rumbo_experiment::files::FileError;
use std::path::{Path, PathBuf};

/// A file beside the folder that this program was built into: of `target/debug/NAME`, `target/FILE`.
pub(crate) fn built(file: &str) -> PathBuf {
    let here = std::env::current_exe().unwrap_or_default();
    let target = here.ancestors().nth(2).map(PathBuf::from);
    target.unwrap_or_default().join(file)
}

/// Replaces the text between `<!-- NAME -->` and `<!-- /NAME -->` of a page; its path is relative to the root.
///
/// # Errors
/// The page cannot be read or written, or has no such markers.
pub(crate) fn write(page: &str, name: &str, text: &str) -> Result<(), FileError> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(page);
    let error = |what: String| FileError::Setting(format!("{page}: {what}"));
    let old = std::fs::read_to_string(&path).map_err(|source| error(source.to_string()))?;
    let (begin, end) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
    let parts = old.split_once(&begin).and_then(|(before, rest)| {
        let (_, after) = rest.split_once(&end)?;
        Some((before, after))
    });
    let (before, after) = parts.ok_or_else(|| error(format!("has no {begin}")))?;
    let new = format!("{before}{begin}\n{}\n\n{end}{after}", text.trim_end());
    std::fs::write(&path, new).map_err(|source| error(source.to_string()))
}

/// Writes a figure of docs/theory.
///
/// # Errors
/// It cannot be written.
pub(crate) fn write_figure(name: &str, svg: &str) -> Result<(), FileError> {
    let path = format!("docs/img/theory/{name}.svg");
    let whole = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/..")).join(&path);
    std::fs::write(whole, svg)
        .map_err(|error| FileError::Setting(format!("{path}: cannot be written ({error})")))
}
