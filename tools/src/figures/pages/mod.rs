//! The sections of each page of docs/theory, and of docs/wiring.md.

mod manual;
mod walls;
mod ways;
mod wheels;
mod wiring;

use crate::figures::runs::{self, Change, Runs, runs};
use crate::figures::table::{Row, row, spread, table};
use rumbo_experiment::files::Setup;
use rumbo_plot::{Curve, Ink, Map, Panel, Plot, Points, Shape, Sheet, WIDTH, Words};
use rumbo_sim::trace::TruthSample;
use rumbo_wire::Command;

const RPM: f64 = 30.0 / std::f64::consts::PI;
const DEG: f64 = 180.0 / std::f64::consts::PI;
/// How the programs look.
const OURS: Ink = Ink::First;
const BASELINE: Ink = Ink::Second;

/// A section of a page.
pub(crate) struct Page {
    pub(crate) name: &'static str,
    pub(crate) file: &'static str,
    pub(crate) make: fn() -> Result<Option<Made>, String>,
}

/// Its content: figures with name, alternative text and SVG, and the text below them.
pub(crate) struct Made {
    pub(crate) figures: Vec<(&'static str, &'static str, String)>,
    pub(crate) words: String,
}

pub(crate) const PAGES: &[Page] = &[
    page("manual", "manual.md", manual::manual),
    page("mode1", "front_distance.md", walls::mode1),
    page("mode2", "front_align.md", walls::mode2),
    page("mode3", "wall_follow.md", walls::mode3),
    page("mode4", "wall_follow.md", walls::mode4),
    page("mode5", "wheel_speed.md", wheels::mode5),
    page("mode6", "straight_line.md", wheels::mode6),
    page("mode7", "waypoints.md", ways::mode7),
    page("pursuit", "pursuit.md", ways::pursuit),
    page("mode8-lane", "lane.md", ways::mode8_lane),
    page("mode8-goals", "baseline.md", ways::mode8_goals),
    page("mode8-obstacles", "baseline.md", ways::mode8_obstacles),
    page("wiring", "../wiring.md", wiring::wiring),
];

const fn page(
    name: &'static str,
    file: &'static str,
    make: fn() -> Result<Option<Made>, String>,
) -> Page {
    Page { name, file, make }
}

/// Both programs' runs of a scenario, the report's first.
fn both(scenario: &str, baseline: Change) -> Result<Option<[Runs; 2]>, String> {
    Ok(runs(scenario, baseline)?
        .zip(runs(scenario, runs::OURS)?)
        .map(|(baseline, ours)| [baseline, ours]))
}

/// A signal over time, of both programs.
fn signal(baseline: &Runs, ours: &Runs, signal: impl Fn(&TruthSample) -> f64) -> Vec<Curve> {
    vec![
        Curve::median(REPORT, BASELINE, &baseline.over_time(&signal)),
        Curve::median("ours", OURS, &ours.over_time(&signal)),
    ]
}

/// A figure of panels.
fn figure(title: &str, plot: &Plot) -> String {
    let picture = plot.picture(Words::default(), WIDTH);
    Sheet::new(1).with(title, picture).svg()
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
    Curve::new("reference", Ink::Reference, points)
}

fn pwm(baseline: &Runs, ours: &Runs) -> Panel {
    let pwm = signal(baseline, ours, |sample| f64::from(sample.duty[0]));
    Panel::new("PWM of the left wheel, of 255", pwm)
}

const REPORT: &str = "the report's program";

/// The text below a figure of both programs: the table, and what was run.
fn words(columns: &[(&str, &Runs)], scenario: &str, rows: &[Row]) -> String {
    let end = match columns {
        [(_, baseline), .., (_, ours)]
            if baseline.setup.scenario.duration_s > ours.setup.scenario.duration_s =>
        {
            format!(", given {} s", baseline.setup.scenario.duration_s)
        }
        _ => String::new(),
    };
    format!(
        "{}\n`rumbo run {scenario} --runs {seeds}`, and with `--program baseline`{end}. The figure shows median and range.\n",
        table(columns, rows),
        seeds = runs::SEEDS,
    )
}

/// The report's program needs longer than the scenario lasts.
const SLOW_STEPS: Change = Change {
    duration_s: Some(30.0),
    later: Some(1.4),
    ..runs::BASELINE
};
const SLOW_SQUARE: Change = Change {
    duration_s: Some(60.0),
    ..runs::BASELINE
};
const SLOW_MISSION: Change = Change {
    duration_s: Some(150.0),
    later: Some(4.0),
    ..runs::BASELINE
};

/// Every seed's path.
type Ways = Vec<Points>;

/// Every seed's path relative to the start.
fn ways(runs: &Runs) -> Ways {
    let start = runs.setup.scenario.start;
    let (sin, cos) = start.heading_rad.sin_cos();
    runs.each(|sample| {
        let (dx, dy) = (sample.x_m - start.x_m, sample.y_m - start.y_m);
        (cos * dx + sin * dy, cos * dy - sin * dx)
    })
}
