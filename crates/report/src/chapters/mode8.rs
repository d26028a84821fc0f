//! Mode 8: goals, around obstacles, and a lane of boxes.

use super::maps;
use super::mode8_beside;
use super::panels;
use super::parts;
use super::{Experiment, Highlight};
use crate::data::Data;
use crate::places::Places;
use crate::signals::{ReportedRun, unwrapped};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Map, Panel, Points};

const GOALS: Text = word("goals");
const LANE: Text = word("lane");
const OBSTACLES: Text = word("obstacles");

const fn of(what: Text, scenario: &'static str, metric: &'static str, real: f64) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: Some(what),
        real: Some(real),
    }
}

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode8",
    number: "8",
    scenarios: &["mode8-goals", "mode8-lane", "mode8-obstacles"],
    highlights: &[
        of(GOALS, "mode8-goals", "total_time_s", 32.0),
        of(LANE, "mode8-lane", "finish_s", 57.8),
        of(OBSTACLES, "mode8-obstacles", "total_time_s", 73.6),
        of(OBSTACLES, "mode8-obstacles", "path_m", 4.16),
    ],
    fill,
};

const GOAL_X: Text = word("goal-x");
const GOAL_Y: Text = word("goal-y");
const POSITION: Text = word("position-m");
const HEADING: Text = word("heading-deg");
const HEADING_NAME: Text = word("heading");
const HEADING_REFERENCE: Text = word("heading-reference");
const STRAIGHT: Text = word("straight-line");
const TRUE: Text = word("true");
const START: Text = word("start");

/// Names of the states, in the order of their numbers.
const STATES: [Text; 13] = [
    word("wait-for-goal"),
    word("initial-turn"),
    word("initialise"),
    word("go-to-goal"),
    word("sweep-right"),
    word("sweep-left"),
    word("decide"),
    word("avoidance-turn"),
    word("advance-seek-the-obstacle"),
    word("advance-along-it"),
    word("advance-safe-distance"),
    word("unreachable"),
    word("straight-on"),
];

/// The original program in a lane numbers its states from 0 again.
const ORIGINAL_LANE: [Text; 5] = [STATES[12], STATES[4], STATES[5], STATES[6], STATES[7]];

fn fill(places: &mut Places, data: &Data) {
    parts::rig_figure(places, data, "mode8", "mode8-goals");
    parts::wiring_figure(places, data, "mode8", "mode8-goals", "final");
    goals(places, data);
    lane_results(places, data);
    obstacles(places, data);
    parts::limits(places, &data.of(&EXPERIMENT));
    for scenario in EXPERIMENT.scenarios {
        mode8_beside::fill(places, data, scenario);
    }
}

/// Panels until a little after the end of what the run is about: the last goal reached, or the end of the lane.
fn until(places: &mut Places, outcome: &ReportedRun, id: &str, panels: Vec<Panel>) {
    let end_s = outcome
        .end_s()
        .map_or(outcome.duration_s(), |end_s| end_s + 2.0);
    parts::timed_within(
        places,
        id,
        panels,
        Some([0.0, end_s.min(outcome.duration_s())]),
    );
}

fn goals(places: &mut Places, data: &Data) {
    let Some(outcome) = data.outcome("mode8-goals") else {
        return;
    };
    let language = places.language;
    let panels = pose_panels(language, outcome, true);
    until(places, outcome, "mode8-goals-pose", panels);
    let panel = panels::references_panel(language, outcome);
    until(places, outcome, "mode8-goals-speeds", vec![panel]);
    let start = outcome.setup.scenario.start;
    let mut ideal = vec![(start.x_m, start.y_m)];
    ideal.extend(
        outcome
            .reached_s()
            .iter()
            .map(|t_s| outcome.true_position_at(*t_s)),
    );
    let mut marks = vec![(start.x_m, start.y_m, places.text(START).to_owned())];
    marks.extend(
        ideal
            .iter()
            .skip(1)
            .zip(1..)
            .map(|((x, y), number)| (*x, *y, format!("{number}"))),
    );
    let curves = vec![
        Curve::new(places.text(STRAIGHT), Ink::Reference, ideal),
        Curve::new(places.text(TRUE), Ink::Third, outcome.true_trajectory()),
    ];
    let svg = Map {
        curves,
        marks,
        ..maps::map(language)
    }
    .svg(language);
    places.figure("mode8-goals-way", Some(svg));
    let panel = panels::state_panel(language, outcome, &STATES);
    until(places, outcome, "mode8-goals-states", vec![panel]);
}

fn lane_results(places: &mut Places, data: &Data) {
    let Some(outcome) = data.outcome("mode8-lane") else {
        return;
    };
    let language = places.language;
    let panel = panels::references_panel(language, outcome);
    until(places, outcome, "mode8-lane-speeds", vec![panel]);
    let svg = maps::path_map(places, outcome, Points::new()).svg(language);
    places.figure("mode8-lane-way", Some(svg));
    let panels = panels::range_panels(language, outcome);
    until(places, outcome, "mode8-lane-ranges", panels);
    let panels = pose_panels(language, outcome, false);
    until(places, outcome, "mode8-lane-pose", panels);
    let names: &[Text] = if outcome.has_text_rows() {
        &ORIGINAL_LANE
    } else {
        &STATES
    };
    let panel = panels::state_panel(language, outcome, names);
    until(places, outcome, "mode8-lane-states", vec![panel]);
}

fn obstacles(places: &mut Places, data: &Data) {
    let Some(outcome) = data.outcome("mode8-obstacles") else {
        return;
    };
    let language = places.language;
    let start = outcome.setup.scenario.start;
    let straight = vec![(start.x_m, start.y_m), (start.x_m + 2.5, start.y_m)];
    let svg = maps::path_map(places, outcome, straight).svg(language);
    places.figure("mode8-obstacles-way", Some(svg));
    let panels = pose_panels(language, outcome, true);
    until(places, outcome, "mode8-obstacles-pose", panels);
    let panel = panels::references_panel(language, outcome);
    parts::timed(places, "mode8-obstacles-speeds", vec![panel]);
    let panels = panels::range_panels(language, outcome);
    until(places, outcome, "mode8-obstacles-ranges", panels);
    let panel = panels::state_panel(language, outcome, &STATES);
    parts::timed(places, "mode8-obstacles-states", vec![panel]);
}

/// Coordinates, with those of the goal, and heading with its reference.
fn pose_panels(language: Language, outcome: &ReportedRun, goal: bool) -> Vec<Panel> {
    let [x, y, heading] = outcome.pose();
    let mut position = Vec::new();
    if goal {
        let [goal_x, goal_y] = outcome.goal_m();
        position.push(Curve::steps(GOAL_X.of(language), Ink::Reference, goal_x));
        position.push(Curve::steps(GOAL_Y.of(language), Ink::Fourth, goal_y));
    }
    position.push(Curve::new("x", Ink::First, x));
    position.push(Curve::new("y", Ink::Second, y));
    let headings = vec![
        Curve::steps(
            HEADING_REFERENCE.of(language),
            Ink::Reference,
            unwrapped(outcome.heading_reference_deg()),
        ),
        Curve::new(HEADING_NAME.of(language), Ink::Third, heading),
    ];
    vec![
        Panel::new(POSITION.of(language), position),
        Panel::new(HEADING.of(language), headings).exactly(-190.0, 190.0),
    ]
}
