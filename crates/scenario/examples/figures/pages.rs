//! What each page of docs/theory shows.

use crate::chart::{Chart, Curve, Legend, ORIGINAL, OURS, THIRD, map, over_time, svg};
use crate::runs::{self, Change, Runs, runs};
use crate::table::{Row, row, spread, table};
use rumbo_scenario::files::Setup;
use rumbo_scenario::trace::Sample;
use rumbo_wire::Command;

const RPM: f64 = 30.0 / std::f64::consts::PI;
const DEG: f64 = 180.0 / std::f64::consts::PI;
const WIDE: (u32, u32) = (860, 290);

/// A section of a page.
pub(crate) struct Page {
    pub(crate) name: &'static str,
    pub(crate) file: &'static str,
    pub(crate) make: fn() -> Result<Option<Made>, String>,
}

/// What is to stand in it: figures with name, alternative text and SVG, and the words below them.
pub(crate) struct Made {
    pub(crate) figures: Vec<(&'static str, &'static str, String)>,
    pub(crate) words: String,
}

pub(crate) const PAGES: &[Page] = &[
    page("mode1", "front_distance.md", mode1),
    page("mode2", "front_align.md", mode2),
    page("mode3", "wall_follow.md", mode3),
    page("mode4", "wall_follow.md", mode4),
    page("mode5", "wheel_speed.md", mode5),
    page("mode6", "straight_line.md", mode6),
    page("mode7", "waypoints.md", mode7),
    page("pursuit", "pursuit.md", pursuit),
    page("mode8-lane", "lane.md", mode8_lane),
    page("mode8-goals", "original.md", mode8_goals),
    page("mode8-obstacles", "original.md", mode8_obstacles),
    page("original", "original.md", original),
];

const fn page(
    name: &'static str,
    file: &'static str,
    make: fn() -> Result<Option<Made>, String>,
) -> Page {
    Page { name, file, make }
}

/// Both programs' runs of a scenario, the report's first.
fn both(scenario: &str, original: Change) -> Result<Option<[Runs; 2]>, String> {
    Ok(runs(scenario, original)?
        .zip(runs(scenario, runs::OURS)?)
        .map(|(original, ours)| [original, ours]))
}

/// A signal over time, of both programs.
fn signal(of: &[Runs; 2], signal: impl Fn(&Sample, f64) -> f64) -> Vec<Curve> {
    let [original, ours] = of;
    vec![
        Curve::Seeds {
            name: "the report's program",
            colour: ORIGINAL,
            runs: original.over_time(&signal),
        },
        Curve::Seeds {
            name: "ours",
            colour: OURS,
            runs: ours.over_time(&signal),
        },
    ]
}

/// The reference over time, in its unit times `factor`.
fn reference(setup: &Setup, factor: f64) -> Curve {
    let mut points: Vec<(f64, f64)> = Vec::new();
    for timed in &setup.scenario.commands {
        let value = match timed.command {
            Command::Reference(value) => f64::from(value),
            Command::WheelReference(wheels) => f64::from(wheels.left),
            _ => continue,
        } * factor;
        if let Some(&(_, last)) = points.last() {
            points.push((timed.at_s, last));
        }
        points.push((timed.at_s, value));
    }
    if let Some(&(_, last)) = points.last() {
        points.push((setup.scenario.duration_s, last));
    }
    Curve::Given {
        name: "reference",
        points,
    }
}

fn pwm(of: &[Runs; 2]) -> Chart {
    over_time(
        "PWM of the left wheel",
        "of 255",
        signal(of, |sample, _| f64::from(sample.duty[0])),
    )
}

