//! Mode 6: straight on by the difference of distance travelled.

use super::beside;
use super::maps;
use super::mode5;
use super::panels;
use super::parts::{self, ANALYSIS, MEASURED, REFERENCE, RESULTS, SPEED};
use super::{Experiment, highlight};
use crate::data::Data;
use crate::drawing::scheme::{Part, Path, Scheme};
use crate::page::Page;
use crate::plot::{Curve, Ink, Map, Panel};
use crate::signals::{CM, DEG, Outcome, Place, RPM};
use crate::text::{Language, Text, same, t};
use rumbo_wire::text::Row;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode6",
    number: "6",
    title: t("Mode 6: straight on", "Modo 6: línea recta"),
    scenarios: &["mode6"],
    highlights: &[
        highlight("mode6", "after_3_m.sideways_m", None),
        highlight("mode6", "after_3_m.heading_rad", None),
    ],
    write,
};

const WHAT: Text = t(
    "Two wheels at the same speed do not make a straight line: one starts earlier, slips, or is a little larger. This mode drives straight on by regulating the \
     difference of the *ways* of both wheels. From rest the robot goes at 40 rpm for 23.5 s, a little more than 3 m.",
    "Dos ruedas a la misma velocidad no dan una línea recta: una arranca antes, desliza o es algo mayor. Este modo avanza en línea recta regulando la \
     diferencia de *recorridos* de ambas ruedas. Desde el reposo, el robot avanza a 40 rpm durante 23,5 s, algo más de 3 m.",
);
const PARTS: Text = t(
    "The components of mode 5: two Hall encoders are all that the mode needs. Before the run the robot measures the ratio of its wheels' radii by itself, along a wall; for \
     that it carries the sonars of the final build.",
    "Los componentes del modo 5: el modo solo necesita los dos encoders Hall. Antes de la prueba el robot mide por sí mismo la relación entre los radios de sus ruedas a lo largo de una pared; para \
     ello lleva los sensores del montaje final.",
);
const SCHEME_WORDS: Text = t(
    "What a regulator of the difference of *speeds* leaves, a regulator of the accumulated difference takes back: the difference of the ways is the heading times the base. A second, slower term \
     leads back to the line itself. What one wheel gets the other loses, so that the mean stays at the commanded speed.",
    "Lo que un regulador de la diferencia de *velocidades* deja sin corregir, lo recupera un regulador de la diferencia acumulada: la diferencia de recorridos es el producto de la orientación por la distancia entre ruedas. Un segundo término, más lento, \
     devuelve el robot a la propia recta. Lo que gana una rueda lo pierde la otra, de modo que la media se mantiene en la velocidad de referencia.",
);
const SCHEME_CAPTION: Text = t(
    "Control scheme of mode 6: the part on the left is new, the speed loops are those of mode 5.",
    "Esquema de control del modo 6: la parte izquierda es nueva, los lazos de velocidad son los del modo 5.",
);
const WAYS: Text = t(
    "The way of a wheel in a period, from its angular speed and its radius, and the difference $d$ of both ways, which is the base times the heading:",
    "El recorrido de una rueda en un periodo, a partir de su velocidad angular y su radio, y la diferencia $d$ de ambos recorridos, igual al producto de la distancia entre ruedas por la orientación:",
);
const WAYS_FORMULA: Text =
    same(r"v = \omega\,R, \qquad \Delta s = v\,\Delta t, \qquad d = s_R - s_L = b\,\varphi");
const LAW: Text = t(
    "With the offset $y$ from the line, $k_p$ = 4 1/s and $k_y$ = 2 rad/m:",
    "Con la separación $y$ respecto de la recta, $k_p$ = 4 1/s y $k_y$ = 2 rad/m:",
);
const LAW_FORMULA: Text =
    same(r"d^* = -b\,k_y\,y, \qquad \dot\varphi^* = \frac{k_p\,(d^* - d)}{b}");
