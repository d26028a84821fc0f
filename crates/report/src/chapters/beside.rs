//! A recorded run beside ours: both curves over each other, and a table of what each came to.

use super::panels::mean_cm;
use super::parts::{self, REFERENCE};
use crate::data::Data;
use crate::judge;
use crate::page::{Cell, Page};
use crate::plot::{Curve, Ink, Panel, Points};
use crate::real::Recording;
use crate::respond::{Kind, Response, responses};
use crate::signals::CM;
use crate::text::{Language, Text, t};
use rumbo_wire::text::Row;

const BESIDE: Text = t("Beside the recorded robot", "Comparación con el robot real");
const OURS: Text = t("Rumbo, simulated robot", "Rumbo, robot simulado");
const REAL: Text = t(
    "recorded robot, original program",
    "robot real, programa original",
);
const REAL_OURS: Text = t("recorded robot, Rumbo", "robot real, Rumbo");

const fn real(recording: &Recording) -> Text {
    if recording.ours { REAL_OURS } else { REAL }
}

/// A curve of ours and one of the recorded robot, over each other.
pub(super) fn both(
    language: Language,
    recording: &Recording,
    ours: Points,
    theirs: Points,
) -> Vec<Curve> {
    vec![
        Curve::new(OURS.of(language), Ink::First, ours),
        Curve::new(real(recording).of(language), Ink::Second, theirs),
    ]
}

const QUANTITY: Text = t("Quantity", "Magnitud");

/// Values of ours beside those of the recorded robot; they come as they are shown.
pub(super) fn table(page: &mut Page, recording: &Recording, rows: &[(String, String, String)]) {
    let header = [QUANTITY, OURS, real(recording)].map(|text| page.say(text));
    let rows: Vec<_> = rows
        .iter()
        .map(|(name, ours, real)| vec![Cell::text(name), Cell::text(ours), Cell::text(real)])
        .collect();
    page.table(&header, &rows);
}

const FILE: Text = t(
    "Recorded run: `{}`. Both curves begin with the arming{}. Both are what the robots measured themselves, and the values below are taken from these \
     measurements in the same way.",
    "Registro: `{}`. Ambas curvas comienzan con el armado{}. Las dos son lo que cada robot midió por sí mismo y los valores que siguen se obtienen de \
     esas medidas de la misma manera.",
);
const SAME_REFERENCES: Text = t(
    ", and ours was given the recorded references at their times",
    " y nuestro robot recibió las referencias del registro en sus mismos instantes",
);

/// Heading and explanation of a comparison.
pub(super) fn heading(page: &mut Page, file: &str, same_references: bool) {
    page.section(BESIDE);
    let more = if same_references {
        page.say(SAME_REFERENCES)
    } else {
        ""
    };
    let text = FILE.with(page.language, &[file, more]);
    page.said(&text);
}

const SETTLING: Text = t("{}: settling time", "{}: tiempo de establecimiento");
const OVERSHOOT: Text = t("{}: overshoot", "{}: sobreoscilación");
const STEADY: Text = t("{}: steady error", "{}: error en régimen permanente");
const RIPPLE: Text = t(
    "{}: ripple, standard deviation",
    "{}: rizado, desviación típica",
);

const DISTANCE_BAND: Text = t(
    "Settled is what stays within 5 % of the step until the next one; *never*: it does not. The steady part is the last 40 % of a step's time.",
    "Se considera establecido lo que se queda dentro del 5 % del escalón hasta el siguiente; *nunca* significa que no llega a hacerlo. El régimen \
     permanente es el último 40 % del tiempo de cada escalón.",
);
const SPEED_BAND: Text = t(
    "Settled is what stays within 3.2 rpm, the resolution of the original program, until the next step; *never*: it does not, such as where the next step \
     comes before the wheel stands. Ripple is that of the last 40 % of a step's time.",
    "Se considera establecido lo que se queda a menos de 3,2 rpm, la resolución del programa original, hasta el escalón siguiente; *nunca* significa que no \
     llega a hacerlo, por ejemplo si el siguiente llega antes de que la rueda se pare. El rizado es el del último 40 % del tiempo de cada escalón.",
);

/// A table beside a recorded run of what each step came to, and how that is reckoned.
pub(super) fn steps(
    page: &mut Page,
    recording: &Recording,
    kind: Kind,
    ours: &[Response],
    real: &[Response],
) {
    let rows = step_rows(page.language, kind, ours, real);
    table(page, recording, &rows);
    page.p(match kind {
        Kind::Distance => DISTANCE_BAND,
        Kind::Speed => SPEED_BAND,
    });
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
                name.with(language, &[&of]),
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
pub(super) fn recorded_mean_cm(recording: &Recording) -> Points {
    recording.signal(|row| match row {
        Row::Distance(row) => Some(0.5 * f64::from(row.left_cm + row.right_cm)),
        _ => None,
    })
}

const BESIDE_CAPTION: Text = t(
    "Distance to the wall (mean of the sonars): ours and the recorded run, with the same references at the same times.",
    "Distancia a la pared (media de los sensores): nuestro robot y el registro real, con las mismas referencias en los mismos instantes.",
);

/// A recorded run of a distance with steps of its reference, beside ours.
pub(super) fn distance(page: &mut Page, data: &Data, scenario: &str, axis: Text) {
    let Some((ours, recording)) = data.beside(scenario) else {
        return;
    };
    heading(page, &recording.file, true);
    let language = page.language;
    let (mine, real) = (mean_cm(ours), recorded_mean_cm(recording));
    let mut curves = vec![Curve::steps(
        REFERENCE.of(language),
        Ink::Reference,
        ours.reference(CM),
    )];
    curves.extend(both(language, recording, mine.clone(), real.clone()));
    let panel = Panel::new(axis.of(language), curves);
    parts::timed(
        page,
        &format!("{scenario}-real"),
        BESIDE_CAPTION,
        vec![panel],
    );
    let references: Vec<(f64, f64)> = recording
        .references()
        .iter()
        .map(|(t_s, m)| (*t_s, CM * m))
        .collect();
    let kind = Kind::Distance;
    steps(
        page,
        recording,
        kind,
        &responses(kind, &references, &mine),
        &responses(kind, &references, &real),
    );
}
