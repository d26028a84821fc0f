//! Where results go. A file is written whole or not at all: beside its place first and then moved there, so that what was there stays until
//! the new one is complete.

use crate::failure::Failure;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Makes a folder, unless it is there.
pub(crate) fn folder(folder: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))
}

/// Whether something can be written into a folder: found before the work, not after it.
pub(crate) fn try_folder(place: &Path) -> Result<(), Failure> {
    folder(place)?;
    let probe = place.join(format!(".rumbo-{}", std::process::id()));
    std::fs::write(&probe, "rumbo")
        .and_then(|()| std::fs::remove_file(&probe))
        .map_err(|error| unwritable(place, &error))
}

/// Writes a file.
pub(crate) fn write(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    make(path, |place| {
        std::fs::write(place, bytes.as_ref()).map_err(|error| unwritable(path, &error))
    })
}

/// Has a file made, beside its place.
pub(crate) fn make(
    path: &Path,
    make: impl FnOnce(&Path) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let Some(beside) = beside(path) else {
        return make(path);
    };
    let made = make(&beside.part).and_then(|()| {
        if let Ok(before) = std::fs::metadata(&beside.place) {
            // A file that was rewritten belongs to whom it belonged.
            let _ = std::fs::set_permissions(&beside.part, before.permissions());
        }
        std::fs::rename(&beside.part, &beside.place).map_err(|error| unwritable(path, &error))
    });
    if made.is_err() {
        // It may not have been begun.
        let _ = std::fs::remove_file(&beside.part);
    }
    made
}

struct Beside {
    /// The file itself, behind any link.
    place: PathBuf,
    part: PathBuf,
}

/// Where a file is made first; `None`: where it belongs, for what is no file (`/dev/stdout`) or stands in a folder where nothing can be made.
fn beside(path: &Path) -> Option<Beside> {
    let place = match std::fs::canonicalize(path) {
        Ok(place) if place.is_file() => place,
        Ok(_) => return None,
        Err(_) => path.to_owned(),
    };
    let ending = place.extension().unwrap_or_default().to_string_lossy();
    let part = place.with_extension(format!("part.{ending}"));
    std::fs::File::create(&part).ok()?;
    Some(Beside { place, part })
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
}
