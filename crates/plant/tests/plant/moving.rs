//! Bodies that move: where they are, what sonars see of them, and how they meet the robot.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use proptest::prelude::*;
use rumbo_plant::cone::{Cone, Hearing, nearest};
use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::moving::{
    Body, BodyMotion, BodyVelocity, Course, MoverRepeat, MoverRoute, TimedWaypoint,
};
use rumbo_plant::plant::{Event, Mount, Mounts, Plant, PlantSetup};
use rumbo_plant::sonar::{Ping, SonarId};
use rumbo_plant::world::{Block, Point, ShapeError, Wall, World};

const S: u64 = 1_000_000;

fn at(x_m: f64, y_m: f64) -> Pose {
    Pose {
        x_m,
        y_m,
        heading_rad: 0.0,
    }
}

fn route(points: &[(u64, Pose)], repeat: MoverRepeat, start_us: u64) -> MoverRoute {
    let waypoints = points
        .iter()
        .map(|&(at_us, pose)| TimedWaypoint { at_us, pose })
        .collect();
    MoverRoute::new(waypoints, repeat, start_us).unwrap()
}

fn square(half_m: f64) -> Vec<Point> {
    [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]
        .map(|[x, y]: Point| [x * half_m, y * half_m])
        .to_vec()
}

fn with(bodies: Vec<Body>, walls: &[Wall]) -> World {
    let mut world = World::new(walls, &[]).unwrap();
    for body in bodies {
        world.add_body(body).unwrap();
    }
    world
}

/// A box of 20 cm that goes from one place to another at 1 m/s, and stays.
fn goes(from: Point, to: Point, start_us: u64) -> Body {
    let way_m = (to[0] - from[0]).hypot(to[1] - from[1]);
    let points = [
        (0, at(from[0], from[1])),
        ((way_m * 1e6).round() as u64, at(to[0], to[1])),
    ];
    Body::new(
        square(0.1),
        Course::Route(route(&points, MoverRepeat::Once, start_us)),
    )
    .unwrap()
}

fn plant(world: World) -> Plant {
    let front = Some(Mount {
        x_m: 0.11,
        ..Mount::default()
    });
    Plant::new(PlantSetup {
        rig: Mounts {
            front,
            ..Mounts::default()
        },
        world,
        seed: 3,
        ..PlantSetup::default()
    })
}

#[test]
fn a_route_is_gone_once_around_or_back_and_forth() {
    let there = [
        (0, at(0.0, 0.0)),
        (2 * S, at(2.0, 0.0)),
        (3 * S, at(2.0, 3.0)),
    ];
    let round = [
        (0, at(0.0, 0.0)),
        (2 * S, at(2.0, 0.0)),
        (4 * S, at(0.0, 0.0)),
    ];
    let body = |points: &[(u64, Pose)], repeat| {
        Body::new(square(0.1), Course::Route(route(points, repeat, S))).unwrap()
    };
    let where_is = |body: &Body, t_us| {
        let BodyMotion { pose, velocity } = body.at(t_us);
        ([pose.x_m, pose.y_m], velocity.m_s)
    };
    let once = body(&there, MoverRepeat::Once);
    assert_eq!(where_is(&once, S / 2), ([0.0, 0.0], [0.0, 0.0]), "not yet");
    assert_eq!(where_is(&once, 2 * S), ([1.0, 0.0], [1.0, 0.0]));
    assert_eq!(where_is(&once, 7 * S / 2), ([2.0, 1.5], [0.0, 3.0]));
    assert_eq!(where_is(&once, 9 * S), ([2.0, 3.0], [0.0, 0.0]), "it stays");
    let back = body(&there, MoverRepeat::BackAndForth);
    assert_eq!(where_is(&back, 9 * S / 2), ([2.0, 1.5], [0.0, -3.0]));
    assert_eq!(where_is(&back, 6 * S), ([1.0, 0.0], [-1.0, 0.0]));
    assert_eq!(where_is(&back, 8 * S), ([1.0, 0.0], [1.0, 0.0]));
    let loops = body(&round, MoverRepeat::Loop);
    assert_eq!(where_is(&loops, 4 * S), ([1.0, 0.0], [-1.0, 0.0]));
    assert_eq!(where_is(&loops, 6 * S), ([1.0, 0.0], [1.0, 0.0]));
    assert_eq!(once.fastest_m_s(), 3.0);
}

