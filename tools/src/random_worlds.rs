//! Draws the random worlds of the first seeds with the shortest path in each, as SVG: the figure of docs/theory/random_worlds.md. Its numbers,
//! of a thousand seeds, go to standard error.
//!
//! `cargo run --release -p rumbo-tools -- random_worlds > docs/img/random_worlds.svg`

use rumbo_experiment::files::{FileError, Library, Overrides, Setup};
use rumbo_experiment::random_world::Size;
use rumbo_experiment::shortest_path::Floor;
use rumbo_plant::world::Point;
use std::process::ExitCode;

/// Seeds that are drawn, and seeds that are counted.
const SEEDS: u64 = 15;
const COUNTED: u64 = 1000;
const COLUMNS: u64 = 5;
/// Pixels per metre.
const SCALE: f64 = 34.0;
/// Floor shown around the arena [m].
const MARGIN_M: f64 = 0.4;

pub(crate) fn main() -> ExitCode {
    crate::ended("random_worlds", draw_all().map(|()| true))
}

fn draw_all() -> Result<(), FileError> {
    let setup = Library::new().setup("mode8-random", &Overrides::default())?;
    let arena = setup.world.arena;
    let [width, height] =
        [0, 1].map(|axis| SCALE * (arena.to_m[axis] - arena.from_m[axis] + 2.0 * MARGIN_M));
    let rows = SEEDS.div_ceil(COLUMNS);
    println!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:.0} {:.0}" font-family="sans-serif" font-size="11">"#,
        COLUMNS as f64 * width,
        rows as f64 * height
    );
    println!(r#"<rect width="100%" height="100%" fill="white"/>"#);
    for index in 0..SEEDS {
        let seed = index + 1;
        let own = setup.of_seed(seed)?;
        let (column, row) = (index % COLUMNS, index / COLUMNS);
        println!(
            r#"<g transform="translate({:.1} {:.1})">"#,
            column as f64 * width,
            row as f64 * height
        );
        draw(&own, seed);
        println!("</g>");
    }
    println!("</svg>");
    count(&setup)
}

/// Shares of the kinds of world, and the detour of a robot that keeps 3 cm more than its turning circle clear.
fn count(setup: &Setup) -> Result<(), FileError> {
    let easy_m = Size::of(&setup.robot.plant.body).easy_m();
    let (mut blocked, mut unreachable, mut ratios) = (0, 0, Vec::new());
    for seed in 1..=COUNTED {
        let own = setup.of_seed(seed)?;
        let (Some(journey), Ok(world)) = (&own.world.journey, own.world.world()) else {
            continue;
        };
        blocked += u32::from(journey.blocked);
        let Some(shortest) = &journey.shortest else {
            unreachable += 1;
            continue;
        };
        let start_m = [own.scenario.start.x_m, own.scenario.start.y_m];
        let easy = Floor::grown(&world, easy_m).shortest(start_m, journey.goal_m);
        if let (true, Some(easy)) = (journey.blocked, easy) {
            ratios.push(easy.length_m / shortest.length_m);
        }
    }
    ratios.sort_by(f64::total_cmp);
    eprintln!(
        "of {COUNTED} seeds: {blocked} block the straight line, {unreachable} goals cannot be reached"
    );
    if let (Some(median), Some(worst)) = (ratios.get(ratios.len() / 2), ratios.last()) {
        eprintln!(
            "a disc of {easy_m:.2} m goes farther by {median:.3} (median), {worst:.3} (worst)"
        );
    }
    Ok(())
}

/// One world: boxes grey, start blue, goal red, shortest path green.
fn draw(setup: &Setup, seed: u64) {
    let arena = setup.world.arena;
    let place = |[x_m, y_m]: Point| {
        format!(
            "{:.1},{:.1}",
            SCALE * (x_m - arena.from_m[0] + MARGIN_M),
            SCALE * (arena.to_m[1] - y_m + MARGIN_M)
        )
    };
    let line = |points: &[Point]| {
        points
            .iter()
            .copied()
            .map(place)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let Ok(world) = setup.world.world() else {
        return;
    };
    for obstacle in world.obstacles() {
        let corners: Vec<Point> = obstacle.corners().collect();
        println!(
            r##"<polygon points="{}" fill="#bbb" stroke="#444" stroke-width="0.8"/>"##,
            line(&corners)
        );
    }
    let dot = |at: Point, radius_m: f64, color: &str| {
        let at = place(at);
        let (x, y) = at.split_once(',').unwrap_or_default();
        println!(
            r#"<circle cx="{x}" cy="{y}" r="{:.1}" fill="{color}"/>"#,
            SCALE * radius_m
        );
    };
    dot(
        [setup.scenario.start.x_m, setup.scenario.start.y_m],
        0.15,
        "#46f",
    );
    if let Some(journey) = &setup.world.journey {
        if let Some(path) = &journey.shortest {
            println!(
                r##"<polyline points="{}" fill="none" stroke="#182" stroke-width="1.6"/>"##,
                line(&path.points_m)
            );
        }
        dot(journey.goal_m, 0.09, "#d22");
    }
    println!(r#"<text x="16" y="11">seed {seed}</text>"#);
}
