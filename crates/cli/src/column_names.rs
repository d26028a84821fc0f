//! Names of the columns of other programs' tables, their unit last: `left_rpm`.

use std::f64::consts::{PI, TAU};

/// A unit: its name, and the factor to ours.
pub(crate) type Unit = (&'static str, f64);

const TIME: &[Unit] = &[("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
const SPEED: &[Unit] = &[
    ("rpm", PI / 30.0),
    ("rad_s", 1.0),
    ("deg_s", PI / 180.0),
    ("rps", TAU),
];
const TURNED: &[Unit] = &[("turn", TAU), ("rad", 1.0), ("deg", PI / 180.0)];
const PWM: &[Unit] = &[("pwm", 1.0), ("duty", 255.0), ("percent", 2.55)];
const LENGTH: &[Unit] = &[("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)];
const ANGLE: &[Unit] = &[("rad", 1.0), ("deg", PI / 180.0)];
const FORWARD: &[Unit] = &[("m_s", 1.0), ("cm_s", 0.01), ("mm_s", 0.001)];
const YAW: &[Unit] = &[("rad_s", 1.0), ("deg_s", PI / 180.0)];

/// What becomes of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Role {
    /// The times of all rows.
    Time,
    /// The time since the row before.
    Period,
    /// These signals of a log.
    Signals(&'static [&'static str]),
    /// This one, a speed: the column is how far a wheel has turned.
    Turned(&'static [&'static str]),
    /// A number with this name.
    Number(&'static str),
}

/// Names before the unit, the longer ones first where one begins another.
#[rustfmt::skip]
pub(crate) const NAMES: &[(&str, Role, &[Unit])] = &[
    ("t", Role::Time, TIME),
    ("dt", Role::Period, TIME),
    ("left_ref", Role::Signals(&["left_ref_rad_s"]), SPEED),
    ("right_ref", Role::Signals(&["right_ref_rad_s"]), SPEED),
    ("ref", Role::Signals(&["left_ref_rad_s", "right_ref_rad_s"]), SPEED),
    ("left", Role::Signals(&["left_rad_s"]), SPEED),
    ("right", Role::Signals(&["right_rad_s"]), SPEED),
    ("left", Role::Turned(&["left_rad_s"]), TURNED),
    ("right", Role::Turned(&["right_rad_s"]), TURNED),
    ("left", Role::Signals(&["left_pwm"]), PWM),
    ("right", Role::Signals(&["right_pwm"]), PWM),
    ("range_left", Role::Signals(&["range_left_m"]), LENGTH),
    ("range_right", Role::Signals(&["range_right_m"]), LENGTH),
    ("range_front", Role::Signals(&["range_front_m"]), LENGTH),
    ("x", Role::Signals(&["x_m"]), LENGTH),
    ("y", Role::Signals(&["y_m"]), LENGTH),
    ("heading", Role::Signals(&["heading_rad"]), ANGLE),
    ("forward_ref", Role::Number("forward_ref_m_s"), FORWARD),
    ("yaw_ref", Role::Number("yaw_ref_rad_s"), YAW),
    ("forward", Role::Number("forward_m_s"), FORWARD),
    ("yaw", Role::Number("yaw_rad_s"), YAW),
];

/// All names there are, with their units: for messages and the help.
pub(crate) fn names() -> String {
    let mut stems: Vec<(&str, Vec<&str>)> = Vec::new();
    for (stem, _, units) in NAMES {
        let units = units.iter().map(|(unit, _)| *unit);
        match stems.iter_mut().find(|(known, _)| known == stem) {
            Some((_, known)) => known.extend(units),
            None => stems.push((stem, units.collect())),
        }
    }
    let shown = stems
        .iter()
        .map(|(stem, units)| format!("{stem}_{}", units.join("|")));
    shown.collect::<Vec<_>>().join(", ")
}
