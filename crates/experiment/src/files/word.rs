//! Why a word or a number in a file or a command is refused: what to write instead.

use super::error::did_you_mean;
use super::near;
use super::value::Allowed;
use rumbo_control::mode::ModeId;
use rumbo_control::params::{ParamId, ParamKind};
use std::fmt;

/// A refused word or number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WordError {
    /// No mode has this name or number; those to choose from.
    Mode(Vec<ModeId>),
    /// No basic movement has this name; those to choose from.
    Movement(Vec<String>),
    /// No parameter has this name.
    Parameter(String),
    /// A value is infinite or none.
    NotFinite,
    /// This text is no number.
    NotANumber(String),
    /// The switch or choice of this name has no value of this name.
    NoValue(ParamId, String),
    /// The parameter may not have this value.
    NotAllowed(ParamId),
}

impl fmt::Display for WordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode(modes) => {
                let name = |mode: &ModeId| format!("`{}` ({})", mode.name(), *mode as u8);
                let names: Vec<String> = modes.iter().map(name).collect();
                write!(f, "unknown mode; did you mean {}?", names.join(" or "))
            }
            Self::Movement(names) => {
                write!(f, "unknown movement; {}", did_you_mean(names))
            }
            Self::Parameter(name) => {
                let known = ParamId::ALL.map(ParamId::name);
                let remedy = near::remedy_for_key(name, None, &known);
                write!(f, "unknown parameter; {remedy}")
            }
            Self::NotFinite => f.write_str("the value must be finite"),
            Self::NotANumber(text) => write!(f, "`{text}` is not a number"),
            Self::NoValue(id, text) => {
                write!(f, "{} {}, not `{text}`", id.name(), named(id.kind()))
            }
            Self::NotAllowed(id) => f.write_str(&match id.kind() {
                ParamKind::Number => allowed(*id).remedy(),
                kind => named(kind),
            }),
        }
    }
}

impl std::error::Error for WordError {}

/// A limit or default as it is written in the table: an `f32` of 0.1 is 0.1 for people, not 0.10000000149.
pub fn exact(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// What is allowed for the number of a parameter.
pub(super) fn allowed(id: ParamId) -> Allowed {
    let limits = id.limits();
    let unit = match id.kind() {
        ParamKind::Number => id.unit(),
        ParamKind::Switch | ParamKind::Choice(_) => "count",
    };
    Allowed::new(exact(limits.min), exact(limits.max), unit)
}

/// What is allowed for a switch or a choice.
pub(super) fn named(kind: ParamKind) -> String {
    let names: Vec<_> = kind
        .names()
        .iter()
        .map(|name| format!("`{name}`"))
        .collect();
    match names.split_last() {
        Some((last, others)) => format!("must be {} or {last}", others.join(", ")),
        None => String::new(),
    }
}
