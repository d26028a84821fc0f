//! Basic movements, open loop: dead zones, static curves, asymmetry, and what becomes of straight lines and turns.

use super::manual_tables;
use super::maps;
use super::panels;
use super::parts::{
    self, ANALYSIS, COMPONENTS, DESCRIPTION, LEFT, LIMITS, PWM, RESULTS, RIGHT, SCHEME, SPEED,
};
use super::{Experiment, Highlight};
use crate::data::Data;
use crate::drawing::scheme::{Part, Scheme};
use crate::judge;
use crate::page::Page;
use crate::plot::{Curve, Ink, Map, Panel, Plot, Points};
use crate::signals::{Outcome, Place, RPM};
use crate::text::{Language, Text, same, t};

pub(super) const FLOOR: Text = t("on the floor, forward", "en el suelo, hacia delante");

const fn of(
    what: Text,
    scenario: &'static str,
    metric: &'static str,
    real: Option<f64>,
) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: Some(what),
        real,
    }
}

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "manual",
    number: "0",
    title: t(
        "Basic movements, open loop",
        "Movimientos básicos en lazo abierto",
    ),
    scenarios: &[
        "manual-curve-floor-forward",
        "manual-curve-floor-backward",
        "manual-curve-air-forward",
        "manual-curve-air-backward",
        "manual-deadzone-floor-forward",
        "manual-deadzone-floor-backward",
        "manual-deadzone-left-forward",
        "manual-deadzone-left-backward",
        "manual-deadzone-right-forward",
        "manual-deadzone-right-backward",
        "manual-asymmetry-forward",
        "manual-asymmetry-backward",
        "manual-straight",
        "manual-backward",
        "manual-turn-left",
        "manual-turn-right",
        "manual-pivot-left-forward",
        "manual-pivot-left-backward",
        "manual-pivot-right-forward",
        "manual-pivot-right-backward",
        "manual-arc-left",
        "manual-arc-right",
        "manual-arc-left-backward",
        "manual-arc-right-backward",
        "manual-straight-speed",
        "manual-backward-speed",
        "manual-turn-left-speed",
        "manual-turn-right-speed",
        "manual-arc-left-speed",
        "manual-arc-right-speed",
    ],
    highlights: &[
        of(
            FLOOR,
            "manual-deadzone-floor-forward",
            "left_dead_zone_duty",
            Some(65.0 / 255.0),
        ),
        of(
            FLOOR,
            "manual-deadzone-floor-forward",
            "right_dead_zone_duty",
            Some(65.0 / 255.0),
        ),
        of(
            t("in the air, forward", "en el aire, hacia delante"),
            "manual-deadzone-right-forward",
            "right_dead_zone_duty",
            Some(35.0 / 255.0),
        ),
    ],
    write,
};