/// The words below a figure of both programs; a third column may stand between them.
fn words(of: &[Runs; 2], third: Option<(&str, &Runs)>, scenario: &str, rows: &[Row]) -> String {
    let [original, ours] = of;
    let mut columns = vec![("the report's program", original), ("ours", ours)];
    if let Some(third) = third {
        columns.insert(1, third);
    }
    let end = if original.setup.scenario.duration_s > ours.setup.scenario.duration_s {
        format!(
            "; the report's was given {} s",
            original.setup.scenario.duration_s
        )
    } else {
        String::new()
    };
    format!(
        "{}\nThe same {} simulated robots with both programs: median, and the range of all. `rumbo run {scenario} --runs {}`, and with `--program original`{end}.\n",
        table(&columns, rows),
        runs::SEEDS,
        runs::SEEDS,
    )
}

fn mode1() -> Result<Option<Made>, String> {
    let Some(of) = both("mode1", runs::ORIGINAL)? else {
        return Ok(None);
    };
    let mut distance = signal(&of, |sample, scale| 100.0 * sample.range_m[2] * scale);
    distance.insert(0, reference(&of[1].setup, 100.0));
    let charts = [
        over_time("Mode 1: distance to the wall", "cm", distance),
        pwm(&of),
    ];
    let rows = [
        row(
            "107 -> 30 cm, within 5 %",
            "step1.settling_s",
            1.0,
            "s",
            "3.0 s",
        ),
        row("overshoot", "step1.overshoot_m", 100.0, "cm", "0.6 cm"),
        row(
            "steady error",
            "step1.steady_error_m",
            100.0,
            "cm",
            "0.02 cm",
        ),
        row(
            "30 -> 50 cm, within 5 %",
            "step2.settling_s",
            1.0,
            "s",
            "1.2 s",
        ),
        row("overshoot", "step2.overshoot_m", 100.0, "cm", ""),
        row(
            "driven against its motion",
            "reverse_drive_rad_s",
            1.0,
            "rad/s",
            "",
        ),
        row(
            "time between two settings of the PWM",
            "control_period_s",
            1000.0,
            "ms",
            "65 ms",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode1",
            "Distance to the wall and PWM over time: ours reaches each reference sooner and without passing it",
            svg(&charts, 1, WIDE)?,
        )],
        words: words(&of, None, "mode1", &rows),
    }))
}

/// Distance of the middle of the front pair from the wall at x = 1.2 m.
fn ahead_m(sample: &Sample) -> f64 {
    1.2 - sample.x_m - 0.13 * sample.heading_rad.cos()
}

fn mode2() -> Result<Option<Made>, String> {
    let (Some(of), Some(turning)) = (
        both("mode2", runs::ORIGINAL)?,
        runs("mode2-final", runs::OURS)?,
    ) else {
        return Ok(None);
    };
    let mut distance = signal(&of, |sample, _| 100.0 * ahead_m(sample));
    distance.insert(0, reference(&of[1].setup, 100.0));
    let mut charts = [
        over_time("Mode 2: distance to the wall", "cm", distance),
        over_time(
            "Angle to the wall's normal",
            "deg",
            signal(&of, |sample, _| DEG * sample.heading_rad),
        ),
    ];
    charts[0].y_range = Some([0.0, 125.0]);
    charts[1].y_range = Some([-60.0, 90.0]);
    let rows = [
        row(
            "119 -> 30 cm, within 5 %",
            "step1.settling_s",
            1.0,
            "s",
            "3.4 s",
        ),
        row(
            "steady error",
            "step1.steady_error_m",
            100.0,
            "cm",
            "0.64 cm",
        ),
        row(
            "angle to the wall at rest",
            "step1.angle_rad",
            DEG,
            "deg",
            "not measured",
        ),
        row(
            "50 -> 15 cm, within 2 cm",
            "step3.within_2cm_s",
            1.0,
            "s",
            "5.5 s",
        ),
        row("overshoot", "step3.overshoot_m", 100.0, "cm", "5.7 cm"),
        row("contacts", "contacts", 1.0, "", "0"),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode2",
            "Distance and angle to the wall over time: ours stands square at every reference",
            svg(&charts, 1, WIDE)?,
        )],
        words: words(
            &of,
            Some(("ours, one sonar on the servo (`mode2-final`)", &turning)),
            "mode2",
            &rows,
        ),
    }))
}

