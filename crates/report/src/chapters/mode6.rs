//! Mode 6: straight on by the difference of distance travelled.

use super::beside;
use super::maps;
use super::mode5;
use super::panels;
use super::parts::{self, MEASURED, REFERENCE, SPEED};
use super::{Experiment, highlight};
use crate::channel::Channel;
use crate::data::Data;
use crate::places::Places;
use crate::signals::{CM, DEG, RPM, ReportedRun};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Map, Panel};
use rumbo_wire::text::TextRow;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode6",
    number: "6",
    scenarios: &["mode6"],
    highlights: &[
        highlight("mode6", "after_3_m.sideways_m", None),
        highlight("mode6", "after_3_m.heading_rad", None),
    ],
    fill,
};

const VARIABLE_NAME: Text = word("variable-reference");
const CONSTANT_NAME: Text = word("constant-reference");
const LEFT_AXIS: Text = word("left-wheel-rpm");
const RIGHT_AXIS: Text = word("right-wheel-rpm");
const DIFFERENCE_AXIS: Text = word("difference-cm");
const HEADING_AXIS: Text = word("true-heading");

fn fill(places: &mut Places, data: &Data) {
    parts::opening(places, data, "mode6", "modes_5_to_7");
    let Some(outcome) = data.outcome("mode6") else {
        return;
    };
    results(places, outcome);
    parts::limits(places, &[outcome]);
    beside(places, data);
}

fn results(places: &mut Places, outcome: &ReportedRun) {
    let language = places.language;
    let speeds = || mode5::speed_panel(language, outcome);
    let panels = vec![speeds(), panels::pwm_panel(language, outcome)];
    parts::timed(places, "mode6-speeds", panels);
    parts::timed_within(places, "mode6-transient", vec![speeds()], Some([0.0, 2.0]));
    let panel = speeds().at_least(38.0, 42.0);
    parts::timed_within(places, "mode6-steady", vec![panel], Some([3.0, 23.0]));
    let panels = vec![
        variable(language, outcome, LEFT_AXIS, Ink::First, Channel::Left),
        variable(language, outcome, RIGHT_AXIS, Ink::Second, Channel::Right),
    ];
    if outcome.setup.takes_parameters() {
        parts::timed_within(places, "mode6-variable", panels, Some([3.0, 23.0]));
    } else {
        places.nothing("mode6-variable");
    }
    let base_cm = CM * outcome.setup.robot.plant.body.base_m;
    let [.., heading_deg] = outcome.pose();
    let angle = heading_deg
        .iter()
        .map(|(t_s, deg)| (*t_s, base_cm * deg / DEG))
        .collect();
    let panels = vec![
        Panel::new(
            places.text(DIFFERENCE_AXIS),
            vec![Curve::new("", Ink::First, angle)],
        )
        .at_least(-0.2, 0.2),
        Panel::new(
            places.text(HEADING_AXIS),
            vec![Curve::new(
                "",
                Ink::Third,
                outcome.truth(|sample| DEG * sample.heading_rad),
            )],
        )
        .at_least(-2.0, 2.0),
    ];
    parts::timed(places, "mode6-difference", panels);
    let start = outcome.setup.scenario.start;
    let line = vec![(start.x_m, start.y_m), (start.x_m + 3.2, start.y_m)];
    let map = Map {
        curves: maps::trajectories(language, outcome, line),
        range: Some([[start.x_m - 0.1, start.x_m + 3.4], [-0.3, 0.3]]),
        ..maps::map(language)
    };
    let svg = map.svg(language);
    places.figure("mode6-way", Some(svg));
}

fn variable(
    language: Language,
    outcome: &ReportedRun,
    axis: Text,
    ink: Ink,
    wheel: Channel,
) -> Panel {
    let curves = vec![
        Curve::new(MEASURED.of(language), ink, outcome.speed_rpm(wheel)),
        Curve::new(
            VARIABLE_NAME.of(language),
            Ink::Fourth,
            outcome.speed_reference_rpm(wheel),
        ),
        Curve::steps(
            CONSTANT_NAME.of(language),
            Ink::Reference,
            outcome.reference(RPM),
        ),
    ];
    Panel::new(axis.of(language), curves).at_least(38.0, 42.0)
}

fn beside(places: &mut Places, data: &Data) {
    let Some((ours, recording)) = beside::recorded(places, data, "mode6") else {
        return;
    };
    let real = recording.signal(|row| match row {
        TextRow::Speed(row) => Some(f64::from(row.wheel_rpm.left)),
        _ => None,
    });
    let mut curves = vec![Curve::steps(
        places.text(REFERENCE),
        Ink::Reference,
        ours.reference(RPM),
    )];
    curves.extend(beside::both(
        places.language,
        recording,
        ours.speed_rpm(Channel::Left),
        real,
    ));
    let panel = Panel::new(places.text(SPEED), curves);
    parts::timed(places, "mode6-real", vec![panel]);
}
