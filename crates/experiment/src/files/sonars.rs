//! Where the sonars of a robot sit, and what they are called.
//!
//! ```toml
//! [rig.mine.front]       # one table per rig and sonar; the control core knows left, right and front
//! x_m = 0.11
//! [rig.mine.rear]        # a sketch any others, each with the pins rear_trigger and rear_echo
//! x_m = -0.08
//! angle_deg = 180
//! ```

use super::error::did_you_mean;
use super::near::near_or_all;
use super::read::{Allowed, Table};
use super::value::ANGLE;
use rumbo_plant::plant::{Mount, Mounts};
use rumbo_plant::sonar::SonarId;
use rumbo_sim::wiring::{SIGNALS, SONARS, Wiring};

/// How their signals end.
const ENDS: [&str; 2] = ["_trigger", "_echo"];

/// Names are in those of signals and of columns.
fn is_of_name(c: char) -> bool {
    c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_'
}

/// Position of a sonar on the body.
const MOUNT: Allowed = Allowed::new(-1.0, 1.0, "m");

/// The names of the other sonars of all rigs.
pub(super) fn read_other_sonars(rigs: &Table<'_, '_>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for rig in rigs.keys() {
        let rig = rigs.table(rig.value);
        for sonar in rig.keys() {
            let is_new =
                !SONARS.contains(&sonar.value) && names.iter().all(|own| own != sonar.value);
            if is_new && !sonar.value.chars().all(is_of_name) {
                rig.complain_here(&format!(
                    "{:?}: a sonar's name has small letters, digits and _ alone, e.g. rear_left",
                    sonar.value
                ));
            } else if is_new && names.len() == SonarId::OTHERS {
                rig.complain_here(&format!(
                    "{}: a robot has left, right, front and at most {} other sonars; there are {}",
                    sonar.value,
                    SonarId::OTHERS,
                    names.join(", ")
                ));
            } else if is_new {
                names.push(sonar.value.to_owned());
            }
        }
    }
    names
}

/// Reads a rig.
pub(super) fn read_rig(table: &Table<'_, '_>, others: &[String]) -> Mounts {
    let mount = |sonar: &str| {
        let mount = table.table(sonar);
        let place = Mount {
            x_m: mount.required_number("x_m", MOUNT),
            y_m: mount.number("y_m", MOUNT).unwrap_or(0.0),
            angle_rad: mount.number("angle_deg", ANGLE).unwrap_or(0.0).to_radians(),
            on_servo: mount.flag("on_servo").is_some_and(|flag| flag.value),
        };
        mount.finish();
        table.has(sonar).then_some(place)
    };
    let [left, right, front] = SONARS.map(mount);
    let mut rig = Mounts {
        left,
        right,
        front,
        ..Mounts::default()
    };
    for (place, sonar) in rig.others.iter_mut().zip(others) {
        *place = mount(sonar);
    }
    table.finish();
    rig
}

/// Whether a signal is of a sonar, whatever that is called.
#[must_use]
pub fn is_of_sonar(signal: &str) -> bool {
    let sonar = ENDS.iter().find_map(|end| signal.strip_suffix(end));
    sonar.is_some_and(|sonar| !sonar.is_empty() && sonar.chars().all(is_of_name))
}

/// The signals of a wiring: those that every robot may have, and those of its other sonars.
pub(super) fn signals(others: &[String]) -> impl Iterator<Item = String> {
    let others = others
        .iter()
        .flat_map(|sonar| ENDS.map(|end| format!("{sonar}{end}")));
    SIGNALS.into_iter().map(str::to_owned).chain(others)
}

/// Reports the signals of sonars that no rig has.
pub(super) fn report_unplaced(table: &Table<'_, '_>, others: &[String]) {
    for key in table.keys() {
        let sonar = ENDS.iter().find_map(|end| key.value.strip_suffix(end));
        let is_known = signals(others).any(|signal| signal == key.value);
        if let (Some(sonar), false) = (sonar, is_known) {
            let near = near_or_all(
                sonar,
                SONARS.into_iter().chain(others.iter().map(String::as_str)),
            );
            table.value(key.value);
            let remedy = format!(
                "no rig says where that sonar is: give it a table, [rig.NAME.{sonar}] with x_m; {}",
                did_you_mean(&near)
            );
            table.complain(key.value, key.line, "a pin", &remedy);
        }
    }
}

/// Reports the echo of a sonar without a trigger, which never comes.
pub(super) fn report_untriggered(table: &Table<'_, '_>, wiring: &Wiring) {
    for signal in wiring.pins.keys() {
        let Some(sonar) = signal.strip_suffix(ENDS[1]) else {
            continue;
        };
        let trigger = format!("{sonar}{}", ENDS[0]);
        if wiring.pins.contains_key(&trigger) {
            continue;
        }
        let line = table.value(signal).map_or(0, |(line, _)| line);
        let remedy = format!(
            "nothing triggers that sonar: give {trigger} too, the same pin where it has one line for both; one that measures \
             by itself is maxsonar.{sonar} = {{ pin = 7, x_m = 0.11 }}"
        );
        table.complain(
            signal,
            line,
            &wiring.board.shown(wiring.pins[signal]),
            &remedy,
        );
    }
}

/// Reports the sonars of a rig that nobody can trigger.
pub(super) fn report_unwired<'a>(
    rigs: &Table<'_, '_>,
    others: &[String],
    wirings: impl Iterator<Item = &'a Wiring> + Clone,
) {
    for sonar in others {
        let trigger = format!("{sonar}{}", ENDS[0]);
        let mut wirings = wirings.clone();
        if wirings.any(|wiring| wiring.pins.contains_key(&trigger)) {
            continue;
        }
        let remedy = format!(
            "no wiring has {trigger}; {}",
            did_you_mean(&near_or_all(sonar, SONARS))
        );
        for rig in rigs.keys() {
            let rig = rigs.table(rig.value);
            let placed = rig.keys().into_iter().find(|key| key.value == sonar);
            if let Some(key) = placed {
                rig.complain(sonar, key.line, "{...}", &remedy);
            }
        }
    }
}
