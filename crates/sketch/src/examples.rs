//! Sketches that come with us: examples by name, and the starter of `rumbo new sketch`.

use crate::board::Board;
use crate::error::SketchError;
use crate::source::Source;
use rust_embed::RustEmbed;
use std::collections::BTreeSet;

#[derive(RustEmbed)]
#[folder = "../../examples/arduino"]
struct Examples;

/// Names of the examples, in order, with the first line of each.
#[must_use]
pub fn examples() -> Vec<(String, String)> {
    let first_line = |name: &str| {
        let text = Examples::get(&format!("{name}/{name}.ino"))?;
        let text = String::from_utf8_lossy(&text.data).into_owned();
        Some(
            text.lines()
                .next()?
                .trim_start_matches(['/', ' '])
                .to_owned(),
        )
    };
    let names: BTreeSet<String> = Examples::iter()
        .filter_map(|file| Some(file.split_once('/')?.0.to_owned()))
        .collect();
    let named = names.into_iter();
    named
        .filter_map(|name| Some((name.clone(), first_line(&name)?)))
        .collect()
}

fn unknown(name: &str) -> SketchError {
    let known = examples().into_iter().map(|(name, _)| name);
    SketchError::NoExample(name.to_owned(), known.collect())
}

/// An example by its name.
///
/// # Errors
/// There is none.
pub fn example(name: &str) -> Result<Source, SketchError> {
    let prefix = format!("{name}/");
    let files = Examples::iter().filter_map(|file| {
        let inner = file.strip_prefix(&prefix)?.to_owned();
        if inner.ends_with(".md") {
            return None;
        }
        Some((inner, Examples::get(&file)?.data.into_owned()))
    });
    let source = Source {
        name: name.to_owned(),
        files: files.collect(),
    };
    match source.files.is_empty() {
        true => Err(unknown(name)),
        false => Ok(source),
    }
}

/// The text of a new sketch: forty lines that drive to a wall, with the wiring.
///
/// # Errors
/// None: it is part of the program.
pub fn starter(board: Board) -> Result<String, SketchError> {
    let name = match board.name {
        "uno" => "wall_uno",
        _ => "wall",
    };
    let file = format!("{name}/{name}.ino");
    let embedded = Examples::get(&file).ok_or_else(|| unknown(name))?;
    Ok(String::from_utf8_lossy(&embedded.data).into_owned())
}
