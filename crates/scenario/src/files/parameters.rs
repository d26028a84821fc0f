//! Control parameters by name, as files and `--param` give them: the table is `control`'s.

use super::near;
use super::read::Table;
use super::value::Allowed;
use rumbo_control::params::ParamId;

/// A limit or default as it is written in the table: an `f32` of 0.1 is 0.1 for people, not 0.10000000149.
pub fn exact(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

/// What is allowed for a parameter, for complaints.
pub(crate) fn allowed(id: ParamId) -> Allowed {
    let limits = id.limits();
    Allowed::new(exact(limits.min), exact(limits.max), id.unit())
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
    let value = |id: ParamId| Some((id, table.number(id.name(), allowed(id))? as f32));
    let values = ParamId::ALL.into_iter().filter_map(value).collect();
    table.finish();
    values
}
