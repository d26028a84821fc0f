//! Control parameters by name, as files and `--param` give them: the table is `control`'s.

use super::near;
use super::read::Table;
use super::value::{Allowed, number_of, shown};
use rumbo_control::params::{ParamId, ParamKind};
use toml::de::DeValue;

/// A limit or default as it is written in the table: an `f32` of 0.1 is 0.1 for people, not 0.10000000149.
pub fn exact(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// A value from the command line: a number, or the name of a value of a switch or a choice. Limits are checked later.
///
/// # Errors
/// What to write instead.
pub fn parse(name: &str, text: &str) -> Result<f64, String> {
    let kind = ParamId::from_name(name).map_or(ParamKind::Number, ParamId::kind);
    if let Some(value) = kind.value_of(text) {
        return Ok(f64::from(value));
    }
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err("the value must be finite".into()),
        Err(_) if kind == ParamKind::Number => Err(format!("`{text}` is not a number")),
        Err(_) => Err(format!("{name} {}, not `{text}`", named(kind))),
    }
}

/// Whether a parameter may have a value.
///
/// # Errors
/// What is allowed.
pub(crate) fn check(id: ParamId, value: f64) -> Result<(), String> {
    let allowed = allowed(id);
    if allowed.admits(value) {
        return Ok(());
    }
    Err(match id.kind() {
        ParamKind::Number => allowed.remedy(),
        kind => named(kind),
    })
}

/// A value of a file, if the key is there.
pub(crate) fn read(table: &Table<'_, '_>, key: &str, id: ParamId) -> Option<f32> {
    let kind = id.kind();
    if kind == ParamKind::Number {
        return table.number(key, allowed(id)).map(|value| value as f32);
    }
    let (line, value) = table.value(key)?;
    let found = match value {
        DeValue::String(name) => kind.value_of(name),
        DeValue::Boolean(flag) if kind == ParamKind::Switch => Some(f32::from(u8::from(*flag))),
        value => number_of(value)
            .filter(|value| check(id, *value).is_ok())
            .map(|value| value as f32),
    };
    if found.is_none() {
        table.complain(key, line, &shown(value), &named(kind));
    }
    found
}

/// A required value.
pub(crate) fn required(table: &Table<'_, '_>, key: &str, id: ParamId) -> Option<f32> {
    table.require(
        key,
        &match id.kind() {
            ParamKind::Number => allowed(id).remedy(),
            kind => named(kind),
        },
    );
    read(table, key, id)
}

/// What is allowed for the number of a parameter.
fn allowed(id: ParamId) -> Allowed {
    let limits = id.limits();
    let unit = match id.kind() {
        ParamKind::Number => id.unit(),
        ParamKind::Switch | ParamKind::Choice(_) => "count",
    };
    Allowed::new(exact(limits.min), exact(limits.max), unit)
}

/// What is allowed for a switch or a choice.
fn named(kind: ParamKind) -> String {
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

/// A parameter by name.
///
/// # Errors
/// What to write instead.
pub(crate) fn find(name: &str) -> Result<ParamId, String> {
    ParamId::from_name(name).ok_or_else(|| {
        let known = ParamId::ALL.map(ParamId::name);
        format!(
            "unknown parameter; {}",
            near::remedy_for_key(name, None, &known)
        )
    })
}

/// Reads a `[parameters]` table: names and values.
pub(crate) fn read_parameters(table: &Table<'_, '_>) -> Vec<(ParamId, f32)> {
    let value = |id: ParamId| Some((id, read(table, id.name(), id)?));
    let values = ParamId::ALL.into_iter().filter_map(value).collect();
    table.finish();
    values
}