#[test]
fn what_is_no_route_is_refused() {
    let refused = |points: &[(u64, f64)], repeat| {
        let waypoints = points.iter().map(|&(at_us, x_m)| TimedWaypoint {
            at_us,
            pose: at(x_m, 0.0),
        });
        MoverRoute::new(waypoints.collect(), repeat, 0).unwrap_err()
    };
    for (points, repeat) in [
        (&[(0, 0.0)][..], MoverRepeat::Once),
        (&[(0, 0.0), (0, 1.0)], MoverRepeat::Once),
        (&[(1, 0.0), (2, 1.0)], MoverRepeat::Once),
        (&[(0, 0.0), (9, 1.0)], MoverRepeat::Loop),
    ] {
        assert_eq!(refused(points, repeat), ShapeError::NoRoute, "{points:?}");
    }
    let endless = [(0, 0.0), (1, f64::INFINITY)];
    assert_eq!(refused(&endless, MoverRepeat::Once), ShapeError::NotFinite);
    let mut world = World::empty();
    let body = goes([0.0, 0.0], [1.0, 0.0], 0);
    for _ in 0..63 {
        world.add_body(body.clone()).unwrap();
    }
    assert_eq!(world.add_body(body), Err(ShapeError::TooMany));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// The same answer, to rounding, as among boxes that stand where the bodies are at that instant.
    #[test]
    fn a_moving_box_echoes_like_one_that_stands_there(
        boxes in prop::collection::vec((prop::array::uniform3(-2.0..2.0_f64), prop::array::uniform3(-1.0..1.0_f64)), 1..6),
        standing in prop::array::uniform2(0.3..2.0_f64),
        axis_rad in -3.2..3.2_f64,
        now_us in 0..3_000_000_u64,
    ) {
        let stands = Block { center_m: standing, size_m: [0.3, 0.2], heading_rad: 0.4 };
        let mut moving = World::new(&[], &[stands]).unwrap();
        let mut still = moving.clone();
        for (place, speed) in boxes {
            let from = BodyMotion {
                pose: Pose { x_m: place[0], y_m: place[1], heading_rad: place[2] },
                velocity: BodyVelocity { m_s: [speed[0], speed[1]], yaw_rad_s: speed[2] },
            };
            let body = Body::new(square(0.15), Course::Straight { at_us: 0, from }).unwrap();
            let Pose { x_m, y_m, heading_rad } = body.at(now_us).pose;
            still.add_block(&Block { center_m: [x_m, y_m], size_m: [0.3, 0.3], heading_rad }).unwrap();
            moving.add_body(body).unwrap();
        }
        let cone = Cone { apex: [0.0, 0.0], axis_rad, half_angle_rad: 0.26 };
        let hearing = Hearing { reach_m: 2.5, incidence_limit_rad: 0.5, corner_reach_m: 0.6 };
        let of = |world: &World| nearest(world, now_us, &cone, &hearing).map(|echo| echo.range_m);
        match (of(&moving), of(&still)) {
            (Some(one), Some(other)) => prop_assert!((one - other).abs() < 1e-9, "{one} {other}"),
            (one, other) => prop_assert_eq!(one, other),
        }
    }
}