/// Distance of the middle of the side pair from the wall at y = 0.65 m.
fn beside_m(sample: &Sample) -> f64 {
    let (sin, cos) = sample.heading_rad.sin_cos();
    0.65 - sample.y_m - 0.03 * sin - 0.075 * cos
}

/// The yaw inertia that the footprint alone would have.
const LIGHT: Change = Change {
    plant: Some(("body.yaw_inertia_kg_m2", 0.0047)),
    ..runs::ORIGINAL
};

const LIGHT_WORDS: &str = "The third column is the report's program on a robot that turns as easily as its footprint alone would (`--param \
body.yaw_inertia_kg_m2=0.0047`); the identified robot has three times that, which takes up the resistance of its castor.";

fn mode3() -> Result<Option<Made>, String> {
    let (Some([original, ours]), Some(light)) =
        (both("mode3", runs::ORIGINAL)?, runs("mode3", LIGHT)?)
    else {
        return Ok(None);
    };
    let error = |runs: &Runs| runs.over_time(|sample, _| 100.0 * (beside_m(sample) - 0.575));
    let curves = vec![
        Curve::Seeds {
            name: "the report's program",
            colour: ORIGINAL,
            runs: error(&original),
        },
        Curve::Seeds {
            name: "the same, easy to turn",
            colour: THIRD,
            runs: error(&light),
        },
        Curve::Seeds {
            name: "ours",
            colour: OURS,
            runs: error(&ours),
        },
    ];
    let mut chart = over_time("Mode 3: error of the distance to the wall", "cm", curves);
    chart.y_range = Some([-40.0, 60.0]);
    chart.legend = Legend::UpperLeft;
    let rows = [
        row(
            "distance error, rms",
            "distance_rms_m",
            100.0,
            "cm",
            "1.2 cm",
        ),
        row("worst", "distance_worst_m", 100.0, "cm", "4.6 cm"),
        Row {
            least_is_worst: true,
            ..row("slowest half second", "cruise_m_s", 1.0, "m/s", "")
        },
        row("contacts", "contacts", 1.0, "", "0"),
    ];
    let columns = [
        ("the report's program", &original),
        ("easy to turn", &light),
        ("ours", &ours),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode3",
            "Error of the distance to the wall over time: ours stays within half a centimetre",
            svg(&[chart], 1, WIDE)?,
        )],
        words: format!(
            "{}\n{LIGHT_WORDS} `rumbo run mode3 --runs 20`, and with `--program original`.\n",
            table(&columns, &rows)
        ),
    }))
}

fn mode4() -> Result<Option<Made>, String> {
    let (Some([original, ours]), Some(light)) =
        (both("mode4", runs::ORIGINAL)?, runs("mode4", LIGHT)?)
    else {
        return Ok(None);
    };
    let distance = |runs: &Runs| runs.over_time(|sample, _| 100.0 * beside_m(sample));
    let curves = vec![
        reference(&ours.setup, 100.0),
        Curve::Seeds {
            name: "the report's program, easy to turn",
            colour: THIRD,
            runs: distance(&light),
        },
        Curve::Seeds {
            name: "ours",
            colour: OURS,
            runs: distance(&ours),
        },
    ];
    let mut chart = over_time("Mode 4: distance to the wall", "cm", curves);
    chart.y_range = Some([0.0, 90.0]);
    let rows = [
        row(
            "59 -> 50 cm, within 2 cm",
            "step1.within_2cm_s",
            1.0,
            "s",
            "7.1 s",
        ),
        row("50 -> 30 cm", "step2.within_2cm_s", 1.0, "s", "6.3 s"),
        row("30 -> 40 cm", "step3.within_2cm_s", 1.0, "s", "9.0 s"),
        row(
            "swing at 50 cm, standard deviation",
            "step1.ripple_m",
            100.0,
            "cm",
            "",
        ),
        row("swing at 30 cm", "step2.ripple_m", 100.0, "cm", ""),
        row(
            "overshoot of 50 -> 30 cm",
            "step2.overshoot_m",
            100.0,
            "cm",
            "",
        ),
        row("contacts", "contacts", 1.0, "", "0"),
    ];
    let columns = [
        ("the report's program", &original),
        ("easy to turn", &light),
        ("ours", &ours),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode4",
            "Distance to the wall over time: ours takes each step without swinging",
            svg(&[chart], 1, WIDE)?,
        )],
        words: format!(
            "{}\nOn these robots the report's program swings by more than 2 cm about its references, or does not start on a weak battery, so that it never counts as settled. `rumbo run mode4 --runs 20`, and with `--program original`.\n",
            table(&columns, &rows)
        ),
    }))
}

