//! Metrics for people: each one's name in both languages, its unit as it is read, and its limit.

use crate::page::{Cell, Page, Tone};
use crate::signals::{CM, DEG, Outcome, RPM};
use crate::text::{Language, Text, escape, same, t};
use rumbo_control::mode::ModeId;
use rumbo_scenario::files::Bounds;
use rumbo_wire::Command;

/// A metric's name, what its value is multiplied with to be shown, and the unit then.
struct Known {
    stem: &'static str,
    name: Text,
    factor: f64,
    unit: Text,
}

const fn known(stem: &'static str, name: Text, factor: f64, unit: &'static str) -> Known {
    Known {
        stem,
        name,
        factor,
        unit: same(unit),
    }
}

const PWM: f64 = 255.0;

const KNOWN: &[Known] = &[
    known(
        "contacts",
        t("contacts with an obstacle", "contactos con un obstáculo"),
        1.0,
        "",
    ),
    known(
        "control_period_s",
        t(
            "time between two settings of the PWM",
            "tiempo entre dos actuaciones PWM",
        ),
        1000.0,
        "ms",
    ),
    known(
        "reverse_drive_rad_s",
        t(
            "wheel driven against its motion, at most",
            "rueda actuada contra su giro, máximo",
        ),
        RPM,
        "rpm",
    ),
    Known {
        stem: "telemetry_hz",
        name: t("telemetry", "telemetría"),
        factor: 1.0,
        unit: t("frames/s", "tramas/s"),
    },
    known(
        "settling_s",
        t("settling time", "tiempo de establecimiento"),
        1.0,
        "s",
    ),
    known(
        "within_2cm_s",
        t(
            "time until within 2 cm",
            "tiempo hasta quedar a menos de 2 cm",
        ),
        1.0,
        "s",
    ),
    known("rise_s", t("rise time", "tiempo de subida"), 1.0, "s"),
    known("overshoot_m", t("overshoot", "sobreoscilación"), CM, "cm"),
    known(
        "overshoot_rad_s",
        t("overshoot", "sobreoscilación"),
        RPM,
        "rpm",
    ),
    known(
        "steady_error_m",
        t("steady error", "error en régimen permanente"),
        CM,
        "cm",
    ),
    known(
        "steady_error_rad_s",
        t("steady error", "error en régimen permanente"),
        RPM,
        "rpm",
    ),
    known(
        "rms_m",
        t("error, root mean square", "error cuadrático medio"),
        CM,
        "cm",
    ),
    known(
        "rms_rad_s",
        t("error, root mean square", "error cuadrático medio"),
        RPM,
        "rpm",
    ),
    known(
        "ripple_m",
        t("ripple, standard deviation", "rizado, desviación típica"),
        CM,
        "cm",
    ),
    known(
        "ripple_rad_s",
        t("ripple, standard deviation", "rizado, desviación típica"),
        RPM,
        "rpm",
    ),
    known(
        "angle_rad",
        t("angle to the wall at rest", "ángulo con la pared en reposo"),
        DEG,
        "°",
    ),
    known(
        "cruise_m_s",
        t(
            "slowest half second along the wall",
            "medio segundo más lento a lo largo de la pared",
        ),
        1.0,
        "m/s",
    ),
    known(
        "distance_rms_m",
        t(
            "distance error, root mean square",
            "error de distancia, cuadrático medio",
        ),
        CM,
        "cm",
    ),
    known(
        "distance_worst_m",
        t("distance error, worst", "error de distancia, máximo"),
        CM,
        "cm",
    ),
    known(
        "heading_rad",
        t(
            "true drift of the heading",
            "desviación real de la orientación",
        ),
        DEG,
        "°",
    ),
    known(
        "sideways_m",
        t("true drift sideways", "desviación lateral real"),
        CM,
        "cm",
    ),
    known("forward_m", t("way ahead", "avance"), 1.0, "m"),
    known(
        "left_rad_s",
        t("speed of the left wheel", "velocidad de la rueda izquierda"),
        RPM,
        "rpm",
    ),
    known(
        "right_rad_s",
        t("speed of the right wheel", "velocidad de la rueda derecha"),
        RPM,
        "rpm",
    ),
    known(
        "end_error_m",
        t(
            "true distance from the end point",
            "distancia real al punto final",
        ),
        CM,
        "cm",
    ),
    known(
        "finish_s",
        t("time to the end", "tiempo hasta el final"),
        1.0,
        "s",
    ),
    known(
        "odometry_rms_m",
        t(
            "off the route by odometry, root mean square",
            "separación de la ruta según la odometría, cuadrática media",
        ),
        CM,
        "cm",
    ),
    known(
        "odometry_worst_m",
        t(
            "off the route by odometry, worst",
            "separación de la ruta según la odometría, máxima",
        ),
        CM,
        "cm",
    ),
    known(
        "true_rms_m",
        t(
            "truly off the route, root mean square",
            "separación real de la ruta, cuadrática media",
        ),
        CM,
        "cm",
    ),
    known(
        "true_worst_m",
        t(
            "truly off the route, worst",
            "separación real de la ruta, máxima",
        ),
        CM,
        "cm",
    ),
    known("path_m", t("way driven", "camino recorrido"), 1.0, "m"),
    known(
        "contact_speed_m_s",
        t(
            "speed of the hardest contact",
            "velocidad del contacto más fuerte",
        ),
        1.0,
        "m/s",
    ),
    known(
        "error_m",
        t("true distance from the goal", "distancia real al objetivo"),
        CM,
        "cm",
    ),
    known(
        "excess_m",
        t(
            "error beyond 4 cm and 2 % of the way",
            "error por encima de 4 cm más el 2 % del camino",
        ),
        CM,
        "cm",
    ),
    known("time_s", t("time", "tiempo"), 1.0, "s"),
    known(
        "reached",
        t("goals reached", "objetivos alcanzados"),
        1.0,
        "",
    ),
    known(
        "unreachable",
        t("goals given up", "objetivos abandonados"),
        1.0,
        "",
    ),
    known(
        "total_time_s",
        t(
            "time from the first goal to the last arrival",
            "tiempo desde el primer objetivo hasta la última llegada",
        ),
        1.0,
        "s",
    ),
    known(
        "clearance_m",
        t(
            "least distance from an obstacle",
            "distancia mínima a un obstáculo",
        ),
        CM,
        "cm",
    ),
    known(
        "heading_error_rad",
        t(
            "heading error on the straights, worst",
            "error de orientación en los tramos rectos, máximo",
        ),
        DEG,
        "°",
    ),
    known(
        "straights",
        t("straights driven", "tramos rectos recorridos"),
        1.0,
        "",
    ),
    known("turn_rad", t("turned by", "giro"), DEG, "°"),
    known(
        "asymmetry",
        t(
            "right wheel faster than left, share",
            "exceso de velocidad de la rueda derecha sobre la izquierda",
        ),
        100.0,
        "%",
    ),
    known(
        "radius_m",
        t("radius of the circle", "radio de la circunferencia"),
        CM,
        "cm",
    ),
    known(
        "left_dead_zone_duty",
        t(
            "left wheel starts at a PWM of",
            "la rueda izquierda arranca con una PWM de",
        ),
        PWM,
        "",
    ),
    known(
        "right_dead_zone_duty",
        t(
            "right wheel starts at a PWM of",
            "la rueda derecha arranca con una PWM de",
        ),
        PWM,
        "",
    ),
    known(
        "left_stop_duty",
        t(
            "left wheel stops at a PWM of",
            "la rueda izquierda se para con una PWM de",
        ),
        PWM,
        "",
    ),
    known(
        "right_stop_duty",
        t(
            "right wheel stops at a PWM of",
            "la rueda derecha se para con una PWM de",
        ),
        PWM,
        "",
    ),
];

