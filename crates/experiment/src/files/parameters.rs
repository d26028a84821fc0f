//! Control parameters by name, as files and `--param` give them: the table is `control`'s.

use super::read::Table;
use super::value::{number_of, shown};
pub use super::word::exact;
use super::word::{WordError, allowed, named};
use rumbo_control::params::{ParamId, ParamKind};
use toml::de::DeValue;

/// A value from the command line: a number, or the name of a value of a switch or a choice. Limits are checked later.
///
/// # Errors
/// [`WordError`].
pub fn parse(name: &str, text: &str) -> Result<f64, WordError> {
    let named = ParamId::from_name(name).filter(|id| id.kind() != ParamKind::Number);
    if let Some(value) = named.and_then(|id| id.kind().value_of(text)) {
        return Ok(f64::from(value));
    }
    match (text.parse::<f64>(), named) {
        (Ok(value), _) if value.is_finite() => Ok(value),
        (Ok(_), _) => Err(WordError::NotFinite),
        (Err(_), None) => Err(WordError::NotANumber(text.to_owned())),
        (Err(_), Some(id)) => Err(WordError::NoValue(id, text.to_owned())),
    }
}

/// Whether a parameter may have a value.
///
/// # Errors
/// [`WordError::NotAllowed`].
pub(crate) fn check(id: ParamId, value: f64) -> Result<(), WordError> {
    match allowed(id).admits(value) {
        true => Ok(()),
        false => Err(WordError::NotAllowed(id)),
    }
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
    table.require(key, &WordError::NotAllowed(id).to_string());
    read(table, key, id)
}

/// A parameter by name.
///
/// # Errors
/// [`WordError`].
pub(crate) fn find(name: &str) -> Result<ParamId, WordError> {
    ParamId::from_name(name).ok_or_else(|| WordError::Parameter(name.to_owned()))
}

/// Reads a `[parameters]` table: names and values.
pub(crate) fn read_parameters(table: &Table<'_, '_>) -> Vec<(ParamId, f32)> {
    let value = |id: ParamId| Some((id, read(table, id.name(), id)?));
    let values = ParamId::ALL.into_iter().filter_map(value).collect();
    table.finish();
    values
}
