//! The common task of `cargo xtask bench --only batch` in rapier2d, without noise: a robot avoids 20 boxes in an arena of
//! 10 x 10 m by three rays read at every step of 10 ms.
//!
//! `rumbo-rapier ROBOTS STEPS` prints the steps a second of all robots, each in a world of its own, on one thread by its time on a processor.

use rapier2d::prelude::*;
use std::process::ExitCode;
use std::time::SystemTime;

/// Directions of the rays from the front [rad].
const RAYS: [f32; 3] = [
    std::f32::consts::FRAC_PI_4,
    0.0,
    -std::f32::consts::FRAC_PI_4,
];
const REACH_M: f32 = 4.0;
/// Nearer than this the robot turns [m].
const NEAR_M: f32 = 0.6;

#[derive(Default)]
struct Robot {
    pipeline: PhysicsPipeline,
    parameters: IntegrationParameters,
    islands: IslandManager,
    broad_phase: BroadPhaseBvh,
    narrow_phase: NarrowPhase,
    bodies: RigidBodySet,
    colliders: ColliderSet,
    joints: ImpulseJointSet,
    multibody_joints: MultibodyJointSet,
    soft_bodies: SoftBodySet,
    ccd: CCDSolver,
    body: RigidBodyHandle,
}

impl Robot {
    fn new(number: usize) -> Self {
        let mut robot = Self::default();
        robot.parameters.dt = 0.01;
        for [x, y, half_x, half_y] in [
            [5.0, 0.0, 0.01, 5.0],
            [-5.0, 0.0, 0.01, 5.0],
            [0.0, 5.0, 5.0, 0.01],
            [0.0, -5.0, 5.0, 0.01],
        ] {
            let wall = ColliderBuilder::cuboid(half_x, half_y);
            robot.colliders.insert(wall.translation(Vector::new(x, y)));
        }
        for i in 0..20 {
            let (angle, away_m) = (2.4 * i as f32, 1.2 + 0.15 * i as f32);
            let at = Vector::new(away_m * angle.cos(), away_m * angle.sin());
            let block = ColliderBuilder::cuboid(0.2, 0.2);
            robot
                .colliders
                .insert(block.translation(at).rotation(angle));
        }
        let body = RigidBodyBuilder::dynamic().rotation(number as f32);
        robot.body = robot.bodies.insert(body);
        let shape = ColliderBuilder::cuboid(0.11, 0.08);
        robot
            .colliders
            .insert_with_parent(shape, robot.body, &mut robot.bodies);
        robot
    }

    fn step(&mut self) {
        self.pipeline.step(
            Vector::new(0.0, 0.0),
            &self.parameters,
            &mut self.islands,
            &mut self.broad_phase,
            &mut self.narrow_phase,
            &mut self.bodies,
            &mut self.colliders,
            &mut self.joints,
            &mut self.multibody_joints,
            &mut self.soft_bodies,
            &mut self.ccd,
            &(),
            &(),
        );
        let body = &self.bodies[self.body];
        let (at, heading) = (body.translation(), body.rotation().angle());
        let query = self.broad_phase.as_query_pipeline(
            self.narrow_phase.query_dispatcher(),
            &self.bodies,
            &self.colliders,
            QueryFilter::new().exclude_rigid_body(self.body),
        );
        let [left, front, right] = RAYS.map(|angle| {
            let (s, c) = (heading + angle).sin_cos();
            let hit = query.cast_ray(&Ray::new(at, Vector::new(c, s)), REACH_M, true);
            hit.map_or(REACH_M, |(_, range_m)| range_m)
        });
        let nearest = left.min(front).min(right);
        let (speed, turn) = match nearest < NEAR_M {
            true if left > right => (0.1, 2.0),
            true => (0.1, -2.0),
            false => (0.3, 0.0),
        };
        let (s, c) = heading.sin_cos();
        let body = &mut self.bodies[self.body];
        body.set_linvel(Vector::new(speed * c, speed * s), true);
        body.set_angvel(turn, true);
    }
}

fn main() -> ExitCode {
    let mut counts = std::env::args().skip(1).map(|count| count.parse::<usize>());
    let (Some(Ok(robots)), Some(Ok(steps))) = (counts.next(), counts.next()) else {
        eprintln!("rumbo-rapier: give the number of robots and of steps");
        return ExitCode::FAILURE;
    };
    let mut robots: Vec<Robot> = (0..robots).map(Robot::new).collect();
    let start = now_s();
    for _ in 0..steps {
        robots.iter_mut().for_each(Robot::step);
    }
    let all = (robots.len() * steps) as f64;
    println!("{:.0}", all / (now_s() - start));
    ExitCode::SUCCESS
}

/// Time of this thread on a processor; where there is none, that of the system's clock.
fn now_s() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let used = text.split_whitespace().next();
    let nanoseconds = used.and_then(|text| text.parse::<f64>().ok());
    let since_1970 = || SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
    nanoseconds.map_or_else(
        || since_1970().as_secs_f64(),
        |nanoseconds| nanoseconds * 1e-9,
    )
}
