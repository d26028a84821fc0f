//! What several chapters have in common: names of curves, rig and wiring, tables beside a recorded run.

use crate::data::Data;
use crate::drawing::{rig, wiring};
use crate::judge::{self, Shown};
use crate::page::{Cell, Page};
use crate::plot::{Curve, Ink, Panel, Plot, Points};
use crate::respond::{Kind, Response};
use crate::signals::{Outcome, Place};
use crate::text::{Language, Text, t};

pub(super) const DESCRIPTION: Text = t("Description", "Descripción");
pub(super) const COMPONENTS: Text = t(
    "Components, rig and wiring",
    "Componentes, montaje y conexionado",
);
pub(super) const SCHEME: Text = t("Control scheme", "Esquema de control");
pub(super) const ANALYSIS: Text = t("Analysis", "Cálculos analíticos");
pub(super) const RESULTS: Text = t("Results", "Resultados experimentales");
pub(super) const LIMITS: Text = t("Metrics against limits", "Métricas frente a sus límites");
pub(super) const BESIDE: Text = t("Beside the recorded robot", "Comparación con el robot real");

pub(super) const TIME: Text = t("time since arming (s)", "tiempo desde el armado (s)");
pub(super) const DISTANCE: Text = t("distance (cm)", "distancia (cm)");
pub(super) const ERROR_CM: Text = t("error (cm)", "error (cm)");
pub(super) const ERROR_RPM: Text = t("error (rpm)", "error (rpm)");
pub(super) const SPEED: Text = t("speed (rpm)", "velocidad (rpm)");
pub(super) const PWM: Text = t("PWM (of 255)", "PWM (sobre 255)");
pub(super) const LEFT: Text = t("left", "izquierda");
pub(super) const RIGHT: Text = t("right", "derecha");
pub(super) const REFERENCE: Text = t("reference", "referencia");
pub(super) const MEASURED: Text = t("measured", "medida");
pub(super) const OURS: Text = t("Rumbo, simulated robot", "Rumbo, robot simulado");
pub(super) const REAL: Text = t(
    "recorded robot, original program",
    "robot real, programa original",
);

const RIG: Text = t(
    "The rig from above: where the sonars sit and where they look, as the robot file has it. x points ahead.",
    "El montaje visto desde arriba: posición y dirección de los sensores según el fichero del robot. El eje x apunta hacia delante.",
);
const WIRING: Text = t(
    "Wiring: a line for each pin of the Mega. Motor A is the right one, motor B the left one.",
    "Conexionado: una línea por cada pin del Mega. El motor A es el derecho y el motor B el izquierdo.",
);

/// The drawing of a scenario's rig.
pub(super) fn rig_figure(page: &mut Page, data: &Data, id: &str, scenario: &str) {
    if let Some(outcome) = data.outcome(scenario) {
        let svg = rig::svg(page.language, &outcome.setup, page.say(RIG));
        page.figure(&format!("{id}-rig"), &svg, RIG);
    }
}

/// The drawing of one of the robot's wirings.
pub(super) fn wiring_figure(page: &mut Page, data: &Data, id: &str, scenario: &str, name: &str) {
    let wiring = data
        .outcome(scenario)
        .and_then(|outcome| outcome.setup.robot.wirings.get(name));
    if let Some(wiring) = wiring {
        let svg = wiring::svg(page.language, wiring, page.say(WIRING));
        page.figure(&format!("{id}-wiring"), &svg, WIRING);
    }
}

/// Panels over the time of a run.
pub(super) fn over_time(
    page: &Page,
    id: &str,
    caption: Text,
    panels: Vec<Panel>,
) -> (String, String, Text) {
    over(page, id, caption, panels, None)
}

/// The same over a part of it.
pub(super) fn over(
    page: &Page,
    id: &str,
    caption: Text,
    panels: Vec<Panel>,
    x_range: Option<[f64; 2]>,
) -> (String, String, Text) {
    let plot = Plot {
        x: page.say(TIME).to_owned(),
        x_range,
        panels,
    };
    (
        id.to_owned(),
        plot.svg(page.language, page.say(caption)),
        caption,
    )
}

/// Puts a figure that was made into the page.
pub(super) fn show(page: &mut Page, (id, svg, caption): (String, String, Text)) {
    page.figure(&id, &svg, caption);
}

/// PWM of both wheels.
pub(super) fn pwm_panel(language: Language, outcome: &Outcome) -> Panel {
    let curve = |name: Text, ink, wheel| Curve::steps(name.of(language), ink, outcome.pwm(wheel));
    Panel::new(
        PWM.of(language),
        vec![
            curve(LEFT, Ink::First, Place::Left),
            curve(RIGHT, Ink::Second, Place::Right),
        ],
    )
    .at_least(0.0, 100.0)
}

/// A curve of ours and one of the recorded robot, over each other.
pub(super) fn both(language: Language, ours: Points, real: Points) -> Vec<Curve> {
    vec![
        Curve::new(OURS.of(language), Ink::First, ours),
        Curve::new(REAL.of(language), Ink::Second, real),
    ]
}

const QUANTITY: Text = t("Quantity", "Magnitud");

/// Values of ours beside those of the recorded robot; they come as they are shown.
pub(super) fn beside_table(page: &mut Page, rows: &[(String, String, String)]) {
    let header = [QUANTITY, OURS, REAL].map(|text| page.say(text));
    let rows: Vec<_> = rows
        .iter()
        .map(|(name, ours, real)| vec![Cell::text(name), Cell::text(ours), Cell::text(real)])
        .collect();
    page.table(&header, &rows);
}

const FILE: Text = t(
    "Recorded run: `{}`. Both curves begin with the arming; ours was given the recorded references at their times. Both are what the robots \
     measured themselves, and the values below are taken from these measurements in the same way.",
    "Registro: `{}`. Ambas curvas comienzan con el armado; nuestro robot recibió las referencias del registro en sus mismos instantes. Las \
     dos son lo que cada robot midió por sí mismo y los valores que siguen se obtienen de esas medidas de la misma manera.",
);

/// Heading and explanation of a comparison.
pub(super) fn beside_heading(page: &mut Page, file: &str) {
    page.section(BESIDE);
    let text = FILE.with(page.language, &[file]);
    page.said(&text);
}

const SETTLING: Text = t("{}: settling time", "{}: tiempo de establecimiento");
const OVERSHOOT: Text = t("{}: overshoot", "{}: sobreoscilación");
const STEADY: Text = t("{}: steady error", "{}: error en régimen permanente");
const RIPPLE: Text = t(
    "{}: ripple, standard deviation",
    "{}: rizado, desviación típica",
);

/// The rows of a table beside a recorded run: what each step came to.
pub(super) fn step_rows(
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
            let shown = Shown {
                name: String::new(),
                factor: 1.0,
                unit,
            };
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
