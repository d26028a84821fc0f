//! Mode 5: each wheel at a commanded speed.

use super::beside;
use super::panels;
use super::parts::{self, ERROR_RPM, LEFT, REFERENCE, RIGHT, SPEED};
use super::{Experiment, highlight};
use crate::channel::Channel;
use crate::data::Data;
use crate::places::Places;
use crate::respond::{self, Kind};
use crate::signals::{RPM, ReportedRun, difference};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Panel};
use rumbo_wire::text::TextRow;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode5",
    number: "5",
    scenarios: &["mode5", "mode5-reversal"],
    highlights: &[
        highlight("mode5", "step1.settling_s", Some(3.7)),
        highlight("mode5", "step3.settling_s", Some(1.8)),
        highlight("mode5", "step6.settling_s", Some(5.3)),
    ],
    fill,
};

const RIGHT_SPEED: Text = word("right-wheel-rpm");
const LEFT_SPEED: Text = word("left-wheel-rpm");

fn fill(places: &mut Places, data: &Data) {
    parts::wiring_figure(places, data, "mode5", "mode5", "modes_5_to_7");
    if let Some(outcome) = data.outcome("mode5") {
        let panels = vec![
            speed_panel(places.language, outcome),
            panels::pwm_panel(places.language, outcome),
        ];
        parts::timed(places, "mode5-speeds", panels);
        let panel = Panel::new(places.text(ERROR_RPM), errors(places.language, outcome));
        parts::timed(places, "mode5-error", vec![panel]);
    }
    if let Some(outcome) = data.outcome("mode5-reversal") {
        let panels = vec![
            speed_panel(places.language, outcome),
            panels::pwm_panel(places.language, outcome),
        ];
        parts::timed(places, "mode5-reversal", panels);
    }
    parts::limits(places, &data.of(&EXPERIMENT));
    beside(places, data);
}

/// Speeds of both wheels with the reference of the commands.
pub(super) fn speed_panel(language: Language, outcome: &ReportedRun) -> Panel {
    let curve =
        |name: Text, ink, wheel| Curve::new(name.of(language), ink, outcome.speed_rpm(wheel));
    Panel::new(
        SPEED.of(language),
        vec![
            Curve::steps(
                REFERENCE.of(language),
                Ink::Reference,
                outcome.reference(RPM),
            ),
            curve(LEFT, Ink::First, Channel::Left),
            curve(RIGHT, Ink::Second, Channel::Right),
        ],
    )
}

fn errors(language: Language, outcome: &ReportedRun) -> Vec<Curve> {
    let reference = outcome.reference(RPM);
    [
        (LEFT, Ink::First, Channel::Left),
        (RIGHT, Ink::Second, Channel::Right),
    ]
    .into_iter()
    .map(|(name, ink, wheel)| {
        Curve::new(
            name.of(language),
            ink,
            difference(&outcome.speed_rpm(wheel), &reference),
        )
    })
    .collect()
}

fn beside(places: &mut Places, data: &Data) {
    let Some((ours, recording)) = beside::recorded(places, data, "mode5") else {
        return;
    };
    let language = places.language;
    let real = |wheel| {
        recording.signal(|row| match row {
            TextRow::Speed(row) if wheel == Channel::Left => Some(f64::from(row.wheel_rpm.left)),
            TextRow::Speed(row) => Some(f64::from(row.wheel_rpm.right)),
            _ => None,
        })
    };
    let panel = |name: Text, wheel| {
        let mut curves = vec![Curve::steps(
            REFERENCE.of(language),
            Ink::Reference,
            ours.reference(RPM),
        )];
        curves.extend(beside::both(
            language,
            recording,
            ours.speed_rpm(wheel),
            real(wheel),
        ));
        Panel::new(name.of(language), curves)
    };
    let panels = vec![
        panel(RIGHT_SPEED, Channel::Right),
        panel(LEFT_SPEED, Channel::Left),
    ];
    parts::timed(places, "mode5-real", panels);
    let references: Vec<(f64, f64)> = recording
        .references()
        .iter()
        .map(|(t_s, rad_s)| (*t_s, RPM * rad_s))
        .collect();
    beside::steps(
        places,
        recording,
        Kind::Speed,
        &respond::responses(Kind::Speed, &references, &ours.speed_rpm(Channel::Right)),
        &respond::responses(Kind::Speed, &references, &real(Channel::Right)),
    );
}