const RADII: Text = t(
    "No encoder sees a wrong ratio of the radii: off by $\\varepsilon$ the robot drives an arc and takes it for a straight line. After a way $L$ it is",
    "Ningún encoder percibe una relación de radios errónea: con un error $\\varepsilon$ el robot describe un arco y lo toma por una recta. Tras un recorrido $L$ su desviación lateral y de orientación son",
);
const RADII_FORMULA: Text =
    same(r"\Delta y = \frac{\varepsilon L^2}{2b}, \qquad \Delta\varphi = \frac{\varepsilon L}{b}");
const RADII_END: Text = t(
    "off the line: 1 % over 3 m are 45 cm and 17 degrees. The calibration knows the ratio to 0.015 %.",
    "respectivamente: un 1 % en 3 m son 45 cm y 17 grados. La calibración conoce la relación con un error del 0,015 %.",
);
const SPEEDS: Text = t(
    "Speeds of both wheels during the run with the constant reference, and PWM of each.",
    "Velocidad de ambas ruedas durante la prueba con la referencia constante y PWM de cada una.",
);
const TRANSIENT: Text = t(
    "The first two seconds: both wheels gather speed along the same ramp.",
    "Transitorio inicial, dos primeros segundos: ambas ruedas aceleran siguiendo la misma rampa.",
);
const STEADY: Text = t(
    "Steady part: both speeds stay around the constant reference.",
    "Régimen permanente: ambas velocidades se mantienen en torno a la referencia constante.",
);
const VARIABLE: Text = t(
    "The variable reference of each wheel: the commanded speed and the small share that keeps the line. The wheels follow these, not the constant one.",
    "Referencia variable de cada rueda: la velocidad de referencia más el pequeño incremento que mantiene la recta. Las ruedas siguen estas referencias, no la constante.",
);
const VARIABLE_NAME: Text = t("variable reference", "referencia variable");
const CONSTANT_NAME: Text = t("constant reference", "referencia constante");
const LEFT_AXIS: Text = t("left wheel (rpm)", "rueda izquierda (rpm)");
const RIGHT_AXIS: Text = t("right wheel (rpm)", "rueda derecha (rpm)");
const DRIFT: Text = t(
    "The way driven from above: where odometry sees the robot and where it truly went. The scales of both axes are equal.",
    "El recorrido visto desde arriba: por dónde cree la odometría que va el robot y por dónde fue realmente. Ambos ejes tienen la misma escala.",
);
const DIFFERENCE: Text = t(
    "Difference of the ways of both wheels by odometry, right less left, and the true heading.",
    "Diferencia de recorridos de ambas ruedas según la odometría, derecha menos izquierda, y orientación real.",
);
const DIFFERENCE_AXIS: Text = t("difference (cm)", "diferencia (cm)");
const HEADING_AXIS: Text = t("true heading (°)", "orientación real (°)");
const REAL_CAPTION: Text = t(
    "Speeds of the left wheel: ours and the recorded run.",
    "Velocidad de la rueda izquierda: nuestro robot y el registro real.",
);

const CONTROL: Scheme = Scheme {
    input: same("d*"),
    row: &[
        (Part::Sum("+", "−", ""), same("")),
        (
            Part::Block(&[t("straight", "línea"), t("line: P", "recta: P")]),
            same("Δω"),
        ),
        (Part::Sum("±", "", "+"), same("ω*")),
        (
            Part::Block(&[
                t("speed loops", "lazos de velocidad"),
                t("(mode 5)", "(modo 5)"),
            ]),
            same("PWM"),
        ),
        (
            Part::Block(&[t("motors,", "motores,"), t("wheels", "ruedas")]),
            same(""),
        ),
        (Part::Block(&[t("robot", "robot")]), same("")),
    ],
    paths: &[Path {
        from: 5,
        to: 0,
        block: &[t(
            "encoders: difference of the ways, d = s_R − s_L",
            "encoders: diferencia de recorridos, d = s_R − s_L",
        )],
        level: 1,
    }],
    from_above: &[(2, t("commanded speed", "velocidad de referencia"))],
};

