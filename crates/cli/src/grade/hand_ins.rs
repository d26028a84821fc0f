//! Finds and compiles the hand-ins.

use crate::failure::Failure;
use rayon::prelude::*;
use rumbo_experiment::files::firmware;
use rumbo_experiment::grade::HandIn;
use rumbo_sketch::similar::text_of;
use rumbo_sketch::{Compiler, Given, SketchError, given};
use std::fs;
use std::path::{Path, PathBuf};

/// Most lines kept of a compiler's output.
const MOST_LINES: usize = 60;
/// Most hand-ins of a class.
const MOST: usize = 10_000;

/// A hand-in as found.
pub(super) struct Found {
    name: String,
    given: Result<Given, SketchError>,
}

impl Found {
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn is_sketch(&self) -> bool {
        self.text().is_some()
    }

    /// Its text, if it is a sketch.
    pub(super) fn text(&self) -> Option<String> {
        match &self.given {
            Ok(Given::Sketch(source)) => Some(text_of(source)),
            _ => None,
        }
    }
}

/// The hand-ins in a folder, each a folder or a file, and the names of what else is there. A file, or a folder that is
/// itself a sketch, is the only one.
pub(super) fn find(folder: &Path) -> Result<(Vec<Found>, Vec<String>), Failure> {
    let wrong = |error: std::io::Error| {
        Failure::Input(format!(
            "{}: {error}; give the folder with the hand-ins",
            folder.display()
        ))
    };
    let about = fs::metadata(folder).map_err(wrong)?;
    let own = folder.canonicalize().map_err(wrong)?;
    let name = stem(&own);
    if about.is_file() || own.join(format!("{name}.ino")).is_file() {
        let given = given(&own, false);
        return Ok((vec![Found { name, given }], Vec::new()));
    }
    let entries = fs::read_dir(folder).map_err(wrong)?.flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    // As people look names up, whatever their capitals.
    paths.sort_by_cached_key(|path| (super::name_of(path).to_lowercase(), path.clone()));
    let (paths, others): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| is_hand_in(path));
    let hidden = |path: &Path| super::name_of(path).starts_with('.');
    // Hidden files of other programs are nobody's hand-in.
    let (paths, more): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| !hidden(path));
    let others = others.into_iter().filter(|path| !hidden(path));
    let others: Vec<PathBuf> = others.chain(more).collect();
    match paths.len() {
        0 => Err(Failure::Input(format!(
            "{}: no hand-ins; each is a folder with a sketch, an .ino, an .elf or a .hex",
            folder.display()
        ))),
        1..=MOST => {
            let found = paths.iter().map(|path| Found {
                name: stem(path),
                given: given(path, false),
            });
            let others = others.iter().map(|path| super::name_of(path));
            Ok((found.collect(), others.collect()))
        }
        count => Err(Failure::Input(format!(
            "{}: {count} hand-ins; at most {MOST} are graded at a time",
            folder.display()
        ))),
    }
}

/// A folder or a file that may be one; not a link, which may lead anywhere.
fn is_hand_in(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    fs::symlink_metadata(path).is_ok_and(|about| {
        about.is_dir() || about.is_file() && matches!(ending, Some("ino" | "elf" | "hex"))
    })
}

/// A file's name without its ending; a folder's name.
fn stem(path: &Path) -> String {
    match path.is_dir() {
        true => super::name_of(path),
        false => path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned())
            .unwrap_or_default(),
    }
}

/// The image of each of them, or why there is none.
pub(super) fn compile(
    found: &[Found],
    compiler: Option<&Compiler>,
    done: impl Fn() + Sync,
) -> Vec<HandIn> {
    found
        .par_iter()
        .map(|one| {
            let program = image(one, compiler);
            if one.is_sketch() {
                done();
            }
            let notes = match one.given {
                Ok(Given::Image(_)) => {
                    vec!["handed in as an image: its compiler is not known".into()]
                }
                _ => Vec::new(),
            };
            HandIn {
                name: one.name.clone(),
                program,
                notes,
            }
        })
        .collect()
}

fn image(found: &Found, compiler: Option<&Compiler>) -> Result<Vec<u8>, Vec<String>> {
    let path = match (&found.given, compiler) {
        (Ok(Given::Image(path)), _) => path.clone(),
        (Ok(Given::Sketch(source)), Some(compiler)) => match compiler.compile(source, &[]) {
            Ok(image) => image.path,
            Err(error) => return Err(lines(&error)),
        },
        (Ok(Given::Sketch(_)), None) => return Err(lines(&SketchError::NoCompiler)),
        (Err(error), _) => return Err(vec![nameless(error)]),
    };
    firmware::bytes(&path).map_err(|_| vec!["no image of a size that a Mega's can have".into()])
}

fn lines(error: &SketchError) -> Vec<String> {
    let text = error.to_string();
    text.lines().take(MOST_LINES).map(str::to_owned).collect()
}

/// The error without the teacher's path.
fn nameless(error: &SketchError) -> String {
    match error {
        SketchError::NoSketch(_) => {
            "no sketch here: hand in a folder with one .ino, or the .elf or .hex of it".into()
        }
        SketchError::File { reason, .. } => format!("it cannot be read: {reason}"),
        other => other.to_string(),
    }
}
