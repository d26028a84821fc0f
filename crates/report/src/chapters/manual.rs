//! Basic movements, open loop: dead zones, static curves, asymmetry, and what becomes of straight lines and turns.

use super::manual_tables;
use super::maps;
use super::panels;
use super::parts::{self, LEFT, PWM, RIGHT, SPEED};
use super::{Experiment, Highlight};
use crate::channel::Channel;
use crate::data::Data;
use crate::judge;
use crate::places::Places;
use crate::signals::{RPM, ReportedRun};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Map, Panel, Plot, Points};

const FLOOR: Text = word("on-the-floor-forward");

const fn of(
    what: Text,
    scenario: &'static str,
    metric: &'static str,
    real: Option<f64>,
) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: Some(what),
        real,
    }
}

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "manual",
    number: "0",
    scenarios: &[
        "manual-curve-floor-forward",
        "manual-curve-floor-backward",
        "manual-curve-air-forward",
        "manual-curve-air-backward",
        "manual-deadzone-floor-forward",
        "manual-deadzone-floor-backward",
        "manual-deadzone-left-forward",
        "manual-deadzone-left-backward",
        "manual-deadzone-right-forward",
        "manual-deadzone-right-backward",
        "manual-asymmetry-forward",
        "manual-asymmetry-backward",
        "manual-straight",
        "manual-backward",
        "manual-turn-left",
        "manual-turn-right",
        "manual-pivot-left-forward",
        "manual-pivot-left-backward",
        "manual-pivot-right-forward",
        "manual-pivot-right-backward",
        "manual-arc-left",
        "manual-arc-right",
        "manual-arc-left-backward",
        "manual-arc-right-backward",
        "manual-straight-speed",
        "manual-backward-speed",
        "manual-turn-left-speed",
        "manual-turn-right-speed",
        "manual-arc-left-speed",
        "manual-arc-right-speed",
    ],
    highlights: &[
        of(
            FLOOR,
            "manual-deadzone-floor-forward",
            "left_dead_zone_duty",
            Some(65.0 / 255.0),
        ),
        of(
            FLOOR,
            "manual-deadzone-floor-forward",
            "right_dead_zone_duty",
            Some(65.0 / 255.0),
        ),
        of(
            word("in-the-air-forward"),
            "manual-deadzone-right-forward",
            "right_dead_zone_duty",
            Some(35.0 / 255.0),
        ),
    ],
    fill,
};

const FORWARD_AXIS: Text = word("forward-rpm");
const BACKWARD_AXIS: Text = word("backward-rpm");
const LEFT_AXIS: Text = word("left-wheel-rpm");
const RIGHT_AXIS: Text = word("right-wheel-rpm");
const ON_FLOOR: Text = word("on-the-floor");
const IN_AIR: Text = word("in-the-air");
const THRESHOLDS: Text = word("thresholds-of-the-original-report");
const STRAIGHT: Text = word("straight");
const ARCS: Text = word("arcs");
const PIVOTS: Text = word("pivots");
const TURNS: Text = word("turns-about-the-centre");

fn fill(places: &mut Places, data: &Data) {
    let language = places.language;
    places.figure("manual-curves", Some(curves(language, data)));
    places.block("starts", manual_tables::starts(language, data));
    dead_zone(places, data);
    asymmetry(places, data);
    places.figure("manual-ways", Some(trajectories(language, data, "")));
    places.figure(
        "manual-ways-speed",
        Some(trajectories(language, data, "-speed")),
    );
    places.block(
        "movements",
        manual_tables::movements(language, data, &EXPERIMENT),
    );
    let limits = judge::limits_together(language, &data.of(&EXPERIMENT));
    places.block("limits", limits);
}

