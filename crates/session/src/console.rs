//! What a USART of an emulated chip, or a robot that speaks text, has said: as a person reads it.

use serde::Serialize;

/// In place of a USART's number: the link to a real robot that speaks text.
pub const LINK_CONSOLE: u8 = 255;

/// In place of a USART's number: what the displays at an emulated chip show, lines `name=content`.
pub const PARTS_CONSOLE: u8 = 5;

/// What a USART of an emulated chip said, or a robot that speaks text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConsoleText {
    /// Its number, or [`LINK_CONSOLE`].
    pub usart: u8,
    /// What.
    pub text: String,
}

/// Bytes as text: what cannot be printed is shown in hexadecimal.
#[must_use]
pub fn readable(bytes: &[u8]) -> String {
    let mut text = String::new();
    for byte in bytes {
        match *byte {
            b'\n' => text.push('\n'),
            b'\r' => {}
            b' '..=b'~' | b'\t' => text.push(char::from(*byte)),
            other => text.push_str(&format!("\\x{other:02x}")),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_stays_and_the_rest_becomes_visible() {
        assert_eq!(readable(b"on\r\n12\t\x00\xffz"), "on\n12\t\\x00\\xffz");
    }
}
