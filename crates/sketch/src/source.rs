//! The files of a sketch, read into memory with bounds on all of them.
//!
//! What is compiled is a copy: links are followed by nobody, so that a sketch cannot make us read what is not its own.

use crate::error::SketchError;
use crate::product::open_regular;
use std::collections::BTreeMap;
use std::fs;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

/// Largest sketch [bytes].
const MOST_BYTES: u64 = 8 << 20;
/// Files and folders looked at.
const MOST_FILES: usize = 2_000;
/// Longest path of a file in a sketch [characters].
const LONGEST: usize = 200;
/// Depth of folders below the sketch's own.
const DEEPEST: usize = 6;
/// Of a path with nothing at it.
const NOWHERE: &str = "no such file or folder; `rumbo new sketch NAME` begins a sketch, and example:NAME takes an example";
/// The file of a PlatformIO project, in its folder.
pub(crate) const PROJECT: &str = "platformio.ini";
/// What a compiler reads, and what else may be included.
const KINDS: [&str; 14] = [
    "ino", "pde", "c", "cpp", "cc", "cxx", "h", "hpp", "hh", "hxx", "inc", "ipp", "tpp", "S",
];

/// What somebody gave as their program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Given {
    /// A sketch, to be compiled.
    Sketch(Source),
    /// An image that is compiled already.
    Image(PathBuf),
}

/// The files of a sketch by their path in its folder, with `/` between folders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The sketch's name.
    pub name: String,
    /// What is in its files.
    pub files: BTreeMap<String, Vec<u8>>,
}

impl Source {
    /// Whether all files have names that a sketch's can have: no part of a name leads anywhere or ends a string in C.
    pub(crate) fn check(&self) -> Result<(), SketchError> {
        match self.files.keys().find(|name| !is_name(name)) {
            None => Ok(()),
            Some(name) => Err(SketchError::Refused(format!(
                "{}: a sketch has no file of this name; take letters, digits, spaces and _ - + . ( ), with a letter, \
                 a digit or _ first, at most {LONGEST} characters, and one of the endings {}",
                name.chars()
                    .take(LONGEST)
                    .collect::<String>()
                    .escape_debug(),
                KINDS.join(", ")
            ))),
        }
    }
}

/// Whether a file of a sketch may be named so.
fn is_name(path: &str) -> bool {
    let is_part = |part: &str| {
        part.starts_with(|c: char| c.is_alphanumeric() || c == '_')
            && part
                .chars()
                .all(|c| c.is_alphanumeric() || " _-+.()".contains(c))
    };
    path.chars().count() <= LONGEST
        && path.split('/').count() <= DEEPEST + 1
        && path.split('/').all(is_part)
        && is_taken(path)
}

/// Whether a file belongs to a sketch, by its path there.
fn is_taken(path: &str) -> bool {
    path == PROJECT || ending(Path::new(path)).is_some_and(|own| KINDS.contains(&own))
}

/// What is at a path: a folder with a sketch or an image, an `.ino`, an `.elf` or a `.hex`. The `.ino` of a folder of
/// the same name stands for the folder if `folder_of_ino`, as in the Arduino IDE; else it is a sketch by itself.
///
/// # Errors
/// Nothing of the kind is there, or more than a sketch can be.
pub fn given(path: &Path, folder_of_ino: bool) -> Result<Given, SketchError> {
    let about = fs::metadata(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => SketchError::file(path, NOWHERE),
        _ => SketchError::file(path, error),
    })?;
    let stem = |path: &Path| {
        path.file_stem()
            .map(|stem| stem.to_string_lossy().into_owned())
            .unwrap_or_default()
    };
    if about.is_dir() {
        return of_folder(path);
    }
    match ending(path) {
        Some("elf" | "hex") if about.is_file() => Ok(Given::Image(path.to_owned())),
        Some("ino" | "pde") if about.is_file() => {
            let own = path.canonicalize().ok();
            let parent = own.as_deref().and_then(Path::parent);
            match parent.filter(|parent| folder_of_ino && stem(parent) == stem(path)) {
                Some(folder) => of_folder(folder),
                None => {
                    let name = path.file_name().unwrap_or_default().to_string_lossy();
                    let (own, mut left) = (own.as_deref().unwrap_or(path), MOST_BYTES);
                    Ok(Given::Sketch(Source {
                        name: stem(path),
                        files: [(name.to_string(), read(own, &name, &mut left)?)].into(),
                    }))
                }
            }
        }
        _ => Err(SketchError::NoSketch(path.display().to_string())),
    }
}