#[test]
fn a_ping_measures_a_body_where_it_is_at_that_instant() {
    let plant = plant(with(vec![goes([2.0, 0.0], [0.5, 0.0], 0)], &[]));
    let mut state = plant.start(Pose::default());
    for tenths in 0..10_u32 {
        let expected_m = 2.0 - 0.1 * f64::from(tenths) - 0.1 - 0.11;
        let seen_m = plant.truth(&state).range_m[SonarId::Front.index()].unwrap();
        assert!((seen_m - expected_m).abs() < 1e-9, "{seen_m} {expected_m}");
        let mut echo_us = [0; 2];
        assert!(plant.trigger(&mut state, SonarId::Front));
        let until_us = u64::from(tenths + 1) * 100_000;
        plant.advance(&mut state, until_us, &mut |event| match event {
            Event::EchoRise { at_us, .. } => echo_us[0] = at_us,
            Event::EchoFall { at_us, .. } => echo_us[1] = at_us,
            _ => {}
        });
        let heard_m = (echo_us[1] - echo_us[0]) as f64 * 1e-6 * 343.4 / 2.0;
        assert!(
            (heard_m - expected_m).abs() < 0.05,
            "{heard_m} {expected_m}"
        );
    }
}

#[test]
fn a_robot_that_stands_is_pushed_by_what_comes_and_says_how_fast() {
    let plant = plant(with(vec![goes([1.0, 0.0], [0.0, 0.0], 0)], &[]));
    let mut state = plant.start(Pose::default());
    let mut impacts = Vec::new();
    for ms in 1..=1_500 {
        plant.advance(&mut state, ms * 1_000, &mut |event| {
            if let Event::Contact {
                at_us,
                obstacle,
                speed_m_s,
            } = event
            {
                impacts.push((at_us, obstacle, speed_m_s));
            }
        });
        let truth = plant.truth(&state);
        let clearance_m = plant
            .footprint()
            .clearance_m(plant.world(), truth.now_us, &truth.pose);
        assert!(clearance_m > -1e-8, "{ms} ms: {clearance_m}");
    }
    let [(at_us, 0, speed_m_s)] = impacts[..] else {
        panic!("{impacts:?}");
    };
    assert!(
        at_us.abs_diff(770_000) <= 1_000,
        "its front is 0.13 m ahead: {at_us}"
    );
    assert!((speed_m_s - 1.0).abs() < 1e-9, "{speed_m_s}");
    let truth = plant.truth(&state);
    assert!((truth.pose.x_m + 0.23).abs() < 1e-6, "{truth:?}");
    assert!(truth.touching && truth.contacts == 1 && truth.wheel_rad_s == [0.0; 2]);
}

#[test]
fn what_goes_away_as_fast_as_the_robot_comes_is_met_softly() {
    let meets = |speed_m_s: f64| {
        let from = BodyMotion {
            pose: at(0.5, 0.0),
            velocity: BodyVelocity {
                m_s: [speed_m_s, 0.0],
                yaw_rad_s: 0.0,
            },
        };
        let body = Body::new(square(0.1), Course::Straight { at_us: 0, from }).unwrap();
        let plant = plant(with(vec![body], &[]));
        let mut state = plant.start(Pose::default());
        for side in [Side::Left, Side::Right] {
            plant.set_bridge(&mut state, side, Bridge::Forward(1.0));
        }
        let mut worst_m_s = 0.0_f64;
        plant.advance(&mut state, 10 * S, &mut |event| {
            if let Event::Contact { speed_m_s, .. } = event {
                worst_m_s = worst_m_s.max(speed_m_s);
            }
        });
        worst_m_s
    };
    let (towards, still, away) = (meets(-0.2), meets(0.0), meets(0.2));
    assert!(
        towards > still + 0.1 && still > away + 0.1 && away > 0.01,
        "{towards} {still} {away}"
    );
}

#[test]
fn a_second_body_is_another_contact_while_the_first_still_touches() {
    let bodies = vec![
        goes([1.0, 0.0], [0.22, 0.0], 0),
        goes([0.0, 1.5], [0.0, 0.15], 0),
    ];
    let plant = plant(with(bodies, &[]));
    let mut state = plant.start(Pose::default());
    let mut met = Vec::new();
    plant.advance(&mut state, 3 * S, &mut |event| {
        if let Event::Contact { obstacle, .. } = event {
            met.push(obstacle);
        }
    });
    assert_eq!(met, [0, 1]);
    assert_eq!(plant.truth(&state).contacts, 2);
}

