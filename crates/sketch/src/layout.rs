//! Which files of a sketch are its own, where its headers are, and which libraries lie beside it: as the Arduino IDE has
//! it, or PlatformIO.
//!
//! | | own files | headers | libraries |
//! |---|---|---|---|
//! | Arduino | those directly in the folder, and all below `src/` | there | `libraries/NAME/` |
//! | PlatformIO, where no `.ino` lies directly in the folder | below `src/` those of the environment | `src/`, `include/` | `lib/NAME/` |

use crate::platformio::Project;
use crate::source::Source;
use std::collections::BTreeMap;

/// Folders of libraries beside a sketch.
const LIBRARIES: [&str; 2] = ["libraries/", "lib/"];

/// How the files of a sketch lie.
#[derive(Debug)]
pub(crate) struct Layout<'a> {
    /// Where its `.ino` files are; ends with `/`, or is empty.
    pub(crate) main: &'static str,
    /// The folders of its headers.
    pub(crate) headers: &'static [&'static str],
    /// Its own files.
    pub(crate) own: Vec<&'a str>,
    /// The libraries beside it.
    pub(crate) libraries: Vec<Beside<'a>>,
}

/// A library beside a sketch.
#[derive(Debug)]
pub(crate) struct Beside<'a> {
    /// The folder of its headers.
    pub(crate) headers: String,
    /// Its files.
    pub(crate) files: Vec<&'a str>,
}

impl<'a> Layout<'a> {
    pub(crate) fn of(source: &'a Source, project: &Project) -> Self {
        let names = || source.files.keys().map(String::as_str);
        let is_ino = |name: &str| name.ends_with(".ino") || name.ends_with(".pde");
        let is_arduino = names().any(|name| !name.contains('/') && is_ino(name));
        let is_own = |name: &&str| match is_arduino {
            true => !name.contains('/') || name.starts_with("src/"),
            false => name
                .strip_prefix("src/")
                .is_some_and(|name| project.builds(name)),
        };
        let mut roots: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for name in names() {
            let below = LIBRARIES.iter().find_map(|folder| {
                let rest = name.strip_prefix(folder)?;
                Some(folder.len() + rest.find('/')?)
            });
            if let Some(end) = below {
                roots.entry(&name[..end]).or_default().push(name);
            }
        }
        let (main, headers): (_, &[_]) = match is_arduino {
            true => ("", &["."]),
            false => ("src/", &["src", "include"]),
        };
        Self {
            main,
            headers,
            own: names().filter(is_own).collect(),
            libraries: roots
                .into_iter()
                .map(|(root, files)| Beside::of(root, files))
                .collect(),
        }
    }

    /// The library beside the sketch that has a header.
    pub(crate) fn library(&self, header: &str) -> Option<usize> {
        let has = |library: &Beside<'_>| {
            let file = format!("{}/{header}", library.headers);
            library.files.contains(&file.as_str())
        };
        self.libraries.iter().position(has)
    }
}

impl<'a> Beside<'a> {
    fn of(root: &str, files: Vec<&'a str>) -> Self {
        let src = format!("{root}/src/");
        let has_src = files.iter().any(|file| file.starts_with(&src));
        let utility = format!("{root}/utility/");
        let is_compiled = |file: &&str| match has_src {
            true => file.starts_with(&src),
            false => !file[root.len() + 1..].contains('/') || file.starts_with(&utility),
        };
        Self {
            headers: match has_src {
                true => format!("{root}/src"),
                false => root.to_owned(),
            },
            files: files.into_iter().filter(is_compiled).collect(),
        }
    }
}
