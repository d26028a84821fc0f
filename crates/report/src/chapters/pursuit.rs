//! Pure pursuit: the extension of the report.

use super::maps;
use super::parts;
use super::{Experiment, Highlight};
use crate::data::Data;
use crate::places::Places;
use crate::signals::{CM, ReportedRun};
use crate::text::{Text, word};
use rumbo_plot::{Curve, Ink, Map, Panel, Points};

const LINE: Text = word("line");
const CURVE: Text = word("curve");

const fn of(what: Text, scenario: &'static str, metric: &'static str) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: Some(what),
        real: None,
    }
}

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "pursuit",
    number: "9",
    scenarios: &["pursuit-line", "pursuit-curve"],
    highlights: &[
        of(LINE, "pursuit-line", "odometry_rms_m"),
        of(CURVE, "pursuit-curve", "odometry_rms_m"),
    ],
    fill,
};

const OFF_AXIS: Text = word("off-the-path-cm");

fn fill(places: &mut Places, data: &Data) {
    let mut off = Vec::new();
    for (scenario, name, ink) in [
        ("pursuit-line", LINE, Ink::First),
        ("pursuit-curve", CURVE, Ink::Second),
    ] {
        let Some(outcome) = data.outcome(scenario) else {
            continue;
        };
        let route = maps::route(outcome);
        let map = Map {
            curves: maps::trajectories(places.language, outcome, route.clone()),
            ..maps::map(places.language)
        };
        let svg = map.svg(places.language);
        places.figure(&format!("{scenario}-way"), Some(svg));
        off.push(Curve::new(
            places.text(name),
            ink,
            off_path_cm(outcome, &route),
        ));
    }
    let panel = Panel::new(places.text(OFF_AXIS), off);
    parts::timed(places, "pursuit-off", vec![panel]);
    parts::limits(places, &data.of(&EXPERIMENT));
}

fn off_path_cm(outcome: &ReportedRun, route: &Points) -> Points {
    let [x, ..] = outcome.pose();
    let times = x.iter().map(|(t_s, _)| *t_s).filter(|t_s| *t_s >= 0.0);
    times
        .zip(outcome.estimated_trajectory())
        .map(|(t_s, place)| (t_s, CM * maps::off_route(route, place)))
        .collect()
}