const STEP: Text = t("Step {}, to {}", "Escalón {}, a {}");
const GOAL: Text = t("Goal {}", "Objetivo {}");
const TURN: Text = t("Turn {}", "Giro {}");
const AFTER: Text = t("After 3 m", "A los 3 m");
const END: Text = t("At the end", "Al final");
const UP: Text = t("Rising, {} % of full PWM", "Subida, {} % de la PWM máxima");
const DOWN: Text = t("Falling, {} % of full PWM", "Bajada, {} % de la PWM máxima");

/// A metric as it is shown.
pub(crate) struct Shown {
    pub(crate) name: String,
    /// Without what it is a metric of.
    pub(crate) bare: &'static str,
    pub(crate) factor: f64,
    pub(crate) unit: &'static str,
}

/// What a metric of a run is called; `None` for one that this table does not know.
pub(crate) fn shown(language: Language, outcome: &Outcome, key: &str) -> Option<Shown> {
    let (prefix, stem) = key.split_once('.').unwrap_or(("", key));
    let number = |name: &str| -> Option<usize> { prefix.strip_prefix(name)?.parse().ok() };
    let turn = stem
        .strip_prefix("turn")
        .and_then(|rest| rest.strip_suffix("_rad"));
    let (of, stem) = if let Some(index) = number("step") {
        let reference = step_references(language, outcome)
            .into_iter()
            .nth(index - 1);
        (
            STEP.with(
                language,
                &[&index.to_string(), &reference.unwrap_or_default()],
            ),
            stem,
        )
    } else if let Some(index) = number("goal") {
        (GOAL.with(language, &[&index.to_string()]), stem)
    } else if let Some(percent) = number("up") {
        (UP.with(language, &[&percent.to_string()]), stem)
    } else if let Some(percent) = number("down") {
        (DOWN.with(language, &[&percent.to_string()]), stem)
    } else if prefix == "after_3_m" {
        (AFTER.of(language).to_owned(), stem)
    } else if prefix == "end" {
        (END.of(language).to_owned(), stem)
    } else if let Some(index) = turn.filter(|index| !index.is_empty()) {
        (TURN.with(language, &[index]), "turn_rad")
    } else {
        (String::new(), stem)
    };
    let known = KNOWN.iter().find(|known| known.stem == stem)?;
    let name = known.name.of(language);
    Some(Shown {
        name: if of.is_empty() {
            capital(name)
        } else {
            format!("{of}: {name}")
        },
        bare: name,
        factor: known.factor,
        unit: known.unit.of(language),
    })
}

