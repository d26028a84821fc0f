//! A recorded run beside ours: both curves overlaid, and a table of their results.

use super::panels::mean_cm;
use super::parts::{self, DISTANCE, REFERENCE};
use crate::data::Data;
use crate::judge;
use crate::places::Places;
use crate::real::RealRun;
use crate::respond::{Kind, Response, responses};
use crate::signals::{CM, ReportedRun, unwrapped};
use crate::table::{Cell, table};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Panel, Points};
use rumbo_wire::text::TextRow;

const OURS: Text = word("rumbo-simulated-robot");
const REAL: Text = word("recorded-robot-original-program");
const REAL_OURS: Text = word("recorded-robot-rumbo");

const fn real(recording: &RealRun) -> Text {
    if recording.ours { REAL_OURS } else { REAL }
}

/// A curve of ours and one of the recorded robot, overlaid.
pub(super) fn both(
    language: Language,
    recording: &RealRun,
    ours: Points,
    theirs: Points,
) -> Vec<Curve> {
    vec![
        Curve::new(OURS.of(language), Ink::First, ours),
        Curve::new(real(recording).of(language), Ink::Second, theirs),
    ]
}

const QUANTITY: Text = word("quantity");

/// A table of our values beside those of the recorded robot, already formatted.
pub(super) fn values(
    language: Language,
    recording: &RealRun,
    rows: &[(String, String, String)],
) -> String {
    let header = [QUANTITY, OURS, real(recording)].map(|text| text.of(language));
    let rows: Vec<_> = rows
        .iter()
        .map(|(name, ours, real)| vec![Cell::text(name), Cell::text(ours), Cell::text(real)])
        .collect();
    table(&header, &rows)
}

/// Our run beside a recorded one, and that one. If there is one, shows the section `recorded` and fills its place
/// `file`.
pub(super) fn recorded<'a>(
    places: &mut Places,
    data: &'a Data,
    scenario: &str,
) -> Option<(&'a ReportedRun, &'a RealRun)> {
    let found = data.beside(scenario);
    places.section("recorded", found.is_some());
    if let Some((_, recording)) = found {
        places.value("file", recording.file.as_str());
    }
    found
}

/// Panels of x, y and heading over time, ours and those of the recorded robot.
pub(super) fn poses(
    language: Language,
    recording: &RealRun,
    ours: [Points; 3],
    theirs: [Points; 3],
) -> Vec<Panel> {
    let [x, y, heading] = ours;
    let [their_x, their_y, their_heading] = theirs;
    let panel =
        |name: &str, ours, theirs| Panel::new(name, both(language, recording, ours, theirs));
    vec![
        panel("x (m)", x, their_x),
        panel("y (m)", y, their_y),
        panel(HEADING.of(language), heading, unwrapped(their_heading)).exactly(-190.0, 190.0),
    ]
}

/// The points since the start.
pub(super) fn started(points: Points) -> Points {
    points.into_iter().filter(|(t_s, _)| *t_s >= 0.0).collect()
}

/// The way from x and y over time.
pub(super) fn way(x: &Points, y: &Points) -> Points {
    x.iter().zip(y).map(|(x, y)| (x.1, y.1)).collect()
}

const HEADING: Text = word("heading-deg");
const SETTLING: Text = word("settling-time");
const OVERSHOOT: Text = word("overshoot");
const STEADY: Text = word("steady-error");
const RIPPLE: Text = word("ripple-standard-deviation");

/// A table of each step's response, beside a recorded run's.
pub(super) fn steps(
    places: &mut Places,
    recording: &RealRun,
    kind: Kind,
    ours: &[Response],
    real: &[Response],
) {
    let language = places.language;
    let rows = step_rows(language, kind, ours, real);
    places.block("recorded-values", values(language, recording, &rows));
}

fn step_rows(
    language: Language,
    kind: Kind,
    ours: &[Response],
    real: &[Response],
) -> Vec<(String, String, String)> {
    let unit = match kind {
        Kind::Distance => "cm",
        Kind::Speed => "rpm",
    };
    let mut rows = Vec::new();
    for (ours, real) in ours.iter().zip(real) {
        let of = format!(
            "{} → {} {unit}",
            language.short(ours.from, 0),
            language.short(ours.to, 0)
        );
        let mut row = |name: Text, value: fn(&Response) -> f64, unit| {
            let shown = judge::plain(unit);
            rows.push((
                format!("{of}: {}", name.of(language)),
                judge::value(language, &shown, value(ours)),
                judge::value(language, &shown, value(real)),
            ));
        };
        row(SETTLING, |response| response.settling_s, "s");
        row(OVERSHOOT, |response| response.overshoot, unit);
        match kind {
            Kind::Distance => row(STEADY, |response| response.steady_error, unit),
            Kind::Speed => row(RIPPLE, |response| response.ripple, unit),
        }
    }
    rows
}

/// The mean of a recorded run's two ranges \[cm\].
pub(super) fn recorded_mean_cm(recording: &RealRun) -> Points {
    recording.signal(|row| match row {
        TextRow::Distance(row) => Some(0.5 * f64::from(row.left_cm + row.right_cm)),
        _ => None,
    })
}

/// A recorded run of a distance with steps of its reference, beside ours.
pub(super) fn distance(places: &mut Places, data: &Data, scenario: &str) {
    let Some((ours, recording)) = recorded(places, data, scenario) else {
        return;
    };
    let language = places.language;
    let (mine, real) = (mean_cm(ours), recorded_mean_cm(recording));
    let mut curves = vec![Curve::steps(
        REFERENCE.of(language),
        Ink::Reference,
        ours.reference(CM),
    )];
    curves.extend(both(language, recording, mine.clone(), real.clone()));
    let panel = Panel::new(DISTANCE.of(language), curves);
    parts::timed(places, &format!("{scenario}-real"), vec![panel]);
    let references: Vec<(f64, f64)> = recording
        .references()
        .iter()
        .map(|(t_s, m)| (*t_s, CM * m))
        .collect();
    let kind = Kind::Distance;
    steps(
        places,
        recording,
        kind,
        &responses(kind, &references, &mine),
        &responses(kind, &references, &real),
    );
}
