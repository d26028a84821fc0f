//! Mode 7: a square by odometry.

use super::beside;
use super::maps;
use super::panels;
use super::parts::{self, ANALYSIS, RESULTS};
use super::{Experiment, highlight};
use crate::data::Data;
use crate::drawing::geometry;
use crate::drawing::scheme::{Part, Path, Scheme};
use crate::judge;
use crate::page::Page;
use crate::plot::{Curve, Ink, Map, Panel, Points};
use crate::respond::rms_and_worst;
use crate::signals::{CM, Outcome, unwrapped};
use crate::text::{Language, Text, same, t};
use rumbo_wire::text::Row;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode7",
    number: "7",
    title: t(
        "Mode 7: a square by odometry",
        "Modo 7: un cuadrado mediante odometría",
    ),
    scenarios: &["mode7"],
    highlights: &[
        highlight("mode7", "finish_s", Some(30.0)),
        highlight("mode7", "odometry_worst_m", Some(0.06)),
        highlight("mode7", "end_error_m", None),
    ],
    write,
};

const WHAT: Text = t(
    "The robot goes to points of a frame whose origin is its start, by odometry alone: here the corners of a square of 1 m, once round. It turns on the spot, drives along \
     the side, and turns again.",
    "El robot se desplaza a puntos de un sistema de referencia con origen en su posición de partida, solo mediante odometría: aquí, los vértices de un cuadrado de 1 m, una vuelta. Gira sobre sí mismo, recorre el \
     lado y vuelve a girar.",
);
const PARTS: Text = t(
    "Nothing is added: the wheels' encoders are the only sensors. As in mode 6, the robot calibrates its wheels before the run.",
    "No se añade nada: los encoders de las ruedas son los únicos sensores. Como en el modo 6, el robot calibra sus ruedas antes de la prueba.",
);
const SCHEME_WORDS: Text = t(
    "Two references come from the difference of pose and goal: a distance and a heading. On a side the distance gives the speed, with a stop that friction can keep, and \
     the offset from the side gives the heading; in a corner only the heading counts. Both make the speeds of the wheels, and mode 5 does the rest.",
    "De la diferencia entre pose y objetivo salen dos referencias: una distancia y una orientación. En un lado, la distancia da la velocidad, con una frenada que la adherencia de las ruedas permite, y \
     la separación del lado da la orientación; en una esquina solo cuenta la orientación. Ambas determinan las velocidades de las ruedas y del resto se ocupa el modo 5.",
);
const SCHEME_CAPTION: Text = t(
    "Control scheme of mode 7. In a turn the distance counts as zero.",
    "Esquema de control del modo 7. Durante un giro la distancia se considera nula.",
);
const FRAMES: Text = t(
    "Global frame (X, Y), the robot's frame (x', y') in the middle of its axis, its heading φ, and the bearing φ* of the goal.",
    "Sistema global (X, Y), sistema local (x', y') en el punto medio del eje de las ruedas, orientación φ y ángulo φ* hacia el objetivo.",
);
const KINEMATICS: Text = t(
    "With the speeds of the right and the left wheel, the radius $R$ and the base $b$, the differential drive moves by",
    "Con las velocidades de las ruedas derecha e izquierda, el radio $R$ y la distancia $b$ entre ruedas, el modelo cinemático diferencial es",
);
const KINEMATICS_FORMULA: Text = t(
    r"\dot x = \frac{R}{2}(\omega_R + \omega_L)\cos\varphi, \qquad \dot y = \frac{R}{2}(\omega_R + \omega_L)\sin\varphi, \qquad \dot\varphi = \frac{R}{b}(\omega_R - \omega_L)",
    r"\dot x = \frac{R}{2}(\omega_R + \omega_L)\cos\varphi, \qquad \dot y = \frac{R}{2}(\omega_R + \omega_L)\sen\varphi, \qquad \dot\varphi = \frac{R}{b}(\omega_R - \omega_L)",
);
const ARC: Text = t(
    "Between two instants the robot drives an arc, and along it the odometry is exact, with the ways $\\Delta s$ of the middle and the turn $\\Delta\\varphi$:",
    "Entre dos instantes el robot describe un arco, y a lo largo de él la odometría es exacta, con el recorrido $\\Delta s$ del punto medio y el giro $\\Delta\\varphi$:",
);
const ARC_FORMULA: Text = t(
    r"\Delta x = \Delta s\,\frac{\sin(\Delta\varphi/2)}{\Delta\varphi/2}\cos\left(\varphi + \frac{\Delta\varphi}{2}\right), \qquad \Delta y = \Delta s\,\frac{\sin(\Delta\varphi/2)}{\Delta\varphi/2}\sin\left(\varphi + \frac{\Delta\varphi}{2}\right)",
    r"\Delta x = \Delta s\,\frac{\sen(\Delta\varphi/2)}{\Delta\varphi/2}\cos\left(\varphi + \frac{\Delta\varphi}{2}\right), \qquad \Delta y = \Delta s\,\frac{\sen(\Delta\varphi/2)}{\Delta\varphi/2}\sen\left(\varphi + \frac{\Delta\varphi}{2}\right)",
);
const BEARING: Text = t(
    "Distance and bearing of the goal:",
    "Distancia y ángulo hacia el objetivo:",
);
const BEARING_FORMULA: Text = same(
    r"\rho = \sqrt{(x^* - x)^2 + (y^* - y)^2}, \qquad \varphi^* = \operatorname{atan2}(y^* - y,\ x^* - x)",
);
const POSE: Text = t(
    "Pose by odometry: x and y, and the heading, within ±180 degrees.",
    "Pose según la odometría: x e y, y orientación, dentro de ±180 grados.",
);
const POSITION_AXIS: Text = t("position (m)", "posición (m)");
const HEADING_AXIS: Text = t("heading (°)", "orientación (°)");
const WHEELS: Text = t(
    "Reference and speed of each wheel, and PWM. On the sides both references have one sign, in the corners opposite ones.",
    "Referencia y velocidad de cada rueda, y PWM. En los lados ambas referencias tienen el mismo signo; en las esquinas, signos opuestos.",
);
const WAY: Text = t(
    "The way beside the ideal square: by odometry, which the robot regulates, and the true one, which only an observer knows.",
    "La trayectoria frente al cuadrado ideal: según la odometría, que es lo que regula el robot, y la real, que solo conoce un observador.",
);
const REAL_WAY: Text = t(
    "The square by the odometry of both robots.",
    "El cuadrado según la odometría de ambos robots.",
);
const REAL_POSE: Text = t(
    "x, y and heading of both robots by their own odometry.",
    "x, y y orientación de ambos robots según su propia odometría.",
);
const LAP: Text = t(
    "time once round, each corner within 10 cm",
    "tiempo de una vuelta, cada vértice a menos de 10 cm",
);
const WORST: Text = t(
    "off the square by odometry, worst",
    "separación del cuadrado según la odometría, máxima",
);
const RMS: Text = t("the same, root mean square", "la misma, cuadrática media");

