//! Sketches that come with us: examples by name, and the starter of `rumbo new sketch`.

use crate::error::SketchError;
use crate::source::Source;
use rust_embed::RustEmbed;
use std::collections::BTreeSet;

#[derive(RustEmbed)]
#[folder = "../../examples/arduino"]
struct Examples;

/// The example that a new sketch starts as.
const STARTER: &str = "wall";

/// Names of the examples, in order.
#[must_use]
pub fn example_names() -> Vec<String> {
    let names: BTreeSet<String> = Examples::iter()
        .filter_map(|file| Some(file.split_once('/')?.0.to_owned()))
        .collect();
    names.into_iter().collect()
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
        true => Err(SketchError::NoExample(name.to_owned(), example_names())),
        false => Ok(source),
    }
}

/// The text of a new sketch: twenty lines that drive to a wall, with the wiring.
///
/// # Errors
/// None: it is part of the program.
pub fn starter() -> Result<String, SketchError> {
    let file = format!("{STARTER}/{STARTER}.ino");
    let embedded = Examples::get(&file)
        .ok_or_else(|| SketchError::NoExample(STARTER.into(), example_names()))?;
    Ok(String::from_utf8_lossy(&embedded.data).into_owned())
}
