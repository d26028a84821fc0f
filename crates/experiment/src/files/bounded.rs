//! Reads files up to a maximum size: a path may name a device that never ends.

use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

/// Longest robot, world or scenario \[bytes\].
pub const LONGEST_TEXT: u64 = 1 << 20;
/// Longest CSV: half a day of one robot \[bytes\].
pub const LONGEST_RECORDING: u64 = 64 << 20;
/// Longest log that is read for such a recording, or as one \[bytes\].
pub const LONGEST_LOG: u64 = 4 * LONGEST_RECORDING;

/// Reads a file of at most this many bytes.
///
/// # Errors
/// What the system says, or that it is longer.
pub fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let what = format!("longer than {} MB, the most that is read", most >> 20);
        return Err(Error::new(ErrorKind::FileTooLarge, what));
    }
    Ok(bytes)
}

/// The same for a text.
///
/// # Errors
/// As [`read_at_most`], or that it is not UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = read_at_most(path, LONGEST_TEXT)?;
    String::from_utf8(bytes).map_err(|_| Error::new(ErrorKind::InvalidData, "no text in UTF-8"))
}
