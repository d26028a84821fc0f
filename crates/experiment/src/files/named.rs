//! What a file chooses from a list by its name: a board, a driver, a sensor's model.

use super::error::did_you_mean;
use super::read::Table;

/// One of a list by its name; the first one where the key is left out.
pub(super) fn read_named<T, const N: usize>(
    root: &Table<'_, '_>,
    key: &str,
    known: &[&'static T; N],
    name_of: fn(&T) -> &'static str,
) -> &'static T {
    let first = known[0];
    let Some(name) = root.text(key) else {
        return first;
    };
    let found = known.iter().find(|each| name_of(each) == name.value);
    found.copied().unwrap_or_else(|| {
        let names = known.map(|each| name_of(each).to_owned());
        root.complain(key, name.line, &name.value, &did_you_mean(&names));
        first
    })
}
