//! Whether a scenario, its world and its robot's rig fit together.

use super::error::FileError;
use super::{ScenarioFile, WorldFile};
use rumbo_control::SonarId;
use rumbo_plant::plant::Rig;
use rumbo_sim::wire_fault::Wire;

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

/// Reports a sonar that is to fail and that the rig lacks.
pub(super) fn has_its_sonars(
    whose: &str,
    scenario: &ScenarioFile,
    rig: &Rig,
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
