//! What is said on the terminal: on stderr, where a closed one is no error.

use std::io::Write;

/// Says something, in one line. Texts come from a robot and from others too: what a terminal would obey is escaped.
pub(crate) fn say(text: &str) {
    let shown: String = text
        .chars()
        .map(|c| if c.is_control() { '\u{fffd}' } else { c })
        .collect();
    let _ = writeln!(std::io::stderr(), "{shown}");
}

/// The same of what is worth a look.
pub(crate) fn note(text: &str) {
    say(&format!("note: {text}"));
}