const CONTROL: Scheme = Scheme {
    input: t("goal (x*, y*)", "objetivo (x*, y*)"),
    row: &[
        (Part::Sum("+", "−", ""), same("")),
        (
            Part::Block(&[
                t("distance ρ,", "distancia ρ,"),
                t("bearing φ*", "ángulo φ*"),
            ]),
            same(""),
        ),
        (
            Part::Block(&[
                t("distance: v", "distancia: v"),
                t("heading: ω", "orientación: ω"),
            ]),
            same("v, ω"),
        ),
        (
            Part::Block(&[t("wheel", "velocidades"), t("speeds", "de rueda")]),
            same("ω*"),
        ),
        (
            Part::Block(&[t("speed", "lazos de"), t("loops", "velocidad")]),
            same("PWM"),
        ),
        (Part::Block(&[t("robot", "robot")]), same("")),
    ],
    paths: &[Path {
        from: 5,
        to: 0,
        block: &[t(
            "encoders, odometry: x, y, φ",
            "encoders y odometría: x, y, φ",
        )],
        level: 1,
    }],
    from_above: &[],
};

fn write(page: &mut Page, data: &Data) {
    parts::opening(page, data, "mode7", [WHAT, PARTS], "modes_5_to_7");
    parts::scheme(page, "mode7", SCHEME_WORDS, &CONTROL, SCHEME_CAPTION);
    page.section(ANALYSIS);
    let frames = geometry::frames(page.language, page.say(FRAMES));
    page.figure("mode7-frames", &frames, FRAMES);
    page.p(KINEMATICS);
    page.formula(KINEMATICS_FORMULA);
    page.p(ARC);
    page.formula(ARC_FORMULA);
    page.p(BEARING);
    page.formula(BEARING_FORMULA);
    let Some(outcome) = data.outcome("mode7") else {
        return;
    };
    page.section(RESULTS);
    let language = page.language;
    let panels = pose_panels(language, outcome);
    parts::timed(page, "mode7-pose", POSE, panels);
    let panels = panels::wheel_panels(language, outcome);
    parts::timed(page, "mode7-wheels", WHEELS, panels);
    let map = Map {
        curves: maps::ways(language, outcome, maps::route(outcome)),
        ..maps::map(language)
    };
    let svg = map.svg(language, page.say(WAY));
    page.figure("mode7-way", &svg, WAY);
    parts::limits(page, &[outcome]);
    beside(page, data);
}

