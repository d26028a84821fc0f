//! What each metric is called in both languages, and in which unit people read it.

use crate::signals::{CM, DEG, RPM};
use crate::text::{Language, Text, capital, same, with_unit, word};
use rumbo_control::mode::ReferenceKind;
use rumbo_experiment::files::ScenarioFile;
use rumbo_wire::Command;

/// A metric's name, and the unit that people read it in.
struct Known {
    stem: &'static str,
    name: Text,
    unit: Text,
}

const fn known(stem: &'static str, name: Text, unit: &'static str) -> Known {
    Known {
        stem,
        name,
        unit: same(unit),
    }
}

const KNOWN: &[Known] = &[
    known("contacts", word("contacts-with-an-obstacle"), ""),
    known("control_period_s", word("control-period"), "ms"),
    known(
        "reverse_drive_rad_s",
        word("wheel-driven-against-its-motion"),
        "rpm",
    ),
    Known {
        stem: "telemetry_hz",
        name: word("telemetry"),
        unit: word("frames-s"),
    },
    known("settling_s", word("settling-time"), "s"),
    known("within_2cm_s", word("time-until-within-2-cm"), "s"),
    known("rise_s", word("rise-time"), "s"),
    known("overshoot_m", word("overshoot"), "cm"),
    known("overshoot_rad_s", word("overshoot"), "rpm"),
    known("steady_error_m", word("steady-error"), "cm"),
    known("steady_error_rad_s", word("steady-error"), "rpm"),
    known("rms_m", word("error-rms"), "cm"),
    known("rms_rad_s", word("error-rms"), "rpm"),
    known("ripple_m", word("ripple-standard-deviation"), "cm"),
    known("ripple_rad_s", word("ripple-standard-deviation"), "rpm"),
    known("angle_rad", word("angle-to-the-wall-at-rest"), "°"),
    known("cruise_m_s", word("slowest-along-the-wall"), "m/s"),
    known("distance_rms_m", word("distance-error-rms"), "cm"),
    known("distance_worst_m", word("distance-error-worst"), "cm"),
    known("heading_rad", word("true-drift-of-the-heading"), "°"),
    known("sideways_m", word("true-drift-sideways"), "cm"),
    known("forward_m", word("way-ahead"), "m"),
    known("left_rad_s", word("speed-of-the-left-wheel"), "rpm"),
    known("right_rad_s", word("speed-of-the-right-wheel"), "rpm"),
    known("end_error_m", word("true-distance-from-the-end"), "cm"),
    known("finish_s", word("time-to-the-end"), "s"),
    known("odometry_rms_m", word("off-the-route-rms"), "cm"),
    known("odometry_worst_m", word("off-the-route-worst"), "cm"),
    known("true_rms_m", word("truly-off-the-route-rms"), "cm"),
    known("true_worst_m", word("truly-off-the-route-worst"), "cm"),
    known("path_m", word("way-driven"), "m"),
    known(
        "contact_speed_m_s",
        word("speed-of-the-hardest-contact"),
        "m/s",
    ),
    known("error_m", word("true-distance-from-the-goal"), "cm"),
    known("excess_m", word("excess-error"), "cm"),
    known("time_s", word("time"), "s"),
    known("reached", word("goals-reached"), ""),
    known("unreachable", word("goals-given-up"), ""),
    known("total_time_s", word("time-to-the-last-arrival"), "s"),
    known("clearance_m", word("least-distance-from-an-obstacle"), "cm"),
    known(
        "heading_error_rad",
        word("heading-error-on-the-straights"),
        "°",
    ),
    known("straights", word("straights-driven"), ""),
    known("turn_rad", word("turned-by"), "°"),
    known("asymmetry", word("right-wheel-faster"), "%"),
    known("radius_m", word("radius-of-the-circle"), "cm"),
    known("left_dead_zone_duty", word("left-wheel-starts"), ""),
    known("right_dead_zone_duty", word("right-wheel-starts"), ""),
    known("left_stop_duty", word("left-wheel-stops"), ""),
    known("right_stop_duty", word("right-wheel-stops"), ""),
    known("wait_longest_s", word("longest-wait"), "ms"),
    known("wait_share", word("time-spent-waiting"), "%"),
    known("turn_longest_s", word("longest-turn"), "ms"),
    known("interrupt_longest_s", word("longest-interrupt"), "µs"),
    known("interrupt_float_s", word("float-in-interrupts"), "µs"),
    known("stack_bytes", word("depth-of-the-stack"), "bytes"),
    known("heap_calls", word("calls-of-the-heap"), ""),
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
    let numbered = |name: &str, text: Text, value: &str| {
        number(name).map(|number| text.with(language, &[(value, number.to_string())]))
    };
    let step = || {
        let number = number("step")?;
        let mut references = step_references(language, scenario).into_iter();
        let reference = references.nth(number.checked_sub(1)?).unwrap_or_default();
        let values = [("number", number.to_string()), ("reference", reference)];
        Some(STEP.with(language, &values))
    };
    let of = match prefix {
        "after_3_m" => Some(AFTER.of(language).to_owned()),
        "program" => Some(PROGRAM.of(language).to_owned()),
        "end" => Some(END.of(language).to_owned()),
        _ => step()
            .or_else(|| numbered("goal", GOAL, "number"))
            .or_else(|| numbered("up", UP, "percent"))
            .or_else(|| numbered("down", DOWN, "percent")),
    };
    let turn = stem
        .strip_prefix("turn")
        .and_then(|rest| rest.strip_suffix("_rad"));
    let (of, stem) = match (of, turn) {
        (Some(of), _) => (of, stem),
        (None, Some(index)) if !index.is_empty() => {
            (TURN.with(language, &[("number", index)]), "turn_rad")
        }
        (None, _) => (prefix.to_owned(), stem),
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
        factor: factor(known),
        unit: known.unit.of(language),
    })
}

/// What its value is multiplied with to be shown; a duty is shown as PWM, of 255.
fn factor(known: &Known) -> f64 {
    match known.unit {
        Text::Same("cm") => CM,
        Text::Same("rpm") => RPM,
        Text::Same("°") => DEG,
        Text::Same("%") => 100.0,
        Text::Same("ms") => 1e3,
        Text::Same("µs") => 1e6,
        Text::Same("") if known.stem.ends_with("_duty") => 255.0,
        _ => 1.0,
    }
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
