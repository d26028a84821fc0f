//! Installed libraries, as the Arduino IDE finds them: by the headers that they have, whatever their folders are called.
//!
//! A library with `library.properties` and `src/` has its headers there, and all below `src/` is compiled; any other has
//! them in its own folder, of which and of `utility/` the files are compiled. Of several with a header the one is taken
//! that says it is for the chip, then whose folder is called like it, else begins so, else the first.

use crate::error::SketchError;
use crate::source::ending;
use std::fs;
use std::path::{Path, PathBuf};

/// Most files of a library, and folders below each other.
const MOST_FILES: usize = 5_000;
const DEEPEST: usize = 10;
/// Libraries of other chips say so.
const ARCHITECTURE: &str = "avr";

/// A library that a sketch needs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Library {
    /// Where its headers are looked for; the first has that which was asked for.
    pub(crate) include: Vec<PathBuf>,
    /// What is in them.
    pub(crate) files: Vec<PathBuf>,
}

impl Library {
    /// One whose headers are in a folder, with what is below it if `recursive`, else with its `utility`.
    pub(crate) fn of(folder: PathBuf, recursive: bool) -> Result<Self, SketchError> {
        let mut files = Vec::new();
        let utility = folder.join("utility");
        collect(&folder, if recursive { DEEPEST } else { 0 }, &mut files)?;
        let mut include = vec![folder];
        if !recursive && utility.is_dir() {
            collect(&utility, 0, &mut files)?;
            include.push(utility);
        }
        files.sort();
        Ok(Self { include, files })
    }
}

/// A file of a library or of the core.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, SketchError> {
    fs::read(path).map_err(|error| SketchError::file(path, error))
}

/// The library in one of these folders that has a header; `None` if there is none.
pub(crate) fn find(folders: &[PathBuf], header: &str) -> Result<Option<Library>, SketchError> {
    if !is_header(header) {
        return Ok(None);
    }
    let stem = Path::new(header).file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy().to_lowercase();
    let mut found: Vec<((bool, u8), PathBuf, bool)> = Vec::new();
    for folder in folders {
        let Ok(entries) = fs::read_dir(folder) else {
            continue;
        };
        let mut inside: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        inside.sort();
        for library in inside {
            let (include, recursive) = layout(&library);
            if !include.join(header).is_file() {
                continue;
            }
            let name = library.file_name().unwrap_or_default();
            let name = name.to_string_lossy().to_lowercase();
            let rank = match name == stem {
                true => 0,
                false if name.starts_with(&stem) => 1,
                false => 2,
            };
            // One that names other chips is taken where nothing else has the header.
            found.push(((!is_for_avr(&library), rank), include, recursive));
        }
    }
    // The first of the best: folders come in their order.
    let best = found.into_iter().min_by_key(|(rank, ..)| *rank);
    best.map(|(_, include, recursive)| Library::of(include, recursive))
        .transpose()
}

/// How a library in one of these folders spells a header.
pub(crate) fn spelled_in(folders: &[PathBuf], header: &str) -> Option<String> {
    let libraries = folders
        .iter()
        .filter_map(|folder| fs::read_dir(folder).ok());
    let mut libraries = libraries.flat_map(|entries| entries.flatten());
    libraries.find_map(|library| spelled(&layout(&library.path()).0, header))
}

/// How a folder spells a header, with other capitals.
pub(crate) fn spelled(folder: &Path, header: &str) -> Option<String> {
    let entries = fs::read_dir(folder).ok()?.flatten();
    let mut names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    names.find(|name| name.eq_ignore_ascii_case(header))
}

/// Where a library has its headers, and whether all below is its.
fn layout(library: &Path) -> (PathBuf, bool) {
    let src = library.join("src");
    match library.join("library.properties").is_file() && src.is_dir() {
        true => (src, true),
        false => (library.to_owned(), false),
    }
}

fn is_for_avr(library: &Path) -> bool {
    let properties = fs::read_to_string(library.join("library.properties")).unwrap_or_default();
    let wanted = properties
        .lines()
        .find_map(|line| line.trim().strip_prefix("architectures="));
    wanted.is_none_or(|wanted| {
        let mut each = wanted.split(',').map(str::trim);
        each.any(|one| one.is_empty() || one == "*" || one == ARCHITECTURE)
    })
}

/// Whether an include may name a library's header: a file below a folder, and nothing that leads elsewhere.
fn is_header(header: &str) -> bool {
    let is_part = |part: &str| {
        !part.is_empty()
            && !part.starts_with('.')
            && part
                .chars()
                .all(|c| c.is_alphanumeric() || "_-+. ".contains(c))
    };
    ending(Path::new(header)).is_some_and(|own| own.starts_with('h'))
        && header.split('/').all(is_part)
}

/// The files in a folder, and so many folders deep.
fn collect(folder: &Path, deep: usize, files: &mut Vec<PathBuf>) -> Result<(), SketchError> {
    let entries = fs::read_dir(folder).map_err(|error| SketchError::file(folder, error))?;
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_file() {
            files.push(path);
        } else if deep > 0 && path.is_dir() {
            collect(&path, deep - 1, files)?;
        }
        if files.len() > MOST_FILES {
            return Err(SketchError::Refused(format!(
                "{}: a library of more than {MOST_FILES} files",
                folder.display()
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_is_found_by_its_header_for_its_chip_by_the_nearest_name() {
        let root = tempfile::tempdir().unwrap();
        for (file, text) in [
            ("Steering/SteerControl.h", ""),
            ("Steering/SteerControl.cpp", ""),
            ("Steering/utility/twi.c", ""),
            ("Steering/library.properties", "architectures=avr, sam\n"),
            ("Horn/src/Horn.h", ""),
            ("Horn/src/avr/Horn.cpp", ""),
            ("Horn/library.properties", "name=Horn\narchitectures=*\n"),
            ("AnotherHorn/Horn.h", ""),
            ("Radio/Radio.h", ""),
            ("Radio/library.properties", "architectures=esp32\n"),
        ] {
            let path = root.path().join(file);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        let folders = [root.path().to_owned(), root.path().join("none")];
        let found = |header| find(&folders, header).unwrap();
        let steering = found("SteerControl.h").unwrap();
        assert_eq!((steering.include.len(), steering.files.len()), (2, 4));
        let horn = found("Horn.h").unwrap();
        assert_eq!(horn.include, [root.path().join("Horn/src")]);
        assert!(horn.files.iter().any(|file| file.ends_with("avr/Horn.cpp")));
        assert!(
            found("Radio.h").is_some(),
            "for another chip, and the only one"
        );
        for strange in ["../Horn/src/Horn.h", "/etc/x.h", "Horn.cpp", "", "Horn/"] {
            assert_eq!(found(strange), None, "{strange}");
        }
    }
}
