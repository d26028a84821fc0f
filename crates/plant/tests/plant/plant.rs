//! The assembled robot: time, events, contact, sonars.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use std::thread;

use rumbo_plant::contact::Pose;
use rumbo_plant::drivetrain::{Bridge, Side};
use rumbo_plant::params::Params;
use rumbo_plant::plant::{Event, GroundTruth, Mount, Mounts, Plant, PlantSetup, State};
use rumbo_plant::sonar::SonarId;
use rumbo_plant::world::{Block, Wall, World};

const FRONT: Mount = Mount {
    x_m: 0.11,
    y_m: 0.0,
    angle_rad: 0.0,
    on_servo: true,
};
const LEFT: Mount = Mount {
    x_m: 0.05,
    y_m: 0.07,
    angle_rad: std::f64::consts::FRAC_PI_2,
    on_servo: false,
};
const RIGHT: Mount = Mount {
    x_m: 0.05,
    y_m: -0.07,
    angle_rad: -std::f64::consts::FRAC_PI_2,
    on_servo: false,
};

fn final_rig() -> Mounts {
    Mounts {
        left: Some(LEFT),
        right: Some(RIGHT),
        front: Some(FRONT),
        ..Mounts::default()
    }
}

fn wall_at(x_m: f64) -> World {
    World::new(
        &[Wall {
            from_m: [x_m, -5.0],
            to_m: [x_m, 5.0],
            thickness_m: 0.0,
        }],
        &[],
    )
    .unwrap()
}

fn plant(world: World, seed: u64) -> Plant {
    Plant::new(PlantSetup {
        rig: final_rig(),
        world,
        seed,
        ..PlantSetup::default()
    })
}

fn drive(plant: &Plant, state: &mut State, left: f64, right: f64) {
    for (side, duty) in [(Side::Left, left), (Side::Right, right)] {
        let bridge = if duty >= 0.0 {
            Bridge::Forward(duty)
        } else {
            Bridge::Backward(-duty)
        };
        plant.set_bridge(state, side, bridge);
    }
}

fn room() -> World {
    let mut walls = Vec::new();
    for (from_m, to_m) in [
        ([-2.0, -2.0], [2.0, -2.0]),
        ([2.0, -2.0], [2.0, 2.0]),
        ([2.0, 2.0], [-2.0, 2.0]),
        ([-2.0, 2.0], [-2.0, -2.0]),
    ] {
        walls.push(Wall {
            from_m,
            to_m,
            thickness_m: 0.02,
        });
    }
    let blocks: Vec<Block> = (0..20)
        .map(|i| {
            let angle = f64::from(i) * 0.7;
            let away = 0.6 + 0.06 * f64::from(i);
            Block {
                center_m: [away * angle.cos(), away * angle.sin()],
                size_m: [0.2, 0.3],
                heading_rad: angle,
            }
        })
        .collect();
    World::new(&walls, &blocks).unwrap()
}

/// A drive about a cluttered room: the bits of everything that happened.
fn eventful_run(seed: u64) -> (Vec<Event>, GroundTruth) {
    let plant = Plant::new(PlantSetup {
        params: Params::default().draw(seed, 0),
        rig: final_rig(),
        world: room(),
        seed,
        ..PlantSetup::default()
    });
    let mut state = plant.start(Pose::default());
    let mut events = Vec::new();
    for tick in 0..600_u64 {
        let phase = (tick / 60) % 4;
        let (left, right) = [(0.6, 0.6), (0.7, 0.5), (-0.6, -0.5), (0.5, 0.7)][phase as usize];
        drive(&plant, &mut state, left, right);
        plant.set_servo(&mut state, if phase % 2 == 0 { 0.8 } else { -0.8 });
        if tick % 3 == 0 {
            plant.trigger(&mut state, SonarId::ALL[(tick / 3 % 3) as usize]);
        }
        plant.advance(&mut state, (tick + 1) * 10_000, &mut |event| {
            events.push(event)
        });
    }
    (events, plant.truth(&state))
}

