//! Tables of the basic movements: where each wheel starts, and the outcome of each movement.

use crate::data::{Data, Experiment};
use crate::judge;
use crate::metric_names::Shown;
use crate::signals::{CM, DEG};
use crate::table::{Cell, table};
use crate::text::{Language, Text, capital, word};

const HEADER: [Text; 5] = [
    word("scenario"),
    word("way"),
    word("to-the-side"),
    word("turned-by-column"),
    word("radius"),
];
const START_HEADER: [Text; 3] = [word("test"), word("left-wheel"), word("right-wheel")];
const TESTS: [(Text, &str, &str); 4] = [
    (
        word("on-the-floor-forward"),
        "manual-deadzone-floor-forward",
        "manual-deadzone-floor-forward",
    ),
    (
        word("on-the-floor-backward"),
        "manual-deadzone-floor-backward",
        "manual-deadzone-floor-backward",
    ),
    (
        word("in-the-air-forward"),
        "manual-deadzone-left-forward",
        "manual-deadzone-right-forward",
    ),
    (
        word("in-the-air-backward"),
        "manual-deadzone-left-backward",
        "manual-deadzone-right-backward",
    ),
];

/// The PWM at which each wheel starts to turn.
pub(super) fn starts(language: Language, data: &Data) -> String {
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
                Cell::text(&capital(name.of(language))),
                cell(left, "left_dead_zone_duty"),
                cell(right, "right_dead_zone_duty"),
            ]
        })
        .collect();
    let header = START_HEADER.map(|text| text.of(language));
    table(&header, &rows)
}

/// Distance, sideways drift, turn and radius of every movement.
pub(super) fn movements(language: Language, data: &Data, experiment: &Experiment) -> String {
    let rows: Vec<Vec<Cell>> = experiment
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
    let header = HEADER.map(|text| text.of(language));
    table(&header, &rows)
}