fn write(page: &mut Page, data: &Data) {
    parts::opening(page, data, "mode6", [WHAT, PARTS], "modes_5_to_7");
    parts::scheme(page, "mode6", SCHEME_WORDS, &CONTROL, SCHEME_CAPTION);
    page.section(ANALYSIS);
    page.p(WAYS);
    page.formula(WAYS_FORMULA);
    page.p(LAW);
    page.formula(LAW_FORMULA);
    page.p(RADII);
    page.formula(RADII_FORMULA);
    page.p(RADII_END);
    let Some(outcome) = data.outcome("mode6") else {
        return;
    };
    page.section(RESULTS);
    results(page, outcome);
    parts::limits(page, &[outcome]);
    beside(page, data);
}

fn results(page: &mut Page, outcome: &Outcome) {
    let language = page.language;
    let speeds = || mode5::speed_panel(language, outcome);
    let panels = vec![speeds(), panels::pwm_panel(language, outcome)];
    parts::timed(page, "mode6-speeds", SPEEDS, panels);
    parts::timed_within(
        page,
        "mode6-transient",
        TRANSIENT,
        vec![speeds()],
        Some([0.0, 2.0]),
    );
    let panel = speeds().at_least(38.0, 42.0);
    parts::timed_within(page, "mode6-steady", STEADY, vec![panel], Some([3.0, 23.0]));
    let panels = vec![
        variable(language, outcome, LEFT_AXIS, Ink::First, Place::Left),
        variable(language, outcome, RIGHT_AXIS, Ink::Second, Place::Right),
    ];
    parts::timed_within(page, "mode6-variable", VARIABLE, panels, Some([3.0, 23.0]));
    let base_cm = CM * outcome.setup.robot.plant.body.base_m;
    let [.., heading_deg] = outcome.pose();
    let ways = heading_deg
        .iter()
        .map(|(t_s, deg)| (*t_s, base_cm * deg / DEG))
        .collect();
    let panels = vec![
        Panel::new(
            page.say(DIFFERENCE_AXIS),
            vec![Curve::new("", Ink::First, ways)],
        )
        .at_least(-0.2, 0.2),
        Panel::new(
            page.say(HEADING_AXIS),
            vec![Curve::new(
                "",
                Ink::Third,
                outcome.truth(|sample| DEG * sample.heading_rad),
            )],
        )
        .at_least(-2.0, 2.0),
    ];
    parts::timed(page, "mode6-difference", DIFFERENCE, panels);
    let start = outcome.setup.scenario.start;
    let line = vec![(start.x_m, start.y_m), (start.x_m + 3.2, start.y_m)];
    let map = Map {
        curves: maps::ways(language, outcome, line),
        range: Some([[start.x_m - 0.1, start.x_m + 3.4], [-0.3, 0.3]]),
        ..maps::map(language)
    };
    let svg = map.svg(language, page.say(DRIFT));
    page.figure("mode6-way", &svg, DRIFT);
}

fn variable(language: Language, outcome: &Outcome, axis: Text, ink: Ink, wheel: Place) -> Panel {
    let curves = vec![
        Curve::new(MEASURED.of(language), ink, outcome.speed_rpm(wheel)),
        Curve::new(
            VARIABLE_NAME.of(language),
            Ink::Fourth,
            outcome.speed_reference_rpm(wheel),
        ),
        Curve::steps(
            CONSTANT_NAME.of(language),
            Ink::Reference,
            outcome.reference(RPM),
        ),
    ];
    Panel::new(axis.of(language), curves).at_least(38.0, 42.0)
}

fn beside(page: &mut Page, data: &Data) {
    let Some((ours, recording)) = data.beside("mode6") else {
        return;
    };
    beside::heading(page, &recording.file, true);
    let real = recording.signal(|row| match row {
        Row::Speed(row) => Some(f64::from(row.wheel_rpm.left)),
        _ => None,
    });
    let mut curves = vec![Curve::steps(
        page.say(REFERENCE),
        Ink::Reference,
        ours.reference(RPM),
    )];
    curves.extend(beside::both(
        page.language,
        recording,
        ours.speed_rpm(Place::Left),
        real,
    ));
    let panel = Panel::new(page.say(SPEED), curves);
    parts::timed(page, "mode6-real", REAL_CAPTION, vec![panel]);
}
