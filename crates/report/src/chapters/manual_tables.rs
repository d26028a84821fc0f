//! Tables of the basic movements: where each wheel starts, and what became of each movement.

use super::manual::{EXPERIMENT, FLOOR};
use crate::data::Data;
use crate::judge;
use crate::metric_names::Shown;
use crate::page::{Cell, Page};
use crate::signals::{CM, DEG};
use crate::text::{Text, t};

const STARTS: Text = t(
    "PWM at which each wheel starts",
    "PWM a la que arranca cada rueda",
);
const MOVEMENTS: Text = t(
    "What became of each movement",
    "Resultado de cada movimiento",
);
const HEADER: [Text; 5] = [
    t("Scenario", "Escenario"),
    t("Way", "Camino"),
    t("To the side", "Desvío lateral"),
    t("Turned by", "Giro"),
    t("Radius", "Radio"),
];
const START_HEADER: [Text; 3] = [
    t("Test", "Ensayo"),
    t("Left wheel", "Rueda izquierda"),
    t("Right wheel", "Rueda derecha"),
];
const TESTS: [(Text, &str, &str); 4] = [
    (
        FLOOR,
        "manual-deadzone-floor-forward",
        "manual-deadzone-floor-forward",
    ),
    (
        t("on the floor, backward", "en el suelo, hacia atrás"),
        "manual-deadzone-floor-backward",
        "manual-deadzone-floor-backward",
    ),
    (
        t("in the air, forward", "en el aire, hacia delante"),
        "manual-deadzone-left-forward",
        "manual-deadzone-right-forward",
    ),
    (
        t("in the air, backward", "en el aire, hacia atrás"),
        "manual-deadzone-left-backward",
        "manual-deadzone-right-backward",
    ),
];

/// The PWM at which each wheel starts to turn.
pub(super) fn starts(page: &mut Page, data: &Data) {
    page.subsection(page.say(STARTS));
    let language = page.language;
    let cell = |scenario: &str, metric: &str| {
        let found = data
            .outcome(scenario)
            .and_then(|outcome| outcome.metric(metric));
        Cell::text(
            &found
                .map(|duty| language.number(255.0 * duty, 0))
                .unwrap_or_default(),
        )
    };
    let rows: Vec<Vec<Cell>> = TESTS
        .iter()
        .map(|(name, left, right)| {
            vec![
                Cell::text(&judge::capital(page.say(*name))),
                cell(left, "left_dead_zone_duty"),
                cell(right, "right_dead_zone_duty"),
            ]
        })
        .collect();
    let header = START_HEADER.map(|text| page.say(text));
    page.table(&header, &rows);
}

/// Way, sideways drift, turn and radius of every movement.
pub(super) fn movements(page: &mut Page, data: &Data) {
    page.subsection(page.say(MOVEMENTS));
    let language = page.language;
    let rows: Vec<Vec<Cell>> = EXPERIMENT
        .scenarios
        .iter()
        .filter_map(|name| data.outcome(name))
        .filter(|outcome| {
            outcome.setup.scenario.duration_s < 10.0 && outcome.metric("path_m").is_some()
        })
        .map(|outcome| {
            let cell = |metric: &str, factor, unit| {
                let shown = Shown {
                    factor,
                    ..judge::plain(unit)
                };
                Cell::text(
                    &outcome
                        .metric(metric)
                        .map(|value| judge::value(language, &shown, value))
                        .unwrap_or_default(),
                )
            };
            vec![
                Cell::html(format!(
                    "<code translate=\"no\">{}</code>",
                    outcome.result.scenario
                )),
                cell("path_m", CM, "cm"),
                cell("sideways_m", CM, "cm"),
                cell("turn_rad", DEG, "°"),
                cell("radius_m", CM, "cm"),
            ]
        })
        .collect();
    let header = HEADER.map(|text| page.say(text));
    page.table(&header, &rows);
}
