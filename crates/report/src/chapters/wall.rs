//! Modes 3 and 4: along a wall, at the distance of the start or at a commanded one.

use super::beside;
use super::panels::{self, Pair};
use super::parts::{self, ANALYSIS, DISTANCE, ERROR_CM, RESULTS};
use super::{Experiment, highlight};
use crate::data::Data;
use crate::drawing::geometry::{self, Wall};
use crate::drawing::scheme::{Part, Path, Scheme};
use crate::judge;
use crate::page::Page;
use crate::plot::{Curve, Ink, Panel, Points};
use crate::respond::rms_and_worst;
use crate::signals::{CM, Outcome, Place, between, difference};
use crate::text::{Text, same, t};

pub(super) const MODE3: Experiment = Experiment {
    name: "mode3",
    number: "3",
    title: t(
        "Mode 3: along a wall at the distance of the start",
        "Modo 3: avance paralelo a una pared a la distancia inicial",
    ),
    scenarios: &["mode3"],
    highlights: &[
        highlight("mode3", "distance_rms_m", Some(0.012)),
        highlight("mode3", "distance_worst_m", Some(0.046)),
    ],
    write: write_mode3,
};

pub(super) const MODE4: Experiment = Experiment {
    name: "mode4",
    number: "4",
    title: t(
        "Mode 4: along a wall at a commanded distance",
        "Modo 4: avance paralelo a una pared a la distancia de referencia",
    ),
    scenarios: &["mode4"],
    highlights: &[
        highlight("mode4", "step1.within_2cm_s", Some(7.1)),
        highlight("mode4", "step2.within_2cm_s", Some(6.3)),
        highlight("mode4", "step3.within_2cm_s", Some(9.0)),
    ],
    write: write_mode4,
};