pub(crate) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().collect::<String>() + letters.as_str()
    })
}

/// The reference of each step of a run, as its metrics count them: those in force while the robot is armed.
fn step_references(language: Language, outcome: &Outcome) -> Vec<String> {
    let scenario = &outcome.setup.scenario;
    let (factor, unit) = match scenario.mode {
        ModeId::WheelSpeed | ModeId::StraightLine => (RPM, "rpm"),
        _ => (CM, "cm"),
    };
    let (mut armed, mut reference, mut steps) = (false, None, Vec::new());
    for timed in &scenario.commands {
        match timed.command {
            Command::Arm => armed = true,
            Command::Reference(value) => reference = Some(value),
            Command::WheelReference(wheels) => reference = Some(wheels.left),
            _ => continue,
        }
        if let (true, Some(reference)) = (armed, reference) {
            let value = language.short(f64::from(reference) * factor, 1);
            steps.push(with_unit(value, unit));
        }
    }
    steps
}

/// A value that is no metric, already in its unit.
pub(crate) const fn plain(unit: &'static str) -> Shown {
    Shown {
        name: String::new(),
        bare: "",
        factor: 1.0,
        unit,
    }
}

/// A value with its unit.
pub(crate) fn with_unit(value: String, unit: &str) -> String {
    match unit {
        "" => value,
        "°" => format!("{value}°"),
        _ => format!("{value}\u{a0}{unit}"),
    }
}

const NEVER: Text = t("never", "nunca");

/// A metric's value as it is shown.
pub(crate) fn value(language: Language, shown: &Shown, value: f64) -> String {
    if value.is_nan() {
        // Such as the settling of what does not settle.
        return NEVER.of(language).to_owned();
    }
    let value = value * shown.factor;
    let text = match shown.unit {
        "m/s" | "m" => language.short(value, 3),
        // Times are known to a tenth at least.
        "s" if value < 100.0 => {
            let short = language.short(value, 2);
            if short.contains(['.', ',']) {
                short
            } else {
                language.number(value, 1)
            }
        }
        _ => language.figure(value),
    };
    with_unit(text, shown.unit)
}

fn bounds(language: Language, shown: &Shown, bounds: Bounds) -> String {
    // Whoever wrote a limit in rad wrote a round number of degrees, rounded.
    let number = |value: f64| {
        let value = value * shown.factor;
        let decimals = if value.abs() >= 100.0 {
            0
        } else if value.abs() >= 10.0 {
            1
        } else {
            2
        };
        language.short(value, decimals)
    };
    let text = match (bounds.min, bounds.max) {
        (Some(min), Some(max)) => format!("{} … {}", number(min), number(max)),
        (Some(min), None) => format!("≥ {}", number(min)),
        (None, Some(max)) => format!("≤ {}", number(max)),
        (None, None) => return String::new(),
    };
    with_unit(text, shown.unit)
}

const METRIC: Text = t("Metric", "Métrica");
const VALUE: Text = t("Value", "Valor");
const LIMIT: Text = t("Limit", "Límite");
const RESULT: Text = t("Result", "Resultado");
pub(crate) const KEPT: Text = t("met", "cumple");
pub(crate) const MISSED: Text = t("missed", "no cumple");
const MESSAGE: Text = t(
    "Message of the program in {}: {}",
    "Mensaje del programa en {} (en inglés): {}",
);