fn mode5() -> Result<Option<Made>, String> {
    let Some(of) = both("mode5", runs::ORIGINAL)? else {
        return Ok(None);
    };
    let speed = || {
        let mut curves = signal(&of, |sample, _| RPM * sample.wheel_rad_s[0]);
        curves.insert(0, reference(&of[1].setup, RPM));
        curves
    };
    let mut charts = [
        over_time("Mode 5: speed of the left wheel", "rpm", speed()),
        over_time("The steps 0 -> 60 -> 50 rpm", "rpm", speed()),
    ];
    charts[0].legend = Legend::LowerLeft;
    charts[1].legend = Legend::LowerRight;
    charts[1].x_range = Some([0.0, 10.5]);
    charts[1].y_range = Some([0.0, 75.0]);
    // Only what is shown, or the few points of a curve would all lie outside.
    for curve in &mut charts[1].curves {
        if let Curve::Seeds { runs, .. } = curve {
            for points in runs {
                points.retain(|(t_s, _)| *t_s < 10.5);
            }
        }
        if let Curve::Given { points, .. } = curve {
            points.retain(|(t_s, _)| *t_s < 10.5);
        }
    }
    let rows = [
        row(
            "0 -> 60 rpm, within 3.2 rpm",
            "step1.settling_s",
            1.0,
            "s",
            "3.7 s",
        ),
        row("50 -> 100 rpm", "step3.settling_s", 1.0, "s", "1.8 s"),
        row("0 -> -100 rpm", "step6.settling_s", 1.0, "s", "5.3 s"),
        row("0 -> 40 rpm", "step9.settling_s", 1.0, "s", "5.5 s"),
        row(
            "ripple at 60 rpm",
            "step1.ripple_rad_s",
            RPM,
            "rpm",
            "0.9 to 2.1 rpm",
        ),
        row("ripple at 100 rpm", "step3.ripple_rad_s", RPM, "rpm", ""),
        row(
            "time between two settings of the PWM",
            "control_period_s",
            1000.0,
            "ms",
            "41 ms",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode5",
            "Speed of the left wheel over time: ours is there within a third of a second",
            svg(&charts, 1, WIDE)?,
        )],
        words: words(&of, None, "mode5", &rows),
    }))
}

/// Every seed's way as seen from the start.
fn ways(runs: &Runs) -> Vec<Vec<(f64, f64)>> {
    let start = runs.setup.scenario.start;
    let (sin, cos) = start.heading_rad.sin_cos();
    runs.each(|sample, _| {
        let (dx, dy) = (sample.x_m - start.x_m, sample.y_m - start.y_m);
        (cos * dx + sin * dy, cos * dy - sin * dx)
    })
}