/// Speed over PWM of both wheels.
fn curves(language: Language, data: &Data) -> String {
    let panel = |axis: Text, wheel: Channel| {
        let mut curves: Vec<Curve> = [35.0, -35.0, 65.0, -65.0]
            .map(|pwm| {
                Curve::new(
                    THRESHOLDS.of(language),
                    Ink::Reference,
                    vec![(pwm, -200.0), (pwm, 200.0)],
                )
            })
            .into();
        for (name, ink, scenario) in [
            (ON_FLOOR, Ink::First, "manual-curve-floor"),
            (IN_AIR, Ink::Third, "manual-curve-air"),
        ] {
            for way in ["forward", "backward"] {
                if let Some(outcome) = data.outcome(&format!("{scenario}-{way}")) {
                    let samples = outcome.result.trace.samples.iter();
                    let points = samples.map(|sample| {
                        (
                            f64::from(sample.duty[wheel as usize]),
                            RPM * sample.wheel_rad_s[wheel as usize],
                        )
                    });
                    curves.push(Curve::new(name.of(language), ink, points.collect()));
                }
            }
        }
        Panel::new(axis.of(language), curves).exactly(-150.0, 150.0)
    };
    let panels = vec![
        panel(LEFT_AXIS, Channel::Left),
        panel(RIGHT_AXIS, Channel::Right),
    ];
    Plot {
        x: PWM.of(language).to_owned(),
        x_range: Some([-130.0, 130.0]),
        panels,
    }
    .svg(language)
}

fn dead_zone(places: &mut Places, data: &Data) {
    let Some(outcome) = data.outcome("manual-deadzone-floor-forward") else {
        return;
    };
    let panels = vec![
        speeds(places.language, outcome, SPEED),
        panels::pwm_panel(places.language, outcome),
    ];
    parts::timed(places, "manual-deadzone", panels);
}

fn asymmetry(places: &mut Places, data: &Data) {
    let Some((forward, backward)) = data
        .outcome("manual-asymmetry-forward")
        .zip(data.outcome("manual-asymmetry-backward"))
    else {
        return;
    };
    let panels = vec![
        speeds(places.language, forward, FORWARD_AXIS),
        speeds(places.language, backward, BACKWARD_AXIS),
    ];
    parts::timed(places, "manual-asymmetry", panels);
}

/// True speeds of both wheels.
fn speeds(language: Language, outcome: &ReportedRun, axis: Text) -> Panel {
    let curve = |name: Text, ink, wheel: Channel| {
        Curve::new(
            name.of(language),
            ink,
            outcome.truth(|sample| RPM * sample.wheel_rad_s[wheel as usize]),
        )
    };
    Panel::new(
        axis.of(language),
        vec![
            curve(LEFT, Ink::First, Channel::Left),
            curve(RIGHT, Ink::Second, Channel::Right),
        ],
    )
}

const WAYS: [(&str, Text, Ink); 12] = [
    ("manual-straight", STRAIGHT, Ink::First),
    ("manual-backward", STRAIGHT, Ink::First),
    ("manual-arc-left", ARCS, Ink::Second),
    ("manual-arc-right", ARCS, Ink::Second),
    ("manual-arc-left-backward", ARCS, Ink::Second),
    ("manual-arc-right-backward", ARCS, Ink::Second),
    ("manual-pivot-left-forward", PIVOTS, Ink::Third),
    ("manual-pivot-left-backward", PIVOTS, Ink::Third),
    ("manual-pivot-right-forward", PIVOTS, Ink::Third),
    ("manual-pivot-right-backward", PIVOTS, Ink::Third),
    ("manual-turn-left", TURNS, Ink::Fourth),
    ("manual-turn-right", TURNS, Ink::Fourth),
];

/// The paths of all movements, each from its own start.
fn trajectories(language: Language, data: &Data, suffix: &str) -> String {
    let curve = |(scenario, name, ink): &(&str, Text, Ink)| {
        let outcome = data.outcome(&format!("{scenario}{suffix}"))?;
        let start = outcome.setup.scenario.start;
        let (sin, cos) = start.heading_rad.sin_cos();
        let seen = |(x, y): (f64, f64)| {
            let (x, y) = (x - start.x_m, y - start.y_m);
            (cos * x + sin * y, cos * y - sin * x)
        };
        let points: Points = outcome.true_trajectory().into_iter().map(seen).collect();
        Some(Curve::new(name.of(language), *ink, points))
    };
    Map {
        curves: WAYS.iter().filter_map(curve).collect(),
        ..maps::map(language)
    }
    .svg(language)
}
