//! The types of parameters: what their numbers mean to people. On the link and on the robot each is an `f32`.

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
    /// What the type is called in lists.
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

    /// The name of a value, as the robot takes it: the nearest.
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
