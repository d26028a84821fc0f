//! What several chapters have in common: names of curves, rig and wiring, tables beside a recorded run.

use crate::data::Data;
use crate::drawing::{rig, wiring};
use crate::judge;
use crate::page::{Cell, Page};
use crate::plot::{Curve, Ink, Map, Panel, Plot, Points, Shape};
use crate::real::Recording;
use crate::respond::{Kind, Response, responses};
use crate::signals::{CM, Outcome, Place, difference};
use crate::text::{Language, Text, t};
use rumbo_wire::Command;
use rumbo_wire::text::Row;

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
    "Recorded run: `{}`. Both curves begin with the arming{}. Both are what the robots measured themselves, and the values below are taken from these \
     measurements in the same way.",
    "Registro: `{}`. Ambas curvas comienzan con el armado{}. Las dos son lo que cada robot midió por sí mismo y los valores que siguen se obtienen de \
     esas medidas de la misma manera.",
);
const SAME_REFERENCES: Text = t(
    ", and ours was given the recorded references at their times",
    " y nuestro robot recibió las referencias del registro en sus mismos instantes",
);

/// Heading and explanation of a comparison.
pub(super) fn beside_heading(page: &mut Page, file: &str, same_references: bool) {
    page.section(BESIDE);
    let more = if same_references {
        page.say(SAME_REFERENCES)
    } else {
        ""
    };
    let text = FILE.with(page.language, &[file, more]);
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
            let shown = judge::plain(unit);
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

/// The mean of a recorded run's two ranges \[cm\].
pub(super) fn recorded_mean_cm(recording: &Recording) -> Points {
    recording.signal(|row| match row {
        Row::Distance(row) => Some(0.5 * f64::from(row.left_cm + row.right_cm)),
        _ => None,
    })
}

const BESIDE_CAPTION: Text = t(
    "Distance to the wall (mean of the sonars): ours and the recorded run, with the same references at the same times.",
    "Distancia a la pared (media de los sensores): nuestro robot y el registro real, con las mismas referencias en los mismos instantes.",
);

/// A recorded run of a distance with steps of its reference, beside ours.
pub(super) fn distance_beside(page: &mut Page, data: &Data, scenario: &str, axis: Text) {
    let Some((ours, recording)) = data.beside(scenario) else {
        return;
    };
    beside_heading(page, &recording.file, true);
    let language = page.language;
    let (mine, real) = (mean_cm(ours), recorded_mean_cm(recording));
    let mut curves = vec![Curve::steps(
        REFERENCE.of(language),
        Ink::Reference,
        ours.reference(CM),
    )];
    curves.extend(both(language, mine.clone(), real.clone()));
    let panel = Panel::new(axis.of(language), curves);
    show(
        page,
        over_time(
            page,
            &format!("{scenario}-real"),
            BESIDE_CAPTION,
            vec![panel],
        ),
    );
    let references: Vec<(f64, f64)> = recording
        .references()
        .iter()
        .map(|(t_s, m)| (*t_s, CM * m))
        .collect();
    let kind = Kind::Distance;
    let rows = step_rows(
        language,
        kind,
        &responses(kind, &references, &mine),
        &responses(kind, &references, &real),
    );
    beside_table(page, &rows);
}

const X_AXIS: Text = t("x (m)", "x (m)");
const Y_AXIS: Text = t("y (m)", "y (m)");
const IDEAL: Text = t("ideal", "ideal");
const BY_ODOMETRY: Text = t("by odometry", "según la odometría");
const TRUE_WAY: Text = t("true", "real");

/// A map with nothing on it.
pub(super) fn map(language: Language) -> Map {
    Map {
        x: X_AXIS.of(language).to_owned(),
        y: Y_AXIS.of(language).to_owned(),
        ..Map::default()
    }
}

/// The ideal way, the way by odometry, and the true one.
pub(super) fn ways(language: Language, outcome: &Outcome, ideal: Points) -> Vec<Curve> {
    let mut curves = vec![Curve::new(IDEAL.of(language), Ink::Reference, ideal)];
    if outcome.tells() {
        curves.push(Curve::new(
            BY_ODOMETRY.of(language),
            Ink::First,
            outcome.told_way(),
        ));
    }
    curves.push(Curve::new(TRUE_WAY.of(language), Ink::Third, outcome.way()));
    curves
}

/// The walls and boxes of a run's world.
pub(super) fn shapes(outcome: &Outcome) -> Vec<Shape> {
    let Ok(world) = outcome.setup.world.world() else {
        return Vec::new();
    };
    let shape = |obstacle: &rumbo_plant::world::Obstacle| {
        let corners: Points = obstacle.corners().map(|[x, y]| (x, y)).collect();
        Shape {
            filled: corners.len() > 2,
            corners,
        }
    };
    world.obstacles().iter().map(shape).collect()
}

/// The route of a run's commands in the world, from its start.
pub(super) fn route(outcome: &Outcome) -> Points {
    let start = outcome.setup.scenario.start;
    let (sin, cos) = start.heading_rad.sin_cos();
    let mut route = vec![(start.x_m, start.y_m)];
    for timed in &outcome.setup.scenario.commands {
        if let Command::Waypoint(waypoint) = timed.command {
            let (x, y) = (f64::from(waypoint.x_m), f64::from(waypoint.y_m));
            route.push((start.x_m + cos * x - sin * y, start.y_m + sin * x + cos * y));
        }
    }
    route
}

/// Distance of a point from a polyline, and of each point of a way over its own index in time.
pub(super) fn off_route(route: &Points, (x, y): (f64, f64)) -> f64 {
    let from_piece = |piece: &[(f64, f64)]| {
        let (a, b) = (piece[0], piece[1]);
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let along = ((x - a.0) * dx + (y - a.1) * dy) / (dx * dx + dy * dy).max(1e-12);
        let along = along.clamp(0.0, 1.0);
        (x - a.0 - along * dx).hypot(y - a.1 - along * dy)
    };
    route
        .windows(2)
        .map(from_piece)
        .fold(f64::INFINITY, f64::min)
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
