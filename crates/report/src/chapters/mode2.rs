//! Mode 2: stop square to a wall.

use super::beside;
use super::panels::Pair;
use super::parts;
use super::{Experiment, highlight};
use crate::channel::Channel;
use crate::data::Data;
use crate::places::Places;
use crate::signals::{CM, DEG, ReportedRun, difference};
use crate::text::{Text, word};
use rumbo_plot::{Curve, Ink, Panel};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode2",
    number: "2",
    scenarios: &["mode2"],
    highlights: &[
        highlight("mode2", "step1.settling_s", Some(3.4)),
        highlight("mode2", "step3.within_2cm_s", Some(5.5)),
        highlight("mode2", "step1.angle_rad", None),
    ],
    fill,
};

const ANGLE_AXIS: Text = word("angle-to-the-wall");
const BY_READINGS: Text = word("of-the-two-readings");
const TRUE: Text = word("true");

fn fill(places: &mut Places, data: &Data) {
    parts::opening(places, data, "mode2", "mode_2");
    let Some(outcome) = data.outcome("mode2") else {
        return;
    };
    let pair = Pair {
        reference: outcome.reference(CM),
        distances_cm: [15.0, 50.0],
        error_cm: 5.0,
    };
    pair.fill(places, "mode2", outcome);
    let panel = angle_panel(places, outcome);
    parts::timed(places, "mode2-angle", vec![panel]);
    parts::limits(places, &[outcome]);
    beside::distance(places, data, "mode2");
}

fn angle_panel(places: &Places, outcome: &ReportedRun) -> Panel {
    let gap_m = match (outcome.setup.rig.left, outcome.setup.rig.right) {
        (Some(left), Some(right)) => left.y_m - right.y_m,
        _ => return Panel::default(),
    };
    // The left one is nearer when the robot is turned to the right, a negative heading: the wall stands across x.
    let difference_cm = difference(
        &outcome.range_cm(Channel::Left),
        &outcome.range_cm(Channel::Right),
    );
    let angle = |(t_s, cm): (f64, f64)| (t_s, DEG * (cm / CM / gap_m).clamp(-1.0, 1.0).asin());
    let curves = vec![
        Curve::new(
            places.text(BY_READINGS),
            Ink::First,
            difference_cm.into_iter().map(angle).collect(),
        ),
        Curve::new(
            places.text(TRUE),
            Ink::True,
            outcome.truth(|sample| DEG * sample.heading_rad),
        ),
    ];
    Panel::new(places.text(ANGLE_AXIS), curves).exactly(-25.0, 35.0)
}
