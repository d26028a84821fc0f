//! Mode 7: a square by odometry.

use super::beside;
use super::maps;
use super::panels;
use super::parts;
use super::{Experiment, highlight};
use crate::data::Data;
use crate::judge;
use crate::places::Places;
use crate::respond::rms_and_worst;
use crate::signals::{CM, ReportedRun};
use crate::text::{Language, Text, capital, word};
use rumbo_plot::{Curve, Ink, Map, Panel, Points};
use rumbo_wire::text::TextRow;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode7",
    number: "7",
    scenarios: &["mode7"],
    highlights: &[
        highlight("mode7", "finish_s", Some(30.0)),
        highlight("mode7", "odometry_worst_m", Some(0.06)),
        highlight("mode7", "end_error_m", None),
    ],
    fill,
};

const POSITION_AXIS: Text = word("position-m");
const HEADING_AXIS: Text = word("heading-deg");
const LAP: Text = word("time-once-round");
const WORST: Text = word("off-the-square-worst");
const RMS: Text = word("off-the-square-rms");

fn fill(places: &mut Places, data: &Data) {
    parts::opening(places, data, "mode7", "modes_5_to_7");
    let Some(outcome) = data.outcome("mode7") else {
        return;
    };
    let language = places.language;
    let panels = pose_panels(language, outcome);
    parts::timed(places, "mode7-pose", panels);
    let panels = panels::wheel_panels(language, outcome);
    parts::timed(places, "mode7-wheels", panels);
    let map = Map {
        curves: maps::trajectories(language, outcome, maps::route(outcome)),
        ..maps::map(language)
    };
    let svg = map.svg(language);
    places.figure("mode7-way", Some(svg));
    parts::limits(places, &[outcome]);
    beside(places, data);
}

/// x and y, and the heading.
pub(super) fn pose_panels(language: Language, outcome: &ReportedRun) -> Vec<Panel> {
    let [x, y, heading] = outcome.pose();
    vec![
        Panel::new(
            POSITION_AXIS.of(language),
            vec![
                Curve::new("x", Ink::First, x),
                Curve::new("y", Ink::Second, y),
            ],
        ),
        Panel::new(
            HEADING_AXIS.of(language),
            vec![Curve::new("", Ink::Third, heading)],
        )
        .exactly(-190.0, 190.0),
    ]
}

/// The corners of the square, from the start.
const SQUARE: [(f64, f64); 5] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];

fn beside(places: &mut Places, data: &Data) {
    let Some((ours, recording)) = beside::recorded(places, data, "mode7") else {
        return;
    };
    let language = places.language;
    let real = |of: fn(&rumbo_wire::text::WaypointsRow) -> f32| {
        recording.signal(|row| match row {
            TextRow::Waypoints(row) => Some(f64::from(of(row))),
            _ => None,
        })
    };
    let mine = ours.pose().map(beside::started);
    let theirs = [
        real(|row| row.x_m),
        real(|row| row.y_m),
        real(|row| row.heading_deg),
    ];
    let rows = [&mine, &theirs].map(|[x, y, _]| figures(x, y));
    let [our_way, their_way] = [&mine, &theirs].map(|[x, y, _]| beside::way(x, y));
    let mut curves = maps::trajectories(language, ours, SQUARE.to_vec());
    curves.truncate(1);
    curves.extend(beside::both(language, recording, our_way, their_way));
    let svg = Map {
        curves,
        ..maps::map(language)
    }
    .svg(language);
    places.figure("mode7-real-way", Some(svg));
    let panels = beside::poses(language, recording, mine, theirs);
    parts::timed(places, "mode7-real", panels);
    let row = |name: Text, index: usize, unit| {
        let shown = judge::plain(unit);
        let [ours, real] = [0, 1].map(|which| judge::value(language, &shown, rows[which][index]));
        (capital(name.of(language)), ours, real)
    };
    let table = beside::values(
        language,
        recording,
        &[row(LAP, 0, "s"), row(WORST, 1, "cm"), row(RMS, 2, "cm")],
    );
    places.block("recorded-values", table);
}

/// Time once round [s], and how far off the square until then, worst and root mean square [cm].
fn figures(x: &Points, y: &Points) -> [f64; 3] {
    let (mut corner, mut lap_s, mut off) = (1, f64::NAN, Points::new());
    let square = SQUARE.to_vec();
    for ((t_s, x), (_, y)) in x.iter().zip(y) {
        off.push((*t_s, CM * maps::off_route(&square, (*x, *y))));
        // A corner counts as the original counts it: within 10 cm.
        if (x - SQUARE[corner].0).hypot(y - SQUARE[corner].1) < 0.1 {
            if corner + 1 == SQUARE.len() {
                lap_s = *t_s;
                break;
            }
            corner += 1;
        }
    }
    let [rms, worst] = rms_and_worst(&off);
    [lap_s, worst, rms]
}
