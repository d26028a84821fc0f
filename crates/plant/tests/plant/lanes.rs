//! Plants in lanes have the bits of plants stepped one by one.

#![allow(clippy::unwrap_used)]

use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::lanes::{LANES, Lane, Lanes};
use rumbo_plant::moving::{Body, Course, Motion, Velocity};
use rumbo_plant::noise::Noise;
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Event, Mount, Plant, Rig, Setup, State};
use rumbo_plant::sonar::SonarId;
use rumbo_plant::world::{Block, Wall, World};

/// Dice for what the test does.
struct Dice {
    noise: Noise,
    thrown: u64,
}

impl Dice {
    fn unit(&mut self) -> f64 {
        self.thrown += 1;
        self.noise.uniform(9_999, self.thrown)
    }

    fn below(&mut self, count: u64) -> u64 {
        (self.unit() * count as f64) as u64
    }

    fn bridge(&mut self) -> Bridge {
        let duty = match self.below(4) {
            0 => 1.0,
            // Often too little to turn the wheel.
            1 => 0.3 * self.unit(),
            _ => self.unit(),
        };
        match self.below(10) {
            0 => Bridge::Released,
            1 => Bridge::Brake(duty),
            2 => Bridge::Backward(duty),
            _ => Bridge::Forward(duty),
        }
    }
}

/// Boxes all around, so that the robot touches them.
fn crowded(dice: &mut Dice) -> World {
    let mut world = World::empty();
    let corners = [[1.5, 1.5], [-1.5, 1.5], [-1.5, -1.5], [1.5, -1.5]];
    for i in 0..4 {
        let (from_m, to_m) = (corners[i], corners[(i + 1) % 4]);
        let thickness_m = 0.02;
        world
            .add_wall(&Wall {
                from_m,
                to_m,
                thickness_m,
            })
            .unwrap();
    }
    for i in 0..8 {
        let (angle, away_m) = (0.8 * f64::from(i), 0.5 + 0.8 * dice.unit());
        world
            .add_block(&Block {
                center_m: [away_m * libm::cos(angle), away_m * libm::sin(angle)],
                size_m: [0.2, 0.3],
                heading_rad: 3.0 * dice.unit(),
            })
            .unwrap();
    }
    world
}

fn rig(dice: &mut Dice) -> Rig {
    let mut mount = |x_m, y_m, angle_rad, on_servo| {
        (dice.below(5) > 0).then_some(Mount {
            x_m,
            y_m,
            angle_rad,
            on_servo,
        })
    };
    Rig {
        left: mount(0.05, 0.07, 1.57, false),
        right: mount(-0.04, 0.07, 1.57, false),
        front: mount(0.11, 0.0, 0.0, true),
    }
}

/// What one robot of a group has that the others have not.
#[derive(Clone, Copy, PartialEq)]
enum Odd {
    No,
    /// Its wheels are off the floor.
    HeldUp,
    /// Something moves about in its world.
    Visited,
}

/// A body that comes through the robot's place.
fn visitor() -> Body {
    let corners = vec![[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]];
    let from = Motion {
        pose: Pose {
            x_m: -0.8,
            ..Pose::default()
        },
        velocity: Velocity {
            m_s: [0.4, 0.0],
            yaw_rad_s: 0.3,
        },
    };
    Body::new(corners, Course::Straight { at_us: 0, from }).unwrap()
}

/// A robot of a seed, some of them out of the ordinary.
fn robot(seed: u64, odd: Odd) -> (Plant, State) {
    let mut dice = Dice {
        noise: Noise::new(seed, 77),
        thrown: 0,
    };
    let mut params = Params::default().draw(seed, 0);
    match dice.below(7) {
        0 => params.floor.yaw_damping_n_m_s = 0.0,
        1 => params.floor.yaw_damping_n_m_s = 0.02,
        2 => params.floor.slip_length_m = 0.0005,
        3 => params.floor.roughness = 0.5,
        4 => params.battery.open_circuit_v = 7.001,
        5 => {
            let [left, right] = [&mut params.wheels.left, &mut params.wheels.right];
            (left.onset_ratio, right.onset_ratio) = (0.4, 0.7);
            (left.onset_rad, right.onset_rad) = (1.4, 0.05);
            (left.onset_rest_s, right.onset_rest_s) = (0.001, 0.3);
        }
        _ => {}
    }
    let mut world = match dice.below(3) {
        0 => World::empty(),
        _ => crowded(&mut dice),
    };
    if odd == Odd::Visited {
        world.add_body(visitor()).unwrap();
    }
    let plant = Plant::new(Setup {
        params,
        rig: rig(&mut dice),
        world,
        seed,
        robot: 0,
        wheels_in_air: odd == Odd::HeldUp,
    });
    // Anywhere in a turn, and just where libm reduces its argument in another way.
    let heading_rad = match dice.below(8) {
        0 => 0.0,
        1 => -0.0,
        2 => std::f64::consts::FRAC_PI_2,
        3 => std::f64::consts::PI,
        4 => -std::f64::consts::FRAC_PI_4,
        _ => 6.0 * dice.unit() - 3.0,
    };
    let mut state = plant.start(Pose {
        x_m: 0.0,
        y_m: 0.0,
        heading_rad,
    });
    // Robots of a group differ by whole milliseconds.
    plant.advance(&mut state, 1_000 * dice.below(30), &mut |_| {});
    (plant, state)
}