#[test]
fn the_same_seed_gives_the_same_bits_on_one_thread_and_on_four() {
    let alone: Vec<_> = (0..4).map(eventful_run).collect();
    let together: Vec<_> = thread::scope(|scope| {
        let handles: Vec<_> = (0..4)
            .map(|seed| scope.spawn(move || eventful_run(seed)))
            .collect();
        handles
            .into_iter()
            .map(|handle| handle.join().unwrap())
            .collect()
    });
    assert_eq!(alone, together);
    assert_ne!(alone[0].0, alone[1].0, "another seed is another run");
}

#[test]
fn events_come_in_the_order_of_time_and_echo_lines_alternate() {
    let (events, truth) = eventful_run(5);
    assert!(
        events
            .windows(2)
            .all(|pair| pair[0].at_us() <= pair[1].at_us())
    );
    assert!(
        events
            .iter()
            .any(|event| matches!(event, Event::Edge { .. }))
    );
    for id in SonarId::ALL.into_iter().take(3) {
        let levels: Vec<bool> = events
            .iter()
            .filter_map(|event| match *event {
                Event::EchoRise { sonar, .. } if sonar == id => Some(true),
                Event::EchoFall { sonar, .. } if sonar == id => Some(false),
                _ => None,
            })
            .collect();
        assert!(levels.len() > 50);
        assert!(levels.windows(2).all(|pair| pair[0] != pair[1]));
    }
    let contacts = events
        .iter()
        .filter(|event| matches!(event, Event::Contact { .. }))
        .count();
    assert_eq!(contacts, truth.contacts as usize);
}

#[test]
fn edges_count_the_angle_that_the_wheels_turned() {
    let plant = plant(World::empty(), 3);
    let mut state = plant.start(Pose::default());
    let before = plant.truth(&state).wheel_rad;
    drive(&plant, &mut state, 0.9, 0.7);
    let mut edges = [0_u32; 2];
    plant.advance(&mut state, 2_000_000, &mut |event| {
        if let Event::Edge { wheel, .. } = event {
            edges[wheel.index()] += 1;
        }
    });
    let after = plant.truth(&state).wheel_rad;
    for i in 0..2 {
        let turned = (after[i] - before[i]) * 384.0 / std::f64::consts::TAU;
        assert!(
            (f64::from(edges[i]) - turned).abs() <= 1.2,
            "{turned} {}",
            edges[i]
        );
        assert!(turned > 50.0);
    }
}

#[test]
fn stopping_more_often_on_the_way_changes_little() {
    let run = |stride_us: u64| {
        let plant = plant(World::empty(), 4);
        let mut state = plant.start(Pose::default());
        drive(&plant, &mut state, 0.6, 0.5);
        let mut now_us = 0;
        while now_us < 3_000_000 {
            now_us += stride_us;
            plant.advance(&mut state, now_us, &mut |_| {});
        }
        plant.truth(&state)
    };
    let (whole, split) = (run(100_000), run(300));
    let apart_m = (whole.pose.x_m - split.pose.x_m).hypot(whole.pose.y_m - split.pose.y_m);
    assert!(apart_m < 0.005, "{apart_m}");
    assert!((whole.pose.heading_rad - split.pose.heading_rad).abs() < 0.02);
    assert_eq!(run(1_000), run(1_000));
    assert_eq!(run(1_000), run(5_000), "whole milliseconds are no split");
}

/// Drives at a wall with full duty, from `angle_rad` off its normal; checks every step that no corner is beyond it.
fn crash(angle_rad: f64, duty: f64) -> (GroundTruth, Vec<f64>) {
    let plant = plant(wall_at(1.0), 6);
    let pose = Pose {
        heading_rad: angle_rad,
        ..Pose::default()
    };
    let mut state = plant.start(pose);
    drive(&plant, &mut state, duty, duty);
    let mut impacts = Vec::new();
    for ms in 1..=6_000 {
        plant.advance(&mut state, ms * 1_000, &mut |event| {
            if let Event::Contact { speed_m_s, .. } = event {
                impacts.push(speed_m_s);
            }
        });
        let farthest_m = plant
            .footprint()
            .corners(&plant.truth(&state).pose)
            .iter()
            .map(|c| c[0])
            .fold(f64::MIN, f64::max);
        assert!(farthest_m <= 1.0 + 1e-6, "{farthest_m} at {ms} ms");
    }
    (plant.truth(&state), impacts)
}