/// The sketch or the image in a folder, or in the one folder in it that has any.
fn of_folder(folder: &Path) -> Result<Given, SketchError> {
    if let Some(found) = directly_in(folder)? {
        return Ok(found);
    }
    let mut found = Vec::new();
    for inner in entries(folder)? {
        if fs::symlink_metadata(&inner).is_ok_and(|about| about.is_dir()) && holds_any(&inner)? {
            found.push(inner);
        }
    }
    let only = match &found[..] {
        [only] => directly_in(only)?,
        _ => None,
    };
    only.ok_or_else(|| SketchError::NoSketch(folder.display().to_string()))
}

/// The files directly in a folder that a sketch begins with, and the images.
fn beginnings(folder: &Path) -> Result<(Vec<PathBuf>, Vec<PathBuf>), SketchError> {
    let is = |path: &Path, kinds: &[&str]| {
        ending(path).is_some_and(|own| kinds.contains(&own))
            && !is_hidden(path)
            && fs::symlink_metadata(path).is_ok_and(|about| about.is_file())
    };
    let mut inside = entries(folder)?;
    inside.retain(|path| is(path, &["ino", "pde", "elf", "hex"]));
    Ok(inside
        .into_iter()
        .partition(|path| is(path, &["ino", "pde"])))
}

fn holds_any(folder: &Path) -> Result<bool, SketchError> {
    let (sketches, images) = beginnings(folder)?;
    Ok(!sketches.is_empty() || is_platformio(folder) || images.len() == 1)
}

/// A project of PlatformIO: its sketch is in `src`.
fn is_platformio(folder: &Path) -> bool {
    let is = |name: &str, what: fn(&fs::Metadata) -> bool| {
        fs::symlink_metadata(folder.join(name)).is_ok_and(|about| what(&about))
    };
    is(PROJECT, fs::Metadata::is_file) && is("src", fs::Metadata::is_dir)
}

fn directly_in(folder: &Path) -> Result<Option<Given>, SketchError> {
    let (sketches, mut images) = beginnings(folder)?;
    if sketches.is_empty() && !is_platformio(folder) {
        return Ok(match images.len() {
            1 => images.pop().map(Given::Image),
            _ => None,
        });
    }
    let mut source = Source {
        name: name_of(folder),
        files: BTreeMap::new(),
    };
    let (mut left, mut seen) = (MOST_BYTES, 0);
    collect(folder, "", 0, &mut source, &mut left, &mut seen)?;
    Ok(Some(Given::Sketch(source)))
}

/// The name of a folder, whatever way it was written.
fn name_of(folder: &Path) -> String {
    let own = folder.canonicalize();
    let own = own.as_deref().unwrap_or(folder);
    own.file_name().map_or_else(
        || "sketch".into(),
        |name| name.to_string_lossy().into_owned(),
    )
}

fn collect(
    folder: &Path,
    prefix: &str,
    depth: usize,
    source: &mut Source,
    left: &mut u64,
    seen: &mut usize,
) -> Result<(), SketchError> {
    for path in entries(folder)? {
        *seen += 1;
        if *seen > MOST_FILES || depth > DEEPEST {
            return Err(too_many());
        }
        let Ok(about) = fs::symlink_metadata(&path) else {
            continue;
        };
        // As the Arduino IDE has it; macOS puts a `._NAME` beside a file.
        if is_hidden(&path) {
            continue;
        }
        // A name that is no text gets a character that no name may have.
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let inner = format!("{prefix}{name}");
        if about.is_dir() {
            collect(&path, &format!("{inner}/"), depth + 1, source, left, seen)?;
        } else if about.is_file() && is_taken(&inner) {
            let bytes = read(&path, &inner, left)?;
            source.files.insert(inner, bytes);
        }
    }
    Ok(())
}

fn too_many() -> SketchError {
    SketchError::Refused(format!(
        "more than {MOST_FILES} files in a folder of the sketch or in all, or folders more than {DEEPEST} deep"
    ))
}

