//! Statistics of the seeds.

use super::arrangement::apart_m;
use super::*;
use crate::files::{Library, Overrides, Setup};
use rumbo_plant::world::Obstacle;

const SEEDS: u64 = 400;

fn setups() -> Vec<Setup> {
    use rayon::prelude::*;
    let setup = Library::new()
        .setup("mode8-random", &Overrides::default())
        .unwrap();
    (1..=SEEDS)
        .into_par_iter()
        .map(|seed| setup.of_seed(seed).unwrap().into_owned())
        .collect()
}

fn journey(setup: &Setup) -> &Journey {
    setup.world.journey.as_ref().unwrap()
}

fn share(setups: &[Setup], is: impl Fn(&Setup) -> bool) -> f64 {
    setups.iter().filter(|setup| is(setup)).count() as f64 / setups.len() as f64
}

#[test]
fn a_tenth_of_the_goals_cannot_be_reached_and_most_straight_lines_are_blocked() {
    let setups = setups();
    let unreachable = share(&setups, |setup| journey(setup).shortest.is_none());
    assert!((0.06..0.14).contains(&unreachable), "{unreachable}");
    let blocked = share(&setups, |setup| journey(setup).blocked);
    assert!((0.75..0.9).contains(&blocked), "{blocked}");
}

#[test]
fn the_same_seed_is_the_same_world_and_another_seed_another() {
    let setup = Library::new()
        .setup("mode8-random", &Overrides::default())
        .unwrap();
    let world = |seed| setup.of_seed(seed).unwrap().world.clone();
    assert_eq!(world(5), world(5));
    assert_ne!(world(5).boxes, world(6).boxes);
}

#[test]
fn the_robot_can_turn_where_it_starts_and_stand_at_every_goal_that_it_can_reach() {
    for setup in setups() {
        let world = setup.world.world().unwrap();
        let room_m = |point: Point| {
            let distance_m = |obstacle: &Obstacle| obstacle.distance_m(point);
            world
                .obstacles()
                .iter()
                .map(distance_m)
                .fold(f64::INFINITY, f64::min)
        };
        assert!(room_m([0.0, 0.0]) >= 0.30);
        let journey = journey(&setup);
        let goal_room_m = room_m(journey.goal_m);
        assert!(journey.shortest.is_none() || goal_room_m >= 0.35);
        let away_m = journey.goal_m[0].hypot(journey.goal_m[1]);
        assert!((2.0..=4.0).contains(&away_m));
    }
}

#[test]
fn whatever_does_not_touch_leaves_a_passage_of_40_cm() {
    for setup in setups() {
        let world = setup.world.world().unwrap();
        let obstacles = world.obstacles();
        let touches = |one: usize, other: usize| apart_m(&obstacles[one], &obstacles[other]) == 0.0;
        // Groups of what touches, directly or through others.
        let mut group: Vec<usize> = (0..obstacles.len()).collect();
        for one in 0..obstacles.len() {
            for other in 0..one {
                if touches(one, other) {
                    let (from, to) = (group[one], group[other]);
                    group
                        .iter_mut()
                        .filter(|own| **own == from)
                        .for_each(|own| *own = to);
                }
            }
        }
        for one in 0..obstacles.len() {
            for other in 0..one {
                let gap_m = apart_m(&obstacles[one], &obstacles[other]);
                assert!(group[one] == group[other] || gap_m >= 0.4, "{gap_m}");
            }
        }
    }
}

#[test]
fn a_robot_that_keeps_its_distance_has_not_far_to_go_round() {
    for (seed, setup) in (1..).zip(setups()) {
        let Some(shortest) = &journey(&setup).shortest else {
            continue;
        };
        let world = setup.world.world().unwrap();
        let easy = Floor::grown(&world, 0.18).shortest([0.0, 0.0], journey(&setup).goal_m);
        let ratio = easy.unwrap().length_m / shortest.length_m;
        assert!(ratio < 1.25, "seed {seed}: {ratio}");
    }
}
