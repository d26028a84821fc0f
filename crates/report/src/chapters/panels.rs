//! Panels that several chapters show: PWM, distances, speeds with their references, states.

use super::parts::{DISTANCE, LEFT, MEASURED, PWM, REFERENCE, RIGHT};
use crate::plot::{Curve, Ink, Panel, Points};
use crate::signals::{CM, Outcome, Place, difference};
use crate::text::{Language, Text, t};

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

/// Both sonars of a pair with the reference.
pub(super) fn pair_panel(language: Language, outcome: &Outcome) -> Panel {
    let names = pair_names(outcome);
    let curve =
        |name: Text, ink, sonar| Curve::new(name.of(language), ink, outcome.range_cm(sonar));
    let curves = vec![
        Curve::steps(
            REFERENCE.of(language),
            Ink::Reference,
            outcome.reference(CM),
        ),
        curve(names[0], Ink::First, Place::Left),
        curve(names[1], Ink::Second, Place::Right),
    ];
    Panel::new(DISTANCE.of(language), curves)
}

const FIRST: Text = t("first sonar (ahead)", "primer sensor (delantero)");
const SECOND: Text = t("second sonar (behind)", "segundo sensor (trasero)");
const LEFT_SONAR: Text = t("left sonar", "sensor izquierdo");
const RIGHT_SONAR: Text = t("right sonar", "sensor derecho");

/// What the two of a pair are called: beside the robot they are one behind the other.
fn pair_names(outcome: &Outcome) -> [Text; 2] {
    let beside = outcome
        .setup
        .rig
        .left
        .is_some_and(|mount| mount.angle_rad != 0.0);
    if beside {
        [FIRST, SECOND]
    } else {
        [LEFT_SONAR, RIGHT_SONAR]
    }
}

/// Differences of both distances from a reference.
pub(super) fn pair_errors(language: Language, outcome: &Outcome, reference: &Points) -> Vec<Curve> {
    let names = pair_names(outcome);
    [
        (names[0], Ink::First, Place::Left),
        (names[1], Ink::Second, Place::Right),
    ]
    .into_iter()
    .map(|(name, ink, sonar)| {
        Curve::new(
            name.of(language),
            ink,
            difference(&outcome.range_cm(sonar), reference),
        )
    })
    .collect()
}

/// The mean of a pair's ranges \[cm\], or the front sonar's.
pub(super) fn mean_cm(outcome: &Outcome) -> Points {
    if outcome.setup.rig.front.is_some() {
        return outcome.range_cm(Place::Front);
    }
    let right = outcome.range_cm(Place::Right);
    let both = outcome.range_cm(Place::Left).into_iter().zip(right);
    both.map(|((t_s, left), (_, right))| (t_s, 0.5 * (left + right)))
        .collect()
}

const LEFT_REFERENCE: Text = t("left reference", "referencia izquierda");
const RIGHT_REFERENCE: Text = t("right reference", "referencia derecha");
const LEFT_AXIS: Text = t("left wheel (rpm)", "rueda izquierda (rpm)");
const RIGHT_AXIS: Text = t("right wheel (rpm)", "rueda derecha (rpm)");
const REFERENCES_AXIS: Text = t("references (rpm)", "referencias (rpm)");

/// Speed references of both wheels.
pub(super) fn references_panel(language: Language, outcome: &Outcome) -> Panel {
    let curve = |name: Text, ink, wheel| {
        Curve::steps(name.of(language), ink, outcome.speed_reference_rpm(wheel))
    };
    Panel::new(
        REFERENCES_AXIS.of(language),
        vec![
            curve(LEFT_REFERENCE, Ink::First, Place::Left),
            curve(RIGHT_REFERENCE, Ink::Second, Place::Right),
        ],
    )
}

/// Reference and speed of each wheel, one above the other, and the PWM of both.
pub(super) fn wheel_panels(language: Language, outcome: &Outcome) -> Vec<Panel> {
    let panel = |axis: Text, ink, wheel| {
        let curves = vec![
            Curve::new(MEASURED.of(language), ink, outcome.speed_rpm(wheel)),
            Curve::steps(
                REFERENCE.of(language),
                Ink::Reference,
                outcome.speed_reference_rpm(wheel),
            ),
        ];
        Panel::new(axis.of(language), curves)
    };
    vec![
        panel(LEFT_AXIS, Ink::First, Place::Left),
        panel(RIGHT_AXIS, Ink::Second, Place::Right),
        pwm_panel(language, outcome),
    ]
}

const LEFT_RANGE: Text = t("left", "izquierdo");
const RIGHT_RANGE: Text = t("right", "derecho");
const FRONT_RANGE: Text = t("front", "frontal");
const RANGE_AXIS: Text = t("range (cm)", "distancia medida (cm)");

/// The ranges of the three sonars.
pub(super) fn range_panels(language: Language, outcome: &Outcome) -> Vec<Panel> {
    let panel = |name: Text, ink, sonar| {
        let curve = Curve::new(name.of(language), ink, outcome.range_cm(sonar));
        Panel::new(RANGE_AXIS.of(language), vec![curve]).at_least(0.0, 60.0)
    };
    vec![
        panel(LEFT_RANGE, Ink::First, Place::Left),
        panel(RIGHT_RANGE, Ink::Second, Place::Right),
        panel(FRONT_RANGE, Ink::Third, Place::Front),
    ]
}

const STATE_AXIS: Text = t("state", "estado");

/// The states of a mode over time; those that never occur are left out. Their names come in the order of their numbers.
pub(super) fn state_panel(language: Language, outcome: &Outcome, names: &[Text]) -> Panel {
    let states = outcome.states();
    let used: Vec<usize> = (0..names.len())
        .filter(|state| states.iter().any(|(_, value)| *value as usize == *state))
        .collect();
    let place = |value: f64| {
        used.iter()
            .position(|state| *state == value as usize)
            .map_or(f64::NAN, |at| at as f64)
    };
    let points = states
        .iter()
        .map(|(t_s, value)| (*t_s, place(*value)))
        .collect();
    Panel {
        names: used
            .iter()
            .map(|state| names[*state].of(language).to_owned())
            .collect(),
        ..Panel::new(
            STATE_AXIS.of(language),
            vec![Curve::steps("", Ink::First, points)],
        )
    }
}
