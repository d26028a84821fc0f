//! The memory of echoes: which points count, fade and give way.

use super::*;
use crate::types::{SonarView, Transform};

/// A reading of the front sonar, pointing in a direction from the origin.
fn answer(range: Range, axis_rad: f32) -> SonarReading {
    SonarReading {
        sonar: SonarId::Front,
        range,
        view: SonarView {
            axis_rad,
            ..SonarView::default()
        },
        servo_rad: axis_rad,
    }
}

fn ingest(echoes: &mut Echoes, robot: &Transform, reading: &SonarReading, sure: bool) {
    let (beam, _) = Beam::of(robot, reading);
    echoes.ingest(robot, reading, &beam, sure);
}

fn after(answers: &[(Range, f32)]) -> Echoes {
    let mut echoes = Echoes::default();
    for (range, axis_rad) in answers {
        ingest(
            &mut echoes,
            &Transform::default(),
            &answer(*range, *axis_rad),
            true,
        );
    }
    echoes
}

/// All points.
fn places(echoes: &Echoes) -> impl Iterator<Item = Place> + '_ {
    echoes.points().iter().filter_map(ObstaclePoint::place)
}

fn count(echoes: &Echoes) -> usize {
    places(echoes).count()
}

fn firm(echoes: &Echoes) -> usize {
    // Far from everything, so that no point counts for being near.
    let far = Place::new(20.0, 20.0);
    (0..CAPACITY)
        .filter(|number| echoes.is_firm(*number, far))
        .count()
}

#[test]
fn an_echo_leaves_points_across_the_beam_and_the_next_one_makes_one_firm() {
    let once = after(&[(Range::Valid(0.8), 0.0)]);
    assert_eq!((count(&once), firm(&once)), (3, 0));
    let twice = after(&[(Range::Valid(0.8), 0.0), (Range::Valid(0.805), 0.05)]);
    assert_eq!((count(&twice), firm(&twice)), (3, 1));
}

#[test]
fn a_beam_that_reaches_farther_removes_points_detected_once() {
    let mut echoes = after(&[(Range::Valid(0.8), 0.0), (Range::Clear, -0.2)]);
    // Of -0.2, 0 and 0.2 rad the beam about -0.2 covers the first two.
    assert_eq!(count(&echoes), 1);
    ingest(
        &mut echoes,
        &Transform::default(),
        &answer(Range::Faulty, 0.2),
        true,
    );
    assert_eq!(count(&echoes), 1, "a faulty sonar says nothing");
    ingest(
        &mut echoes,
        &Transform::default(),
        &answer(Range::Valid(0.82), 1.4),
        true,
    );
    assert_eq!(count(&echoes), 4, "nor does one that looks elsewhere");
}

#[test]
fn silence_from_another_direction_says_nothing() {
    let mut echoes = after(&[(Range::Valid(0.5), 0.0), (Range::Valid(0.5), 0.0)]);
    let beside = Pose {
        x_m: 0.5,
        y_m: -0.6,
        heading_rad: 1.57,
    };
    let before = count(&echoes);
    for _ in 0..10 {
        ingest(
            &mut echoes,
            &Transform::of(beside),
            &answer(Range::Clear, 0.0),
            true,
        );
    }
    assert_eq!(count(&echoes), before);
}

#[test]
fn points_detected_once_fade_and_firm_ones_stay() {
    let mut echoes = after(&[(Range::Valid(0.8), 0.0), (Range::Valid(0.8), 0.0)]);
    for _ in 0..10 {
        echoes.fade(false);
    }
    assert_eq!((count(&echoes), firm(&echoes)), (1, 1));
    for _ in 0..MOST_BELIEF {
        echoes.fade(true);
    }
    assert_eq!(count(&echoes), 0, "all of them fade, however firm");
}

#[test]
fn a_full_memory_gives_up_the_farthest_point_and_keeps_its_size() {
    let mut echoes = Echoes::default();
    for step in 0..200u16 {
        let pose = Pose {
            x_m: 0.1 * f32::from(step),
            ..Pose::default()
        };
        ingest(
            &mut echoes,
            &Transform::of(pose),
            &answer(Range::Valid(0.15), 1.57),
            true,
        );
    }
    assert_eq!(count(&echoes), CAPACITY);
    let nearest = places(&echoes).map(|at| at.x_mm).min().unwrap();
    assert!(nearest > 14_000, "{nearest}");
}

#[test]
fn a_moved_origin_leaves_the_points_where_they_are() {
    let mut echoes = after(&[(Range::Valid(0.8), 0.0)]);
    let origin = Transform::of(Pose {
        x_m: 0.8,
        y_m: 0.1,
        heading_rad: core::f32::consts::FRAC_PI_2,
    });
    echoes.move_origin(&origin.pose, (origin.sin, origin.cos));
    let at = places(&echoes).next().unwrap();
    let (x_m, y_m) = at.metres();
    assert!((x_m + 0.1).abs() < 2e-3 && y_m.abs() < 2e-3, "{at:?}");
}

#[test]
fn a_silence_contradicts_nothing_before_the_next_echo() {
    let robot = Transform::default();
    let mut echoes = after(&[(Range::Valid(0.8), 0.0)]);
    let settle = |echoes: &mut Echoes| (0..2 * SILENCES).for_each(|_| echoes.settle());
    for _ in 0..2 * SILENCES {
        echoes.silence(&Beam::of(&robot, &answer(Range::Clear, 0.0)).0);
        settle(&mut echoes);
    }
    assert_eq!(count(&echoes), 3);
    echoes.confirm_silences();
    echoes.silence(&Beam::of(&robot, &answer(Range::Clear, 0.4)).0);
    settle(&mut echoes);
    assert_eq!(count(&echoes), 0, "the silences ahead are confirmed");
    let before = echoes;
    settle(&mut echoes);
    assert_eq!(echoes, before, "the one after the echo waits");
}

#[test]
fn a_turn_moves_no_point_of_the_wall_ahead_of_the_sonar_beside() {
    let mut echoes = Echoes::default();
    let right = SonarReading {
        sonar: SonarId::Right,
        ..answer(Range::Valid(0.15), -core::f32::consts::FRAC_PI_2)
    };
    for step in 0..8u16 {
        let pose = Pose {
            heading_rad: -0.05 * f32::from(step),
            ..Pose::default()
        };
        ingest(&mut echoes, &Transform::of(pose), &right, true);
    }
    // The wall lies along y = -0.15 m; ahead of the sonar it is assumed at x = 0.1 m.
    let ahead = Place::new(0.1, -0.15);
    assert!(places(&echoes).any(|at| at == ahead), "{echoes:?}");
}
