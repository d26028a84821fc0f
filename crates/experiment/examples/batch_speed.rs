//! Robots in batches on the common task of `cargo xtask bench --only batch`: steps of 10 ms a second, memory per robot.
//!
//! An arena of 10 x 10 m with 20 boxes, three sonars, closed-loop avoidance. First the plant alone, with a few lines for a
//! program; then the whole control program in the same world, commanded by the caller and by a scenario over its link;
//! then several robots that share that world.
//! `batch_speed SECONDS` prints a line for each measurement: what, threads, value. What one thread does counts
//! by the processor's time (Linux), so that other work on the machine disturbs it less; `-wall` is by the clock on the wall.

use rumbo_control::mode::ModeId;
use rumbo_control::{ServoAngle, Wheels};
use rumbo_experiment::batch::{Batch, DrivenBy};
use rumbo_experiment::files::{FileError, Kind, Library, Overrides, Setup, fleet_around};
use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Event, Mount, Mounts, Plant, State};
use rumbo_plant::sonar::SonarId;
use rumbo_plant::world::World;
use rumbo_wire::Command;
use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

const ROBOTS: usize = 64;
/// Robots in one world; alone as any other.
const TEAMS: [usize; 3] = [1, 4, 16];
const TICK_US: u64 = 10_000;
/// Nearer than this the robot of the plant turns [m].
const NEAR_M: f64 = 0.6;

fn main() -> Result<(), Box<dyn Error>> {
    let seconds: u64 = match std::env::args().nth(1) {
        Some(text) => text.parse()?,
        None => 10,
    };
    let arena = arena()?;
    print("plant", 1, plant_alone(&arena, seconds)?.thread);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let (caller, scenario) = pool.install(|| -> Result<_, FileError> {
            Ok((commanded(&arena, seconds)?, by_scenario(&arena, seconds)?))
        })?;
        for (what, speed) in [("caller", caller), ("scenario", scenario)] {
            if threads == 1 {
                print(what, threads, speed.thread);
            }
            print(&format!("{what}-wall"), threads, speed.wall);
        }
    }
    for robots in TEAMS {
        let speed = together(&arena, robots, seconds)?;
        print(&format!("together-{robots}"), 1, speed.thread);
    }
    print("memory", 1, memory(&arena)?);
    Ok(())
}

fn print(what: &str, threads: usize, value: f64) {
    println!("{what} {threads} {value:.0}");
}

/// Steps a second: by the time of this thread on a processor, and by the clock on the wall.
struct Speed {
    thread: f64,
    wall: f64,
}

/// When a measurement began.
struct Start {
    wall: Instant,
    thread_s: Option<f64>,
}

impl Start {
    fn now() -> Self {
        Self {
            wall: Instant::now(),
            thread_s: thread_s(),
        }
    }

    /// After so many steps of each robot.
    fn speed(&self, steps: u64) -> Speed {
        self.speed_of(ROBOTS, steps)
    }

    fn speed_of(&self, robots: usize, steps: u64) -> Speed {
        let all = (robots as u64 * steps) as f64;
        let wall_s = self.wall.elapsed().as_secs_f64();
        let used_s = self.thread_s.zip(thread_s()).map(|(from, to)| to - from);
        Speed {
            thread: all / used_s.unwrap_or(wall_s),
            wall: all / wall_s,
        }
    }
}

/// Time of this thread on a processor.
fn thread_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(nanoseconds * 1e-9)
}

/// A robot that drives about the arena.
fn arena() -> Result<Setup, Box<dyn Error>> {
    let mut world =
        "title = \"20 boxes\"\n[arena]\nfrom_m = [-5.0, -5.0]\nto_m = [5.0, 5.0]\n".to_owned();
    for i in 0..20 {
        let (angle, away_m) = (2.4 * f64::from(i), 1.2 + 0.15 * f64::from(i));
        let (x, y) = (away_m * libm::cos(angle), away_m * libm::sin(angle));
        let degrees = (angle.to_degrees() + 180.0) % 360.0 - 180.0;
        write!(
            world,
            "[[box]]\ncentre_m = [{x}, {y}]\nsize_m = [0.4, 0.4]\nangle_deg = {degrees}\n"
        )?;
    }
    let scenario = "title = \"20 boxes\"\nrobot = \"memoria\"\nrig = \"final\"\nworld = \"arena\"\nmode = \"mission\"\nduration_s = 600\n\
                    [[command]]\nat_s = 0.1\ngoal_m = [4.7, -4.7]\n[[command]]\nat_s = 0.2\narm = true\n";
    let library = Library::new()
        .holding(Kind::World, "arena", &world)
        .holding(Kind::Scenario, "bench", scenario);
    Ok(library.setup("bench", &Overrides::default())?)
}

/// What the few lines know: when each line rose, and the last ranges.
#[derive(Clone, Copy)]
struct Eyes {
    rise_us: [u64; 3],
    range_m: [f64; 3],
}

