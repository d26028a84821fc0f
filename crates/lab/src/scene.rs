//! The dashboard's scene of a simulated robot: world, footprint, sonars, and the alternatives to choose from.

use rumbo_experiment::files::TimedCommand;
use rumbo_experiment::files::{FileError, Kind, Library, ScenarioFile, Setup, goal_seen_from};
use rumbo_log::{
    Choice, FloorLine, MapPose, Other, Repeat, RoutePlan, ScenarioOffer, Scene, SceneLamp,
    SceneMover, SceneObstacle, SonarMount, TimedPose,
};
use rumbo_plant::contact::{Footprint, Pose};
use rumbo_plant::moving;
use rumbo_plant::plant::Mount;
use rumbo_wire::Command;
use std::collections::BTreeMap;

/// The scene of a setup.
///
/// # Errors
/// The world's shapes are none.
pub fn scene(library: &Library, setup: &Setup, choice: Choice) -> Result<Scene, FileError> {
    let Setup {
        scenario,
        robot,
        world,
        ..
    } = setup;
    let plant = &robot.plant;
    let standing = world
        .world()
        .map_err(|error| FileError::Setting(format!("world {}: {error}", world.name)))?;
    let footprint = Footprint::new(&plant.body, &plant.wheels);
    Ok(Scene {
        experiments: experiments(library, scenario, &choice),
        worlds: library.list(Kind::World),
        world_titles: world_titles(library, choice.world.as_deref()),
        rigs: robot.rigs.keys().cloned().collect(),
        rig: scenario.rig.clone(),
        goals: goals(setup),
        routes: routes(&scenario.commands),
        robot: robot.name.clone(),
        start: MapPose {
            x_m: scenario.start.x_m,
            y_m: scenario.start.y_m,
            heading_rad: scenario.start.heading_rad,
        },
        obstacles: standing
            .obstacles()
            .iter()
            .map(|it| obstacle(it.corners()))
            .collect(),
        lines: world.lines.iter().map(floor_line).collect(),
        lamps: world.light.lamps.iter().map(lamp).collect(),
        movers: world.movers.iter().map(mover).collect(),
        others: Vec::new(),
        footprint_m: footprint.corners(&Pose::default()).to_vec(),
        base_m: plant.body.base_m,
        wheel_radius_m: (plant.wheels.left.radius_m + plant.wheels.right.radius_m) / 2.0,
        sonars: sonars(setup),
        other_sonars: robot.other_sonars.clone(),
        of_ghost: false,
        choice,
    })
}

/// The other robots in the world of one of several.
#[must_use]
pub fn others(fleet: &[Setup], number: usize) -> Vec<Other> {
    let others = fleet.iter().enumerate();
    let others = others.filter(|(other, _)| *other != number);
    let outline = |setup: &Setup| {
        let plant = &setup.robot.plant;
        let footprint = Footprint::new(&plant.body, &plant.wheels);
        footprint.corners(&Pose::default()).to_vec()
    };
    others
        .map(|(_, setup)| Other {
            name: setup.scenario.name.clone(),
            footprint_m: outline(setup),
        })
        .collect()
}

fn sonars(setup: &Setup) -> Vec<SonarMount> {
    let (rig, sonar) = (&setup.rig, &setup.robot.plant.sonar);
    let mount = |(id, mount): (usize, Option<Mount>)| {
        let mount = mount?;
        Some(SonarMount {
            id: id as u8,
            at: MapPose {
                x_m: mount.x_m,
                y_m: mount.y_m,
                heading_rad: mount.angle_rad,
            },
            half_angle_rad: sonar.beam_half_angle_rad,
            reach_m: sonar.reach_m,
            on_servo: mount.on_servo,
        })
    };
    rig.mounts()
        .into_iter()
        .enumerate()
        .filter_map(mount)
        .collect()
}

fn obstacle(corners: impl Iterator<Item = [f64; 2]>) -> SceneObstacle {
    let corners_m: Vec<[f64; 2]> = corners.collect();
    SceneObstacle {
        closed: corners_m.len() > 2,
        corners_m,
    }
}

fn floor_line(line: &rumbo_sim::floor::DarkLine) -> FloorLine {
    FloorLine {
        points_m: line.points_m.clone(),
        width_m: line.width_m,
    }
}

fn lamp(lamp: &rumbo_sim::light::Lamp) -> SceneLamp {
    SceneLamp {
        at_m: lamp.at_m,
        lumen: lamp.lumen,
    }
}

/// Something that moves, as the map needs it.
fn mover(mover: &rumbo_experiment::files::Mover) -> SceneMover {
    let seconds = |us: u64| us as f64 * 1e-6;
    let waypoints = mover.route.waypoints().iter();
    SceneMover {
        corners_m: mover.corners_m.clone(),
        waypoints: waypoints
            .map(|waypoint| TimedPose {
                t_s: seconds(waypoint.at_us),
                at: MapPose {
                    x_m: waypoint.pose.x_m,
                    y_m: waypoint.pose.y_m,
                    heading_rad: waypoint.pose.heading_rad,
                },
            })
            .collect(),
        repeat: match mover.route.repeat() {
            moving::MoverRepeat::Once => Repeat::Once,
            moving::MoverRepeat::Loop => Repeat::Loop,
            moving::MoverRepeat::BackAndForth => Repeat::BackAndForth,
        },
        start_s: seconds(mover.route.start_us()),
    }
}

