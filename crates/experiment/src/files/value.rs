//! Single values of a TOML file: what is allowed for them, and their form in error messages.

use toml::de::DeValue;

/// What is allowed for a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Allowed {
    /// Smallest.
    pub(crate) min: f64,
    /// Largest.
    pub(crate) max: f64,
    /// For people; empty for a bare number, `count` for a whole one.
    pub(crate) unit: &'static str,
}

impl Allowed {
    /// `min` to `max` of a unit, both included.
    pub(crate) const fn new(min: f64, max: f64, unit: &'static str) -> Self {
        Self { min, max, unit }
    }

    /// Whether a value is allowed.
    pub(crate) fn admits(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value) && (self.unit != "count" || value.fract() == 0.0)
    }

    /// What to do about a value that is not allowed.
    pub(crate) fn remedy(&self) -> String {
        let Self { min, max, unit } = self;
        match *unit {
            "" | "1" => format!("must be within {min}..{max}"),
            "count" => format!("must be a whole number within {min}..{max}"),
            unit => format!("must be within {min}..{max} {unit}"),
        }
    }
}

/// Coordinates of anything in a world.
pub(crate) const PLACE: Allowed = Allowed::new(-50.0, 50.0, "m");
/// Lengths of what stands in one.
pub(crate) const SIDE: Allowed = Allowed::new(0.01, 50.0, "m");
/// Directions there.
pub(crate) const ANGLE: Allowed = Allowed::new(-360.0, 360.0, "deg");

/// A value with its line, for loaders that check it themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placed<T> {
    /// The value.
    pub(crate) value: T,
    /// Its line.
    pub(crate) line: usize,
}

/// The number that a value is, if it is one.
pub(crate) fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|integer| integer as f64),
        _ => None,
    }
}

/// A value as error messages show it.
pub(crate) fn shown(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("{text:?}"),
        DeValue::Integer(integer) => integer.as_str().to_owned(),
        DeValue::Float(float) => float.as_str().to_owned(),
        DeValue::Boolean(flag) => flag.to_string(),
        DeValue::Datetime(date) => date.to_string(),
        DeValue::Array(items) => {
            format!(
                "[{}]",
                items
                    .iter()
                    .map(|item| shown(item.get_ref()))
                    .collect::<Vec<_>>()
                    .join(", ")
            )
        }
        DeValue::Table(_) => "{...}".into(),
    }
}
