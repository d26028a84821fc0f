//! Mode 2: stop square to a wall.

use super::beside;
use super::panels::Pair;
use super::parts::{self, ANALYSIS, DISTANCE, RESULTS};
use super::{Experiment, highlight};
use crate::data::Data;
use crate::drawing::geometry::{self, Wall};
use crate::drawing::scheme::{Part, Path, Scheme};
use crate::page::Page;
use crate::plot::{Curve, Ink, Panel};
use crate::signals::{CM, DEG, Outcome, Place, difference};
use crate::text::{Text, same, t};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode2",
    number: "2",
    title: t(
        "Mode 2: stop square to a wall",
        "Modo 2: parada perpendicular a una pared",
    ),
    scenarios: &["mode2"],
    highlights: &[
        highlight("mode2", "step1.settling_s", Some(3.4)),
        highlight("mode2", "step3.within_2cm_s", Some(5.5)),
        highlight("mode2", "step1.angle_rad", None),
    ],
    write,
};

const WHAT: Text = t(
    "A second sonar in front tells the angle to the wall, and the robot squares up to it while it goes to its distance. It starts 119 cm away and 20 \
     degrees askew, and is sent to 30, 50, 15 and 25 cm.",
    "Un segundo sensor delantero permite conocer el ángulo con la pared, y el robot se coloca perpendicular a ella mientras alcanza su distancia. Parte a \
     119 cm y girado 20 grados, y se le envía a 30, 50, 15 y 25 cm.",
);
const PARTS: Text = t(
    "The components of mode 1 and a second HC-SR04. Both sit in front, 12 cm apart, and ping in turn, 20 ms one after the other, so that neither hears \
     the other's echo.",
    "Los componentes del modo 1 y un segundo HC-SR04. Ambos van delante, separados 12 cm, y disparan por turnos, con 20 ms entre uno y otro, de modo que \
     ninguno oye el eco del otro.",
);
const SCHEME_WORDS: Text = t(
    "Two loops that do not disturb each other: the distance is counted from the middle of the wheels' axis, which a turn on the spot does not move. The distance loop \
     gives a forward speed as in mode 1, the angle loop a yaw rate, $\\omega = 3\\,\\theta$ per second; both wheels get their sum and their difference. Within \
     the tolerance of the distance what is left of the angle is turned on the spot.",
    "Dos lazos que no se perturban entre sí: la distancia se cuenta desde el punto medio del eje de las ruedas, que no se desplaza al girar sobre sí mismo. El lazo de \
     distancia da una velocidad de avance como en el modo 1 y el de orientación una velocidad de giro, $\\omega = 3\\,\\theta$ por segundo; las ruedas reciben su suma y su \
     diferencia. Dentro de la tolerancia de distancia, el ángulo restante se corrige girando sobre sí mismo.",
);
const SCHEME_CAPTION: Text = t(
    "Control scheme of mode 2: distance and angle, both from the same two sonars and the encoders.",
    "Esquema de control del modo 2: distancia y orientación, obtenidas de los mismos dos sensores y de los encoders.",
);
const GEOMETRY: Text = t(
    "Two sonars, δ apart, askew to the wall by θ: the right triangle with the sides δ and the difference of both readings.",
    "Dos sensores separados δ y girados θ respecto a la pared: triángulo rectángulo de catetos δ y la diferencia de ambas lecturas.",
);
const TRIANGLE: Text = t(
    "With thin beams the readings $d_1$ and $d_2$ and the gap $\\delta$ make a right triangle. The original has two cases:",
    "Con haces finos, las lecturas $d_1$ y $d_2$ y la separación $\\delta$ forman un triángulo rectángulo. El trabajo original distingue dos casos:",
);
const CASES: Text = t(
    r"\theta = \pm\left(\frac{\pi}{2} - \arcsin\frac{\delta}{\sqrt{\delta^2 + (d_2 - d_1)^2}}\right), \qquad d = \max(d_1, d_2)\cos\theta - \frac{\delta}{2}\sin|\theta|",
    r"\theta = \pm\left(\frac{\pi}{2} - \arcsen\frac{\delta}{\sqrt{\delta^2 + (d_2 - d_1)^2}}\right), \qquad d = \max(d_1, d_2)\cos\theta - \frac{\delta}{2}\sen|\theta|",
);
const ONE: Text = t(
    "with the sign of $d_2 - d_1$; for equal readings it keeps the distance of before. Both cases are one expression, good for equal readings too:",
    "con el signo de $d_2 - d_1$; para lecturas iguales conserva la distancia anterior. Ambos casos son una única expresión, válida también para lecturas iguales:",
);
const UNITED: Text =
    same(r"\theta = \arctan\frac{d_2 - d_1}{\delta}, \qquad d = \frac{d_1 + d_2}{2}\cos\theta");