/// What the built-in worlds are, and the one of a file.
fn world_titles(library: &Library, chosen: Option<&str>) -> BTreeMap<String, String> {
    let names = library.list(Kind::World).into_iter();
    let names = names.chain(chosen.map(str::to_owned));
    let titled = names.filter_map(|name| {
        let title = library.world(&name).ok()?.title;
        Some((name, title))
    });
    titled.collect()
}

/// The scenarios to choose from: the one of a file first, then the built-in ones by group.
fn experiments(library: &Library, scenario: &ScenarioFile, choice: &Choice) -> Vec<ScenarioOffer> {
    let of = |name: &str, file: &ScenarioFile| ScenarioOffer {
        name: name.into(),
        title: file.title.clone(),
        group: file.group.clone(),
        mode: file.mode as u8,
        shows_mode: !file.commands.is_empty(),
    };
    let names = library.list(Kind::Scenario);
    let own = (!names.contains(&choice.scenario)).then(|| of(&choice.scenario, scenario));
    let known = names.iter().filter_map(|name| {
        let file = library.scenario(name).ok()?;
        Some(of(name, &file))
    });
    let mut known: Vec<_> = known.collect();
    known.sort_by(|one, other| one.group.cmp(&other.group));
    own.into_iter().chain(known).collect()
}

/// The commands that prepare a robot without starting it: the mode, and the experiment's settings up to arming, or its
/// first setpoint after that. The goal of a world comes before that of the experiment.
pub(crate) fn first_commands(setup: &Setup) -> Vec<Command> {
    let goal = goal_of_world(setup);
    let commands = setup.scenario.commands.iter();
    let commands = commands.map(|timed| match (timed.command, goal) {
        (Command::Goal { .. }, Some(goal)) => goal,
        (command, _) => command,
    });
    let armed = |command: &Command| *command == Command::Arm;
    let before: Vec<_> = commands
        .clone()
        .take_while(|command| !armed(command))
        .filter(|command| matches!(command, Command::SetParam { .. }) || is_setpoint(command))
        .collect();
    let mut first = vec![Command::Mode(setup.scenario.mode)];
    let set = before.iter().any(is_setpoint);
    first.extend(before);
    if !set {
        // A route is several commands.
        let mut later = commands.filter(is_setpoint);
        first.extend(later.next());
        first.extend(later.take_while(|command| matches!(command, Command::Waypoint(_))));
    }
    first
}

/// Whether a command is such a setting. A movement is not: the operator starts it.
fn is_setpoint(command: &Command) -> bool {
    matches!(
        command,
        Command::Reference(_)
            | Command::WheelReference(_)
            | Command::Goal { .. }
            | Command::Lane
            | Command::Route { .. }
            | Command::Waypoint(_)
    )
}

/// The command to go to the goal of a world that has one.
fn goal_of_world(setup: &Setup) -> Option<Command> {
    let goal_m = setup.world.goal_m?;
    Some(goal_seen_from(&setup.scenario.start, goal_m))
}

/// The goals of a world and an experiment, each once.
fn goals(setup: &Setup) -> Vec<[f32; 2]> {
    let mut goals = Vec::new();
    let commands = setup.scenario.commands.iter();
    let commands = commands.map(|timed| timed.command);
    for command in goal_of_world(setup).into_iter().chain(commands) {
        if let Command::Goal { x_m, y_m } = command
            && !goals.contains(&[x_m, y_m])
        {
            goals.push([x_m, y_m]);
        }
    }
    goals
}

/// The routes of an experiment.
fn routes(commands: &[TimedCommand]) -> Vec<RoutePlan> {
    let mut routes: Vec<RoutePlan> = Vec::new();
    for timed in commands {
        match (timed.command, routes.last_mut()) {
            (Command::Route { repeat, relative }, _) => routes.push(RoutePlan {
                repeat,
                relative,
                waypoints: Vec::new(),
            }),
            (Command::Waypoint(waypoint), Some(route)) => route.waypoints.push(waypoint.into()),
            _ => {}
        }
    }
    routes
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::mode::ModeId;
    use rumbo_experiment::files::Overrides;

    #[test]
    fn the_lab_begins_in_every_scenario_s_mode_and_never_armed_or_moving() {
        let library = Library::new();
        for name in library.list(Kind::Scenario) {
            let setup = library.setup(&name, &Overrides::default()).unwrap();
            let first = first_commands(&setup);
            assert_eq!(first[0], Command::Mode(setup.scenario.mode), "{name}");
            let starts = |command: &Command| matches!(command, Command::Arm | Command::Move { .. });
            assert!(!first.iter().any(starts), "{name}");
            // The station holds this many back at most.
            assert!(first.len() <= 64, "{name}");
        }
        let setup = library.setup("mode1", &Overrides::default()).unwrap();
        let expected = [
            Command::Mode(ModeId::FrontDistance),
            Command::Reference(0.3),
        ];
        assert_eq!(first_commands(&setup), expected);
        let setup = library.setup("mode8-random", &Overrides::default());
        let setup = setup.unwrap().of_seed(4).unwrap().into_owned();
        let first = first_commands(&setup);
        assert!(
            matches!(first[..], [Command::Mode(_), Command::Goal { .. }]),
            "{first:?}"
        );
    }
}