fn mode6() -> Result<Option<Made>, String> {
    let raw = Change {
        uncalibrated: true,
        ..runs::OURS
    };
    let (Some(of), Some(raw)) = (both("mode6", runs::ORIGINAL)?, runs("mode6", raw)?) else {
        return Ok(None);
    };
    let drift = |runs: &Runs| -> Vec<Vec<(f64, f64)>> {
        let in_cm = |(x_m, y_m): (f64, f64)| (x_m, 100.0 * y_m);
        ways(runs)
            .into_iter()
            .map(|way| way.into_iter().map(in_cm).collect())
            .collect()
    };
    let [original, ours] = &of;
    let chart = Chart {
        x: "way ahead, m",
        legend: Legend::UpperLeft,
        ..over_time(
            "Mode 6: drift to the left of a straight line",
            "cm",
            vec![
                Curve::Ways {
                    name: "the report's program",
                    colour: ORIGINAL,
                    runs: drift(original),
                },
                Curve::Ways {
                    name: "ours, calibrated",
                    colour: OURS,
                    runs: drift(ours),
                },
            ],
        )
    };
    let rows = [
        row(
            "to the side after 3 m",
            "after_3_m.sideways_m",
            100.0,
            "cm",
            "not measured",
        ),
        row(
            "heading after 3 m",
            "after_3_m.heading_rad",
            DEG,
            "deg",
            "not measured",
        ),
    ];
    Ok(Some(Made {
        figures: vec![(
            "mode6",
            "Sideways drift over the way ahead: ours stays within four centimetres",
            svg(&[chart], 1, WIDE)?,
        )],
        words: words(
            &of,
            Some(("ours, `calibrated = false`", &raw)),
            "mode6",
            &rows,
        ),
    }))
}

/// Maps of both programs beside each other, in the frame of the world or of the start.
fn maps(
    of: &[Runs; 2],
    titles: [&'static str; 2],
    around: impl Fn() -> Vec<Curve>,
    way: fn(&Runs) -> Vec<Vec<(f64, f64)>>,
    x_range: Option<[f64; 2]>,
    y_range: Option<[f64; 2]>,
) -> Result<String, String> {
    let charts: Vec<Chart> = of
        .iter()
        .zip(titles)
        .zip([ORIGINAL, OURS])
        .map(|((runs, title), colour)| {
            let mut curves = around();
            curves.push(Curve::Ways {
                name: "",
                colour,
                runs: way(runs),
            });
            Chart {
                x_range,
                y_range,
                ..map(title, curves)
            }
        })
        .collect();
    svg(&charts, 2, (430, 430))
}

/// The report's program needs longer than the scenario lasts.
const SLOW_SQUARE: Change = Change {
    duration_s: Some(60.0),
    ..runs::ORIGINAL
};
const SLOW_MISSION: Change = Change {
    duration_s: Some(150.0),
    later: Some(4.0),
    ..runs::ORIGINAL
};

fn mode7() -> Result<Option<Made>, String> {
    let Some(of) = both("mode7", SLOW_SQUARE)? else {
        return Ok(None);
    };
    let square = || {
        vec![Curve::Given {
            name: "",
            points: vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)],
        }]
    };
    let rows = [
        row(
            "off the square by odometry, worst",
            "odometry_worst_m",
            100.0,
            "cm",
            "6 cm",
        ),
        row("the same, rms", "odometry_rms_m", 100.0, "cm", "2.4 cm"),
        row(
            "truly off the square, worst",
            "true_worst_m",
            100.0,
            "cm",
            "not measured",
        ),
        row(
            "true closing error",
            "end_error_m",
            100.0,
            "cm",
            "not measured",
        ),
        row("once round", "finish_s", 1.0, "s", "30 s"),
    ];
    let titles = ["the report's program", "Mode 7: ours, calibrated"];
    let range = Some([-0.3, 1.3]);
    Ok(Some(Made {
        figures: vec![(
            "mode7",
            "True ways of 20 robots around a square of 1 m: ours all but on it",
            maps(&of, titles, square, ways, range, range)?,
        )],
        words: words(&of, None, "mode7", &rows),
    }))
}