const WHAT3: Text = t(
    "The robot drives along a wall and keeps the distance at which it stood when it was armed, 57.5 cm here, for 27 s.",
    "El robot avanza a lo largo de una pared manteniendo la distancia a la que se encontraba al armarlo, 57,5 cm en este caso, durante 27 s.",
);
const PARTS3: Text = t(
    "The components of mode 2 with the same wiring; only the two sonars have moved to one side, 14 cm apart, one behind the other.",
    "Los componentes del modo 2 con el mismo conexionado; solo cambian de sitio los dos sensores, que pasan a un lateral, separados 14 cm, uno detrás del otro.",
);
const SCHEME3: Text = t(
    "A cascade, master and slave. The outer loop makes an angle of the distance error: too far from the wall, drive towards it. The inner loop makes a yaw rate of the \
     error of that angle. The angle is limited to 24 degrees, so that the beams still meet the wall; where it is limited the integral stands still.",
    "Una cascada maestro-esclavo. El lazo externo convierte el error de distancia en un ángulo: si el robot está demasiado lejos de la pared, avanza hacia ella. El lazo interno convierte el \
     error de ese ángulo en una velocidad de giro. El ángulo se limita a 24 grados para que los haces sigan alcanzando la pared; mientras está limitado, el término integral se detiene.",
);
const SCHEME3_CAPTION: Text = t(
    "Control scheme of mode 3: the reference is the median of the first readings.",
    "Esquema de control del modo 3: la referencia es la mediana de las primeras lecturas.",
);
const GEOMETRY: Text = t(
    "The same triangle as in mode 2, with the wall beside the robot: δ between the sonars, angle θ, distance d of their middle.",
    "El mismo triángulo del modo 2 con la pared en el lateral: δ entre sensores, ángulo θ y distancia d de su punto medio.",
);
const SAME: Text = t(
    "Angle and distance come from the two readings as in mode 2. With the speed $v$, the distance changes as the robot drives at the angle $\\alpha$ towards the wall:",
    "El ángulo y la distancia se obtienen de las dos lecturas como en el modo 2. Con la velocidad $v$, la distancia cambia según el robot avanza con un ángulo $\\alpha$ hacia la pared:",
);
const KINEMATICS: Text = t(
    r"\dot d = -v\sin\alpha, \qquad \alpha^* = \frac{k_p\,(d - d^*)}{v} + k_i\int(d - d^*)\,dt, \qquad \omega = k\,(\alpha^* - \alpha)",
    r"\dot d = -v\sen\alpha, \qquad \alpha^* = \frac{k_p\,(d - d^*)}{v} + k_i\int(d - d^*)\,dt, \qquad \omega = k\,(\alpha^* - \alpha)",
);
const POLES: Text = t(
    "With $v$ = 0.16 m/s, $k_p$ = 1.6 1/s, $k$ = 5 1/s the linear loop has the poles −2.2 and −2.8 1/s: no overshoot. The division by $v$ makes it equally fast at any speed.",
    "Con $v$ = 0,16 m/s, $k_p$ = 1,6 1/s y $k$ = 5 1/s el lazo lineal tiene los polos −2,2 y −2,8 1/s: sin sobreoscilación. La división por $v$ lo hace igual de rápido a cualquier velocidad.",
);
const DISTANCES3: Text = t(
    "Distances of both sonars beside the distance of the start, and PWM of both wheels.",
    "Distancias de ambos sensores junto a la distancia inicial y PWM de ambas ruedas.",
);
const ERROR3: Text = t(
    "Error over time: both distances less the distance of the start. Floor and slip disturb the robot all the way, so it does not come to rest at zero.",
    "Evolución del error: ambas distancias menos la inicial. El suelo y el deslizamiento perturban al robot durante todo el recorrido, por lo que el error no se queda en cero.",
);
const WHAT4: Text = t(
    "As mode 3, with a distance that is commanded and changes on the way: from 59 cm to 50, then 30, then 40 cm.",
    "Como el modo 3, con una distancia que se ordena y cambia durante el recorrido: de 59 cm a 50, después a 30 y por último a 40 cm.",
);
const PARTS4: Text = t(
    "Rig and wiring are those of mode 3.",
    "El montaje y el conexionado son los del modo 3.",
);
const SCHEME4: Text = t(
    "The scheme of mode 3; only the reference now varies. A step of 20 cm is driven at the limit of the angle, and then the error decays with the time constant $1/k_p$ = 0.6 s.",
    "El esquema del modo 3; solo que ahora la referencia es variable. Un escalón de 20 cm se recorre con el ángulo límite y después el error decae con la constante de tiempo $1/k_p$ = 0,6 s.",
);
const SCHEME4_CAPTION: Text = t(
    "Control scheme of mode 4: the reference is commanded.",
    "Esquema de control del modo 4: la referencia es variable.",
);
const ANALYSIS4: Text = t(
    "The same as in modes 2 and 3. At the limit of 24 degrees the distance changes by",
    "Los mismos que en los modos 2 y 3. Con el ángulo límite de 24 grados la distancia cambia",
);
const RATE: Text = t(
    r"|\dot d| = v\sin 24^\circ = 6.5\ \mathrm{cm/s}",
    r"|\dot d| = v\sen 24^\circ = 6{,}5\ \mathrm{cm/s}",
);
const DISTANCES4: Text = t(
    "Distances of both sonars with the reference, and PWM of both wheels. On the way to another distance the sonars differ by the angle.",
    "Distancias de ambos sensores con la referencia y PWM de ambas ruedas. En las transiciones las lecturas difieren por el ángulo.",
);
const ERROR4: Text = t(
    "Errors: the difference of each distance from the reference. Both at zero: at the distance, and parallel to the wall.",
    "Errores: diferencia de cada distancia con la referencia. Ambos nulos: a la distancia de referencia y paralelo a la pared.",
);
const DIFFERENCE: Text = t(
    "Difference of the distances, first less second: a measure of the angle to the wall, negative on the way towards it.",
    "Diferencia entre las distancias, primera menos segunda: una medida del ángulo con la pared, negativa al acercarse a ella.",
);
const DIFFERENCE_AXIS: Text = t("difference (cm)", "diferencia (cm)");

const ROW: &[(Part, Text)] = &[
    (Part::Sum("−", "+", ""), t("d err.", "err. d")),
    (
        Part::Block(&[t("distance:", "distancia:"), t("PI, ±24°", "PI, ±24°")]),
        same("α*"),
    ),
    (Part::Sum("+", "−", ""), same("")),
    (Part::Block(&[t("angle:", "ángulo:"), same("k")]), same("ω")),
    (
        Part::Block(&[t("wheel", "velocidades"), t("speeds", "de rueda")]),
        same("ω*"),
    ),
    (
        Part::Block(&[t("speed", "lazos de"), t("loops", "velocidad")]),
        same("PWM"),
    ),
    (Part::Block(&[t("robot", "robot")]), t("d, α", "d, α")),
];
const PATHS: &[Path] = &[
    Path {
        from: 6,
        to: 2,
        block: &[t("angle α", "ángulo α")],
        level: 1,
    },
    Path {
        from: 6,
        to: 0,
        block: &[t(
            "two HC-SR04, encoders: filter of the wall",
            "dos HC-SR04 y encoders: filtro de la pared",
        )],
        level: 2,
    },
];
const CRUISE: &[(usize, Text)] = &[];
const CONTROL3: Scheme = Scheme {
    input: t("distance at start", "distancia inicial"),
    row: ROW,
    paths: PATHS,
    from_above: CRUISE,
};
const CONTROL4: Scheme = Scheme {
    input: t("commanded d*", "referencia d*"),
    row: ROW,
    paths: PATHS,
    from_above: CRUISE,
};

