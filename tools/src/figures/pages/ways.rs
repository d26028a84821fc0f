//! Modes 7 and 8 and pure pursuit: maps.

use super::*;

/// Width of a map beside another one [px].
const HALF: f64 = 0.5 * WIDTH;

/// Maps of both programs beside each other, with the same surroundings.
fn maps(of: [&Runs; 2], titles: [&str; 2], around: &Map, way: fn(&Runs) -> Ways) -> String {
    let of = of.into_iter().zip(titles).zip([BASELINE, OURS]);
    let sheet = of.fold(Sheet::new(2), |sheet, ((runs, title), ink)| {
        let mut map = around.clone();
        map.curves.push(Curve::each("", ink, &way(runs)));
        sheet.with(title, map.picture(Words::default(), HALF))
    });
    sheet.svg()
}

/// An ideal path.
fn ideal(points: Points) -> Curve {
    Curve::new("", Ink::Reference, points)
}

pub(super) fn mode7() -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both("mode7", SLOW_SQUARE)? else {
        return Ok(None);
    };
    let square = vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];
    let square = Map {
        range: Some([[-0.3, 1.3]; 2]),
        ..Map::of(Vec::new(), vec![ideal(square)])
    };
    let rows = [
        row(
            "off the square by odometry, worst",
            "odometry_worst_m",
            "cm",
            "6 cm",
        ),
        row("the same, rms", "odometry_rms_m", "cm", "2.4 cm"),
        row(
            "truly off the square, worst",
            "true_worst_m",
            "cm",
            "not measured",
        ),
        row("true closing error", "end_error_m", "cm", "not measured"),
        row("once round", "finish_s", "s", "30 s"),
    ];
    let titles = ["Mode 7: the report's program", "ours, calibrated"];
    Ok(Some(Made {
        figures: vec![(
            "mode7",
            "True paths of 20 robots around a square of 1 m: ours almost on it",
            maps([&baseline, &ours], titles, &square, ways),
        )],
        words: words(&[(REPORT, &baseline), ("ours", &ours)], "mode7", &rows),
    }))
}

pub(super) fn pursuit() -> Result<Option<Made>, String> {
    let (Some(line), Some(curve)) = (
        runs("pursuit-line", runs::OURS)?,
        runs("pursuit-curve", runs::OURS)?,
    ) else {
        return Ok(None);
    };
    let pictures = [
        (&line, "Pure pursuit of a line from 18 degrees off it"),
        (&curve, "and of a sine"),
    ]
    .into_iter()
    .map(|(runs, title)| {
        let mut path = vec![(0.0, 0.0)];
        for timed in &runs.setup.scenario.commands {
            if let Command::Waypoint(point) = timed.command {
                path.push((f64::from(point.x_m), f64::from(point.y_m)));
            }
        }
        let curves = vec![ideal(path), Curve::each("", OURS, &ways(runs))];
        let map = Map::of(Vec::new(), curves);
        (title, map.picture(Words::default(), WIDTH))
    });
    let sheet = pictures.fold(Sheet::new(1), |sheet, (title, picture)| {
        sheet.with(title, picture)
    });
    let rows = [
        row(
            "off the path by odometry, worst",
            "odometry_worst_m",
            "cm",
            "",
        ),
        row("the same, rms", "odometry_rms_m", "cm", ""),
        row("truly off the path, worst", "true_worst_m", "cm", ""),
        row("finished after", "finish_s", "s", ""),
    ];
    let columns = [("line", &line), ("curve", &curve)];
    Ok(Some(Made {
        figures: vec![(
            "pursuit",
            "True paths of 20 robots along a line and along a sine",
            sheet.svg(),
        )],
        words: format!(
            "{}\nTrue paths of 20 robots, calibrated; limits are the curve's. `rumbo run pursuit-line pursuit-curve --runs 20`.\n",
            table(&columns, &rows)
        ),
    }))
}

/// Walls and boxes of the world.
fn shapes(setup: &Setup) -> Vec<Shape> {
    let Ok(world) = setup.world.world() else {
        return Vec::new();
    };
    world
        .obstacles()
        .iter()
        .map(|obstacle| {
            let corners: Points = obstacle.corners().map(|[x_m, y_m]| (x_m, y_m)).collect();
            Shape {
                filled: corners.len() > 2,
                corners,
            }
        })
        .collect()
}

fn in_the_world(runs: &Runs) -> Ways {
    runs.each(|sample| (sample.x_m, sample.y_m))
}

/// A mission: maps, and the figures that its metrics give.
fn mission(
    scenario: &'static str,
    alt: &'static str,
    range: Option<[[f64; 2]; 2]>,
    rows: &[Row],
) -> Result<Option<Made>, String> {
    let Some([baseline, ours]) = both(scenario, SLOW_MISSION)? else {
        return Ok(None);
    };
    let titles = ["Mode 8: the report's program", "ours"];
    let world = Map {
        range,
        ..Map::of(shapes(&ours.setup), Vec::new())
    };
    let figure = maps([&baseline, &ours], titles, &world, in_the_world);
    Ok(Some(Made {
        figures: vec![(scenario, alt, figure)],
        words: words(&[(REPORT, &baseline), ("ours", &ours)], scenario, rows),
    }))
}

pub(super) fn mode8_goals() -> Result<Option<Made>, String> {
    let rows = [
        row("all four goals", "total_time_s", "s", "32 s"),
        Row {
            least_is_worst: true,
            ..row("goals reached", "reached", "", "4")
        },
    ];
    mission(
        "mode8-goals",
        "True paths of 20 robots to four goals",
        None,
        &rows,
    )
}

pub(super) fn mode8_obstacles() -> Result<Option<Made>, String> {
    let rows = [
        row("time", "total_time_s", "s", "73.6 s"),
        row("path", "path_m", "m", "4.16 m"),
        row("contacts", "contacts", "", "0"),
        Row {
            least_is_worst: true,
            ..row("reached", "reached", "", "1")
        },
    ];
    mission(
        "mode8-obstacles",
        "True paths of 20 robots around a box and a block of two",
        Some([[-0.4, 3.0], [-1.6, 1.6]]),
        &rows,
    )
}

pub(super) fn mode8_lane() -> Result<Option<Made>, String> {
    let rows = [
        row("time of the four straights", "finish_s", "s", "57.8 s"),
        Row {
            least_is_worst: true,
            ..row("straights driven", "straights", "", "4")
        },
        row("contacts", "contacts", "", "0"),
        Row {
            least_is_worst: true,
            ..row("least clearance", "clearance_m", "cm", "")
        },
    ];
    mission(
        "mode8-lane",
        "True paths of 20 robots along a lane of boxes",
        Some([[-0.6, 2.8], [-1.0, 1.4]]),
        &rows,
    )
}
