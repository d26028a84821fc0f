//! Writes the figures and tables of docs/theory: `cargo xtask figures`.
//!
//! ```text
//! pages ──► runs (20 seeds of each program) ──► plot (SVG in docs/img/theory/) and table (Markdown between markers)
//! ```
//!
//! Beside them it writes the page's table of signals. The text of a page between `<!-- figures:NAME -->` and
//! `<!-- /figures -->` is replaced. The same sources give the same bytes: `--check` writes nothing and lists what is out
//! of date.

#![allow(missing_docs)]

mod pages;
mod runs;
mod signals;
mod table;

use std::fs;
use std::path::Path;
use std::process::ExitCode;

/// Folder of the figures, relative to the root and to a page.
const FOLDER: &str = "docs/img/theory";
const FROM_PAGE: &str = "../img/theory";
/// The same relative to a page of docs/ itself, whose name begins with `../`.
const FROM_ABOVE: &str = "img/theory";

/// The expected content of a file.
struct File {
    path: String,
    text: String,
}

pub(crate) fn main() -> ExitCode {
    let args: Vec<String> = crate::arguments().collect();
    let check = args.iter().any(|arg| arg == "--check");
    let only: Vec<&str> = args
        .iter()
        .map(String::as_str)
        .filter(|arg| *arg != "--check")
        .collect();
    // The figures belong to the checkout that this program was built from.
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    crate::ended(
        "figures",
        files(root, &only).and_then(|files| settle(root, &files, check)),
    )
}

/// All figures, and the pages with their new sections; those of `only`, if it names any.
fn files(root: &Path, only: &[&str]) -> Result<Vec<File>, String> {
    let mut files = Vec::new();
    if only.is_empty() || only.contains(&signals::NAME) {
        files.push(signals::file());
    }
    for page in pages::PAGES {
        if !only.is_empty() && !only.contains(&page.name) {
            continue;
        }
        let Some(made) = (page.make)()? else {
            println!("{}: its scenarios do not exist yet", page.name);
            continue;
        };
        let folder = match page.file.strip_prefix("../") {
            Some(_) => FROM_ABOVE,
            None => FROM_PAGE,
        };
        let mut section = String::new();
        for (name, alt, svg) in made.figures {
            section += &format!("![{alt}]({folder}/{name}.svg)\n\n");
            files.push(File {
                path: format!("{FOLDER}/{name}.svg"),
                text: svg,
            });
        }
        section += &made.words;
        let path = match page.file.strip_prefix("../") {
            Some(file) => format!("docs/{file}"),
            None => format!("docs/theory/{}", page.file),
        };
        let page_text = match files.iter().position(|file| file.path == path) {
            Some(index) => files.remove(index).text,
            None => read(root, &path)?,
        };
        let text = replace(&page_text, page.name, &section).ok_or_else(|| {
            format!(
                "{path}: has no <!-- figures:{} --> … <!-- /figures -->",
                page.name
            )
        })?;
        files.push(File { path, text });
    }
    Ok(files)
}

/// The text with the section between the page's markers replaced.
fn replace(text: &str, name: &str, section: &str) -> Option<String> {
    let begin = format!("<!-- figures:{name} -->\n");
    let start = text.find(&begin)? + begin.len();
    let end = start + text[start..].find("<!-- /figures -->")?;
    Some(format!(
        "{}\n{}\n\n{}",
        &text[..start],
        section.trim_end(),
        &text[end..]
    ))
}

fn read(root: &Path, path: &str) -> Result<String, String> {
    fs::read_to_string(root.join(path)).map_err(|error| format!("{path}: {error}"))
}

/// Writes what differs, or only lists it. False if something differs and is not written.
fn settle(root: &Path, files: &[File], check: bool) -> Result<bool, String> {
    let mut up_to_date = true;
    for File { path, text } in files {
        if read(root, path).is_ok_and(|old| old == *text) {
            continue;
        }
        if check {
            println!("{path}: out of date; run `cargo xtask figures`");
            up_to_date = false;
            continue;
        }
        let place = root.join(path);
        let folder = place.parent().unwrap_or(root);
        fs::create_dir_all(folder)
            .and_then(|()| fs::write(&place, text))
            .map_err(|error| format!("{path}: {error}"))?;
        println!("{path}: written");
    }
    Ok(up_to_date || !check)
}
