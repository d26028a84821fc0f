//! Sketches that come with us: examples by name, and the starter of `rumbo new sketch`.

use crate::board::Board;
use crate::bundled::files_below;
use crate::error::SketchError;
use crate::source::Source;
use include_dir::{Dir, include_dir};
use std::collections::BTreeSet;

static EXAMPLES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../examples/arduino");

/// Names of the examples, in order, with the first line of each.
#[must_use]
pub fn examples() -> Vec<(String, String)> {
    let first_line = |name: &str| {
        let text = EXAMPLES.get_file(format!("{name}/{name}.ino"))?;
        let text = String::from_utf8_lossy(text.contents()).into_owned();
        Some(
            text.lines()
                .next()?
                .trim_start_matches(['/', ' '])
                .to_owned(),
        )
    };
    let folders = EXAMPLES.dirs().filter_map(|folder| folder.path().to_str());
    let names: BTreeSet<String> = folders.map(str::to_owned).collect();
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
    let files = EXAMPLES.get_dir(name).map(files_below).unwrap_or_default();
    let files = files.into_iter().filter(|(file, _)| !file.ends_with(".md"));
    let source = Source {
        name: name.to_owned(),
        files: files.map(|(file, bytes)| (file, bytes.to_vec())).collect(),
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
        "uno" | "nano" => "wall_uno",
        _ => "wall",
    };
    let file = format!("{name}/{name}.ino");
    let embedded = EXAMPLES.get_file(&file).ok_or_else(|| unknown(name))?;
    Ok(String::from_utf8_lossy(embedded.contents()).into_owned())
}
