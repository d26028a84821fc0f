//! Zip archives of people whom nobody trusts, unpacked into a folder: regular files with plain names, bounded in number and
//! size, and nothing else. And archives of ours.

use crate::error::SketchError;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// What an archive may hold.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Files and folders.
    pub entries: usize,
    /// Bytes of all files together, unpacked.
    pub bytes: u64,
}

impl Bounds {
    /// Those of one person's sketch.
    pub const SKETCH: Bounds = Bounds {
        entries: 2_000,
        bytes: 32 << 20,
    };
    /// Those of a class.
    pub const CLASS: Bounds = Bounds {
        entries: 100_000,
        bytes: 1 << 30,
    };
}

/// Unpacks an archive into an empty folder. Gives the names of what was left out: links, names that lead out of the folder,
/// and the second of two files with one name.
///
/// # Errors
/// It is no zip archive, is encrypted, holds more than the bounds allow, or cannot be read or written.
pub fn unpack(archive: &Path, into: &Path, bounds: Bounds) -> Result<Vec<String>, SketchError> {
    let file = File::open(archive).map_err(|error| SketchError::file(archive, error))?;
    let mut zip = ZipArchive::new(file).map_err(|error| wrong(archive, &error))?;
    if zip.len() > bounds.entries {
        return Err(SketchError::Refused(format!(
            "{}: holds {} files, more than {}: it is none of a person's sketches",
            shown(archive),
            zip.len(),
            bounds.entries
        )));
    }
    let (mut left, mut left_out) = (bounds.bytes, Vec::new());
    for index in 0..zip.len() {
        let mut entry = zip
            .by_index(index)
            .map_err(|error| wrong(archive, &error))?;
        let name = entry
            .name()
            .map_or_else(|_| "a name that is none".into(), |name| name.to_string());
        let Some(inner) = entry.enclosed_name().filter(|_| !entry.is_symlink()) else {
            left_out.push(name);
            continue;
        };
        let path = into.join(inner);
        let unwritten = |error| SketchError::file(archive, error);
        if entry.is_dir() {
            fs::create_dir_all(&path).map_err(unwritten)?;
            continue;
        }
        if let Some(parent) = path.parent() {
            fs::create_dir_all(parent).map_err(unwritten)?;
        }
        let mut file = match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                left_out.push(name);
                continue;
            }
            Err(error) => return Err(unwritten(error)),
        };
        // What the archive says of sizes is not believed.
        let mut some = (&mut entry).take(left + 1);
        let written = std::io::copy(&mut some, &mut file).map_err(unwritten)?;
        left = left.checked_sub(written).ok_or_else(|| {
            SketchError::Refused(format!(
                "{}: unpacked it is larger than {} MB: it is none of a person's sketches",
                shown(archive),
                bounds.bytes >> 20
            ))
        })?;
    }
    Ok(left_out)
}

/// A file in an archive of ours.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Its path in it.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
    /// It can be run.
    pub runs: bool,
}

/// Writes an archive; the same files give the same bytes.
///
/// # Errors
/// It cannot be written.
pub fn pack(archive: &Path, entries: &[Entry]) -> std::io::Result<()> {
    let mut zip = ZipWriter::new(File::create(archive)?);
    for Entry { name, bytes, runs } in entries {
        let mode = if *runs { 0o755 } else { 0o644 };
        let options = SimpleFileOptions::default().unix_permissions(mode);
        zip.start_file(name.as_str(), options)?;
        zip.write_all(bytes)?;
    }
    zip.finish()?.sync_all()
}

fn shown(archive: &Path) -> String {
    let name = archive.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

fn wrong(archive: &Path, error: &ZipError) -> SketchError {
    let name = shown(archive);
    SketchError::Refused(match error {
        ZipError::UnsupportedArchive(what) if *what == ZipError::PASSWORD_REQUIRED => {
            format!("{name}: is encrypted: hand in one without a password")
        }
        ZipError::Io(error) => format!("{name}: cannot be read ({error})"),
        error => format!("{name}: is no zip archive that can be read ({error})"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    fn archive(entries: &[(&str, &[u8])]) -> Vec<u8> {
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, bytes) in entries {
            zip.start_file(*name, SimpleFileOptions::default()).unwrap();
            zip.write_all(bytes).unwrap();
        }
        zip.add_symlink("link.ino", "/etc/passwd", SimpleFileOptions::default())
            .unwrap();
        zip.finish().unwrap().into_inner()
    }

    fn unpacked(
        bytes: &[u8],
        bounds: Bounds,
    ) -> (tempfile::TempDir, Result<Vec<String>, SketchError>) {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.zip"), bytes).unwrap();
        let into = folder.path().join("in");
        let done = unpack(&folder.path().join("a.zip"), &into, bounds);
        (folder, done)
    }

    #[test]
    fn plain_files_are_unpacked_and_what_leads_out_or_is_a_link_is_left_out_and_named() {
        let bytes = archive(&[
            ("ana/ana.ino", b"void setup() {}"),
            ("../out.ino", b"x"),
            ("/abs.ino", b"x"),
        ]);
        let (folder, done) = unpacked(&bytes, Bounds::SKETCH);
        assert_eq!(done.unwrap(), ["../out.ino", "link.ino"]);
        let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
        assert_eq!(read("in/ana/ana.ino"), b"void setup() {}");
        // An absolute name stays below.
        assert_eq!(read("in/abs.ino"), b"x");
        assert!(!folder.path().join("out.ino").exists());
    }

    #[test]
    fn a_bomb_too_many_files_an_encrypted_one_and_none_are_refused_with_why() {
        let zeros = vec![0; 3 << 20];
        let bomb = archive(&[("a.ino", &zeros), ("b.ino", &zeros)]);
        assert!(bomb.len() < 50_000);
        let few = Bounds {
            entries: 2,
            bytes: 4 << 20,
        };
        let said = |bytes: &[u8], bounds| unpacked(bytes, bounds).1.unwrap_err().to_string();
        assert_eq!(
            said(&bomb, few),
            "a.zip: holds 3 files, more than 2: it is none of a person's sketches"
        );
        let small = Bounds { entries: 9, ..few };
        assert!(said(&bomb, small).contains("larger than 4 MB"));
        assert!(said(b"PK nothing", small).contains("no zip archive"));
        let mut encrypted = archive(&[("a.ino", b"x")]);
        // The flag of the first entry, in its own header and in the directory's.
        let directory = encrypted
            .windows(4)
            .position(|at| at == b"PK\x01\x02")
            .unwrap();
        encrypted[6] |= 1;
        encrypted[directory + 8] |= 1;
        assert!(said(&encrypted, small).contains("is encrypted"));
    }
}
