//! Mode 1: stop at a distance from a wall.

use super::beside;
use super::panels;
use super::parts::{self, DISTANCE, ERROR_CM, MEASURED, REFERENCE};
use super::{Experiment, highlight};
use crate::channel::Channel;
use crate::data::Data;
use crate::places::Places;
use crate::signals::{CM, ReportedRun, difference};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Panel, Plot};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode1",
    number: "1",
    scenarios: &["mode1"],
    highlights: &[
        highlight("mode1", "step1.settling_s", Some(3.0)),
        highlight("mode1", "step1.overshoot_m", Some(0.006)),
        highlight("mode1", "step2.settling_s", Some(1.2)),
    ],
    fill,
};

const LAW_X: Text = word("error-distance-reference-cm");
const LAW_Y: Text = word("speed-m-s");
const FAR: Text = word("far-planned-deceleration");
const NEAR: Text = word("near-proportional");
const IN_FORCE: Text = word("in-force");
fn fill(places: &mut Places, data: &Data) {
    let Some(outcome) = data.outcome("mode1") else {
        return;
    };
    let language = places.language;
    let plant = &outcome.setup.robot.plant;
    places.value("radius", language.short(CM * plant.wheels.left.radius_m, 2));
    places.value("base", language.short(CM * plant.body.base_m, 1));
    parts::opening(places, data, "mode1", "mode_1");
    places.figure("mode1-law", Some(law(language)));
    let panels = vec![
        distance_panel(language, outcome),
        panels::pwm_panel(language, outcome),
    ];
    parts::timed(places, "mode1-distances", panels);
    let error = difference(&outcome.range_cm(Channel::Front), &outcome.reference(CM));
    let panel = Panel::new(
        places.text(ERROR_CM),
        vec![Curve::new("", Ink::First, error)],
    )
    .at_least(-5.0, 5.0);
    parts::timed(places, "mode1-error", vec![panel]);
    parts::limits(places, &[outcome]);
    beside::distance(places, data, "mode1");
}

/// Speed over error, with the parameters' defaults.
fn law(language: Language) -> String {
    let errors = (-400..=800).map(|mm| f64::from(mm) * 1e-3);
    let (cruise, brake, kp) = (0.5_f64, 0.36, 5.0);
    let curve = |speed: fn(f64, f64, f64) -> f64| -> Vec<(f64, f64)> {
        errors
            .clone()
            .map(|e| (CM * e, e.signum() * speed(e.abs(), brake, kp)))
            .collect()
    };
    let applied: Vec<(f64, f64)> = errors
        .clone()
        .map(|e| {
            (
                CM * e,
                e.signum() * cruise.min((2.0 * brake * e.abs()).sqrt()).min(kp * e.abs()),
            )
        })
        .collect();
    let curves = vec![
        Curve::new(
            FAR.of(language),
            Ink::Third,
            curve(|e, a, _| (2.0 * a * e).sqrt()),
        ),
        Curve::new(NEAR.of(language), Ink::Second, curve(|e, _, k| k * e)),
        Curve::new(IN_FORCE.of(language), Ink::First, applied),
    ];
    let panel = Panel::new(LAW_Y.of(language), curves).exactly(-0.6, 0.8);
    Plot {
        x: LAW_X.of(language).to_owned(),
        x_range: Some([-40.0, 80.0]),
        panels: vec![panel],
    }
    .svg(language)
}

fn distance_panel(language: Language, outcome: &ReportedRun) -> Panel {
    let curves = vec![
        Curve::steps(
            REFERENCE.of(language),
            Ink::Reference,
            outcome.reference(CM),
        ),
        Curve::new(
            MEASURED.of(language),
            Ink::First,
            outcome.range_cm(Channel::Front),
        ),
    ];
    Panel::new(DISTANCE.of(language), curves).at_least(0.0, 100.0)
}