#[test]
fn at_full_speed_the_robot_stops_at_a_thin_wall() {
    let (truth, impacts) = crash(0.0, 1.0);
    assert_eq!(truth.contacts, 1);
    assert!(truth.touching);
    assert!(impacts[0] > 0.2, "{impacts:?}");
    assert!(
        truth.forward_m_s.abs() < 0.02,
        "its wheels spin at 0.3 m/s, it jerks at most: {truth:?}"
    );
    assert!(
        (truth.pose.x_m - 0.87).abs() < 1e-3,
        "0.13 m from the axis to the front: {}",
        truth.pose.x_m
    );
    let (slow, slow_impacts) = crash(0.0, 0.5);
    assert_eq!(slow.contacts, 1);
    assert!(slow_impacts[0] < impacts[0]);
}

#[test]
fn a_robot_that_meets_a_wall_at_an_angle_slides_along_it() {
    let (truth, _) = crash(0.9, 0.7);
    assert!(truth.pose.y_m > 0.6, "{truth:?}");
    assert!(
        truth.pose.heading_rad > 0.9,
        "it swings round towards the wall's direction: {truth:?}"
    );
}

#[test]
fn a_robot_that_blunders_about_a_cluttered_room_never_overlaps_anything() {
    let mut contacts = 0;
    for seed in 0..6 {
        let plant = plant(room(), seed);
        let choice = rumbo_plant::noise::Noise::new(seed, 9);
        let mut state = plant.start(Pose::default());
        for tick in 0..3_000_u64 {
            if tick % 50 == 0 {
                let duty = |wheel| 2.4 * choice.uniform(wheel, tick) - 1.0;
                drive(&plant, &mut state, duty(0), duty(1));
            }
            plant.advance(&mut state, (tick + 1) * 10_000, &mut |_| {});
            let truth = plant.truth(&state);
            let clearance_m =
                plant
                    .footprint()
                    .clearance_m(plant.world(), truth.now_us, &truth.pose);
            assert!(
                clearance_m > -1e-8,
                "seed {seed}, tick {tick}: {clearance_m}"
            );
            contacts = contacts.max(truth.contacts);
        }
    }
    assert!(contacts > 5, "it met things: {contacts}");
}

#[test]
fn the_wheels_feel_the_wall() {
    let plant = plant(wall_at(0.3), 6);
    let free = {
        let mut state = plant.start(Pose {
            heading_rad: std::f64::consts::PI,
            ..Pose::default()
        });
        drive(&plant, &mut state, 0.6, 0.6);
        plant.advance(&mut state, 3_000_000, &mut |_| {});
        plant.truth(&state)
    };
    let blocked = {
        let mut state = plant.start(Pose::default());
        drive(&plant, &mut state, 0.6, 0.6);
        plant.advance(&mut state, 3_000_000, &mut |_| {});
        plant.truth(&state)
    };
    assert!(blocked.touching);
    assert!(
        blocked.wheel_rad_s[0] < 0.8 * free.wheel_rad_s[0],
        "{blocked:?} {free:?}"
    );
}

#[test]
fn a_robot_backs_off_a_wall_it_hit() {
    let plant = plant(wall_at(0.3), 8);
    let mut state = plant.start(Pose::default());
    drive(&plant, &mut state, 0.8, 0.8);
    plant.advance(&mut state, 1_500_000, &mut |_| {});
    assert!(plant.truth(&state).touching);
    drive(&plant, &mut state, -0.8, -0.8);
    plant.advance(&mut state, 3_000_000, &mut |_| {});
    let truth = plant.truth(&state);
    assert!(!truth.touching && truth.contacts == 1);
    assert!(truth.pose.x_m < -0.1, "{truth:?}");
}