#[test]
fn between_a_wall_and_what_comes_the_robot_stays_in_the_room() {
    let wall = Wall {
        from_m: [-0.3, -1.0],
        to_m: [-0.3, 1.0],
        thickness_m: 0.0,
    };
    let plant = plant(with(vec![goes([1.0, 0.0], [-1.0, 0.0], 0)], &[wall]));
    let mut state = plant.start(Pose::default());
    for ms in 1..=4_000 {
        plant.advance(&mut state, ms * 1_000, &mut |_| {});
        let pose = plant.truth(&state).pose;
        let least_m = plant
            .footprint()
            .corners(&pose)
            .iter()
            .map(|corner| corner[0])
            .fold(f64::MAX, f64::min);
        assert!(least_m >= -0.3 - 1e-8, "{ms} ms: {least_m}");
    }
}

#[test]
fn a_copy_of_the_state_meets_the_same_bodies() {
    let plant = plant(with(vec![goes([0.6, 0.05], [0.0, 0.0], S / 3)], &[]));
    let mut state = plant.start(Pose::default());
    plant.advance(&mut state, S / 2, &mut |_| {});
    let mut copy = state;
    plant.advance(&mut state, 2 * S, &mut |_| {});
    plant.advance(&mut copy, 2 * S, &mut |_| {});
    assert_eq!(state, copy);
    assert!(plant.truth(&state).contacts > 0);
}

/// Width of the echo pulse of a robot in an open space that pings at 0, in metres, beside pings of other robots.
fn pulse_m(world: World, pings: &[Ping]) -> f64 {
    let mut plant = plant(world);
    let mut state = plant.start(Pose::default());
    assert!(plant.trigger(&mut state, SonarId::Front));
    plant.receive_pings(&mut state, pings);
    let mut echo_us = [0; 2];
    plant.advance(&mut state, 60_000, &mut |event| match event {
        Event::EchoRise { at_us, .. } => echo_us[0] = at_us,
        Event::EchoFall { at_us, .. } => echo_us[1] = at_us,
        _ => {}
    });
    (echo_us[1] - echo_us[0]) as f64 * 1e-6 * 343.4 / 2.0
}

#[test]
fn a_burst_of_a_robot_that_looks_here_ends_the_pulse_at_half_its_way() {
    let ping = Ping {
        speaker: 5,
        number: 1,
        rise_us: 450,
        at: [1.11, 0.0],
        axis_rad: std::f64::consts::PI,
        range_m: None,
    };
    let alone_m = pulse_m(World::empty(), &[]);
    assert!(alone_m > 6.0, "no echo: {alone_m}");
    let heard_m = pulse_m(World::empty(), &[ping]);
    assert!((heard_m - 0.5).abs() < 0.01, "1 m of way: {heard_m}");
    let later = Ping {
        rise_us: 10_450,
        ..ping
    };
    let later_m = pulse_m(World::empty(), &[later]);
    assert!(
        (later_m - 0.5 - 1.717).abs() < 0.01,
        "10 ms later: {later_m}"
    );
    let away = Ping {
        axis_rad: 0.0,
        ..ping
    };
    assert_eq!(pulse_m(World::empty(), &[away]), alone_m, "it looks away");
    let beside = Ping {
        at: [0.11, 1.0],
        axis_rad: -std::f64::consts::FRAC_PI_2,
        ..ping
    };
    assert_eq!(
        pulse_m(World::empty(), &[beside]),
        alone_m,
        "this one looks elsewhere"
    );
    let behind_a_wall = Wall {
        from_m: [0.9, -1.0],
        to_m: [0.9, 1.0],
        thickness_m: 0.0,
    };
    let wall_m = pulse_m(with(vec![], &[behind_a_wall]), &[ping]);
    assert!(
        (wall_m - 0.79).abs() < 0.05,
        "the wall is in its way: {wall_m}"
    );
}
