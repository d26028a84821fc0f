//! Finds and compiles the hand-ins.

use crate::failure::Failure;
use rayon::prelude::*;
use rumbo_experiment::files::firmware;
use rumbo_experiment::grade::HandIn;
use rumbo_experiment::note::Note;
use rumbo_sketch::archive::{Bounds, unpack};
use rumbo_sketch::similar::text_of;
use rumbo_sketch::{Compiler, Given, SketchError, given};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Most lines kept of a compiler's output.
const MOST_LINES: usize = 60;
/// Most hand-ins of a class.
const MOST: usize = 10_000;

/// A hand-in as found.
pub(super) struct Found {
    name: String,
    is_late: bool,
    given: Result<Given, SketchError>,
}

/// All that was found in a folder or an archive.
pub(super) struct Class {
    /// The hand-ins, in the order of their names.
    pub(super) found: Vec<Found>,
    /// Names of what is none.
    pub(super) others: Vec<String>,
    /// Archives are unpacked here, as long as it is looked at.
    _unpacked: Option<TempDir>,
}

impl Found {
    pub(super) fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn is_sketch(&self) -> bool {
        matches!(self.given, Ok(Given::Sketch(_)))
    }

    /// Its text, if it is a sketch.
    pub(super) fn text(&self) -> Option<String> {
        match &self.given {
            Ok(Given::Sketch(source)) => Some(text_of(source)),
            _ => None,
        }
    }
}

/// A folder that is one hand-in, whatever its name.
pub(super) fn only(folder: &Path) -> Found {
    Found {
        name: super::name_of(folder),
        is_late: false,
        given: given(folder, false),
    }
}

/// The hand-ins in a folder or an archive of a class, each a folder, a file or an archive. A file, or a folder that is
/// itself a sketch, is the only one.
pub(super) fn find(folder: &Path) -> Result<Class, Failure> {
    let wrong = |error: std::io::Error| {
        Failure::Input(format!(
            "{}: {error}; give the folder with the hand-ins",
            folder.display()
        ))
    };
    let about = fs::metadata(folder).map_err(wrong)?;
    let own = folder.canonicalize().map_err(wrong)?;
    let name = stem(&own);
    if !is_archive(&own) && (about.is_file() || own.join(format!("{name}.ino")).is_file()) {
        return Ok(Class {
            found: vec![Found { name, ..only(&own) }],
            others: Vec::new(),
            _unpacked: None,
        });
    }
    let (mut unpacked, mut others) = (None, Vec::new());
    let inside = match is_archive(&own) {
        true => {
            let place = tempfile::tempdir().map_err(wrong)?;
            let whole = place.path().join("class");
            others.extend(unpack(&own, &whole, Bounds::CLASS)?);
            unpacked = Some(place);
            only_folder(whole)
        }
        false => own,
    };
    let entries = fs::read_dir(&inside).map_err(wrong)?.flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    paths.sort_by_cached_key(|path| (sorted_as(&super::name_of(path)), path.clone()));
    let (paths, more): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| is_hand_in(path));
    let hidden = |path: &Path| super::name_of(path).starts_with('.') || path.ends_with("__MACOSX");
    // Hidden files of other programs are nobody's hand-in.
    let (paths, own): (Vec<_>, Vec<_>) = paths.into_iter().partition(|path| !hidden(path));
    let more = more.into_iter().filter(|path| !hidden(path)).chain(own);
    others.extend(more.map(|path| super::name_of(&path)));
    let problem = match paths.len() {
        0 => "no hand-ins; each is a folder with a sketch, an .ino, an .elf, a .hex, or a .zip of these".into(),
        1..=MOST => String::new(),
        count => format!("{count} hand-ins; at most {MOST} are graded at a time"),
    };
    if !problem.is_empty() {
        return Err(Failure::Input(format!("{}: {problem}", folder.display())));
    }
    if unpacked.is_none() && paths.iter().any(|path| is_archive(path)) {
        unpacked = Some(tempfile::tempdir().map_err(wrong)?);
    }
    let place = unpacked.as_ref().map(tempfile::TempDir::path);
    Ok(Class {
        found: hand_ins(&paths, place),
        others,
        _unpacked: unpacked,
    })
}

/// The hand-ins at these paths, a person's second one with its number; archives are unpacked at this place.
fn hand_ins(paths: &[PathBuf], place: Option<&Path>) -> Vec<Found> {
    let mut tries: BTreeMap<String, usize> = BTreeMap::new();
    let each = (0..).zip(paths).map(|(number, path)| {
        let (person, is_late) = person(&stem(path));
        let tried = tries.entry(person.clone()).or_default();
        *tried += 1;
        let place = place.filter(|_| is_archive(path));
        Found {
            name: match tried {
                1 => person,
                tried => format!("{person} ({tried})"),
            },
            is_late,
            given: match place {
                Some(place) => of_archive(path, &place.join(format!("{number}"))),
                None => given(path, false),
            },
        }
    });
    each.collect()
}

