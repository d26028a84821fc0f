//! The stamp of a file that Rumbo wrote, `rumbo compare 5a1c09e2`: the command, and a checksum of what it was about. A file
//! that has the stamp of the same may be written again.

use crc::{CRC_32_ISO_HDLC, Crc};

/// The mark added to a file whose contents have none: the command, and a checksum of its arguments.
#[derive(Clone, Debug)]
pub struct FileStamp(String);

impl FileStamp {
    /// What a command makes of these.
    #[must_use]
    pub fn of(command: &str, about: &[String]) -> Self {
        let sum = crc32(about.join("\n").as_bytes());
        Self(format!("rumbo {command} {sum:08x}"))
    }

    /// What stands in the file.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }

    /// An SVG or HTML file with it.
    #[must_use]
    pub fn put_on(&self, file: impl Into<Vec<u8>>) -> Vec<u8> {
        let (file, text) = (file.into(), &self.0);
        let comment = format!("<!-- {text} -->\n");
        // Nothing but the document's type comes before a comment in HTML.
        match file.iter().position(|byte| *byte == b'\n') {
            Some(end) if file.starts_with(b"<!") => {
                let (first, rest) = file.split_at(end + 1);
                [first, comment.as_bytes(), rest].concat()
            }
            _ => [comment.as_bytes(), &file].concat(),
        }
    }
}

fn crc32(bytes: &[u8]) -> u32 {
    Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(bytes)
}
