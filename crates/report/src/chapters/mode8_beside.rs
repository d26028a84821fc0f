//! Mode 8 beside a recorded run: paths and poses by the odometry of both.

use super::beside;
use super::maps;
use super::parts;
use crate::data::Data;
use crate::judge;
use crate::places::Places;
use crate::real::RealRun;
use crate::text::{Text, word};
use rumbo_plot::{Map, Points};
use rumbo_wire::text::{MissionRow, TextRow};

const TIME: Text = word("duration");
const PATH: Text = word("way-by-odometry");

pub(super) fn fill(places: &mut Places, data: &Data, scenario: &str) {
    let name = scenario.trim_start_matches("mode8-");
    let found = data.beside(scenario);
    places.section(&format!("recorded-{name}"), found.is_some());
    let Some((ours, recording)) = found else {
        return;
    };
    places.value(&format!("file-{name}"), recording.file.as_str());
    let language = places.language;
    let real = |of: fn(&MissionRow) -> f32| recorded(recording, of);
    let mine = ours.pose().map(beside::started);
    let theirs = [
        real(|row| row.x_m),
        real(|row| row.y_m),
        real(|row| row.heading_deg),
    ];
    if scenario != "mode8-goals" {
        let their_way = beside::way(&theirs[0], &theirs[1]);
        let our_way = ours.estimated_trajectory();
        let curves = beside::both(language, recording, our_way, their_way);
        let map = Map {
            curves,
            ..maps::path_map(places, ours, Points::new())
        };
        let svg = map.svg(language);
        places.figure(&format!("{scenario}-real-way"), Some(svg));
    }
    let end_s = ours.end_s().unwrap_or_else(|| ours.duration_s());
    let walked = [
        length(&mine[0], &mine[1], end_s),
        length(&theirs[0], &theirs[1], f64::INFINITY),
    ];
    let lasted = [
        ours.metric(if scenario == "mode8-lane" {
            "finish_s"
        } else {
            "total_time_s"
        })
        .unwrap_or(end_s),
        recording.duration_s(),
    ];
    let panels = beside::poses(language, recording, mine, theirs);
    parts::timed(places, &format!("{scenario}-real"), panels);
    let row = |name: Text, values: [f64; 2], unit| {
        let shown = judge::plain(unit);
        let [ours, real] = values.map(|value| judge::value(language, &shown, value));
        (places.text(name).to_owned(), ours, real)
    };
    let rows = [row(TIME, lasted, "s"), row(PATH, walked, "m")];
    let table = beside::values(language, recording, &rows);
    places.block(&format!("recorded-values-{name}"), table);
}

fn recorded(recording: &RealRun, of: fn(&MissionRow) -> f32) -> Points {
    recording.signal(|row| match row {
        TextRow::Mission(row) => Some(f64::from(of(row))),
        _ => None,
    })
}

/// Length of a path until a time [m]. A new origin adds no length.
fn length(x: &Points, y: &Points, until_s: f64) -> f64 {
    let places: Points = x
        .iter()
        .zip(y)
        .filter(|(x, _)| x.0 <= until_s)
        .map(|(x, y)| (x.1, y.1))
        .collect();
    let pieces = places
        .windows(2)
        .map(|two| (two[1].0 - two[0].0).hypot(two[1].1 - two[0].1));
    pieces.filter(|piece| *piece < 0.2).sum()
}
