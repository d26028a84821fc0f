//! The exact cone against dense ray sampling; which faces answer and which hide others.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use proptest::prelude::*;
use rumbo_plant::cone::{Cone, Hearing, nearest};
use rumbo_plant::world::{Block, Point, Wall, World};

/// Nearest hit of a fan of rays over the cone, edge rays included.
fn sampled(world: &World, cone: &Cone, reach_m: f64, rays: u32) -> Option<f64> {
    let mut best = f64::INFINITY;
    for i in 0..=rays {
        let share = f64::from(i) / f64::from(rays) * 2.0 - 1.0;
        let angle = cone.axis_rad + share * cone.half_angle_rad;
        let ray = [angle.cos(), angle.sin()];
        for obstacle in world.obstacles() {
            let corners: Vec<Point> = obstacle.corners().collect();
            for (i, a) in corners.iter().enumerate() {
                let b = corners[(i + 1) % corners.len()];
                let edge = [b[0] - a[0], b[1] - a[1]];
                let to = [a[0] - cone.apex[0], a[1] - cone.apex[1]];
                let turn = ray[0] * edge[1] - ray[1] * edge[0];
                let along = (to[0] * edge[1] - to[1] * edge[0]) / turn;
                let share = (to[0] * ray[1] - to[1] * ray[0]) / turn;
                if turn.abs() > 1e-12 && along >= 0.0 && (0.0..=1.0).contains(&share) {
                    best = best.min(along);
                }
            }
        }
    }
    (best <= reach_m).then_some(best)
}

/// A convex polygon with corners on an ellipse, so that any angles make a valid one.
fn polygon(center: Point, radii: [f64; 2], turn: f64, mut angles: Vec<f64>) -> Option<Vec<Point>> {
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| (*a - *b).abs() < 0.05);
    let corners: Vec<Point> = angles
        .iter()
        .map(|angle| {
            let (x, y) = (radii[0] * angle.cos(), radii[1] * angle.sin());
            [
                center[0] + x * turn.cos() - y * turn.sin(),
                center[1] + x * turn.sin() + y * turn.cos(),
            ]
        })
        .collect();
    (corners.len() >= 3).then_some(corners)
}

fn any_polygon() -> impl Strategy<Value = Vec<Point>> {
    (
        prop::array::uniform2(-3.0..3.0_f64),
        prop::array::uniform2(0.05..0.6_f64),
        0.0..6.3_f64,
        prop::collection::vec(0.0..6.2_f64, 3..8),
    )
        .prop_filter_map("too few corners", |(c, r, t, a)| polygon(c, r, t, a))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_exact_range_is_the_limit_of_ever_denser_rays(
        polygons in prop::collection::vec(any_polygon(), 1..6),
        axis_rad in -3.2..3.2_f64,
        half_angle_rad in 0.02..1.2_f64,
    ) {
        let mut world = World::empty();
        for corners in &polygons {
            prop_assume!(world.add_convex(corners).is_ok());
        }
        let apex = [0.0, 0.0];
        prop_assume!(world.obstacles().iter().all(|obstacle| obstacle.distance_m(apex) > 0.01));
        let cone = Cone { apex, axis_rad, half_angle_rad };
        let exact = nearest(&world, 0, &cone, &Hearing::geometric(4.0)).map(|echo| echo.range_m);
        // Between two rays a corner may reach out: a sharp one takes many of them.
        let comes_near = |rays| match (exact, sampled(&world, &cone, 4.0, rays)) {
            (Some(exact), Some(dense)) => dense - exact < 0.02,
            (Some(exact), None) => exact > 3.98,
            (None, found) => found.is_none(),
        };
        prop_assert!(comes_near(2_000) || comes_near(400_000), "{exact:?}");
        let dense = sampled(&world, &cone, 4.0, 2_000);
        prop_assert!(dense.is_none_or(|dense| exact.is_some_and(|exact| exact <= dense + 1e-9)), "no ray is shorter: {exact:?} {dense:?}");
    }
}

fn screen(from_m: Point, to_m: Point) -> Wall {
    Wall {
        from_m,
        to_m,
        thickness_m: 0.0,
    }
}