fn write_mode3(page: &mut Page, data: &Data) {
    parts::opening(page, data, "mode3", [WHAT3, PARTS3], "modes_2_to_4");
    parts::scheme(page, "mode3", SCHEME3, &CONTROL3, SCHEME3_CAPTION);
    page.section(ANALYSIS);
    let pair = geometry::pair(page.language, Wall::Beside, page.say(GEOMETRY));
    page.figure("mode3-geometry", &pair, GEOMETRY);
    page.p(SAME);
    page.formula(KINEMATICS);
    page.p(POLES);
    let Some(outcome) = data.outcome("mode3") else {
        return;
    };
    page.section(RESULTS);
    let pair = Pair {
        captions: [DISTANCES3, ERROR3],
        reference: held(outcome),
        distances_cm: [50.0, 65.0],
        error_cm: 1.0,
    };
    pair.write(page, "mode3", outcome);
    parts::limits(page, &[outcome]);
    beside(page, data);
}

fn write_mode4(page: &mut Page, data: &Data) {
    parts::opening(page, data, "mode4", [WHAT4, PARTS4], "modes_2_to_4");
    parts::scheme(page, "mode4", SCHEME4, &CONTROL4, SCHEME4_CAPTION);
    page.section(ANALYSIS);
    page.p(ANALYSIS4);
    page.formula(RATE);
    let Some(outcome) = data.outcome("mode4") else {
        return;
    };
    page.section(RESULTS);
    let pair = Pair {
        captions: [DISTANCES4, ERROR4],
        reference: outcome.reference(CM),
        distances_cm: [30.0, 50.0],
        error_cm: 5.0,
    };
    pair.write(page, "mode4", outcome);
    let between = difference(
        &outcome.range_cm(Place::Left),
        &outcome.range_cm(Place::Right),
    );
    let panel = Panel::new(
        page.say(DIFFERENCE_AXIS),
        vec![Curve::new("", Ink::First, between)],
    )
    .at_least(-5.0, 5.0);
    parts::timed(page, "mode4-difference", DIFFERENCE, vec![panel]);
    parts::limits(page, &[outcome]);
    beside::distance(page, data, "mode4", DISTANCE);
}

/// The distance that mode 3 holds: what both sonars read while the robot still stood.
fn held(outcome: &Outcome) -> Points {
    let mean = panels::mean_cm(outcome);
    let standing = between(&mean, -0.5, 0.3);
    let values: Vec<f64> = standing
        .iter()
        .map(|(_, value)| *value)
        .filter(|value| value.is_finite())
        .collect();
    let distance_cm = values.iter().sum::<f64>() / values.len().max(1) as f64;
    vec![(0.0, distance_cm), (outcome.duration_s(), distance_cm)]
}

const REAL: Text = t(
    "Error of the distance (mean of both sonars less the distance of the start): ours and the recorded run.",
    "Error de distancia (media de ambos sensores menos la distancia inicial): nuestro robot y el registro real.",
);
const RMS: Text = t(
    "distance error, root mean square",
    "error de distancia, cuadrático medio",
);
const WORST: Text = t("distance error, worst", "error de distancia, máximo");

fn beside(page: &mut Page, data: &Data) {
    let Some((ours, recording)) = data.beside("mode3") else {
        return;
    };
    beside::heading(page, &recording.file, false);
    let language = page.language;
    let mine = difference(&panels::mean_cm(ours), &held(ours));
    let mine = between(&mine, 0.0, f64::INFINITY);
    let references: Points = recording
        .references()
        .iter()
        .map(|(t_s, m)| (*t_s, CM * m))
        .collect();
    let real = difference(&beside::recorded_mean_cm(recording), &references);
    let panel = Panel::new(
        page.say(ERROR_CM),
        beside::both(language, recording, mine.clone(), real.clone()),
    )
    .at_least(-5.0, 5.0);
    parts::timed(page, "mode3-real", REAL, vec![panel]);
    let cm = judge::plain("cm");
    let rows: Vec<_> = [RMS, WORST]
        .into_iter()
        .zip(rms_and_worst(&mine).into_iter().zip(rms_and_worst(&real)))
        .map(|(name, (ours, real))| {
            (
                judge::capital(page.say(name)),
                judge::value(language, &cm, ours),
                judge::value(language, &cm, real),
            )
        })
        .collect();
    beside::table(page, recording, &rows);
}