#[test]
fn with_the_wheels_in_the_air_they_turn_and_the_body_stays() {
    let plant = Plant::new(PlantSetup {
        wheels_in_air: true,
        ..PlantSetup::default()
    });
    let mut state = plant.start(Pose::default());
    drive(&plant, &mut state, 0.5, -0.5);
    plant.advance(&mut state, 2_000_000, &mut |_| {});
    let truth = plant.truth(&state);
    assert_eq!(truth.pose, Pose::default());
    assert!(truth.wheel_rad_s[0] > 1.0 && truth.wheel_rad_s[1] < -1.0);
}

#[test]
fn the_front_sonar_looks_where_the_servo_has_got_to() {
    let plant = plant(wall_at(0.8), 2);
    let mut state = plant.start(Pose::default());
    let ahead = plant.truth(&state).range_m[2].unwrap();
    assert!((ahead - 0.69).abs() < 1e-9);
    plant.set_servo(&mut state, 1.5);
    plant.advance(&mut state, 1_000, &mut |_| {});
    assert!(
        plant.truth(&state).range_m[2] < Some(f64::INFINITY),
        "the servo has hardly moved"
    );
    plant.advance(&mut state, 500_000, &mut |_| {});
    assert_eq!(
        plant.truth(&state).range_m[2],
        Some(f64::INFINITY),
        "it looks along the wall now"
    );
}

#[test]
fn a_ping_takes_its_round_trip_and_blocks_only_itself() {
    let plant = plant(wall_at(1.0), 2);
    let mut state = plant.start(Pose::default());
    assert!(plant.trigger(&mut state, SonarId::Front));
    assert!(
        !plant.trigger(&mut state, SonarId::Front),
        "its line is about to rise"
    );
    assert!(
        plant.trigger(&mut state, SonarId::Left),
        "another one is free"
    );
    let mut events = Vec::new();
    plant.advance(&mut state, 60_000, &mut |event| events.push(event));
    let time = |wanted: SonarId, rise: bool| {
        events
            .iter()
            .find_map(|event| match *event {
                Event::EchoRise { sonar, at_us } if rise && sonar == wanted => Some(at_us),
                Event::EchoFall { sonar, at_us } if !rise && sonar == wanted => Some(at_us),
                _ => None,
            })
            .unwrap()
    };
    assert_eq!(time(SonarId::Front, true), 450);
    let pulse_us = (time(SonarId::Front, false) - 450) as f64;
    let round_trip_us = 2.0 * 0.89 / (331.3 + 0.606 * 20.0) * 1e6;
    assert!(
        (pulse_us - round_trip_us).abs() < 200.0,
        "{pulse_us} {round_trip_us}"
    );
    assert_eq!(
        time(SonarId::Left, false) - time(SonarId::Left, true),
        38_000,
        "nothing on the left: time-out"
    );
    assert!(plant.trigger(&mut state, SonarId::Left), "free again");
}

#[test]
fn a_weak_robot_that_stalled_at_a_wall_backs_off() {
    let mut params = Params::default();
    params.motor.resistance_ohm = 12.0;
    params.battery.open_circuit_v = 6.0;
    let plant = Plant::new(PlantSetup {
        params,
        world: wall_at(0.3),
        ..PlantSetup::default()
    });
    let mut state = plant.start(Pose::default());
    let both = |state: &mut State, bridge| {
        plant.set_bridge(state, Side::Left, bridge);
        plant.set_bridge(state, Side::Right, bridge);
    };
    both(&mut state, Bridge::Forward(1.0));
    plant.advance(&mut state, 2_000_000, &mut |_| {});
    assert_eq!(
        plant.truth(&state).wheel_rad_s,
        [0.0; 2],
        "its tyres do not slip"
    );
    let stalled_m = plant.truth(&state).pose.x_m;
    both(&mut state, Bridge::Backward(1.0));
    plant.advance(&mut state, 3_000_000, &mut |_| {});
    assert!(plant.truth(&state).pose.x_m < stalled_m - 0.05);
}
