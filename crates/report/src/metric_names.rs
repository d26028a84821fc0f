//! What each metric is called in both languages, and in which unit people read it.

use crate::signals::{CM, DEG, RPM};
use crate::text::{Language, Text, capital, same, with_unit, word};
use rumbo_control::mode::ReferenceKind;
use rumbo_experiment::files::ScenarioFile;
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
    known("contacts", word("contacts-with-an-obstacle"), 1.0, ""),
    known("control_period_s", word("control-period"), 1000.0, "ms"),
    known(
        "reverse_drive_rad_s",
        word("wheel-driven-against-its-motion"),
        RPM,
        "rpm",
    ),
    Known {
        stem: "telemetry_hz",
        name: word("telemetry"),
        factor: 1.0,
        unit: word("frames-s"),
    },
    known("settling_s", word("settling-time"), 1.0, "s"),
    known("within_2cm_s", word("time-until-within-2-cm"), 1.0, "s"),
    known("rise_s", word("rise-time"), 1.0, "s"),
    known("overshoot_m", word("overshoot"), CM, "cm"),
    known("overshoot_rad_s", word("overshoot"), RPM, "rpm"),
    known("steady_error_m", word("steady-error"), CM, "cm"),
    known("steady_error_rad_s", word("steady-error"), RPM, "rpm"),
    known("rms_m", word("error-rms"), CM, "cm"),
    known("rms_rad_s", word("error-rms"), RPM, "rpm"),
    known("ripple_m", word("ripple-standard-deviation"), CM, "cm"),
    known(
        "ripple_rad_s",
        word("ripple-standard-deviation"),
        RPM,
        "rpm",
    ),
    known("angle_rad", word("angle-to-the-wall-at-rest"), DEG, "°"),
    known("cruise_m_s", word("slowest-along-the-wall"), 1.0, "m/s"),
    known("distance_rms_m", word("distance-error-rms"), CM, "cm"),
    known("distance_worst_m", word("distance-error-worst"), CM, "cm"),
    known("heading_rad", word("true-drift-of-the-heading"), DEG, "°"),
    known("sideways_m", word("true-drift-sideways"), CM, "cm"),
    known("forward_m", word("way-ahead"), 1.0, "m"),
    known("left_rad_s", word("speed-of-the-left-wheel"), RPM, "rpm"),
    known("right_rad_s", word("speed-of-the-right-wheel"), RPM, "rpm"),
    known("end_error_m", word("true-distance-from-the-end"), CM, "cm"),
    known("finish_s", word("time-to-the-end"), 1.0, "s"),
    known("odometry_rms_m", word("off-the-route-rms"), CM, "cm"),
    known("odometry_worst_m", word("off-the-route-worst"), CM, "cm"),
    known("true_rms_m", word("truly-off-the-route-rms"), CM, "cm"),
    known("true_worst_m", word("truly-off-the-route-worst"), CM, "cm"),
    known("path_m", word("way-driven"), 1.0, "m"),
    known(
        "contact_speed_m_s",
        word("speed-of-the-hardest-contact"),
        1.0,
        "m/s",
    ),
    known("error_m", word("true-distance-from-the-goal"), CM, "cm"),
    known("excess_m", word("excess-error"), CM, "cm"),
    known("time_s", word("time"), 1.0, "s"),
    known("reached", word("goals-reached"), 1.0, ""),
    known("unreachable", word("goals-given-up"), 1.0, ""),
    known("total_time_s", word("time-to-the-last-arrival"), 1.0, "s"),
    known(
        "clearance_m",
        word("least-distance-from-an-obstacle"),
        CM,
        "cm",
    ),
    known(
        "heading_error_rad",
        word("heading-error-on-the-straights"),
        DEG,
        "°",
    ),
    known("straights", word("straights-driven"), 1.0, ""),
    known("turn_rad", word("turned-by"), DEG, "°"),
    known("asymmetry", word("right-wheel-faster"), 100.0, "%"),
    known("radius_m", word("radius-of-the-circle"), CM, "cm"),
    known("left_dead_zone_duty", word("left-wheel-starts"), PWM, ""),
    known("right_dead_zone_duty", word("right-wheel-starts"), PWM, ""),
    known("left_stop_duty", word("left-wheel-stops"), PWM, ""),
    known("right_stop_duty", word("right-wheel-stops"), PWM, ""),
    known("wait_longest_s", word("longest-wait"), 1000.0, "ms"),
    known("wait_share", word("time-spent-waiting"), 100.0, "%"),
    known("turn_longest_s", word("longest-turn"), 1000.0, "ms"),
    known("interrupt_longest_s", word("longest-interrupt"), 1e6, "µs"),
    known("interrupt_float_s", word("float-in-interrupts"), 1e6, "µs"),
    known("stack_bytes", word("depth-of-the-stack"), 1.0, "bytes"),
    known("heap_calls", word("calls-of-the-heap"), 1.0, ""),
];

