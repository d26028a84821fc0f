//! What all chapters have in common: headings, names of axes, rig and wiring, figures over time.

use crate::data::Data;
use crate::drawing::{rig, wiring};
use crate::judge;
use crate::places::Places;
use crate::signals::ReportedRun;
use crate::text::{Text, word};
use rumbo_plot::{Panel, Plot};

pub(crate) const TIME: Text = word("time-since-arming-s");
pub(crate) const DISTANCE: Text = word("distance-cm");
pub(super) const ERROR_CM: Text = word("error-cm");
pub(super) const ERROR_RPM: Text = word("error-rpm");
pub(crate) const SPEED: Text = word("speed-rpm");
pub(super) const PWM: Text = word("pwm-of-255");
pub(crate) const LEFT: Text = word("left");
pub(crate) const RIGHT: Text = word("right");
pub(crate) const REFERENCE: Text = word("reference");
pub(super) const MEASURED: Text = word("measured");

/// The drawing of a scenario's rig.
pub(super) fn rig_figure(places: &mut Places, data: &Data, id: &str, scenario: &str) {
    let svg = data
        .outcome(scenario)
        .map(|outcome| rig::svg(places.language, &outcome.setup));
    places.figure(&format!("{id}-rig"), svg);
}

/// The drawing of one of the robot's wirings, where it has that one.
pub(super) fn wiring_figure(
    places: &mut Places,
    data: &Data,
    id: &str,
    scenario: &str,
    name: &str,
) {
    let wiring = data
        .outcome(scenario)
        .and_then(|outcome| outcome.setup.robot.wirings.get(name));
    let svg = wiring.map(|wiring| wiring::svg(places.language, wiring));
    places.figure(&format!("{id}-wiring"), svg);
}

/// What most chapters begin with: rig and wiring of its scenario.
pub(super) fn opening(places: &mut Places, data: &Data, id: &str, wiring: &str) {
    rig_figure(places, data, id, id);
    wiring_figure(places, data, id, id, wiring);
}

/// The metrics of runs against their limits.
pub(super) fn limits(places: &mut Places, outcomes: &[&ReportedRun]) {
    let tables = judge::limits(places.language, outcomes);
    places.block("limits", tables);
}

/// A figure of panels over the time of a run.
pub(super) fn timed(places: &mut Places, id: &str, panels: Vec<Panel>) {
    timed_within(places, id, panels, None);
}

/// The same over a part of it.
pub(super) fn timed_within(
    places: &mut Places,
    id: &str,
    panels: Vec<Panel>,
    x_range: Option<[f64; 2]>,
) {
    let plot = Plot {
        x: places.text(TIME).to_owned(),
        x_range,
        panels,
    };
    places.figure(id, Some(plot.svg(places.language)));
}