fn ahead(half_angle_rad: f64) -> Cone {
    Cone {
        apex: [0.0, 0.0],
        axis_rad: 0.0,
        half_angle_rad,
    }
}

const HEARING: Hearing = Hearing {
    reach_m: 2.5,
    incidence_limit_rad: 0.5,
    corner_reach_m: 0.6,
};

/// A long screen whose normal is turned by `angle_rad` from the view, 1 m away along it.
fn slanted(angle_rad: f64) -> World {
    let (s, c) = angle_rad.sin_cos();
    World::new(
        &[screen(
            [c + 9.0 * s, s - 9.0 * c],
            [c - 9.0 * s, s + 9.0 * c],
        )],
        &[],
    )
    .unwrap()
}

#[test]
fn a_wall_turned_within_the_beam_reads_its_perpendicular_distance() {
    for angle_rad in [0.0, 0.1, -0.29] {
        let echo = nearest(&slanted(angle_rad), 0, &ahead(0.3), &HEARING).unwrap();
        assert!((echo.range_m - 1.0).abs() < 1e-12);
        assert!(echo.incidence_rad < 1e-6);
        assert!(!echo.corner);
    }
}

#[test]
fn a_wall_turned_further_reads_along_the_beams_edge_until_it_mirrors_the_sound_away() {
    let echo = nearest(&slanted(0.7), 0, &ahead(0.3), &HEARING).unwrap();
    assert!((echo.incidence_rad - 0.4).abs() < 1e-9);
    assert!((echo.range_m - 1.0 / 0.4_f64.cos()).abs() < 1e-9);
    assert_eq!(nearest(&slanted(0.81), 0, &ahead(0.3), &HEARING), None);
    assert_eq!(nearest(&slanted(-0.81), 0, &ahead(0.3), &HEARING), None);
}

#[test]
fn a_silent_wall_hides_what_is_behind_it() {
    let mut world = slanted(0.9);
    world.add_wall(&screen([2.0, -1.0], [2.0, 1.0])).unwrap();
    assert_eq!(nearest(&world, 0, &ahead(0.3), &HEARING), None);
    let open = World::new(&[screen([2.0, -1.0], [2.0, 1.0])], &[]).unwrap();
    assert!((nearest(&open, 0, &ahead(0.3), &HEARING).unwrap().range_m - 2.0).abs() < 1e-12);
}

#[test]
fn a_box_seen_corner_on_echoes_only_from_near() {
    let corner_at = |x_m: f64| {
        let block = Block {
            center_m: [x_m + 0.2 * 2.0_f64.sqrt(), 0.0],
            size_m: [0.4, 0.4],
            heading_rad: std::f64::consts::FRAC_PI_4,
        };
        nearest(
            &World::new(&[], &[block]).unwrap(),
            0,
            &ahead(0.2),
            &HEARING,
        )
    };
    let near = corner_at(0.5).unwrap();
    assert!(near.corner && (near.range_m - 0.5).abs() < 1e-12);
    assert_eq!(corner_at(0.7), None);
}

#[test]
fn the_nearer_of_two_boxes_echoes() {
    let block = |x_m: f64, y_m: f64| Block {
        center_m: [x_m, y_m],
        size_m: [0.2, 0.2],
        heading_rad: 0.0,
    };
    let world = World::new(&[], &[block(1.5, 0.0), block(1.0, 0.2)]).unwrap();
    assert!(
        (nearest(&world, 0, &ahead(0.3), &HEARING).unwrap().range_m
            - (0.9_f64.powi(2) + 0.01).sqrt())
        .abs()
            < 1e-12
    );
    let only_far = Cone {
        axis_rad: -0.06,
        half_angle_rad: 0.1,
        ..ahead(0.1)
    };
    assert!((nearest(&world, 0, &only_far, &HEARING).unwrap().range_m - 1.4).abs() < 1e-12);
}

#[test]
fn nothing_beyond_the_reach_or_behind_the_transducer_echoes() {
    let world = World::new(
        &[
            screen([2.6, -5.0], [2.6, 5.0]),
            screen([-0.5, -5.0], [-0.5, 5.0]),
        ],
        &[],
    )
    .unwrap();
    assert_eq!(nearest(&world, 0, &ahead(0.3), &HEARING), None);
}