const PROGRAM: Text = word("of-the-program");
const STEP: Text = word("step-number");
const GOAL: Text = word("goal-number");
const TURN: Text = word("turn-number");
const AFTER: Text = word("after-3-m");
const END: Text = word("at-the-end");
const UP: Text = word("rising-pwm");
const DOWN: Text = word("falling-pwm");

/// A metric as it is shown.
pub(crate) struct Shown {
    pub(crate) name: String,
    /// Without what it is a metric of.
    pub(crate) bare: &'static str,
    pub(crate) factor: f64,
    pub(crate) unit: &'static str,
}

/// What a metric of a scenario's run is called; `None` for one that this table does not know.
pub(crate) fn shown(language: Language, scenario: &ScenarioFile, key: &str) -> Option<Shown> {
    let (prefix, stem) = key.split_once('.').unwrap_or(("", key));
    let number = |name: &str| -> Option<usize> { prefix.strip_prefix(name)?.parse().ok() };
    let turn = stem
        .strip_prefix("turn")
        .and_then(|rest| rest.strip_suffix("_rad"));
    let (of, stem) = if let Some(index) = number("step") {
        let reference = step_references(language, scenario)
            .into_iter()
            .nth(index - 1);
        (
            STEP.with(
                language,
                &[
                    ("number", &index.to_string()),
                    ("reference", &reference.unwrap_or_default()),
                ],
            ),
            stem,
        )
    } else if let Some(index) = number("goal") {
        (GOAL.with(language, &[("number", &index.to_string())]), stem)
    } else if let Some(percent) = number("up") {
        (
            UP.with(language, &[("percent", &percent.to_string())]),
            stem,
        )
    } else if let Some(percent) = number("down") {
        (
            DOWN.with(language, &[("percent", &percent.to_string())]),
            stem,
        )
    } else if prefix == "after_3_m" {
        (AFTER.of(language).to_owned(), stem)
    } else if prefix == "program" {
        (PROGRAM.of(language).to_owned(), stem)
    } else if prefix == "end" {
        (END.of(language).to_owned(), stem)
    } else if let Some(index) = turn.filter(|index| !index.is_empty()) {
        (TURN.with(language, &[("number", index)]), "turn_rad")
    } else {
        (prefix.to_owned(), stem)
    };
    let shown = bare(language, stem)?;
    let name = match of.is_empty() {
        true => shown.name,
        false => format!("{of}: {}", shown.bare),
    };
    Some(Shown { name, ..shown })
}

/// What a metric is called without the step or goal that it is of.
pub(crate) fn bare(language: Language, stem: &str) -> Option<Shown> {
    let known = KNOWN.iter().find(|known| known.stem == stem)?;
    let name = known.name.of(language);
    Some(Shown {
        name: capital(name),
        bare: name,
        factor: known.factor,
        unit: known.unit.of(language),
    })
}

/// The reference of each step of a run, as its metrics count them: those in force while the robot is armed.
fn step_references(language: Language, scenario: &ScenarioFile) -> Vec<String> {
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
