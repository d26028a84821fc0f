//! Lines of text that a person types: of the command line, and of a scenario.
//!
//! ```toml
//! [[command]]
//! at_s = 1
//! text = "F"             # over the robot's link; usb = "F" on the board's USB port; "\\x05" is that byte
//! line_ending = "none"   # or "lf", as where it is left out, "cr", "crlf"
//!
//! [[command]]
//! at_s = 3
//! place = [0.2, 0.1, 90] # a hand puts the robot there: x, y in m, heading in degrees, 0 where it is left out
//! ```

use super::error::did_you_mean;
use super::near::near_or_all;
use super::read::{Allowed, Table};
use super::value;
use rumbo_wire::LineEnding;

/// Where a line of text goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TypedPort {
    /// Over the robot's link.
    #[default]
    Link,
    /// To an emulated board, over its USB cable.
    Usb,
    /// To what a person works at the robot: `name=value`.
    Parts,
    /// To the hand that moves the robot ([`crate::hand`]).
    Hand,
}

/// The keys of a scenario, each with where its line goes.
pub(super) const PORTS: [(&str, TypedPort); 2] =
    [("text", TypedPort::Link), ("usb", TypedPort::Usb)];
/// The key that works a part, and that for its value: pressed for a moment without one.
pub(super) const PRESS: &str = "press";
pub(super) const VALUE: &str = "to";
/// How long it is held \[s\].
pub(super) const HELD: &str = "for_s";
const HOLD: Allowed = Allowed::new(0.01, 3600.0, "s");
/// The key of where a hand puts the robot.
pub(super) const PLACE: &str = "place";
/// How long a button is pressed, and a key of a remote control stays down [s].
const PRESSED_S: f64 = 0.2;
/// A key that is held is pressed again so often, as the page does [s].
const AGAIN_S: f64 = 0.1;
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
    pub port: TypedPort,
}

impl TimedText {
    /// What is sent.
    #[must_use]
    pub fn bytes(&self) -> Vec<u8> {
        self.ending.typed(&self.text).collect()
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

/// What is done with a part: pressed for a time, a moment if none is said, or put to a value, a number from 0 to 1 or the key of a
/// remote control, which is held for that time.
#[must_use]
pub fn pressed(name: &str, value: Option<&str>, at_s: f64, for_s: Option<f64>) -> Vec<TimedText> {
    let put = |at_s: f64, value: &str| TimedText {
        at_s,
        text: format!("{name}={value}"),
        ending: LineEnding::None,
        port: TypedPort::Parts,
    };
    let for_s = for_s.unwrap_or(PRESSED_S);
    match value {
        Some(value) => {
            let again = ((for_s - PRESSED_S) / AGAIN_S).ceil().max(0.0) as u32;
            let presses = (0..=again).map(|number| f64::from(number) * AGAIN_S);
            let presses = presses.map(|after_s| after_s.min((for_s - PRESSED_S).max(0.0)));
            presses.map(|after_s| put(at_s + after_s, value)).collect()
        }
        None => vec![put(at_s, "on"), put(at_s + for_s, "off")],
    }
}

/// A hand puts the robot at a pose in the world: x, y \[m\], heading \[deg\]. It stays where it is if there is no room.
#[must_use]
pub fn placed([x_m, y_m, heading_deg]: [f64; 3], at_s: f64) -> TimedText {
    TimedText {
        at_s,
        text: format!("robot={x_m} {y_m} {}", heading_deg.to_radians()),
        ending: LineEnding::None,
        port: TypedPort::Hand,
    }
}

/// The command that has the key [`PLACE`].
pub(super) fn read_place(table: &Table<'_, '_>, at_s: f64) -> Option<TimedText> {
    let what = "x and y in m, or x, y and the heading in degrees";
    let (line, items) = table.items(PLACE, what)?;
    let ranges = [
        value::PLACE,
        value::PLACE,
        Allowed::new(-180.0, 180.0, "deg"),
    ];
    let numbers = items.iter().zip(ranges);
    let numbers =
        numbers.map(|(item, allowed)| table.judge_number(PLACE, item.line, item.value, allowed));
    let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
    match (items.len(), &numbers[..]) {
        (2, &[x_m, y_m]) => Some(placed([x_m, y_m, 0.0], at_s)),
        (3, &[x_m, y_m, deg]) => Some(placed([x_m, y_m, deg], at_s)),
        _ => {
            let remedy = format!("must be {what}");
            table.complain(PLACE, line, &format!("{} numbers", items.len()), &remedy);
            None
        }
    }
}

/// What a part is put to: a number, or the key of a remote control.
fn read_value(table: &Table<'_, '_>) -> Option<String> {
    if table.is_text(VALUE) {
        return table.text(VALUE).map(|key| key.value);
    }
    let value = table.number(VALUE, Allowed::new(0.0, 9.0, ""));
    value.map(|value| value.to_string())
}

/// The command that has the key [`PRESS`].
pub(crate) fn read_press(table: &Table<'_, '_>, at_s: f64) -> Vec<TimedText> {
    let (value, for_s) = (read_value(table), table.number(HELD, HOLD));
    let name = table.text(PRESS);
    name.map_or_else(Vec::new, |name| {
        pressed(&name.value, value.as_deref(), at_s, for_s)
    })
}

/// The line of a command that has a key of [`PORTS`].
pub(super) fn read_typed(
    table: &Table<'_, '_>,
    at_s: f64,
    (key, port): (&str, TypedPort),
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

#[cfg(test)]
mod tests {
    use super::pressed;

    /// The times of the lines, in ms, with what they put the part to.
    fn lines(value: Option<&str>, for_s: Option<f64>) -> Vec<(i64, String)> {
        let lines = pressed("it", value, 1.0, for_s).into_iter();
        lines
            .map(|line| {
                (
                    (1e3 * line.at_s).round() as i64,
                    line.text["it=".len()..].to_owned(),
                )
            })
            .collect()
    }

    #[test]
    fn a_button_is_held_until_it_is_let_go_and_a_key_by_pressing_it_again() {
        let button = |for_s| {
            lines(None, for_s)
                .into_iter()
                .map(|(ms, _)| ms)
                .collect::<Vec<_>>()
        };
        assert_eq!(button(None), [1_000, 1_200]);
        assert_eq!(button(Some(2.0)), [1_000, 3_000]);
        let key = |for_s| lines(Some("up"), for_s);
        assert_eq!(key(None), [(1_000, "up".to_owned())]);
        assert_eq!(key(Some(0.05)).len(), 1);
        // It stays down for 0.2 s after the last one.
        let held: Vec<i64> = key(Some(0.55)).into_iter().map(|(ms, _)| ms).collect();
        assert_eq!(held, [1_000, 1_100, 1_200, 1_300, 1_350]);
    }
}