const WHAT: Text = t(
    "The robot is moved without any feedback, to see that it is built right and what stands between a wish and a motion: forward and backward, turns about the centre, pivots about each wheel, \
     arcs. The same movements with the speed loops of mode 5 stand beside them.",
    "Se mueve el robot sin realimentación alguna, para comprobar que el montaje es correcto y qué se interpone entre la orden y el movimiento: avance y retroceso, giros sobre el centro, pivotes sobre cada rueda \
     y arcos. Junto a ellos, los mismos movimientos con los lazos de velocidad del modo 5.",
);
const FINDINGS: [Text; 4] = [
    t(
        "Both motors differ, and each differs between forward and backward.",
        "Los dos motores no son iguales, y cada uno se comporta distinto hacia delante y hacia atrás.",
    ),
    t(
        "Below a PWM nothing moves: about 35 with the wheels in the air, about 65 on the floor. It moves with the charge of the battery and with the floor.",
        "Por debajo de cierta PWM nada se mueve: unos 35 con las ruedas en el aire, unos 65 en el suelo. El umbral varía con la carga de la batería y con el suelo.",
    ),
    t(
        "Once turning, a wheel goes on at less PWM than it took to start it.",
        "Una vez en marcha, la rueda sigue girando con menos PWM de la que necesitó para arrancar.",
    ),
    t(
        "Floor, slip and friction bend every open-loop line.",
        "El suelo, el deslizamiento y el rozamiento curvan cualquier recta en lazo abierto.",
    ),
];
const PARTS: Text = t(
    "Mega, L298N, the two motors and the battery; sensors are not used. Rig and wiring are those of mode 1. Some tests hold the robot in the air.",
    "Mega, L298N, los dos motores y la batería; no se usan sensores. El montaje y el conexionado son los del modo 1. Algunos ensayos se hacen con el robot en el aire.",
);
const SCHEME_CAPTION: Text = t(
    "Open loop: the PWM of each wheel is given, and nothing comes back.",
    "Lazo abierto: se fija la PWM de cada rueda y no hay realimentación.",
);
const FACTORS: Text = t(
    "A movement is a factor for each wheel. Straight on both are equal, about the centre opposite, about a wheel that one's is zero. With the speeds $v_R$ and $v_L$ of the wheels on the floor, \
     the middle of the axis goes around a circle of radius",
    "Un movimiento es un factor por rueda: iguales en línea recta, opuestos al girar sobre el centro y nulo para la rueda sobre la que se pivota. Con las velocidades $v_R$ y $v_L$ de las ruedas sobre el suelo, \
     el punto medio del eje describe una circunferencia de radio",
);
const RADIUS: Text = same(r"r = \frac{b}{2}\,\frac{v_R + v_L}{v_R - v_L}");
const RADIUS_END: Text = t(
    "half the base in a pivot; one and a half times the base with the inner wheel at half the speed. Open loop the wheels do not keep their ratio, so the circle is another one.",
    "la mitad de la distancia entre ruedas en un pivote; vez y media esa distancia con la rueda interior a la mitad de velocidad. En lazo abierto las ruedas no conservan su relación, así que la circunferencia es otra.",
);
const DEAD: Text = t(
    "The dead zone: the mean current of a standing motor grows with the square of the duty $u$, since the current dies in every off-time. It moves when its torque exceeds the dry friction $T_c$, so",
    "La zona muerta: la corriente media de un motor parado crece con el cuadrado del ciclo de trabajo $u$, ya que la corriente se extingue en cada intervalo de apagado. Arranca cuando su par supera el rozamiento seco $T_c$, luego",
);
const DEAD_FORMULA: Text = same(r"u_0 \sim \sqrt{T_c}");
const CURVES: Text = t(
    "Static curves: speed of each wheel over the PWM, slowly up and down again, both directions, on the floor and in the air. Dashed: the thresholds that the original report gives.",
    "Características estáticas: velocidad de cada rueda en función de la PWM, subiendo y bajando lentamente, en ambos sentidos, en el suelo y en el aire. A trazos, los umbrales que da la memoria original.",
);
const DEAD_CAPTION: Text = t(
    "Dead zone on the floor, forward: the PWM grows slowly, and the wheels start when it overcomes friction.",
    "Zona muerta en el suelo, hacia delante: la PWM crece lentamente y las ruedas arrancan cuando esta vence el rozamiento.",
);
const ASYMMETRY: Text = t(
    "Asymmetry: speeds of both wheels at the same PWM, in the air, forward (above) and backward (below).",
    "Asimetría: velocidades de ambas ruedas con la misma PWM, en el aire, hacia delante (arriba) y hacia atrás (abajo).",
);
const OPEN_WAYS: Text = t(
    "Where the basic movements lead open loop, all from the origin, looking along x: true ways of the middle of the axis.",
    "Adónde llevan los movimientos básicos en lazo abierto, todos desde el origen y mirando según x: trayectorias reales del punto medio del eje.",
);
const SPEED_WAYS: Text = t(
    "The same with the speed of each wheel regulated: straight lines are straight, and the arcs are circles.",
    "Los mismos con la velocidad de cada rueda regulada: las rectas son rectas y los arcos, circunferencias.",
);
const FORWARD_AXIS: Text = t("forward (rpm)", "hacia delante (rpm)");
const BACKWARD_AXIS: Text = t("backward (rpm)", "hacia atrás (rpm)");
const LEFT_AXIS: Text = t("left wheel (rpm)", "rueda izquierda (rpm)");
const RIGHT_AXIS: Text = t("right wheel (rpm)", "rueda derecha (rpm)");
const ON_FLOOR: Text = t("on the floor", "en el suelo");
const IN_AIR: Text = t("in the air", "en el aire");
const THRESHOLDS: Text = t(
    "thresholds of the original report",
    "umbrales de la memoria original",
);
const STRAIGHT: Text = t("straight", "recta");
const ARCS: Text = t("arcs", "arcos");
const PIVOTS: Text = t("pivots", "pivotes");
const TURNS: Text = t("turns about the centre", "giros sobre el centro");

const CONTROL: Scheme = Scheme {
    input: same("PWM"),
    row: &[
        (Part::Block(&[same("L298N")]), same("U")),
        (
            Part::Block(&[
                t("gear motors", "motores"),
                t("with friction", "con rozamiento"),
            ]),
            same("ω"),
        ),
        (
            Part::Block(&[
                t("wheels,", "ruedas,"),
                t("floor, slip", "suelo, deslizamiento"),
            ]),
            t("motion", "movimiento"),
        ),
    ],
    paths: &[],
    from_above: &[],
};

fn write(page: &mut Page, data: &Data) {
    page.section(DESCRIPTION);
    page.p(WHAT);
    page.list(&FINDINGS);
    page.section(COMPONENTS);
    page.p(PARTS);
    page.section(SCHEME);
    let scheme = CONTROL.svg(page.language, page.say(SCHEME_CAPTION));
    page.figure("manual-scheme", &scheme, SCHEME_CAPTION);
    page.section(ANALYSIS);
    page.p(FACTORS);
    page.formula(RADIUS);
    page.p(RADIUS_END);
    page.p(DEAD);
    page.formula(DEAD_FORMULA);
    page.section(RESULTS);
    let curves = curves(page.language, data);
    page.figure("manual-curves", &curves, CURVES);
    manual_tables::starts(page, data);
    dead_zone(page, data);
    asymmetry(page, data);
    let open = ways(page.language, data, "", page.say(OPEN_WAYS));
    page.figure("manual-ways", &open, OPEN_WAYS);
    let regulated = ways(page.language, data, "-speed", page.say(SPEED_WAYS));
    page.figure("manual-ways-speed", &regulated, SPEED_WAYS);
    manual_tables::movements(page, data);
    page.section(LIMITS);
    judge::limits_together(page, &data.of(&EXPERIMENT));
}

