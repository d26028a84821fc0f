//! Figures of a hand-in's run.

use crate::channel::Channel;
use crate::chapters::maps;
use crate::chapters::panels::pwm_panel;
use crate::chapters::parts::{DISTANCE, LEFT, REFERENCE, RIGHT, SPEED, TIME};
use crate::signals::{CM, RPM, ReportedRun};
use crate::text::{Language, Text, word};
use rumbo_control::mode::ReferenceKind;
use rumbo_control::rig::Rig;
use rumbo_experiment::grade::GradedTest;
use rumbo_plot::{Curve, Ink, Panel, Plot};
use rumbo_wire::Command;

const LEFT_SONAR: Text = word("left-sonar");
const RIGHT_SONAR: Text = word("right-sonar");
const FRONT: Text = word("front-sonar");
const DRIVEN: Text = word("driven");

/// The quantity plotted for a run of this mode, from ground truth.
pub(super) fn figures(language: Language, test: &GradedTest, outcome: &ReportedRun) -> Vec<String> {
    let truth = |name: Text, ink, signal: &dyn Fn(&rumbo_sim::trace::TruthSample) -> f64| {
        Curve::new(name.of(language), ink, outcome.truth(signal))
    };
    let range = |name, ink, sonar: Channel| {
        truth(name, ink, &|s| {
            CM * outcome.trace().range_m(s, sonar as usize)
        })
    };
    let speed =
        |name, ink, wheel: Channel| truth(name, ink, &|s| RPM * s.wheel_rad_s[wheel as usize]);
    let speeds = || {
        vec![
            speed(LEFT, Ink::First, Channel::Left),
            speed(RIGHT, Ink::Second, Channel::Right),
        ]
    };
    let asked = |factor| {
        Curve::steps(
            REFERENCE.of(language),
            Ink::Reference,
            outcome.reference(factor),
        )
    };
    let pwm = pwm_panel(language, outcome);
    let timed = |panels| {
        Plot {
            x: TIME.of(language).to_owned(),
            x_range: None,
            panels,
        }
        .svg(language)
    };
    let with = |text: Text, mut curves: Vec<Curve>, more: Curve| {
        curves.insert(0, more);
        Panel::new(text.of(language), curves)
    };
    let mode = test.setup.scenario.mode.description();
    match mode.reference.map(|reference| reference.kind) {
        Some(ReferenceKind::Distance) if mode.rigs.contains(Rig::FrontSingle) => {
            let front = vec![range(FRONT, Ink::First, Channel::Front)];
            vec![timed(vec![
                with(DISTANCE, front, asked(CM)).at_least(0.0, 100.0),
                pwm,
            ])]
        }
        Some(ReferenceKind::Distance) => {
            let both = vec![
                range(LEFT_SONAR, Ink::First, Channel::Left),
                range(RIGHT_SONAR, Ink::Second, Channel::Right),
            ];
            vec![timed(vec![with(DISTANCE, both, asked(CM)), pwm])]
        }
        Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => {
            vec![timed(vec![with(SPEED, speeds(), asked(RPM)), pwm])]
        }
        None => vec![timed(vec![Panel::new(SPEED.of(language), speeds()), pwm])],
        Some(ReferenceKind::Goal) => {
            let mut map = maps::map(language);
            map.shapes = maps::shapes(outcome);
            map.curves = vec![Curve::new(
                DRIVEN.of(language),
                Ink::First,
                outcome.true_trajectory(),
            )];
            map.marks = goals(outcome);
            let speeds = Panel::new(SPEED.of(language), speeds());
            vec![map.svg(language), timed(vec![speeds, pwm])]
        }
    }
}

/// The robot's goals, in the world.
fn goals(outcome: &ReportedRun) -> Vec<(f64, f64, String)> {
    let start = outcome.setup.scenario.start;
    let (sin, cos) = start.heading_rad.sin_cos();
    let commands = outcome.setup.scenario.commands.iter();
    let places = commands.filter_map(|timed| match timed.command {
        Command::Goal { x_m, y_m } => Some((f64::from(x_m), f64::from(y_m))),
        Command::Waypoint(place) => Some((f64::from(place.x_m), f64::from(place.y_m))),
        _ => None,
    });
    places
        .enumerate()
        .map(|(number, (x, y))| {
            let (x, y) = (start.x_m + cos * x - sin * y, start.y_m + sin * x + cos * y);
            (x, y, (number + 1).to_string())
        })
        .collect()
}