fn pursuit() -> Result<Option<Made>, String> {
    let (Some(line), Some(curve)) = (
        runs("pursuit-line", runs::OURS)?,
        runs("pursuit-curve", runs::OURS)?,
    ) else {
        return Ok(None);
    };
    let charts: Vec<Chart> = [
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
        map(
            title,
            vec![
                Curve::Given {
                    name: "",
                    points: path,
                },
                Curve::Ways {
                    name: "",
                    colour: OURS,
                    runs: ways(runs),
                },
            ],
        )
    })
    .collect();
    let rows = [
        row(
            "off the path by odometry, worst",
            "odometry_worst_m",
            100.0,
            "cm",
            "",
        ),
        row("the same, rms", "odometry_rms_m", 100.0, "cm", ""),
        row("truly off the path, worst", "true_worst_m", 100.0, "cm", ""),
        row("finished after", "finish_s", 1.0, "s", ""),
    ];
    let columns = [("line", &line), ("curve", &curve)];
    Ok(Some(Made {
        figures: vec![(
            "pursuit",
            "True ways of 20 robots along a line and along a sine",
            svg(&charts, 1, (860, 330))?,
        )],
        words: format!(
            "{}\nTrue ways of 20 robots, calibrated; limits are the curve's. `rumbo run pursuit-line pursuit-curve --runs 20`.\n",
            table(&columns, &rows)
        ),
    }))
}

/// Walls and boxes of the world.
fn shapes(setup: &Setup) -> Vec<Curve> {
    let Ok(world) = setup.world.world() else {
        return Vec::new();
    };
    world
        .obstacles()
        .iter()
        .map(|obstacle| {
            let corners = obstacle.corners().map(|[x_m, y_m]| (x_m, y_m));
            Curve::Shape(corners.collect())
        })
        .collect()
}

fn in_the_world(runs: &Runs) -> Vec<Vec<(f64, f64)>> {
    runs.each(|sample, _| (sample.x_m, sample.y_m))
}

/// A mission: maps, and the figures that its metrics give.
fn mission(
    scenario: &'static str,
    alt: &'static str,
    range: [Option<[f64; 2]>; 2],
    rows: &[Row],
) -> Result<Option<Made>, String> {
    let Some(of) = both(scenario, SLOW_MISSION)? else {
        return Ok(None);
    };
    let titles = ["the report's program", "Mode 8: ours"];
    let figure = maps(
        &of,
        titles,
        || shapes(&of[1].setup),
        in_the_world,
        range[0],
        range[1],
    )?;
    Ok(Some(Made {
        figures: vec![(scenario, alt, figure)],
        words: words(&of, None, scenario, rows),
    }))
}

fn mode8_goals() -> Result<Option<Made>, String> {
    let rows = [
        row("all four goals", "total_time_s", 1.0, "s", "32 s"),
        Row {
            least_is_worst: true,
            ..row("goals reached", "reached", 1.0, "", "4")
        },
    ];
    mission(
        "mode8-goals",
        "True ways of 20 robots to four goals",
        [None, None],
        &rows,
    )
}

fn mode8_obstacles() -> Result<Option<Made>, String> {
    let rows = [
        row("time", "total_time_s", 1.0, "s", "73.6 s"),
        row("way", "path_m", 1.0, "m", "4.16 m"),
        row("contacts", "contacts", 1.0, "", "0"),
        Row {
            least_is_worst: true,
            ..row("reached", "reached", 1.0, "", "1")
        },
    ];
    mission(
        "mode8-obstacles",
        "True ways of 20 robots around a box and a block of two",
        [Some([-0.4, 3.0]), Some([-1.6, 1.6])],
        &rows,
    )
}

fn mode8_lane() -> Result<Option<Made>, String> {
    let rows = [
        row("time of the four straights", "finish_s", 1.0, "s", "57.8 s"),
        Row {
            least_is_worst: true,
            ..row("straights driven", "straights", 1.0, "", "4")
        },
        row("contacts", "contacts", 1.0, "", "0"),
        Row {
            least_is_worst: true,
            ..row("least clearance", "clearance_m", 100.0, "cm", "")
        },
    ];
    mission(
        "mode8-lane",
        "True ways of 20 robots along a lane of boxes",
        [Some([-0.6, 2.8]), Some([-1.0, 1.4])],
        &rows,
    )
}

