//! What the dashboard draws around a simulated robot: world, footprint, sonars, and what could be chosen instead.

use rumbo_control::SonarId;
use rumbo_plant::contact::{Footprint, Pose};
use rumbo_plant::plant::Mount;
use rumbo_scenario::files::{FileError, Kind, Library, Setup};
use rumbo_station::{Choice, MapPose, Obstacle, Scene, SonarMount};

/// The scene of a setup.
pub(crate) fn scene(library: &Library, setup: &Setup, choice: Choice) -> Result<Scene, FileError> {
    let Setup {
        scenario,
        robot,
        rig,
        world,
        program: _,
    } = setup;
    let plant = &robot.plant;
    let obstacles = world
        .world()
        .map_err(|error| FileError::Setting(format!("world {}: {error}", world.name)))?;
    let obstacles = obstacles.obstacles().iter().map(|obstacle| {
        let corners_m: Vec<[f64; 2]> = obstacle.corners().collect();
        Obstacle {
            closed: corners_m.len() > 2,
            corners_m,
        }
    });
    let sonar = |id: SonarId, mount: Mount| SonarMount {
        id: id as u8,
        at: MapPose {
            x_m: mount.x_m,
            y_m: mount.y_m,
            heading_rad: mount.angle_rad,
        },
        half_angle_rad: plant.sonar.beam_half_angle_rad,
        reach_m: plant.sonar.reach_m,
        on_servo: mount.on_servo,
    };
    let mounts = [
        (SonarId::Left, rig.left),
        (SonarId::Right, rig.right),
        (SonarId::Front, rig.front),
    ];
    let footprint = Footprint::new(&plant.body, &plant.wheels);
    Ok(Scene {
        choice,
        scenarios: library.list(Kind::Scenario),
        worlds: library.list(Kind::World),
        robot: robot.name.clone(),
        start: MapPose {
            x_m: scenario.start.x_m,
            y_m: scenario.start.y_m,
            heading_rad: scenario.start.heading_rad,
        },
        obstacles: obstacles.collect(),
        footprint_m: footprint.corners(&Pose::default()).to_vec(),
        base_m: plant.body.base_m,
        wheel_radius_m: (plant.wheels.left.radius_m + plant.wheels.right.radius_m) / 2.0,
        sonars: mounts
            .into_iter()
            .filter_map(|(id, mount)| Some(sonar(id, mount?)))
            .collect(),
    })
}