const CONE: Text = t(
    "A real beam is a cone, 18 degrees to each side, and its first echo counts: as long as the wall's normal lies within it, a sonar reads the perpendicular distance \
     of its own place. The tangent becomes a sine, and the mean needs no cosine:",
    "Un haz real es un cono de 18 grados a cada lado y cuenta el primer eco: mientras la normal a la pared quede dentro del cono, el sensor lee la distancia \
     perpendicular desde su propia posición. La tangente se convierte en seno y la media no necesita coseno:",
);
const CONED: Text = t(
    r"\sin\theta = \frac{d_2 - d_1}{\delta}, \qquad d = \frac{d_1 + d_2}{2}",
    r"\sen\theta = \frac{d_2 - d_1}{\delta}, \qquad d = \frac{d_1 + d_2}{2}",
);
const FILTER: Text = t(
    "A Kalman filter with the two states distance and bearing of the wall takes each reading as it comes; the encoders move both states in between.",
    "Un filtro de Kalman con dos estados, distancia y orientación de la pared, incorpora cada lectura según llega; entre lecturas, los encoders desplazan ambos estados.",
);
const DISTANCES: Text = t(
    "Distances of both sonars with the reference, and PWM of both wheels, which differ where the angle is corrected.",
    "Distancias de ambos sensores con la referencia y PWM de ambas ruedas, que difieren donde se corrige la orientación.",
);
const ERROR: Text = t(
    "Difference between both distances and the reference: both are zero when the robot stands at its distance and square to the wall.",
    "Diferencia entre ambas distancias y la referencia: las dos son nulas cuando el robot está a su distancia y perpendicular a la pared.",
);
const ANGLE: Text = t(
    "Angle to the wall: what the formula above makes of the two readings of the moment, and the true one.",
    "Ángulo con la pared: el que da la fórmula anterior con las dos lecturas del momento y el real.",
);
const ANGLE_AXIS: Text = t("angle to the wall (°)", "ángulo con la pared (°)");
const BY_READINGS: Text = t("of the two readings", "según las dos lecturas");
const TRUE: Text = t("true", "real");

const CONTROL: Scheme = Scheme {
    input: t("reference", "referencia"),
    row: &[
        (Part::Sum("−", "+", ""), same("e")),
        (
            Part::Block(&[
                t("distance law", "ley de distancia"),
                t("(mode 1)", "(modo 1)"),
            ]),
            same("v"),
        ),
        (
            Part::Block(&[t("wheel speeds", "velocidades"), same("v ∓ b ω/2")]),
            same("ω*"),
        ),
        (
            Part::Block(&[
                t("speed loops", "lazos de velocidad"),
                t("(mode 5)", "(modo 5)"),
            ]),
            same("PWM"),
        ),
        (Part::Block(&[t("robot", "robot")]), t("d, θ", "d, θ")),
    ],
    paths: &[
        Path {
            from: 4,
            to: 2,
            block: &[t("ω = k θ, reference 0°", "ω = k θ, referencia 0°")],
            level: 1,
        },
        Path {
            from: 4,
            to: 0,
            block: &[t(
                "two HC-SR04, encoders: filter of the wall, d and θ",
                "dos HC-SR04 y encoders: filtro de la pared, d y θ",
            )],
            level: 2,
        },
    ],
    from_above: &[],
};

fn write(page: &mut Page, data: &Data) {
    parts::opening(page, data, "mode2", [WHAT, PARTS], "modes_2_to_4");
    parts::scheme(page, "mode2", SCHEME_WORDS, &CONTROL, SCHEME_CAPTION);
    page.section(ANALYSIS);
    let pair = geometry::pair(page.language, Wall::Ahead, page.say(GEOMETRY));
    page.figure("mode2-geometry", &pair, GEOMETRY);
    page.p(TRIANGLE);
    page.formula(CASES);
    page.p(ONE);
    page.formula(UNITED);
    page.p(CONE);
    page.formula(CONED);
    page.p(FILTER);
    let Some(outcome) = data.outcome("mode2") else {
        return;
    };
    page.section(RESULTS);
    let pair = Pair {
        captions: [DISTANCES, ERROR],
        reference: outcome.reference(CM),
        distances_cm: [15.0, 50.0],
        error_cm: 5.0,
    };
    pair.write(page, "mode2", outcome);
    let panel = angle_panel(page, outcome);
    parts::timed(page, "mode2-angle", ANGLE, vec![panel]);
    parts::limits(page, &[outcome]);
    beside::distance(page, data, "mode2", DISTANCE);
}

fn angle_panel(page: &Page, outcome: &Outcome) -> Panel {
    let gap_m = match (outcome.setup.rig.left, outcome.setup.rig.right) {
        (Some(left), Some(right)) => left.y_m - right.y_m,
        _ => return Panel::default(),
    };
    // The left one is nearer when the robot is turned to the right, a negative heading: the wall stands across x.
    let difference_cm = difference(
        &outcome.range_cm(Place::Left),
        &outcome.range_cm(Place::Right),
    );
    let angle = |(t_s, cm): (f64, f64)| (t_s, DEG * (cm / CM / gap_m).clamp(-1.0, 1.0).asin());
    let curves = vec![
        Curve::new(
            page.say(BY_READINGS),
            Ink::First,
            difference_cm.into_iter().map(angle).collect(),
        ),
        Curve::new(
            page.say(TRUE),
            Ink::True,
            outcome.truth(|sample| DEG * sample.heading_rad),
        ),
    ];
    Panel::new(page.say(ANGLE_AXIS), curves).exactly(-25.0, 35.0)
}
