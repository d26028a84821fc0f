//! Intel HEX: lines of bytes with their addresses and checksums.

use super::{Image, ImageError, start};
use ihex::Record;

/// The text, if the first mark in it is that of a HEX record.
pub(super) fn text(bytes: &[u8]) -> Option<&str> {
    let text = str::from_utf8(bytes).ok()?;
    text.trim_start().starts_with(':').then_some(text)
}

pub(super) fn read(text: &str) -> Result<Image, ImageError> {
    let mut image = Image::default();
    let (mut filled, mut base, mut ended) = (Vec::new(), 0u64, false);
    for (index, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() {
            continue;
        }
        let wrong = |what: String| ImageError::Hex {
            line: index + 1,
            what,
        };
        if ended {
            return Err(wrong("something follows the end record".into()));
        }
        let record = Record::from_record_string(line).map_err(|error| wrong(error.to_string()))?;
        match record {
            Record::Data { offset, value } => {
                image.put(&mut filled, base + u64::from(offset), &value)?;
            }
            Record::ExtendedSegmentAddress(segment) => base = u64::from(segment) << 4,
            Record::ExtendedLinearAddress(high) => base = u64::from(high) << 16,
            Record::EndOfFile => ended = true,
            Record::StartSegmentAddress { .. } | Record::StartLinearAddress(_) => {}
        }
    }
    if !ended {
        return Err(ImageError::Truncated);
    }
    image.model = start::model(&image)?;
    Ok(image)
}
