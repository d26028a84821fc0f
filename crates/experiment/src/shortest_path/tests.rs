//! Properties of every shortest path, and cases that can be calculated by hand.

use super::*;
use proptest::prelude::*;
use rumbo_plant::world::{Block, Wall};

const RADIUS_M: f64 = 0.075;

fn block(center_m: Point, size_m: [f64; 2], heading_rad: f64) -> Block {
    Block {
        center_m,
        size_m,
        heading_rad,
    }
}

fn floor(boxes: &[Block]) -> Floor {
    Floor::grown(&World::new(&[], boxes).unwrap(), RADIUS_M)
}

/// A path that deviates from the straight line by less than this is straight [m].
const ROUNDING_M: f64 = 1e-6;

#[test]
fn around_one_box_the_path_is_two_tangents_two_arcs_and_a_face() {
    // A square of 0.4 m at x = 1: from the origin the tangent to the arc about its corner (0.8, 0.2), then the arc, then along the face.
    let path = floor(&[block([1.0, 0.0], [0.4, 0.4], 0.0)]).shortest([0.0, 0.0], [2.0, 0.0]);
    let corner_m = 0.8_f64.hypot(0.2);
    let tangent_m = (corner_m.powi(2) - RADIUS_M.powi(2)).sqrt();
    let turn_rad = 0.2_f64.atan2(0.8) + (RADIUS_M / corner_m).asin();
    let exact_m = 2.0 * (tangent_m + RADIUS_M * turn_rad) + 0.4;
    let length_m = path.unwrap().length_m;
    assert!(
        (exact_m..exact_m + 0.002).contains(&length_m),
        "{length_m} {exact_m}"
    );
}

#[test]
fn around_the_end_of_a_thin_wall_the_path_is_two_tangents_and_an_arc() {
    let wall = Wall {
        from_m: [1.0, -0.5],
        to_m: [1.0, 3.0],
        thickness_m: 0.0,
    };
    let world = World::new(&[wall], &[]).unwrap();
    let path = Floor::grown(&world, RADIUS_M).shortest([0.0, 0.0], [2.0, 0.0]);
    let end_m = 1.0_f64.hypot(0.5);
    let tangent_m = (end_m.powi(2) - RADIUS_M.powi(2)).sqrt();
    let turn_rad = 0.5_f64.atan2(1.0) + (RADIUS_M / end_m).asin();
    let exact_m = 2.0 * (tangent_m + RADIUS_M * turn_rad);
    let length_m = path.unwrap().length_m;
    assert!(
        (exact_m..exact_m + 0.002).contains(&length_m),
        "{length_m} {exact_m}"
    );
}

#[test]
fn a_gap_lets_through_what_is_narrower() {
    let pair = [
        block([1.0, 0.6], [0.2, 1.0], 0.0),
        block([1.0, -0.6], [0.2, 1.0], 0.0),
    ];
    let world = World::new(&[], &pair).unwrap();
    let path = |radius_m| Floor::grown(&world, radius_m).shortest([0.0, 0.0], [2.0, 0.0]);
    assert_eq!(path(0.099).unwrap().length_m, 2.0);
    assert!(path(0.101).unwrap().length_m > 2.5, "around");
}

#[test]
fn a_goal_walled_in_or_inside_a_box_has_no_path() {
    let ring = [
        block([2.0, 0.4], [1.0, 0.2], 0.0),
        block([2.0, -0.4], [1.0, 0.2], 0.0),
        block([1.6, 0.0], [0.2, 0.8], 0.0),
        block([2.4, 0.0], [0.2, 0.8], 0.0),
    ];
    assert_eq!(floor(&ring).shortest([0.0, 0.0], [2.0, 0.0]), None);
    assert!(floor(&ring[1..]).shortest([0.0, 0.0], [2.0, 0.0]).is_some());
    assert_eq!(floor(&ring[..1]).shortest([0.0, 0.0], [2.0, 0.4]), None);
    assert!(!floor(&ring[..1]).admits([2.0, 0.4]));
}

