//! The two languages of the report: every text in both, and numbers as each of them writes them.

use std::fmt::Write;

/// Language of a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Language {
    /// English: decimal points.
    #[default]
    English,
    /// Spanish: decimal commas.
    Spanish,
}

impl Language {
    /// The language that a locale such as `es_ES.UTF-8` asks for; English for all but Spanish.
    #[must_use]
    pub fn of_locale(locale: &str) -> Self {
        let tag = locale
            .split(['_', '.', '-', '@'])
            .next()
            .unwrap_or_default();
        if tag.eq_ignore_ascii_case("es") {
            Self::Spanish
        } else {
            Self::English
        }
    }

    /// Its tag, as in `<html lang="es">`.
    #[must_use]
    pub const fn tag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Spanish => "es",
        }
    }

    /// A number with this many decimals, with a true minus sign and the language's decimal mark.
    #[must_use]
    pub fn number(self, value: f64, decimals: usize) -> String {
        if !value.is_finite() {
            return "–".into();
        }
        let mut digits = format!("{value:.decimals$}");
        if digits.trim_start_matches(['-', '0', '.']).is_empty() {
            // A rounded nothing has no sign.
            digits = digits.trim_start_matches('-').to_owned();
        }
        let digits = digits.replace('-', "\u{2212}");
        match self {
            Self::English => digits,
            Self::Spanish => digits.replace('.', ","),
        }
    }

    /// A number as short as it can be said with at most this many decimals.
    #[must_use]
    pub fn short(self, value: f64, decimals: usize) -> String {
        let mut text = self.number(value, decimals);
        if text.contains(['.', ',']) {
            text.truncate(
                text.trim_end_matches('0')
                    .trim_end_matches(['.', ','])
                    .len(),
            );
        }
        text
    }

    /// A measured value: three significant digits, at most two decimals.
    #[must_use]
    pub fn figure(self, value: f64) -> String {
        let magnitude = if value == 0.0 {
            0.0
        } else {
            value.abs().log10().floor()
        };
        let decimals = (2.0 - magnitude).clamp(0.0, 2.0) as usize;
        self.short(value, decimals)
    }
}

/// A text in both languages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Text {
    /// English.
    pub en: &'static str,
    /// Spanish.
    pub es: &'static str,
}

/// A text in English and Spanish.
pub(crate) const fn t(en: &'static str, es: &'static str) -> Text {
    Text { en, es }
}

/// What is the same in both languages: names, symbols.
pub(crate) const fn same(text: &'static str) -> Text {
    t(text, text)
}

impl Text {
    /// The text in one language.
    #[must_use]
    pub const fn of(self, language: Language) -> &'static str {
        match language {
            Language::English => self.en,
            Language::Spanish => self.es,
        }
    }

    /// The text in one language, each `{}` replaced by the next of these.
    pub(crate) fn with(self, language: Language, values: &[&str]) -> String {
        let mut text = String::new();
        let mut values = values.iter();
        for (index, part) in self.of(language).split("{}").enumerate() {
            if index > 0 {
                text += values.next().copied().unwrap_or_default();
            }
            text += part;
        }
        text
    }
}

/// The text with what HTML takes for markup escaped.
pub(crate) fn escape(text: &str) -> String {
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
pub(crate) fn put(into: &mut String, arguments: std::fmt::Arguments<'_>) {
    let _ = into.write_fmt(arguments);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_each_language_does() {
        assert_eq!(Language::English.number(-1.25, 2), "\u{2212}1.25");
        assert_eq!(Language::Spanish.number(-1.25, 2), "\u{2212}1,25");
        assert_eq!(Language::Spanish.number(-0.001, 1), "0,0");
        assert_eq!(Language::English.figure(1234.5), "1234");
        assert_eq!(Language::Spanish.figure(0.012_34), "0,01");
        assert_eq!(Language::English.figure(f64::NAN), "–");
    }

    #[test]
    fn a_locale_chooses_the_language() {
        for (locale, language) in [
            ("es_ES.UTF-8", Language::Spanish),
            ("es", Language::Spanish),
            ("C", Language::English),
            ("en_GB", Language::English),
            ("est_EE", Language::English),
        ] {
            assert_eq!(Language::of_locale(locale), language, "{locale}");
        }
    }

    #[test]
    fn values_take_the_place_of_braces_in_order() {
        assert_eq!(
            t("{} of {}", "{} de {}").with(Language::Spanish, &["1", "2"]),
            "1 de 2"
        );
    }
}