/// What is in a person's archive. Of a sketch, which is read then, nothing stays unpacked.
fn of_archive(archive: &Path, place: &Path) -> Result<Given, SketchError> {
    let found = unpack(archive, place, Bounds::SKETCH).and_then(|left_out| {
        // macOS puts its own folder beside the other one.
        let _ = fs::remove_dir_all(place.join("__MACOSX"));
        let found = given(&only_folder(place.to_owned()), false);
        found.map_err(|error| match left_out.first() {
            None => error,
            Some(name) => SketchError::Refused(format!(
                "{}: `{name}` is left out: a link, a name that leads out of the archive, or another file's; the rest is \
                 no sketch",
                super::name_of(archive)
            )),
        })
    });
    if !matches!(found, Ok(Given::Image(_))) {
        let _ = fs::remove_dir_all(place);
    }
    found
}

/// The one folder in a folder, if nothing else is there, or the folder.
fn only_folder(folder: PathBuf) -> PathBuf {
    let inside = fs::read_dir(&folder).into_iter().flatten().flatten();
    let inside: Vec<PathBuf> = inside.map(|entry| entry.path()).collect();
    match &inside[..] {
        [only] if only.is_dir() => only.clone(),
        _ => folder,
    }
}

/// The person that a hand-in is of, and whether its name says that it is late: Moodle's `Ana Paz_123_assignsubmission_file`,
/// Canvas's `pazana_LATE_123_456_sketch`; any other name is the person's.
fn person(name: &str) -> (String, bool) {
    let parts: Vec<&str> = name.split('_').collect();
    let is_number =
        |part: &&str| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit());
    let moodle = parts.iter().position(|part| *part == "assignsubmission");
    let late = parts.iter().position(|part| *part == "LATE");
    let end = match (moodle, late) {
        (Some(at), _) if at > 1 && is_number(&parts[at - 1]) => at - 1,
        (_, Some(at)) if at > 0 => at,
        _ => match parts.windows(2).position(|pair| pair.iter().all(is_number)) {
            Some(at) if at > 0 && at + 2 < parts.len() => at,
            _ => parts.len(),
        },
    };
    (parts[..end].join("_"), late.is_some_and(|at| at > 0))
}

fn is_archive(path: &Path) -> bool {
    path.is_file()
        && path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("zip"))
}

/// A folder or a file that may be one; not a link, which may lead anywhere.
fn is_hand_in(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    fs::symlink_metadata(path).is_ok_and(|about| {
        about.is_dir()
            || about.is_file()
                && (matches!(ending, Some("ino" | "elf" | "hex")) || is_archive(path))
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

/// As people look names up: whatever their capitals and accents, which macOS writes as characters of their own.
fn sorted_as(name: &str) -> String {
    const LETTERS: [(&str, char); 8] = [
        ("àáâãäå", 'a'),
        ("ç", 'c'),
        ("èéêë", 'e'),
        ("ìíîï", 'i'),
        ("ñ", 'n'),
        ("òóôõöø", 'o'),
        ("ùúûü", 'u'),
        ("ýÿ", 'y'),
    ];
    let plain = |c: char| {
        let of_it = LETTERS
            .iter()
            .find(|(with_accents, _)| with_accents.contains(c));
        of_it.map_or(c, |(_, letter)| *letter)
    };
    let is_accent = |c: &char| ('\u{300}'..='\u{36f}').contains(c);
    let letters = name.to_lowercase();
    letters
        .chars()
        .filter(|c| !is_accent(c))
        .map(plain)
        .collect()
}

/// The image of each of them, or why there is none.
pub(super) fn compile(
    found: &[Found],
    compiler: Option<&Compiler>,
    goes_on: impl Fn() -> bool + Sync,
) -> Option<Vec<HandIn>> {
    found
        .par_iter()
        .map(|one| {
            let program = image(one, compiler);
            if one.is_sketch() && !goes_on() {
                return None;
            }
            let mut notes = Vec::new();
            if matches!(one.given, Ok(Given::Image(_))) {
                notes.push(Note::HandedInAsImage {});
            }
            if one.is_late {
                notes.push(Note::HandedInLate {});
            }
            Some(HandIn {
                name: one.name.clone(),
                program,
                notes,
            })
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
            "no sketch here: hand in a folder with one .ino, the .elf or .hex of it, or a .zip of these".into()
        }
        SketchError::File { reason, .. } => format!("it cannot be read: {reason}"),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::{person, sorted_as};

    #[test]
    fn names_stand_as_people_look_them_up() {
        let mut names = ["Zoe", "ana", "E\u{301}va", "José", "Joan", "Ángel", "Eva B"];
        names.sort_by_cached_key(|name| sorted_as(name));
        assert_eq!(
            names,
            ["ana", "Ángel", "E\u{301}va", "Eva B", "Joan", "José", "Zoe"]
        );
    }

    #[test]
    fn names_of_hand_ins_are_those_of_their_people() {
        for (name, of, late) in [
            ("Ana Paz_4711_assignsubmission_file", "Ana Paz", false),
            ("Ana Paz_4711_assignsubmission_file_", "Ana Paz", false),
            ("pazana_LATE_4711_815_sketch", "pazana", true),
            ("pazana_4711_815_wall_2", "pazana", false),
            ("ana_paz", "ana_paz", false),
            ("group_12", "group_12", false),
            ("LATE_bird", "LATE_bird", false),
            ("submission_4711", "submission_4711", false),
        ] {
            assert_eq!(person(name), (of.to_owned(), late), "{name}");
        }
    }
}
