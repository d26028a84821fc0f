//! Texts and numbers in a picture.

use std::fmt::{Arguments, Write};

/// How a language writes what the engine itself puts into a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Words<'a> {
    /// Numbers have a decimal comma.
    pub comma: bool,
    /// Label of a panel without values.
    pub no_value: &'a str,
}

impl Default for Words<'_> {
    /// English.
    fn default() -> Self {
        Self {
            comma: false,
            no_value: "no value",
        }
    }
}

/// A number with this many decimals, with a true minus sign; `comma`: with a decimal comma.
#[must_use]
pub fn number(value: f64, decimals: usize, comma: bool) -> String {
    if !value.is_finite() {
        return "–".into();
    }
    let mut digits = format!("{value:.decimals$}");
    if digits.trim_start_matches(['-', '0', '.']).is_empty() {
        // A value rounded to zero has no sign.
        digits = digits.trim_start_matches('-').to_owned();
    }
    let digits = digits.replace('-', "\u{2212}");
    match comma {
        false => digits,
        true => digits.replace('.', ","),
    }
}

/// The text with what HTML and SVG take for markup escaped.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            _ => escaped.push(letter),
        }
    }
    escaped
}

/// Appends formatted text; writing to a string cannot fail.
pub fn put(into: &mut String, arguments: Arguments<'_>) {
    let _ = into.write_fmt(arguments);
}
