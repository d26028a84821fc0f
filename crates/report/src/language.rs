//! The two languages of the report, and how each writes numbers.

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
        rumbo_plot::number(value, decimals, self == Self::Spanish)
    }

    /// A number in its shortest form with at most this many decimals.
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

    /// A value in its shortest form with at most so many significant digits.
    #[must_use]
    pub fn significant(self, value: f64, digits: i32) -> String {
        let magnitude = value.abs().max(1e-9).log10().floor() as i32;
        self.short(value, (digits - 1 - magnitude).clamp(0, 9) as usize)
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
}
