//! Whether a scenario, its world and its robot's rig fit together.

use super::error::FileError;
use super::{ScenarioFile, TimedText, TypedPort, WorldFile};
use rumbo_control::SonarId;
use rumbo_plant::plant::Mounts;
use rumbo_sim::wire_fault::Wire;
use rumbo_sim::wiring::{Part, PartKind};

/// Reports a goal that only a random world could provide.
pub(super) fn has_its_goal(scenario: &ScenarioFile, world: &WorldFile) -> Result<(), FileError> {
    let asks = scenario.commands.iter().any(|timed| timed.goal_of_world);
    if !asks || world.random.is_some() || world.goal_m.is_some() {
        return Ok(());
    }
    Err(FileError::Setting(format!(
        "scenario {}: its goal is that of the world, and world {} has none; give a world with goal_m or [random], or goal_m in place of goal",
        scenario.name, world.name
    )))
}

/// Reports a part that is to be pressed and that the wiring lacks.
pub(super) fn has_its_parts(
    whose: &str,
    texts: &[TimedText],
    parts: &[Part],
) -> Result<(), FileError> {
    let worked = || parts.iter().filter(|part| part.kind.is_worked());
    let asked = texts.iter().filter(|timed| timed.port == TypedPort::Parts);
    let mut asked = asked.filter_map(|timed| timed.text.split_once('='));
    let missing = asked.find_map(|(name, value)| {
        let Some(part) = worked().find(|part| part.name == name) else {
            return Some(Err(name));
        };
        takes(part, value).err().map(Ok)
    });
    let missing = match missing {
        None => return Ok(()),
        Some(Ok(why)) => return Err(FileError::Setting(format!("{whose}: {why}"))),
        Some(Err(missing)) => missing,
    };
    let known: Vec<&str> = worked().map(|part| part.name.as_str()).collect();
    let known = match &known[..] {
        [] => "there are none; the robot file has them, e.g. parts.start = { button = 8 } in its [wiring.NAME], for a sketch".into(),
        known => format!("there are {}", known.join(", ")),
    };
    Err(FileError::Setting(format!(
        "{whose}: `{missing}` is to be pressed, and the wiring has no button, switch, potentiometer or remote control of that name: {known}"
    )))
}

/// Whether a part can be put to a value; if not, why.
pub(crate) fn takes(part: &Part, value: &str) -> Result<(), String> {
    let name = &part.name;
    if part.kind == PartKind::Infrared {
        let keys: Vec<&str> = part.keys.iter().map(|(key, _)| key.as_str()).collect();
        return match keys.contains(&value) {
            true => Ok(()),
            false => Err(format!(
                "`{name}` is a remote control, and {value} none of its keys: {}, e.g. {name}={}",
                keys.join(", "),
                keys[0]
            )),
        };
    }
    match (value, value.parse()) {
        ("on" | "off", _) | (_, Ok(0.0..=1.0)) => Ok(()),
        _ => Err(format!(
            "`{name}` is put to {value}: give a value from 0 to 1"
        )),
    }
}

/// Reports a sonar that is to fail and that the rig lacks.
pub(super) fn has_its_sonars(
    whose: &str,
    scenario: &ScenarioFile,
    rig: &Mounts,
) -> Result<(), FileError> {
    let sonars = scenario.sonar_faults.iter().map(|fault| fault.sonar);
    let echoes = scenario.wire_faults.iter().map(|fault| fault.wire);
    let echoes = echoes.filter_map(|wire| match wire {
        Wire::Echo(sonar) => Some(sonar),
        Wire::Encoder(_) => None,
    });
    let missing = sonars.chain(echoes).find_map(|sonar| match sonar {
        SonarId::Left => rig.left.is_none().then_some("left"),
        SonarId::Right => rig.right.is_none().then_some("right"),
        SonarId::Front => rig.front.is_none().then_some("front"),
    });
    match missing {
        None => Ok(()),
        Some(sonar) => Err(FileError::Setting(format!(
            "{whose}: its sonar `{sonar}` is to fail, and rig {} has none of that name; name another sonar, or choose another rig",
            scenario.rig
        ))),
    }
}
