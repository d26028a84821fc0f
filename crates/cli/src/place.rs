//! Writing of results. A file is written completely or not at all: first beside its destination, under a unique name,
//! and then moved there.
//!
//! No result destroys data: a command never writes to its inputs, and an existing file is replaced only if it carries
//! the [`Mark`] of the same run or report, or with `--force`; what a program is made of never. [`Guard`] checks before
//! anything runs.

use crate::failure::Failure;
use crate::mark::Mark;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Makes a folder, unless it exists.
pub(crate) fn folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))
}

/// Checks that a folder is writable, before the work instead of after it.
pub(crate) fn try_folder(place: &Path) -> Result<(), Failure> {
    folder(place)?;
    let probe = place.join(format!(".rumbo-{}", std::process::id()));
    std::fs::write(&probe, "rumbo")
        .and_then(|()| std::fs::remove_file(&probe))
        .map_err(|error| unwritable(place, &error))
}

/// Checks that a file can be made, before the work instead of after it.
pub(crate) fn try_file(path: &Path) -> Result<(), Failure> {
    let made = match path.symlink_metadata() {
        Ok(_) if path.is_dir() => Err(ErrorKind::IsADirectory.into()),
        Ok(_) => Ok(()),
        Err(_) => std::fs::File::create_new(path).and_then(|_| std::fs::remove_file(path)),
    };
    made.map_err(|error| unwritable(path, &error))
}

/// Protection against overwriting.
pub(crate) struct Guard {
    inputs: Vec<PathBuf>,
    force: bool,
}

impl Guard {
    /// Of a command that reads these files, names of built-in ones among them.
    pub(crate) fn new<P: Into<PathBuf>>(inputs: impl IntoIterator<Item = P>, force: bool) -> Self {
        let inputs = inputs.into_iter().map(Into::into);
        Self {
            inputs: inputs.collect(),
            force,
        }
    }

    /// Whether a file may be written.
    pub(crate) fn check(&self, path: &Path, mark: &Mark) -> Result<(), Failure> {
        self.check_own(path, mark.is_on(path))
    }

    /// The same of a file of which something else says whether it is an older result of the same.
    pub(crate) fn check_own(&self, path: &Path, is_own: bool) -> Result<(), Failure> {
        self.keeps_inputs(path)?;
        match self.force || !path.is_file() || is_own {
            true => Ok(()),
            false => Err(is_another(path)),
        }
    }

    /// The same of a file whose contents alone tell what it is: it is made, and replaces only its equal.
    pub(crate) fn make_equal(
        &self,
        path: &Path,
        make: impl FnOnce(&Path) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        self.keeps_inputs(path)?;
        self::make(path, |place| {
            make(place)?;
            let differs = || std::fs::read(place).ok() != std::fs::read(path).ok();
            match self.force || place == path || !path.is_file() || !differs() {
                true => Ok(()),
                false => Err(is_another(path)),
            }
        })
    }

    fn keeps_inputs(&self, path: &Path) -> Result<(), Failure> {
        // Both are opened for that, and to open a pipe may wait for ever.
        let is_there = path.symlink_metadata().is_ok();
        // Whichever files a sketch includes: no result has such an ending.
        if is_there && rumbo_sketch::is_program(path) {
            return Err(Failure::Input(format!(
                "{}: is part of a program; choose another place",
                path.display()
            )));
        }
        let is_same =
            |input: &&PathBuf| is_there && same_file::is_same_file(input, path).unwrap_or(false);
        match self.inputs.iter().find(is_same) {
            None => Ok(()),
            Some(input) => Err(Failure::Input(format!(
                "{}: would be written over {}, which this command reads; choose another place",
                path.display(),
                input.display()
            ))),
        }
    }
}

fn is_another(path: &Path) -> Failure {
    Failure::Input(format!(
        "{}: is there already, and not of the same run or report, with the same options; choose another place, or replace it with --force",
        path.display()
    ))
}

/// Rejects two results of one command in one place; `whose` names them.
pub(crate) fn distinct(results: &[(PathBuf, String)]) -> Result<(), Failure> {
    for (index, (path, whose)) in results.iter().enumerate() {
        let before = results
            .iter()
            .take(index)
            .find(|(other, _)| is_one(path, other));
        if let Some((_, other)) = before {
            return Err(Failure::Input(format!(
                "{}: both {other} and {whose} would be written there; rename one, or run them one by one into folders of their own",
                path.display()
            )));
        }
    }
    Ok(())
}

/// Whether two paths are one place, whether or not something is there.
fn is_one(one: &Path, other: &Path) -> bool {
    if let Ok(same) = same_file::is_same_file(one, other) {
        return same;
    }
    let folder = |path: &Path| {
        let folder = path.parent().unwrap_or(path);
        let folder = match folder.as_os_str().is_empty() {
            true => Path::new("."),
            false => folder,
        };
        std::fs::canonicalize(folder)
            .or_else(|_| std::path::absolute(folder))
            .ok()
    };
    one.file_name() == other.file_name() && folder(one) == folder(other)
}