/// How near the program comes to what its robot did.
fn original() -> Result<Option<Made>, String> {
    let experiments: [(&str, &str, Change, &[Row]); 7] = [
        (
            "mode 1",
            "mode1",
            runs::ORIGINAL,
            &[
                row(
                    "107 -> 30 cm, within 5 %",
                    "step1.settling_s",
                    1.0,
                    "s",
                    "3.0 s",
                ),
                row(
                    "30 -> 50 cm, within 5 %",
                    "step2.settling_s",
                    1.0,
                    "s",
                    "1.2 s",
                ),
                row("overshoot", "step1.overshoot_m", 100.0, "cm", "0.6 cm"),
                row(
                    "period of the loop",
                    "control_period_s",
                    1000.0,
                    "ms",
                    "65 ms",
                ),
            ],
        ),
        (
            "mode 2",
            "mode2",
            runs::ORIGINAL,
            &[row(
                "119 -> 30 cm, within 5 %",
                "step1.settling_s",
                1.0,
                "s",
                "3.4 s",
            )],
        ),
        (
            "mode 3, easy to turn",
            "mode3",
            LIGHT,
            &[
                row(
                    "distance error, rms",
                    "distance_rms_m",
                    100.0,
                    "cm",
                    "1.2 cm",
                ),
                row(
                    "distance error, worst",
                    "distance_worst_m",
                    100.0,
                    "cm",
                    "4.6 cm",
                ),
            ],
        ),
        (
            "mode 5",
            "mode5",
            runs::ORIGINAL,
            &[
                row(
                    "0 -> 60 rpm, within 3.2 rpm",
                    "step1.settling_s",
                    1.0,
                    "s",
                    "3.7 s",
                ),
                row("50 -> 100 rpm", "step3.settling_s", 1.0, "s", "1.8 s"),
                row("0 -> -100 rpm", "step6.settling_s", 1.0, "s", "5.3 s"),
                row("0 -> 40 rpm", "step9.settling_s", 1.0, "s", "5.5 s"),
                row(
                    "ripple at 60 rpm",
                    "step1.ripple_rad_s",
                    RPM,
                    "rpm",
                    "0.9 to 2.1 rpm",
                ),
                row(
                    "period of the loop",
                    "control_period_s",
                    1000.0,
                    "ms",
                    "41 ms",
                ),
            ],
        ),
        (
            "mode 7",
            "mode7",
            SLOW_SQUARE,
            &[
                row("once round", "finish_s", 1.0, "s", "30 s"),
                row(
                    "off the square by odometry, worst",
                    "odometry_worst_m",
                    100.0,
                    "cm",
                    "6 cm",
                ),
                row("the same, rms", "odometry_rms_m", 100.0, "cm", "2.4 cm"),
                row(
                    "period of the loop",
                    "control_period_s",
                    1000.0,
                    "ms",
                    "67 ms",
                ),
            ],
        ),
        (
            "mode 8, goals",
            "mode8-goals",
            SLOW_MISSION,
            &[
                row("all four", "total_time_s", 1.0, "s", "32 s"),
                row("way", "path_m", 1.0, "m", "4.3 m"),
            ],
        ),
        (
            "mode 8, obstacles",
            "mode8-obstacles",
            SLOW_MISSION,
            &[
                row("time", "total_time_s", 1.0, "s", "73.6 s"),
                row("way", "path_m", 1.0, "m", "4.16 m"),
            ],
        ),
    ];
    let mut words = String::from(
        "| experiment | | the report's robot, one run | its program here, median | least | most |\n|---|---|---|---|---|---|\n",
    );
    for (name, scenario, change, rows) in experiments {
        let Some(runs) = runs(scenario, change)? else {
            return Ok(None);
        };
        for row in rows {
            words += &format!(
                "| {name} | {} | {} | {} |\n",
                row.what,
                row.real,
                spread(row, &runs)
            );
        }
    }
    Ok(Some(Made {
        figures: Vec::new(),
        words,
    }))
}
