//! Why a word or a number in a file or a command is refused: what to write instead.

use super::error::did_you_mean;
use super::near;
use super::value::Allowed;
use rumbo_control::mode::ModeId;
use rumbo_control::params::{ParamId, ParamKind};
use thiserror::Error;

/// A refused word or number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WordError {
    /// No mode has this name or number; those to choose from.
    #[error("unknown mode; did you mean {}?", modes(.0))]
    Mode(Vec<ModeId>),
    /// No basic movement has this name; those to choose from.
    #[error("unknown movement; {}", did_you_mean(.0))]
    Movement(Vec<String>),
    /// No parameter has this name.
    #[error("unknown parameter; {}", near::remedy_for_key(.0, None, &ParamId::ALL.map(ParamId::name)))]
    Parameter(String),
    /// A value is infinite or none.
    #[error("the value must be finite")]
    NotFinite,
    /// This text is no number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// The switch or choice of this name has no value of this name.
    #[error("{name} {must}, not `{1}`", name = .0.name(), must = named(.0.kind()))]
    NoValue(ParamId, String),
    /// The parameter may not have this value.
    #[error("{}", remedy(*.0))]
    NotAllowed(ParamId),
}

fn modes(modes: &[ModeId]) -> String {
    let name = |mode: &ModeId| format!("`{}` ({})", mode.name(), *mode as u8);
    let names: Vec<String> = modes.iter().map(name).collect();
    names.join(" or ")
}

fn remedy(id: ParamId) -> String {
    match id.kind() {
        ParamKind::Number => allowed(id).remedy(),
        kind => named(kind),
    }
}

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