/// Writes a file.
pub(crate) fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    make(path, |place| {
        std::fs::write(place, bytes.as_ref()).map_err(|error| unwritable(path, &error))
    })
}

/// Lets a file be made, beside its destination.
pub(crate) fn make(
    path: &Path,
    make: impl FnOnce(&Path) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let Some(Beside { place, part }) = beside(path) else {
        return make(path);
    };
    // A part that is not moved is removed.
    make(&part)?;
    if let Ok(before) = std::fs::metadata(&place) {
        // A rewritten file keeps its owner.
        let _ = std::fs::set_permissions(&part, before.permissions());
    }
    part.persist(&place)
        .map_err(|error| unwritable(path, &error.error))
}

struct Beside {
    /// The file itself, behind any link.
    place: PathBuf,
    part: TempPath,
}

/// Where a file is made first; `None`: where it belongs, for what is no file (`/dev/stdout`) or stands in a folder where nothing can be made.
fn beside(path: &Path) -> Option<Beside> {
    let place = match std::fs::canonicalize(path) {
        Ok(place) if place.is_file() => place,
        Ok(_) => return None,
        Err(_) => path.to_owned(),
    };
    let ending = place.extension().unwrap_or_default().to_string_lossy();
    let suffix = format!(".{ending}");
    let folder = place
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let mut part = tempfile::Builder::new();
    part.prefix(".rumbo-").suffix(&suffix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file: the user's mask takes from it what it takes.
        part.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let part = part.tempfile_in(folder.unwrap_or(Path::new("."))).ok()?;
    Some(Beside {
        part: part.into_temp_path(),
        place,
    })
}

/// A place where nothing can be written: what, where, what to do.
pub(crate) fn unwritable(path: &Path, error: &Error) -> Failure {
    let (shown, what) = (path.display(), "cannot be written");
    Failure::Input(match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            format!("{shown}: {what}, a file stands where a folder is needed; choose another place")
        }
        ErrorKind::StorageFull => {
            format!("{shown}: {what}, the disk is full; make room or choose another place")
        }
        ErrorKind::NotFound => {
            format!("{shown}: {what}, its folder is not there; make it or choose another place")
        }
        _ => format!("{shown}: {what} ({error}); choose another place"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_could_not_be_made_leaves_the_one_before_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        write(&path, "before").unwrap();
        let failed = make(&path, |place| {
            std::fs::write(place, "half").unwrap();
            Err(unwritable(&path, &ErrorKind::StorageFull.into()))
        });
        let Err(Failure::Input(said)) = failed else {
            panic!("made")
        };
        assert!(
            said.contains("a.csv") && said.contains("disk is full"),
            "{said}"
        );
        assert_eq!(std::fs::read(&path).unwrap(), b"before");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write(&path, "after").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"after");
    }

    #[test]
    fn no_result_replaces_a_sketch() {
        let folder = tempfile::tempdir().unwrap();
        let guard = Guard::new(Vec::<PathBuf>::new(), true);
        let mark = Mark::Text("rumbo run".into());
        for name in ["a.ino", "motor.h", "a.elf"] {
            let path = folder.path().join(name);
            assert!(guard.check(&path, &mark).is_ok());
            std::fs::write(&path, "void setup() {}").unwrap();
            assert!(guard.check(&path, &mark).is_err(), "{name}");
            assert!(guard.make_equal(&path, |_| Ok(())).is_err(), "{name}");
        }
    }

    #[test]
    fn a_place_is_tried_without_a_trace() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        assert!(try_file(&path).is_ok() && !path.exists());
        std::fs::write(&path, "mine").unwrap();
        assert!(try_file(&path).is_ok());
        assert_eq!(std::fs::read(&path).unwrap(), b"mine");
        for (path, why) in [
            (folder.path().to_owned(), "irectory"),
            (
                folder.path().join("x").join("a.csv"),
                "its folder is not there",
            ),
            (path.join("a.csv"), "a file stands where a folder is needed"),
        ] {
            let Err(Failure::Input(said)) = try_file(&path) else {
                panic!("{}", path.display())
            };
            assert!(said.contains(why), "{said}");
        }
    }

    #[test]
    fn two_names_of_one_place_are_one_place() {
        let folder = tempfile::tempdir().unwrap();
        let here = folder.path().join("a.csv");
        let roundabout = folder.path().join("x").join("..").join("a.csv");
        std::fs::create_dir(folder.path().join("x")).unwrap();
        let results = |other: &Path| [(here.clone(), "one".into()), (other.into(), "two".into())];
        assert!(distinct(&results(&roundabout)).is_err());
        assert!(distinct(&results(&folder.path().join("b.csv"))).is_ok());
        std::fs::write(&here, "a").unwrap();
        assert!(distinct(&results(&roundabout)).is_err());
        #[cfg(unix)]
        {
            let link = folder.path().join("link.csv");
            std::os::unix::fs::symlink(&here, &link).unwrap();
            assert!(distinct(&results(&link)).is_err());
        }
    }
}