/// The metrics of runs against their limits, a table for each run.
pub(crate) fn limits(page: &mut Page, outcomes: &[&Outcome]) {
    let header = [METRIC, VALUE, LIMIT, RESULT].map(|text| page.say(text));
    for outcome in outcomes {
        let rows = rows(page.language, outcome);
        if !rows.is_empty() {
            page.html(&format!(
                "<h4><code translate=\"no\">{}</code></h4>\n",
                escape(&outcome.result.scenario)
            ));
            page.table(&header, &rows);
        }
        complaints(page, outcome);
    }
}

const SCENARIO: Text = t("Scenario", "Escenario");

/// The same of many runs in one table.
pub(crate) fn limits_together(page: &mut Page, outcomes: &[&Outcome]) {
    let mut all = Vec::new();
    for outcome in outcomes {
        for (index, mut row) in rows(page.language, outcome).into_iter().enumerate() {
            // Said once, where the table's rows are many.
            let name = match index {
                0 => format!(
                    "<code translate=\"no\">{}</code>",
                    escape(&outcome.result.scenario)
                ),
                _ => String::new(),
            };
            row.insert(0, Cell::html(name));
            all.push(row);
        }
    }
    let header = [SCENARIO, METRIC, VALUE, LIMIT, RESULT].map(|text| page.say(text));
    page.table(&header, &all);
    outcomes
        .iter()
        .for_each(|outcome| complaints(page, outcome));
}

/// A run's metrics that have a limit.
fn rows(language: Language, outcome: &Outcome) -> Vec<Vec<Cell>> {
    let row = |(key, limit): (&String, &Bounds)| {
        let shown = shown(language, outcome, key)?;
        let found = outcome.metric(key).unwrap_or(f64::NAN);
        let (verdict, tone) = if limit.admit(found) {
            (KEPT, Tone::Good)
        } else {
            (MISSED, Tone::Bad)
        };
        Some(vec![
            Cell::text(&shown.name),
            Cell::text(&value(language, &shown, found)),
            Cell::text(&bounds(language, &shown, *limit)),
            Cell::text(verdict.of(language)).tone(tone),
        ])
    };
    outcome
        .setup
        .scenario
        .limits
        .iter()
        .filter_map(row)
        .collect()
}

/// What the robot or the program said besides missed limits.
fn complaints(page: &mut Page, outcome: &Outcome) {
    let is_limit = |line: &str| {
        outcome
            .setup
            .scenario
            .limits
            .keys()
            .any(|key| line.starts_with(&format!("{key} = ")))
    };
    for line in outcome
        .result
        .failures
        .iter()
        .filter(|line| !is_limit(line))
    {
        let name = &outcome.result.scenario;
        let [before, rest] = page.say(MESSAGE).splitn(2, "{}").collect::<Vec<_>>()[..] else {
            continue;
        };
        let html = format!(
            "<p class=\"verdict bad\">{}<code translate=\"no\">{}</code>{}<span lang=\"en\" translate=\"no\">{}</span></p>\n",
            escape(before),
            escape(name),
            escape(rest.trim_end_matches("{}")),
            escape(line)
        );
        page.html(&html);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_scenario::files::{Library, Overrides};
    use rumbo_scenario::run::run;

    #[test]
    fn every_metric_that_has_a_limit_has_a_name_in_both_languages() {
        let library = Library::new();
        for experiment in crate::EXPERIMENTS {
            for name in experiment.scenarios {
                let mut setup = library.setup(name, &Overrides::default()).unwrap();
                // Names depend on the commands, not on what comes of them.
                setup.scenario.calibrated = false;
                setup.scenario.duration_s = 0.1;
                let limits: Vec<String> = setup.scenario.limits.keys().cloned().collect();
                let result = run(&setup, 1).unwrap();
                let outcome = Outcome { setup, result };
                for key in limits {
                    for language in [Language::English, Language::Spanish] {
                        assert!(shown(language, &outcome, &key).is_some(), "{name}: {key}");
                    }
                }
            }
        }
    }

    #[test]
    fn values_and_bounds_are_shown_in_the_unit_of_a_reader() {
        let shown = Shown {
            factor: DEG,
            ..plain("°")
        };
        assert_eq!(value(Language::Spanish, &shown, 0.0349), "2°");
        let both = Bounds {
            min: Some(-1.75),
            max: Some(-1.4),
        };
        assert_eq!(
            bounds(Language::English, &shown, both),
            "\u{2212}100 … \u{2212}80.2°"
        );
        assert_eq!(value(Language::English, &shown, f64::NAN), "never");
    }
}