/// Speed over PWM of both wheels.
fn curves(language: Language, data: &Data) -> String {
    let panel = |axis: Text, wheel: Place| {
        let mut curves: Vec<Curve> = [35.0, -35.0, 65.0, -65.0]
            .map(|pwm| {
                Curve::new(
                    THRESHOLDS.of(language),
                    Ink::Reference,
                    vec![(pwm, -200.0), (pwm, 200.0)],
                )
            })
            .into();
        for (name, ink, scenario) in [
            (ON_FLOOR, Ink::First, "manual-curve-floor"),
            (IN_AIR, Ink::Third, "manual-curve-air"),
        ] {
            for way in ["forward", "backward"] {
                if let Some(outcome) = data.outcome(&format!("{scenario}-{way}")) {
                    let samples = outcome.result.trace.samples.iter();
                    let points = samples.map(|sample| {
                        (
                            f64::from(sample.duty[wheel as usize]),
                            RPM * sample.wheel_rad_s[wheel as usize],
                        )
                    });
                    curves.push(Curve::new(name.of(language), ink, points.collect()));
                }
            }
        }
        Panel::new(axis.of(language), curves).exactly(-150.0, 150.0)
    };
    let panels = vec![
        panel(LEFT_AXIS, Place::Left),
        panel(RIGHT_AXIS, Place::Right),
    ];
    Plot {
        x: PWM.of(language).to_owned(),
        x_range: Some([-130.0, 130.0]),
        panels,
    }
    .svg(language, CURVES.of(language))
}

fn dead_zone(page: &mut Page, data: &Data) {
    let Some(outcome) = data.outcome("manual-deadzone-floor-forward") else {
        return;
    };
    let panels = vec![
        speeds(page.language, outcome, SPEED),
        panels::pwm_panel(page.language, outcome),
    ];
    parts::timed(page, "manual-deadzone", DEAD_CAPTION, panels);
}

fn asymmetry(page: &mut Page, data: &Data) {
    let Some((forward, backward)) = data
        .outcome("manual-asymmetry-forward")
        .zip(data.outcome("manual-asymmetry-backward"))
    else {
        return;
    };
    let panels = vec![
        speeds(page.language, forward, FORWARD_AXIS),
        speeds(page.language, backward, BACKWARD_AXIS),
    ];
    parts::timed(page, "manual-asymmetry", ASYMMETRY, panels);
}

/// True speeds of both wheels.
fn speeds(language: Language, outcome: &Outcome, axis: Text) -> Panel {
    let curve = |name: Text, ink, wheel: Place| {
        Curve::new(
            name.of(language),
            ink,
            outcome.truth(|sample| RPM * sample.wheel_rad_s[wheel as usize]),
        )
    };
    Panel::new(
        axis.of(language),
        vec![
            curve(LEFT, Ink::First, Place::Left),
            curve(RIGHT, Ink::Second, Place::Right),
        ],
    )
}

const WAYS: [(&str, Text, Ink); 12] = [
    ("manual-straight", STRAIGHT, Ink::First),
    ("manual-backward", STRAIGHT, Ink::First),
    ("manual-arc-left", ARCS, Ink::Second),
    ("manual-arc-right", ARCS, Ink::Second),
    ("manual-arc-left-backward", ARCS, Ink::Second),
    ("manual-arc-right-backward", ARCS, Ink::Second),
    ("manual-pivot-left-forward", PIVOTS, Ink::Third),
    ("manual-pivot-left-backward", PIVOTS, Ink::Third),
    ("manual-pivot-right-forward", PIVOTS, Ink::Third),
    ("manual-pivot-right-backward", PIVOTS, Ink::Third),
    ("manual-turn-left", TURNS, Ink::Fourth),
    ("manual-turn-right", TURNS, Ink::Fourth),
];

/// The ways of all movements, each from its own start.
fn ways(language: Language, data: &Data, suffix: &str, description: &str) -> String {
    let curve = |(scenario, name, ink): &(&str, Text, Ink)| {
        let outcome = data.outcome(&format!("{scenario}{suffix}"))?;
        let start = outcome.setup.scenario.start;
        let (sin, cos) = start.heading_rad.sin_cos();
        let seen = |(x, y): (f64, f64)| {
            let (x, y) = (x - start.x_m, y - start.y_m);
            (cos * x + sin * y, cos * y - sin * x)
        };
        let points: Points = outcome.way().into_iter().map(seen).collect();
        Some(Curve::new(name.of(language), *ink, points))
    };
    Map {
        curves: WAYS.iter().filter_map(curve).collect(),
        ..maps::map(language)
    }
    .svg(language, description)
}
