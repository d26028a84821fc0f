//! The types of parameters: the meaning of their numbers. On the link and on the robot each is an `f32`.

use crate::math::round;

/// The type of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParamKind {
    /// A number with a unit, within its limits.
    Number,
    /// 0 no, 1 yes.
    Switch,
    /// One of these, by number from 0.
    Choice(&'static [&'static str]),
}

impl ParamKind {
    /// The type's name in lists.
    pub const fn name(self) -> &'static str {
        match self {
            ParamKind::Number => "number",
            ParamKind::Switch => "switch",
            ParamKind::Choice(_) => "choice",
        }
    }

    /// The names of the values 0, 1, ...; a number has none.
    pub const fn names(self) -> &'static [&'static str] {
        match self {
            ParamKind::Number => &[],
            ParamKind::Switch => &["no", "yes"],
            ParamKind::Choice(names) => names,
        }
    }

    /// The name of a value, rounded as the robot does.
    pub fn name_of(self, value: f32) -> Option<&'static str> {
        self.names()
            .get(usize::try_from(round(value)).ok()?)
            .copied()
    }

    /// The value with this name.
    pub fn value_of(self, name: &str) -> Option<f32> {
        let number = self.names().iter().position(|own| *own == name)?;
        Some(number as f32)
    }
}
