//! Lines of text that a person types: of the command line, and of a scenario.
//!
//! ```toml
//! [[command]]
//! at_s = 1
//! text = "F"             # over the robot's link; usb = "F" on the board's USB port
//! line_ending = "none"   # or "lf", as where it is left out, "cr", "crlf"
//! ```

use super::error::did_you_mean;
use super::near::near_or_all;
use super::read::Table;
use rumbo_wire::LineEnding;

/// Where a line of text goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Port {
    /// Over the robot's link.
    #[default]
    Link,
    /// To an emulated board, over its USB cable.
    Usb,
}

/// The keys of a scenario, each with where its line goes.
pub(super) const PORTS: [(&str, Port); 2] = [("text", Port::Link), ("usb", Port::Usb)];
/// The key that goes with them.
pub(super) const ENDING: &str = "line_ending";

/// A line of text and its time.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedText {
    /// Time since the start [s].
    pub at_s: f64,
    /// The line, without its end.
    pub text: String,
    /// What is sent behind it.
    pub ending: LineEnding,
    /// Where it goes.
    pub port: Port,
}

impl TimedText {
    /// What is sent.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        [&self.text, self.ending.text()].concat().into_bytes()
    }
}

/// Why a text is no line that can be typed.
///
/// # Errors
/// What to do about it.
pub fn check_line(text: &str) -> Result<(), &'static str> {
    match !text.is_empty() && text.bytes().all(|byte| (b' '..=b'~').contains(&byte)) {
        true => Ok(()),
        false => Err("the text must be one line of ASCII"),
    }
}

/// The line of a command that has a key of [`PORTS`].
pub(super) fn read_typed(
    table: &Table<'_, '_>,
    at_s: f64,
    (key, port): (&str, Port),
) -> Option<TimedText> {
    let text = table.text(key)?;
    if let Err(remedy) = check_line(&text.value) {
        table.complain(key, text.line, &format!("{:?}", text.value), remedy);
    }
    let ending = table.text(ENDING).map(|name| {
        LineEnding::named(&name.value).unwrap_or_else(|| {
            let known = LineEnding::ALL.map(LineEnding::name);
            let remedy = did_you_mean(&near_or_all(&name.value, known));
            table.complain(ENDING, name.line, &format!("{:?}", name.value), &remedy);
            LineEnding::default()
        })
    });
    Some(TimedText {
        at_s,
        text: text.value,
        ending: ending.unwrap_or_default(),
        port,
    })
}