fn command(dice: &mut Dice, plant: &Plant, state: &mut State) {
    for side in [Side::Left, Side::Right] {
        if dice.below(40) == 0 {
            plant.set_bridge(state, side, dice.bridge());
        }
    }
    if dice.below(20) == 0 {
        plant.set_servo(state, 3.0 * dice.unit() - 1.5);
    }
    if dice.below(3) == 0 {
        plant.trigger(state, SonarId::ALL[dice.below(3) as usize]);
    }
}

/// Drives a group and its scalar twins by the same dice for so many steps, and gives how many events and touches there were.
fn compare(lanes: Lanes, seed: u64, odd: Odd, steps: u32) -> (usize, u32) {
    let mut robots: [(Plant, State); LANES] =
        std::array::from_fn(|i| robot(seed + i as u64, if i == 3 { odd } else { Odd::No }));
    let mut twins = robots.each_ref().map(|(_, state)| *state);
    let mut dice = Dice {
        noise: Noise::new(seed, 78),
        thrown: 0,
    };
    let mut count = 0;
    for step in 0..steps {
        for ((plant, state), twin) in robots.iter_mut().zip(&mut twins) {
            let thrown = dice.thrown;
            command(&mut dice, plant, state);
            dice.thrown = thrown;
            command(&mut dice, plant, twin);
        }
        let for_us = [3_000, 7_000, 10_000, 137, 863, 1, 999][dice.below(7) as usize];
        let mut events: [Vec<Event>; LANES] = Default::default();
        let mut group: [Lane<'_>; LANES] = robots.each_mut().map(|(plant, state)| (&*plant, state));
        lanes.advance(&mut group, for_us, &mut |i, event| events[i].push(event));
        for (i, (plant, state)) in robots.iter().enumerate() {
            let mut expected = Vec::new();
            let until_us = twins[i].now_us() + for_us;
            plant.advance(&mut twins[i], until_us, &mut |event| expected.push(event));
            let place = || format!("{} seed {seed}, robot {i}, step {step}", lanes.name());
            assert_eq!(events[i], expected, "{}", place());
            assert_eq!(*state, twins[i], "{}", place());
            if step % 20 == 0 {
                // As text, so that 0 and -0 differ.
                let text = |state: &State| format!("{state:?}");
                assert_eq!(text(state), text(&twins[i]), "{}", place());
            }
            count += expected.len();
        }
    }
    let touches = (robots.iter().zip(&twins)).map(|((plant, _), twin)| plant.truth(twin).contacts);
    (count, touches.sum())
}

/// More seeds than usual: `RUMBO_LANES_SEEDS=100`.
fn seeds() -> u64 {
    let more = std::env::var("RUMBO_LANES_SEEDS").ok();
    more.and_then(|count| count.parse().ok()).unwrap_or(6)
}

#[test]
fn a_robot_in_a_lane_is_bit_for_bit_the_one_alone() {
    for lanes in Lanes::all() {
        let mut all = (0, 0);
        for seed in 1..=seeds() {
            let (events, touches) = compare(lanes, 1_000 * seed, Odd::No, 1_500);
            all = (all.0 + events, all.1 + touches);
        }
        println!("{}: {} events, {} touches", lanes.name(), all.0, all.1);
        assert!(
            all.0 > 10_000 && all.1 > 10,
            "{all:?}: they drove and touched"
        );
    }
}

#[test]
fn a_group_with_an_odd_robot_is_that_of_robots_alone() {
    for lanes in Lanes::all() {
        for odd in [Odd::HeldUp, Odd::Visited] {
            assert!(compare(lanes, 5, odd, 600).0 > 1_000);
        }
    }
}

#[test]
fn robots_at_different_places_within_a_millisecond_go_one_by_one() {
    for lanes in Lanes::all() {
        let (plant, start) = robot(1, Odd::No);
        let (mut states, mut twin) = ([start; LANES], start);
        plant.advance(&mut states[5], start.now_us() + 300, &mut |_| {});
        let mut group: [Lane<'_>; LANES] = states.each_mut().map(|state| (&plant, state));
        lanes.advance(&mut group, 1_700, &mut |_, _| {});
        plant.advance(&mut twin, start.now_us() + 300, &mut |_| {});
        plant.advance(&mut twin, start.now_us() + 2_000, &mut |_| {});
        assert_eq!(states[5], twin);
    }
}
