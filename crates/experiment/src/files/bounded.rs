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

/// The same for a text: UTF-8, or UTF-16 with its mark, as Windows' PowerShell redirects what a command prints.
///
/// # Errors
/// As [`read_at_most`], or that it is neither.
pub fn read_text(path: &Path) -> Result<String> {
    let bytes = read_at_most(path, LONGEST_TEXT)?;
    let wide = |unit: fn([u8; 2]) -> u16| {
        let units = bytes[2..].chunks_exact(2);
        let units: Vec<u16> = units.map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16(&units).ok()
    };
    let text = match bytes.get(..2) {
        Some([0xFF, 0xFE]) => wide(u16::from_le_bytes),
        Some([0xFE, 0xFF]) => wide(u16::from_be_bytes),
        _ => str::from_utf8(&bytes).ok().map(str::to_owned),
    };
    text.ok_or_else(|| Error::new(ErrorKind::InvalidData, "neither UTF-8 nor UTF-16"))
}
