//! What a compiler has left, opened as what somebody else may have put there.

use crate::error::SketchError;
use std::fs::{File, OpenOptions};
use std::path::Path;

/// Opens a regular file without following a link.
pub(crate) fn open_regular(path: &Path) -> std::io::Result<File> {
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        // Opening a FIFO would wait for its other end.
        options.custom_flags((OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed());
    }
    #[cfg(not(unix))]
    if !path.symlink_metadata()?.is_file() {
        return Err(std::io::Error::other("no regular file"));
    }
    let file = options.open(path)?;
    match file.metadata()?.is_file() {
        true => Ok(file),
        false => Err(std::io::Error::other("no regular file")),
    }
}

/// Opens a product: a regular file with no other name, of at most so many bytes.
pub(crate) fn open(path: &Path, most: u64) -> Result<File, SketchError> {
    let strange = || {
        SketchError::Refused(
            "the compiler left something that is no product of a compiler".to_owned(),
        )
    };
    let file = open_regular(path).map_err(|_| strange())?;
    let about = file.metadata().map_err(|_| strange())?;
    #[cfg(unix)]
    let is_alone = std::os::unix::fs::MetadataExt::nlink(&about) == 1;
    #[cfg(not(unix))]
    let is_alone = true;
    match is_alone && about.len() <= most {
        true => Ok(file),
        false => Err(strange()),
    }
}