/// x and y, and the heading.
pub(super) fn pose_panels(language: Language, outcome: &Outcome) -> Vec<Panel> {
    let [x, y, heading] = outcome.pose();
    vec![
        Panel::new(
            POSITION_AXIS.of(language),
            vec![
                Curve::new("x", Ink::First, x),
                Curve::new("y", Ink::Second, y),
            ],
        ),
        Panel::new(
            HEADING_AXIS.of(language),
            vec![Curve::new("", Ink::Third, heading)],
        )
        .exactly(-190.0, 190.0),
    ]
}

/// The corners of the square, from the start.
const SQUARE: [(f64, f64); 5] = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)];

fn beside(page: &mut Page, data: &Data) {
    let Some((ours, recording)) = data.beside("mode7") else {
        return;
    };
    beside::heading(page, &recording.file, false);
    let language = page.language;
    let real = |of: fn(&rumbo_wire::text::WaypointsRow) -> f32| {
        recording.signal(|row| match row {
            Row::Waypoints(row) => Some(f64::from(of(row))),
            _ => None,
        })
    };
    let [x, y, heading] = ours.pose();
    let started = |points: &Points| -> Points {
        points
            .iter()
            .copied()
            .filter(|(t_s, _)| *t_s >= 0.0)
            .collect()
    };
    let (mine, theirs) = (
        [started(&x), started(&y)],
        [real(|row| row.x_m), real(|row| row.y_m)],
    );
    let way =
        |[x, y]: &[Points; 2]| -> Points { x.iter().zip(y).map(|(x, y)| (x.1, y.1)).collect() };
    let mut curves = maps::ways(language, ours, SQUARE.to_vec());
    curves.truncate(1);
    curves.extend(beside::both(language, recording, way(&mine), way(&theirs)));
    let svg = Map {
        curves,
        ..maps::map(language)
    }
    .svg(language, page.say(REAL_WAY));
    page.figure("mode7-real-way", &svg, REAL_WAY);
    let panels = vec![
        Panel::new(
            "x (m)",
            beside::both(language, recording, mine[0].clone(), theirs[0].clone()),
        ),
        Panel::new(
            "y (m)",
            beside::both(language, recording, mine[1].clone(), theirs[1].clone()),
        ),
        Panel::new(
            page.say(HEADING_AXIS),
            beside::both(
                language,
                recording,
                started(&heading),
                unwrapped(real(|row| row.heading_deg)),
            ),
        )
        .exactly(-190.0, 190.0),
    ];
    parts::timed(page, "mode7-real", REAL_POSE, panels);
    let rows = [figures(&mine), figures(&theirs)];
    let row = |name: Text, index: usize, unit| {
        let shown = judge::plain(unit);
        let [ours, real] = [0, 1].map(|which| judge::value(language, &shown, rows[which][index]));
        (judge::capital(name.of(language)), ours, real)
    };
    beside::table(
        page,
        recording,
        &[row(LAP, 0, "s"), row(WORST, 1, "cm"), row(RMS, 2, "cm")],
    );
}

/// Time once round [s], and how far off the square until then, worst and root mean square [cm].
fn figures([x, y]: &[Points; 2]) -> [f64; 3] {
    let (mut corner, mut lap_s, mut off) = (1, f64::NAN, Points::new());
    let square = SQUARE.to_vec();
    for ((t_s, x), (_, y)) in x.iter().zip(y) {
        off.push((*t_s, CM * maps::off_route(&square, (*x, *y))));
        // A corner counts as the original counts it: within 10 cm.
        if (x - SQUARE[corner].0).hypot(y - SQUARE[corner].1) < 0.1 {
            if corner + 1 == SQUARE.len() {
                lap_s = *t_s;
                break;
            }
            corner += 1;
        }
    }
    let [rms, worst] = rms_and_worst(&off);
    [lap_s, worst, rms]
}