/// Boxes anywhere within 4 x 3 m, most of them between (0, 0) and (4, 0).
fn boxes() -> impl Strategy<Value = Vec<Block>> {
    let one = (0.5..3.5, -1.5..1.5, 0.1..0.8, 0.1..0.8, 0.0..3.2)
        .prop_map(|(x, y, w, h, heading_rad)| block([x, y], [w, h], heading_rad));
    prop::collection::vec(one, 0..8)
}

fn turned(point: Point, angle_rad: f64) -> Point {
    let (sin, cos) = angle_rad.sin_cos();
    [
        cos * point[0] - sin * point[1] + 0.7,
        sin * point[0] + cos * point[1] - 1.3,
    ]
}

proptest! {
    #[test]
    fn the_way_back_is_as_long(boxes in boxes(), y in -1.0..1.0) {
        let floor = floor(&boxes);
        let length_m = |from, to| floor.shortest(from, to).map(|path| path.length_m);
        let (there, back) = (length_m([0.0, 0.0], [4.0, y]), length_m([4.0, y], [0.0, 0.0]));
        prop_assert_eq!(there.is_some(), back.is_some());
        prop_assert!((there.unwrap_or(0.0) - back.unwrap_or(0.0)).abs() < ROUNDING_M);
    }

    #[test]
    fn no_path_is_shorter_than_the_straight_line_and_a_free_line_is_the_path(boxes in boxes(), y in -1.0..1.0) {
        let floor = floor(&boxes);
        let straight_m = 4.0_f64.hypot(y);
        if let Some(path) = floor.shortest([0.0, 0.0], [4.0, y]) {
            prop_assert!(path.length_m >= straight_m - ROUNDING_M);
            let free = floor.is_straight([0.0, 0.0], [4.0, y]);
            prop_assert_eq!(path.points_m.len() == 2, free);
        }
    }

    #[test]
    fn a_path_keeps_its_distance_from_every_box(boxes in boxes()) {
        let world = World::new(&[], &boxes).unwrap();
        if let Some(path) = floor(&boxes).shortest([0.0, 0.0], [4.0, 0.0]) {
            for ends in path.points_m.windows(2) {
                for step in 0..=50 {
                    let part = f64::from(step) / 50.0;
                    let at = [0, 1].map(|axis| ends[0][axis] + part * (ends[1][axis] - ends[0][axis]));
                    for obstacle in world.obstacles() {
                        prop_assert!(obstacle.distance_m(at) > RADIUS_M - ROUNDING_M);
                    }
                }
            }
        }
    }

    #[test]
    fn a_turned_world_has_turned_paths(boxes in boxes(), angle_rad in -3.0..3.0) {
        let other: Vec<Block> = boxes
            .iter()
            .map(|one| block(turned(one.center_m, angle_rad), one.size_m, one.heading_rad + angle_rad))
            .collect();
        let path = floor(&boxes).shortest([0.0, 0.0], [4.0, 0.0]);
        let same = floor(&other).shortest(turned([0.0, 0.0], angle_rad), turned([4.0, 0.0], angle_rad));
        prop_assert_eq!(path.is_some(), same.is_some());
        if let (Some(path), Some(same)) = (path, same) {
            prop_assert!((path.length_m - same.length_m).abs() < ROUNDING_M);
        }
    }

    #[test]
    fn a_box_more_never_shortens_a_path(boxes in boxes()) {
        let more = floor(&boxes).shortest([0.0, 0.0], [4.0, 0.0]).map_or(f64::INFINITY, |path| path.length_m);
        let fewer = floor(&boxes[..boxes.len() / 2]).shortest([0.0, 0.0], [4.0, 0.0]).map_or(f64::INFINITY, |path| path.length_m);
        prop_assert!(fewer <= more + ROUNDING_M);
    }
}
