//! Panels that several chapters show: PWM, distances, speeds with their references, states.

use super::parts::{self, DISTANCE, ERROR_CM, LEFT, MEASURED, PWM, REFERENCE, RIGHT};
use crate::channel::Channel;
use crate::places::Places;
use crate::signals::{ReportedRun, difference};
use crate::text::{Language, Text, word};
use rumbo_plot::{Curve, Ink, Panel, Points};

/// PWM of both wheels.
pub(crate) fn pwm_panel(language: Language, outcome: &ReportedRun) -> Panel {
    let curve = |name: Text, ink, wheel| Curve::steps(name.of(language), ink, outcome.pwm(wheel));
    Panel::new(
        PWM.of(language),
        vec![
            curve(LEFT, Ink::First, Channel::Left),
            curve(RIGHT, Ink::Second, Channel::Right),
        ],
    )
    .at_least(0.0, 100.0)
}

/// What is shown of a pair of sonars.
pub(super) struct Pair {
    /// The distance that is wanted [cm].
    pub(super) reference: Points,
    /// What the distances' axis shows at least [cm].
    pub(super) distances_cm: [f64; 2],
    /// The same of the errors', either way [cm].
    pub(super) error_cm: f64,
}

impl Pair {
    /// Both distances with the reference over the PWM, and how far both are from it.
    pub(super) fn fill(&self, places: &mut Places, id: &str, outcome: &ReportedRun) {
        let language = places.language;
        let [from, to] = self.distances_cm;
        let distances = self.distances(language, outcome).at_least(from, to);
        let panels = vec![distances, pwm_panel(language, outcome)];
        parts::timed(places, &format!("{id}-distances"), panels);
        let errors = self.errors(language, outcome);
        let errors =
            Panel::new(ERROR_CM.of(language), errors).at_least(-self.error_cm, self.error_cm);
        parts::timed(places, &format!("{id}-error"), vec![errors]);
    }

    fn distances(&self, language: Language, outcome: &ReportedRun) -> Panel {
        let reference = REFERENCE.of(language);
        let mut curves = vec![Curve::steps(
            reference,
            Ink::Reference,
            self.reference.clone(),
        )];
        curves.extend(each(language, outcome, |sonar| outcome.range_cm(sonar)));
        Panel::new(DISTANCE.of(language), curves)
    }

    fn errors(&self, language: Language, outcome: &ReportedRun) -> Vec<Curve> {
        each(language, outcome, |sonar| {
            difference(&outcome.range_cm(sonar), &self.reference)
        })
    }
}

/// A curve for each of a pair.
fn each(
    language: Language,
    outcome: &ReportedRun,
    points: impl Fn(Channel) -> Points,
) -> Vec<Curve> {
    let places = [(Ink::First, Channel::Left), (Ink::Second, Channel::Right)];
    let named = pair_names(outcome).into_iter().zip(places);
    named
        .map(|(name, (ink, sonar))| Curve::new(name.of(language), ink, points(sonar)))
        .collect()
}

const FIRST: Text = word("first-sonar-ahead");
const SECOND: Text = word("second-sonar-behind");
const LEFT_SONAR: Text = word("left-sonar");
const RIGHT_SONAR: Text = word("right-sonar");

/// What the two of a pair are called: beside the robot they are one behind the other.
fn pair_names(outcome: &ReportedRun) -> [Text; 2] {
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

/// The mean of a pair's ranges \[cm\], or the front sonar's.
pub(super) fn mean_cm(outcome: &ReportedRun) -> Points {
    if outcome.setup.rig.front.is_some() {
        return outcome.range_cm(Channel::Front);
    }
    let right = outcome.range_cm(Channel::Right);
    let both = outcome.range_cm(Channel::Left).into_iter().zip(right);
    both.map(|((t_s, left), (_, right))| (t_s, 0.5 * (left + right)))
        .collect()
}

const LEFT_REFERENCE: Text = word("left-reference");
const RIGHT_REFERENCE: Text = word("right-reference");
const LEFT_AXIS: Text = word("left-wheel-rpm");
const RIGHT_AXIS: Text = word("right-wheel-rpm");
const REFERENCES_AXIS: Text = word("references-rpm");

/// Speed references of both wheels.
pub(super) fn references_panel(language: Language, outcome: &ReportedRun) -> Panel {
    let curve = |name: Text, ink, wheel| {
        Curve::steps(name.of(language), ink, outcome.speed_reference_rpm(wheel))
    };
    Panel::new(
        REFERENCES_AXIS.of(language),
        vec![
            curve(LEFT_REFERENCE, Ink::First, Channel::Left),
            curve(RIGHT_REFERENCE, Ink::Second, Channel::Right),
        ],
    )
}

/// Reference and speed of each wheel, one above the other, and the PWM of both.
pub(super) fn wheel_panels(language: Language, outcome: &ReportedRun) -> Vec<Panel> {
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
        panel(LEFT_AXIS, Ink::First, Channel::Left),
        panel(RIGHT_AXIS, Ink::Second, Channel::Right),
        pwm_panel(language, outcome),
    ]
}

const LEFT_RANGE: Text = word("left-sonar-name");
const RIGHT_RANGE: Text = word("right-sonar-name");
const FRONT_RANGE: Text = word("front");
const RANGE_AXIS: Text = word("range-cm");

/// The ranges of the three sonars.
pub(super) fn range_panels(language: Language, outcome: &ReportedRun) -> Vec<Panel> {
    let panel = |name: Text, ink, sonar| {
        let curve = Curve::new(name.of(language), ink, outcome.range_cm(sonar));
        Panel::new(RANGE_AXIS.of(language), vec![curve]).at_least(0.0, 60.0)
    };
    vec![
        panel(LEFT_RANGE, Ink::First, Channel::Left),
        panel(RIGHT_RANGE, Ink::Second, Channel::Right),
        panel(FRONT_RANGE, Ink::Third, Channel::Front),
    ]
}

const STATE_AXIS: Text = word("state");

/// The states of a mode over time; those that never occur are left out. Their names come in the order of their numbers.
pub(super) fn state_panel(language: Language, outcome: &ReportedRun, names: &[Text]) -> Panel {
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
