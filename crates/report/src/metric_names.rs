//! What each metric is called in both languages, and in which unit people read it.

use crate::judge::{capital, with_unit};
use crate::signals::{CM, DEG, Outcome, RPM};
use crate::text::{Language, Text, same, t};
use rumbo_control::mode::ReferenceKind;
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
            "velocidad de una rueda accionada contra su giro, máxima",
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
            "velocidad a lo largo de la pared en el medio segundo más lento",
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
            "PWM a la que arranca la rueda izquierda",
        ),
        PWM,
        "",
    ),
    known(
        "right_dead_zone_duty",
        t(
            "right wheel starts at a PWM of",
            "PWM a la que arranca la rueda derecha",
        ),
        PWM,
        "",
    ),
    known(
        "left_stop_duty",
        t(
            "left wheel stops at a PWM of",
            "PWM a la que se para la rueda izquierda",
        ),
        PWM,
        "",
    ),
    known(
        "right_stop_duty",
        t(
            "right wheel stops at a PWM of",
            "PWM a la que se para la rueda derecha",
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

/// The reference of each step of a run, as its metrics count them: those in force while the robot is armed.
fn step_references(language: Language, outcome: &Outcome) -> Vec<String> {
    let scenario = &outcome.setup.scenario;
    let (factor, unit) = match scenario.mode.takes_reference() {
        Some(ReferenceKind::WheelSpeed | ReferenceKind::Speed) => (RPM, "rpm"),
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
