//! How fast the plant is: `cargo run --release -p rumbo-plant --example speed`.
//!
//! Eight robots drive about a room with 20 boxes, first without pings, then with their three sonars at 50 pings a second.

use std::hint::black_box;
use std::time::Instant;

use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::plant::{Mount, Mounts, Plant, PlantSetup};
use rumbo_plant::sonar::SonarId;
use rumbo_plant::world::{Block, ShapeError, Wall, World};

const RUN_S: u64 = 400;
const ROBOTS: usize = 8;

fn main() -> Result<(), ShapeError> {
    let mount = |x_m, y_m, angle_rad| {
        Some(Mount {
            x_m,
            y_m,
            angle_rad,
            on_servo: false,
        })
    };
    let rig = Mounts {
        left: mount(0.05, 0.07, 1.57),
        right: mount(0.05, -0.07, -1.57),
        front: mount(0.11, 0.0, 0.0),
        ..Mounts::default()
    };
    let walls = [[5.0, 5.0], [-5.0, 5.0], [-5.0, -5.0], [5.0, -5.0]];
    let walls: Vec<Wall> = (0..4)
        .map(|i| Wall {
            from_m: walls[i],
            to_m: walls[(i + 1) % 4],
            thickness_m: 0.02,
        })
        .collect();
    let blocks: Vec<Block> = (0..20)
        .map(|i| {
            let (angle, away_m) = (2.4 * f64::from(i), 1.2 + 0.15 * f64::from(i));
            Block {
                center_m: [away_m * libm::cos(angle), away_m * libm::sin(angle)],
                size_m: [0.4, 0.4],
                heading_rad: angle,
            }
        })
        .collect();
    let world = World::new(&walls, &blocks)?;
    let plants: [Plant; ROBOTS] = std::array::from_fn(|seed| {
        Plant::new(PlantSetup {
            rig,
            world: world.clone(),
            seed: seed as u64,
            ..PlantSetup::default()
        })
    });
    for ping in [false, true] {
        measure(&plants, ping);
    }
    Ok(())
}

fn measure(plants: &[Plant; ROBOTS], ping: bool) {
    let mut robots = plants
        .each_ref()
        .map(|plant| (plant, plant.start(Pose::default())));
    let mut events = 0_u64;
    let started = Instant::now();
    for tick in 0..RUN_S * 100 {
        // Circles of about half a metre, each tick another duty as a controller would command.
        let ripple = 0.01 * (tick % 7) as f64;
        for (plant, state) in &mut robots {
            plant.set_bridge(state, Side::Left, Bridge::Forward(0.4 + ripple));
            plant.set_bridge(state, Side::Right, Bridge::Forward(0.6 - ripple));
            if ping && tick % 2 == 0 {
                plant.trigger(state, SonarId::ALL[(tick / 2 % 3) as usize]);
            }
        }
        for (plant, state) in &mut robots {
            plant.advance(state, 10_000, &mut |event| {
                events += u64::from(event.at_us() > 0);
            });
        }
    }
    let took_s = started.elapsed().as_secs_f64();
    let contacts = robots
        .each_ref()
        .map(|(plant, state)| plant.truth(state).contacts);
    let contacts: u32 = black_box(contacts).iter().sum();
    println!(
        "{:<12} {:6.1} ns per 1 ms step of a robot, {:6.0} x real time ({events} events, {contacts} contacts)",
        if ping { "50 pings/s:" } else { "no ping:" },
        took_s / (RUN_S * 1000 * ROBOTS as u64) as f64 * 1e9,
        (RUN_S * ROBOTS as u64) as f64 / took_s,
    );
}
