//! Where robots start: free of what is there, and of each other.

use super::{FileError, RobotFile, ScenarioFile, Setup, StartPose, WorldFile};
use rumbo_plant::contact::{Footprint, Pose};
use rumbo_plant::world::Obstacle;

/// Reports a start inside a wall, a box or something that moves.
pub(super) fn stands_free(
    scenario: &ScenarioFile,
    robot: &RobotFile,
    world: &WorldFile,
    alone: bool,
) -> Result<(), FileError> {
    let obstacles = world
        .world()
        .map_err(|error| FileError::Setting(format!("world {}: {error}", world.name)))?;
    let StartPose { x_m, y_m, .. } = scenario.start;
    if scenario.wheels_in_air {
        return Ok(());
    }
    let footprint = Footprint::new(&robot.plant.body, &robot.plant.wheels);
    let corners = footprint.corners(&pose(&scenario.start));
    let within =
        |outline: &Obstacle| Obstacle::convex(&corners).is_ok_and(|own| own.overlaps(outline));
    let inside = if obstacles.obstacles().iter().any(within) {
        "a wall or box".to_owned()
    } else {
        let mut bodies = obstacles.bodies().iter();
        let Some(index) = bodies.position(|body| within(&body.outline(&body.at(0).pose))) else {
            return Ok(());
        };
        world.movers[index].called(index)
    };
    let whose = match world.start {
        _ if !alone => format!("robot {}", scenario.name),
        Some(_) => format!("world {}", world.name),
        None => format!("scenario {}", scenario.name),
    };
    Err(FileError::Setting(format!(
        "{whose}: its start x_m = {x_m}, y_m = {y_m} is inside {inside} of world {}; move [start] or choose another world",
        world.name
    )))
}

/// Reports two robots that start inside each other, and a world that is another one for each seed.
pub(super) fn stand_apart(scenario: &str, fleet: &[Setup]) -> Result<(), FileError> {
    let refused = |text: String| Err(FileError::Setting(format!("scenario {scenario}: {text}")));
    let mut outlines: Vec<(&str, Obstacle)> = Vec::new();
    for setup in fleet {
        let (name, world) = (setup.scenario.name.as_str(), &setup.world);
        if world.random.is_some() {
            return refused(format!(
                "a fleet cannot use world {}, whose boxes differ with each seed; give it a world without [random]",
                world.name
            ));
        }
        let footprint = Footprint::new(&setup.robot.plant.body, &setup.robot.plant.wheels);
        let corners = footprint.corners(&pose(&setup.scenario.start));
        let Ok(outline) = Obstacle::convex(&corners) else {
            continue;
        };
        if let Some((other, _)) = outlines.iter().find(|(_, other)| other.overlaps(&outline)) {
            return refused(format!(
                "robots {other} and {name} start inside each other; move the start of one"
            ));
        }
        outlines.push((name, outline));
    }
    Ok(())
}

pub(super) fn pose(start: &StartPose) -> Pose {
    Pose {
        x_m: start.x_m,
        y_m: start.y_m,
        heading_rad: start.heading_rad,
    }
}

/// Distance between the places that are tried for a robot's start, in m.
const GRID_M: f64 = 0.5;

/// The entries of `[[fleet]]`, as text, that make so many robots of the scenario's one: the first at its start, the others
/// on a grid around it, free of walls, boxes, movers and each other, in the world's arena.
///
/// # Errors
/// The world has no room for so many.
pub fn fleet_around(setup: &Setup, robots: usize) -> Result<String, FileError> {
    let Setup {
        scenario,
        robot,
        world,
        ..
    } = setup;
    let StartPose {
        x_m,
        y_m,
        heading_rad,
    } = scenario.start;
    let obstacles = world
        .world()
        .map_err(|error| FileError::Setting(format!("world {}: {error}", world.name)))?;
    let footprint = Footprint::new(&robot.plant.body, &robot.plant.wheels);
    let steps = |from_m: f64, to_m: f64, at_m: f64| {
        let [first, last] = [from_m, to_m].map(|end_m| ((end_m - at_m) / GRID_M) as i32);
        first..=last
    };
    let [[left_m, low_m], [right_m, high_m]] = [world.arena.from_m, world.arena.to_m];
    let columns = steps(left_m, right_m, x_m);
    let mut places: Vec<(i32, i32)> = columns
        .flat_map(|column| steps(low_m, high_m, y_m).map(move |row| (column, row)))
        .collect();
    places.sort_by_key(|(column, row)| (column * column + row * row, *row, *column));
    let starts = places.into_iter().map(|(column, row)| Pose {
        x_m: x_m + GRID_M * f64::from(column),
        y_m: y_m + GRID_M * f64::from(row),
        heading_rad,
    });
    let bodies = obstacles.bodies().iter();
    let bodies = bodies.map(|body| body.outline(&body.at(0).pose));
    let standing = obstacles.obstacles().iter().cloned();
    let taken: Vec<Obstacle> = standing.chain(bodies).collect();
    let is_free = |at: &Pose| {
        let corners = footprint.corners(at);
        let inside = |[x_m, y_m]: &[f64; 2]| {
            (left_m..=right_m).contains(x_m) && (low_m..=high_m).contains(y_m)
        };
        let alone = |own: Obstacle| !taken.iter().any(|each| each.overlaps(&own));
        corners.iter().all(inside) && Obstacle::convex(&corners).is_ok_and(alone)
    };
    let free: Vec<Pose> = starts.filter(is_free).take(robots).collect();
    if free.len() < robots {
        return Err(FileError::Setting(format!(
            "world {}: has room for {} of {robots} robots; ask for fewer, or choose a larger world",
            world.name,
            free.len()
        )));
    }
    let entries = (1..).zip(free).map(|(number, Pose { x_m, y_m, heading_rad })| {
        let heading_deg = heading_rad.to_degrees();
        format!(
            "\n[[fleet]]\nname = \"robot{number}\"\nstart = {{ x_m = {x_m:?}, y_m = {y_m:?}, heading_deg = {heading_deg:?} }}\n"
        )
    });
    Ok(entries.collect())
}
