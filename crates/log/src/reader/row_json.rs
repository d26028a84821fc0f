//! The signals of one instant as a log has them.

use crate::signals::Row;
use serde::Deserialize;
use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// A row from its JSON object, whatever the order of the names.
pub(super) struct Signals(pub(super) Row);

impl<'de> Deserialize<'de> for Signals {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(RowVisitor).map(Self)
    }
}

struct RowVisitor;

impl<'de> Visitor<'de> for RowVisitor {
    type Value = Row;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object of signals")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Row, A::Error> {
        let mut row = Row::unknown(0);
        while let Some(name) = map.next_key::<Cow<'de, str>>()? {
            if let Some(range) = name.strip_suffix("_clear") {
                map.next_value::<IgnoredAny>()?;
                row.set(range, f64::INFINITY);
            } else if let Some(value) = map.next_value::<Option<f64>>()? {
                set(&mut row, &name, value);
            }
        }
        Ok(row)
    }
}

/// Sets a signal, under our name for it or under that of `rumbo import`.
fn set(row: &mut Row, name: &str, value: f64) {
    match name {
        "left_range_m" => row.set("range_left_m", value),
        "right_range_m" => row.set("range_right_m", value),
        "front_range_m" => row.set("range_front_m", value),
        "left_speed_rad_s" => row.set("left_rad_s", value),
        "right_speed_rad_s" => row.set("right_rad_s", value),
        "left_reference_rad_s" => row.set("left_ref_rad_s", value),
        "right_reference_rad_s" => row.set("right_ref_rad_s", value),
        "reference_rad_s" => {
            row.set("left_ref_rad_s", value);
            row.set("right_ref_rad_s", value);
        }
        "reference_m" => row.set("reference_left", value),
        _ => row.set(name, value),
    }
}