fn robots(world: &World) -> Vec<(Plant, State, Eyes)> {
    let mount = |angle_rad| {
        Some(Mount {
            x_m: 0.1,
            y_m: 0.0,
            angle_rad,
            on_servo: false,
        })
    };
    let rig = Mounts {
        left: mount(0.785),
        right: mount(-0.785),
        front: mount(0.0),
        ..Mounts::default()
    };
    (0..ROBOTS as u64)
        .map(|seed| {
            let plant = Plant::new(rumbo_plant::plant::PlantSetup {
                params: Params::default().draw(seed, 0),
                rig,
                world: world.clone(),
                seed,
                robot: 0,
                wheels_in_air: false,
            });
            let start = Pose {
                heading_rad: seed as f64 % 6.0 - 3.0,
                ..Pose::default()
            };
            let state = plant.start(start);
            let eyes = Eyes {
                rise_us: [0; 3],
                range_m: [4.0; 3],
            };
            (plant, state, eyes)
        })
        .collect()
}

/// Steps a second of the plant, each robot with one ping a tick and wheels that turn it away from what is near.
fn plant_alone(arena: &Setup, seconds: u64) -> Result<Speed, Box<dyn Error>> {
    let mut robots = robots(&arena.world.world()?);
    let ticks = seconds * 100;
    let start = Start::now();
    for (plant, state, eyes) in &mut robots {
        for tick in 0..ticks {
            let [left_m, right_m, front_m] = eyes.range_m;
            let duties = match left_m.min(right_m).min(front_m) < NEAR_M {
                true if left_m > right_m => [Bridge::Backward(0.5), Bridge::Forward(0.6)],
                true => [Bridge::Forward(0.6), Bridge::Backward(0.5)],
                false => [Bridge::Forward(0.6 + 0.001 * (tick % 7) as f64); 2],
            };
            plant.set_bridge(state, Side::Left, duties[0]);
            plant.set_bridge(state, Side::Right, duties[1]);
            plant.trigger(state, SonarId::ALL[(tick % 3) as usize]);
            plant.advance(state, TICK_US, &mut |event| match event {
                Event::EchoRise { sonar, at_us } => eyes.rise_us[sonar.index()] = at_us,
                Event::EchoFall { sonar, at_us } => {
                    let high_us = (at_us - eyes.rise_us[sonar.index()]) as f64;
                    eyes.range_m[sonar.index()] = high_us * 171.5e-6;
                }
                _ => {}
            });
        }
    }
    Ok(start.speed(ticks))
}

/// Ticks a second of the whole control program, wheel speeds commanded by the caller ten times a second.
fn commanded(arena: &Setup, seconds: u64) -> Result<Speed, FileError> {
    let mut arena = arena.clone();
    arena.scenario.mode = ModeId::WheelSpeed;
    let mut batch = Batch::new(&arena, DrivenBy::Caller, &seeds(ROBOTS))?;
    batch.for_each(|_, group| {
        // A robot at its start obeys.
        let _ = group.robots_mut()[0].command(&Command::Arm);
    });
    let (mut known, mut truth) = (vec![0.0; ROBOTS * 14], vec![0.0; ROBOTS * 20]);
    let start = Start::now();
    for _ in 0..seconds * 10 {
        batch.step(&mut known, &mut truth, 10, |_, robots| {
            let robot = &mut robots[0];
            let [_, _, left_m, right_m, front_m, ..] = robot.observed();
            let (left, right) = match left_m.min(right_m).min(front_m) < NEAR_M as f32 {
                true if left_m > right_m => (-3.0, 3.0),
                true => (3.0, -3.0),
                false => (8.0, 8.0),
            };
            let _ = robot.command(&Command::WheelReference(Wheels { left, right }));
            robot.aim(Some(ServoAngle(0.0)));
            true
        });
    }
    Ok(start.speed(seconds * 100))
}

/// The same of mode 8 by the scenario's commands over the link.
fn by_scenario(arena: &Setup, seconds: u64) -> Result<Speed, FileError> {
    let mut batch = Batch::new(arena, DrivenBy::Scenario, &seeds(ROBOTS))?;
    let start = Start::now();
    batch.advance(seconds as u32 * 100);
    Ok(start.speed(seconds * 100))
}

/// The same of robots that share the world, as long as [`ROBOTS`] robots take one by one.
fn together(arena: &Setup, robots: usize, seconds: u64) -> Result<Speed, FileError> {
    let fleet = fleet_around(arena, robots)?;
    let library = Library::new()
        .holding(Kind::World, "arena", &arena.world.text)
        .holding(
            Kind::Scenario,
            "bench",
            &(arena.scenario.text.clone() + &fleet),
        );
    let setup = library.setup("bench", &Overrides::default())?;
    let rounds = ROBOTS / robots;
    let mut batch = Batch::new(&setup, DrivenBy::Scenario, &seeds(rounds))?;
    let start = Start::now();
    batch.advance(seconds as u32 * 100);
    Ok(start.speed_of(rounds * robots, seconds * 100))
}

/// Memory of a robot of a large batch [bytes], by what the process has resident (Linux).
fn memory(arena: &Setup) -> Result<f64, Box<dyn Error>> {
    let resident_kib = || -> Result<f64, Box<dyn Error>> {
        let status = std::fs::read_to_string("/proc/self/status")?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kib = line.and_then(|line| line.split_whitespace().next());
        Ok(kib.ok_or("no VmRSS in /proc/self/status")?.parse()?)
    };
    let count = 8_192;
    let before_kib = resident_kib()?;
    let batch = Batch::new(arena, DrivenBy::Caller, &seeds(count))?;
    let each = (resident_kib()? - before_kib) * 1024.0 / count as f64;
    drop(batch);
    Ok(each)
}

fn seeds(count: usize) -> Vec<u64> {
    (1..=count as u64).collect()
}
