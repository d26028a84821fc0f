//! The modes to choose from, as the page gets them.

use rumbo_control::mode::{ModeId, StateDescription, Takes};
use rumbo_control::rig::Rig;
use serde::Serialize;

/// A mode to choose: its description, as the page gets it.
#[derive(Clone, Debug, Serialize)]
pub struct ModeEntry {
    id: u8,
    name: &'static str,
    about: &'static str,
    /// Names of its states, by the number in telemetry.
    states: Vec<&'static str>,
    /// The ways between them: from, to, when.
    ways: Vec<(u8, u8, &'static str)>,
    /// The state in which its reference is not in force.
    idle: Option<u8>,
    reference: Option<ReferenceEntry>,
    /// It wants a heading.
    heading: bool,
    /// Takes basic movements.
    movements: bool,
    /// Takes a route of at most this many waypoints.
    route: Option<usize>,
    /// Follows a lane on command.
    lane: bool,
    /// Takes velocities.
    velocity: bool,
    /// Names of the rigs it can drive with.
    rigs: Vec<&'static str>,
    /// Its parameters by number, those that matter most first: title and numbers.
    parameters: Vec<(&'static str, Vec<u8>)>,
    /// Its equations: the signal that each gives, what it is, the parameters within its terms, and the states in which it
    /// holds; none: in all.
    laws: Vec<(&'static str, &'static str, Vec<u8>, &'static [u8])>,
    /// Names of the plots to begin with.
    plots: Vec<&'static str>,
}

#[derive(Clone, Copy, Debug, Serialize)]
struct ReferenceEntry {
    kind: &'static str,
    min: f32,
    max: f32,
    offered: f32,
    commanded: bool,
}

/// The modes to choose from.
pub(crate) fn modes() -> Vec<ModeEntry> {
    ModeId::ALL.into_iter().map(mode_entry).collect()
}

fn mode_entry(mode: ModeId) -> ModeEntry {
    let about = mode.description();
    let ways = |(from, state): (u8, &'static StateDescription)| {
        state.ways.iter().map(move |way| (from, way.to, way.when))
    };
    ModeEntry {
        id: about.number,
        name: about.name,
        about: about.about,
        states: about.states.iter().map(|state| state.name).collect(),
        ways: (0..).zip(about.states).flat_map(ways).collect(),
        idle: about.idle,
        reference: about.reference.map(|reference| ReferenceEntry {
            kind: reference.kind.name(),
            min: reference.min,
            max: reference.max,
            offered: reference.offered,
            commanded: reference.commanded,
        }),
        heading: about.heading,
        movements: about.takes == Some(Takes::Movements),
        route: match about.takes {
            Some(Takes::Route(most)) => Some(most),
            _ => None,
        },
        lane: about.takes == Some(Takes::Lane),
        velocity: about.takes == Some(Takes::Velocity),
        rigs: about.rigs.iter().map(Rig::name).collect(),
        parameters: about
            .parameters
            .iter()
            .map(|group| {
                (
                    group.title,
                    group.parameters.iter().map(|id| *id as u8).collect(),
                )
            })
            .collect(),
        laws: about
            .laws
            .iter()
            .flat_map(|laws| laws.iter())
            .map(|law| {
                let gains = law.gains.iter().map(|id| *id as u8);
                (law.gives, law.is, gains.collect(), law.states)
            })
            .collect(),
        plots: about.plots.iter().map(|plot| plot.name()).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::params::ParamId;
    use rumbo_log::SIGNALS;

    /// Signals that the simulated loops add ([`rumbo_log::ReadingSource::Loops`]), and the distance setpoint as the page has it.
    const LOOPS: [&str; 22] = [
        "left_p_pwm",
        "left_i_pwm",
        "left_d_pwm",
        "left_feedforward_pwm",
        "right_p_pwm",
        "right_i_pwm",
        "right_d_pwm",
        "right_feedforward_pwm",
        "forward_ref_m_s",
        "yaw_ref_rad_s",
        "distance_p_rad",
        "distance_i_rad",
        "heading_p_rad_s",
        "heading_d_rad_s",
        "network_left",
        "network_right",
        "network_servo",
        "reference_m",
        // The page's: of the setpoint, and since ON.
        "heading_error_rad",
        "heading_since_on_rad",
        "goal_x_m",
        "goal_y_m",
    ];

    #[test]
    fn every_name_in_a_law_is_a_parameter_a_signal_or_a_function() {
        let functions = ["min", "max", "abs", "sqrt", "sign", "clamp"];
        let is_known = |name: &str| {
            ParamId::from_name(name).is_some()
                || SIGNALS.iter().any(|signal| signal.name == name)
                || LOOPS.contains(&name)
                || functions.contains(&name)
        };
        for mode in modes() {
            for (gives, is, ..) in &mode.laws {
                let names = is.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
                let names =
                    names.filter(|name| name.starts_with(|c: char| c.is_ascii_alphabetic()));
                for name in names {
                    let is_given = mode.laws.iter().any(|(given, ..)| *given == name);
                    assert!(is_given || is_known(name), "{}: {name}", mode.name);
                }
                let own =
                    "error_m most_rad_s left_m speed_m_s left_asked_rad_s right_asked_rad_s slower";
                let is_own = own.split(' ').any(|name| name == *gives);
                assert!(is_known(gives) || is_own, "{}: {gives}", mode.name);
            }
        }
    }
}
