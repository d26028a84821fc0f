//! What all chapters have in common: headings, names of axes, rig and wiring, figures over time.

use crate::data::Data;
use crate::drawing::scheme::Scheme;
use crate::drawing::{rig, wiring};
use crate::judge;
use crate::page::Page;
use crate::plot::{Panel, Plot};
use crate::signals::Outcome;
use crate::text::{Text, t};

pub(super) const DESCRIPTION: Text = t("Description", "Descripción");
pub(super) const COMPONENTS: Text = t(
    "Components, rig and wiring",
    "Componentes, montaje y conexionado",
);
pub(super) const SCHEME: Text = t("Control scheme", "Esquema de control");
pub(super) const ANALYSIS: Text = t("Analysis", "Cálculos analíticos");
pub(super) const RESULTS: Text = t("Results", "Resultados experimentales");
pub(super) const LIMITS: Text = t("Metrics against limits", "Métricas frente a sus límites");

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

/// How a chapter begins: what the experiment is, what it needs, the rig and the wiring of its scenario.
pub(super) fn opening(
    page: &mut Page,
    data: &Data,
    id: &str,
    [what, parts]: [Text; 2],
    wiring: &str,
) {
    page.section(DESCRIPTION);
    page.p(what);
    page.section(COMPONENTS);
    page.p(parts);
    rig_figure(page, data, id, id);
    wiring_figure(page, data, id, id, wiring);
}

/// The control scheme, in words and drawn.
pub(super) fn scheme(page: &mut Page, id: &str, words: Text, scheme: &Scheme, caption: Text) {
    page.section(SCHEME);
    page.p(words);
    let svg = scheme.svg(page.language, page.say(caption));
    page.figure(&format!("{id}-scheme"), &svg, caption);
}

/// The metrics of runs against their limits.
pub(super) fn limits(page: &mut Page, outcomes: &[&Outcome]) {
    page.section(LIMITS);
    judge::limits(page, outcomes);
}

/// A figure of panels over the time of a run.
pub(super) fn timed(page: &mut Page, id: &str, caption: Text, panels: Vec<Panel>) {
    timed_within(page, id, caption, panels, None);
}

/// The same over a part of it.
pub(super) fn timed_within(
    page: &mut Page,
    id: &str,
    caption: Text,
    panels: Vec<Panel>,
    x_range: Option<[f64; 2]>,
) {
    let plot = Plot {
        x: page.say(TIME).to_owned(),
        x_range,
        panels,
    };
    let svg = plot.svg(page.language, page.say(caption));
    page.figure(id, &svg, caption);
}