fn is_hidden(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.as_encoded_bytes().starts_with(b".")
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, SketchError> {
    let entries = fs::read_dir(folder).map_err(|error| SketchError::file(folder, error))?;
    let entries = entries.flatten().take(MOST_FILES + 1);
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    if paths.len() > MOST_FILES {
        return Err(too_many());
    }
    paths.sort();
    Ok(paths)
}

/// Reads a file of a sketch; `name` is its name there.
fn read(path: &Path, name: &str, left: &mut u64) -> Result<Vec<u8>, SketchError> {
    let wrong = |error| SketchError::file(path, error);
    let mut bytes = Vec::new();
    let file = open_regular(path).map_err(wrong)?;
    file.take(*left + 1)
        .read_to_end(&mut bytes)
        .map_err(wrong)?;
    *left = left.checked_sub(bytes.len() as u64).ok_or_else(|| {
        SketchError::Refused(format!(
            "{}: the sketch has more than {} MB",
            name.escape_debug(),
            MOST_BYTES >> 20
        ))
    })?;
    // Headers of other programs may be; they lie there and are not included.
    let is_utf_16 = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    if is_utf_16 && matches!(ending(path), Some("ino" | "pde")) {
        return Err(SketchError::Refused(format!(
            "{}: is text in UTF-16, which no compiler reads; save it as UTF-8",
            name.escape_debug()
        )));
    }
    Ok(bytes)
}

/// Whether a file is, by its ending, one that a sketch is made of, or an image.
#[must_use]
pub fn is_program(path: &Path) -> bool {
    ending(path).is_some_and(|own| KINDS.contains(&own) || ["elf", "hex"].contains(&own))
}

/// The ending of a file's name.
pub(crate) fn ending(path: &Path) -> Option<&str> {
    path.extension().and_then(|ending| ending.to_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    fn names(given: &Given) -> Vec<&str> {
        match given {
            Given::Sketch(source) => source.files.keys().map(String::as_str).collect(),
            Given::Image(path) => vec![path.file_name().unwrap().to_str().unwrap()],
        }
    }

    #[test]
    fn a_folder_is_read_with_what_is_below_it_and_an_archive_s_extra_folder_is_seen_through() {
        let files = [
            ("wall/wall.ino", "a"),
            ("wall/pid.h", "b"),
            ("wall/src/x/y.cpp", "c"),
            ("wall/notes.pdf", "d"),
        ];
        let folder = folder(&files);
        let expected = ["pid.h", "src/x/y.cpp", "wall.ino"];
        assert_eq!(names(&given(folder.path(), true).unwrap()), expected);
        let inner = folder.path().join("wall");
        assert_eq!(names(&given(&inner, true).unwrap()), expected);
        let ino = inner.join("wall.ino");
        assert_eq!(names(&given(&ino, true).unwrap()), expected);
        assert_eq!(names(&given(&ino, false).unwrap()), ["wall.ino"]);
    }

    #[test]
    fn a_project_of_platformio_is_a_sketch() {
        let folder = folder(&[
            ("platformio.ini", ""),
            ("src/main.cpp", "x"),
            ("lib/A/A.h", ""),
        ]);
        let expected = ["lib/A/A.h", "platformio.ini", "src/main.cpp"];
        assert_eq!(names(&given(folder.path(), true).unwrap()), expected);
    }

    #[test]
    fn a_sketch_in_utf_16_is_refused_and_a_header_in_it_is_not_looked_at() {
        let folder = folder(&[("a.ino", "")]);
        fs::write(folder.path().join("resource.h"), b"\xFF\xFE/\0").unwrap();
        assert!(given(folder.path(), true).is_ok());
        fs::write(folder.path().join("a.ino"), b"\xFF\xFE/\0").unwrap();
        let refused = given(folder.path(), true).unwrap_err().to_string();
        assert!(refused.contains("save it as UTF-8"), "{refused}");
    }

    #[test]
    fn an_image_is_taken_where_there_is_no_sketch() {
        let folder = folder(&[("a.elf", "x"), ("readme.txt", "")]);
        assert_eq!(names(&given(folder.path(), true).unwrap()), ["a.elf"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        let folder = folder(&[("a.ino", "x")]);
        for name in ["secret.h", "b.ino"] {
            std::os::unix::fs::symlink("/etc/passwd", folder.path().join(name)).unwrap();
        }
        std::os::unix::fs::symlink("/etc", folder.path().join("etc")).unwrap();
        assert_eq!(names(&given(folder.path(), true).unwrap()), ["a.ino"]);
    }

    #[test]
    fn more_than_a_sketch_can_be_is_refused() {
        let folder = folder(&[("a.ino", "x")]);
        fs::write(folder.path().join("b.h"), vec![b' '; MOST_BYTES as usize]).unwrap();
        let error = given(folder.path(), true).unwrap_err().to_string();
        assert!(error.contains("more than 8 MB"), "{error}");
    }
}
