//! Modes 3 and 4: along a wall, at the distance of the start or at a commanded one.

use super::beside;
use super::panels::{self, Pair};
use super::parts::{self, ERROR_CM};
use super::{Experiment, highlight};
use crate::channel::Channel;
use crate::data::Data;
use crate::judge;
use crate::places::Places;
use crate::respond::rms_and_worst;
use crate::signals::{CM, ReportedRun, between, difference};
use crate::text::{Text, capital, word};
use rumbo_plot::{Curve, Ink, Panel, Points};

pub(super) const MODE3: Experiment = Experiment {
    name: "mode3",
    number: "3",
    scenarios: &["mode3"],
    highlights: &[
        highlight("mode3", "distance_rms_m", Some(0.012)),
        highlight("mode3", "distance_worst_m", Some(0.046)),
    ],
    fill: fill_mode3,
};

pub(super) const MODE4: Experiment = Experiment {
    name: "mode4",
    number: "4",
    scenarios: &["mode4"],
    highlights: &[
        highlight("mode4", "step1.within_2cm_s", Some(7.1)),
        highlight("mode4", "step2.within_2cm_s", Some(6.3)),
        highlight("mode4", "step3.within_2cm_s", Some(9.0)),
    ],
    fill: fill_mode4,
};

const DIFFERENCE_AXIS: Text = word("difference-cm");

fn fill_mode3(places: &mut Places, data: &Data) {
    parts::opening(places, data, "mode3", "modes_3_and_4");
    let Some(outcome) = data.outcome("mode3") else {
        return;
    };
    let pair = Pair {
        reference: held(outcome),
        distances_cm: [50.0, 65.0],
        error_cm: 1.0,
    };
    pair.fill(places, "mode3", outcome);
    parts::limits(places, &[outcome]);
    beside(places, data);
}

fn fill_mode4(places: &mut Places, data: &Data) {
    parts::opening(places, data, "mode4", "modes_3_and_4");
    let Some(outcome) = data.outcome("mode4") else {
        return;
    };
    let pair = Pair {
        reference: outcome.reference(CM),
        distances_cm: [30.0, 50.0],
        error_cm: 5.0,
    };
    pair.fill(places, "mode4", outcome);
    let between = difference(
        &outcome.range_cm(Channel::Left),
        &outcome.range_cm(Channel::Right),
    );
    let panel = Panel::new(
        places.text(DIFFERENCE_AXIS),
        vec![Curve::new("", Ink::First, between)],
    )
    .at_least(-5.0, 5.0);
    parts::timed(places, "mode4-difference", vec![panel]);
    parts::limits(places, &[outcome]);
    beside::distance(places, data, "mode4");
}

/// The distance that mode 3 holds: what both sonars read while the robot was still standing.
fn held(outcome: &ReportedRun) -> Points {
    let mean = panels::mean_cm(outcome);
    let standing = between(&mean, -0.5, 0.3);
    let values: Vec<f64> = standing
        .iter()
        .map(|(_, value)| *value)
        .filter(|value| value.is_finite())
        .collect();
    let distance_cm = values.iter().sum::<f64>() / values.len().max(1) as f64;
    vec![(0.0, distance_cm), (outcome.duration_s(), distance_cm)]
}

const RMS: Text = word("distance-error-rms");
const WORST: Text = word("distance-error-worst");

fn beside(places: &mut Places, data: &Data) {
    let Some((ours, recording)) = beside::recorded(places, data, "mode3") else {
        return;
    };
    let language = places.language;
    let mine = difference(&panels::mean_cm(ours), &held(ours));
    let mine = between(&mine, 0.0, f64::INFINITY);
    let references: Points = recording
        .references()
        .iter()
        .map(|(t_s, m)| (*t_s, CM * m))
        .collect();
    let real = difference(&beside::recorded_mean_cm(recording), &references);
    let panel = Panel::new(
        places.text(ERROR_CM),
        beside::both(language, recording, mine.clone(), real.clone()),
    )
    .at_least(-5.0, 5.0);
    parts::timed(places, "mode3-real", vec![panel]);
    let cm = judge::plain("cm");
    let rows: Vec<_> = [RMS, WORST]
        .into_iter()
        .zip(rms_and_worst(&mine).into_iter().zip(rms_and_worst(&real)))
        .map(|(name, (ours, real))| {
            (
                capital(places.text(name)),
                judge::value(language, &cm, ours),
                judge::value(language, &cm, real),
            )
        })
        .collect();
    let table = beside::values(language, recording, &rows);
    places.block("recorded-values", table);
}
