//! Mode 1: stop at a distance from a wall.

use super::beside;
use super::panels;
use super::parts::{
    self, ANALYSIS, COMPONENTS, DESCRIPTION, DISTANCE, ERROR_CM, MEASURED, REFERENCE, RESULTS,
};
use super::{Experiment, highlight};
use crate::data::Data;
use crate::drawing::geometry;
use crate::drawing::scheme::{Part, Path, Scheme};
use crate::page::Page;
use crate::plot::{Curve, Ink, Panel, Plot};
use crate::signals::{CM, Outcome, Place, difference};
use crate::text::{Language, Text, same, t};

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode1",
    number: "1",
    title: t(
        "Mode 1: stop at a distance from a wall",
        "Modo 1: parada a una distancia de una pared",
    ),
    scenarios: &["mode1"],
    highlights: &[
        highlight("mode1", "step1.settling_s", Some(3.0)),
        highlight("mode1", "step1.overshoot_m", Some(0.006)),
        highlight("mode1", "step2.settling_s", Some(1.2)),
    ],
    write,
};

const WHAT: Text = t(
    "The robot stops in front of a wall at the distance that it is given, and goes to another distance when told. One sonar that looks ahead \
     is all that it measures the wall with. It starts 107 cm away, is sent to 30 cm, and then back to 50 cm.",
    "El robot se detiene frente a una pared a la distancia que se le indica y pasa a otra distancia cuando se le ordena. Para medir la pared \
     dispone únicamente de un sensor de ultrasonidos que mira hacia delante. Parte a 107 cm, se le envía a 30 cm y después retrocede hasta \
     50 cm.",
);
/// With the robot's own `{radius}` and `{base}`.
const PARTS: [Text; 6] = [
    t(
        "Arduino Mega 2560 (ATmega2560, 16 MHz): runs the program; its pins read the sensors and drive the bridge.",
        "Arduino Mega 2560 (ATmega2560, 16 MHz): ejecuta el programa; sus pines leen los sensores y gobiernan el puente en H.",
    ),
    t(
        "HC-SR04: sends a burst of ultrasound and holds its echo line high until the echo is back.",
        "HC-SR04: emite una ráfaga de ultrasonidos y mantiene a nivel alto su línea de eco hasta que el eco regresa.",
    ),
    t(
        "L298N: two H-bridges. IN1 to IN4 choose the directions, the PWM at ENA and ENB (0 to 255) how much; with both inputs low a motor is released.",
        "L298N: doble puente en H. IN1 a IN4 eligen los sentidos de giro y la PWM en ENA y ENB (0 a 255), la intensidad; con ambas entradas a \
         nivel bajo el motor queda libre.",
    ),
    t(
        "Two DC gear motors, 48:1, with wheels of {radius} cm radius, {base} cm apart.",
        "Dos motores de corriente continua con reductora 48:1 y ruedas de {radius} cm de radio, separadas {base} cm.",
    ),
    t(
        "Bluetooth module HC-05 on a serial port at 9600 baud: at most 960 bytes per second for commands and telemetry.",
        "Módulo Bluetooth HC-05 en un puerto serie a 9600 baudios: como máximo 960 bytes por segundo para órdenes y telemetría.",
    ),
    t(
        "Li-ion battery, two cells, 7.2 V, 2600 mAh.",
        "Batería de ion de litio de dos celdas, 7,2 V y 2600 mAh.",
    ),
];
const TIMING: Text = t(
    "The HC-SR04's lines: a pulse of 10 µs on TRIG starts the burst; ECHO is high for as long as the sound is on its way.",
    "Líneas del HC-SR04: un pulso de 10 µs en TRIG inicia la ráfaga; ECHO permanece a nivel alto mientras el sonido está en camino.",
);
const SCHEME_WORDS: Text = t(
    "The error of the distance becomes a speed, the speed becomes wheel speeds, and each wheel has a speed loop of its own. The loops inside hide \
     the dead zone of the motors, the floor and the battery from the loop outside. Between two readings of the sonar, 60 ms apart, the \
     distance goes on with the encoders, so that the error is never late. The heading of the start is kept by odometry.",
    "El error de distancia se convierte en una velocidad, esta en velocidades de rueda, y cada rueda tiene su propio lazo de velocidad. Los \
     lazos internos ocultan al externo la zona muerta de los motores, el suelo y la batería. Entre dos lecturas del sensor, separadas 60 ms, la distancia \
     se actualiza con los encoders, de modo que el error nunca llega tarde. La orientación inicial se mantiene mediante odometría.",
);
const SCHEME_CAPTION: Text = t(
    "Control scheme of mode 1. The wheel-speed loops are those of mode 5.",
    "Esquema de control del modo 1. Los lazos de velocidad de las ruedas son los del modo 5.",
);
const LAW_WORDS: Text = t(
    "Like the original, the controller has a far and a near part. Far away the speed is the one from which a planned deceleration $a$ ends exactly \
     at the reference; near it, where that root grows steep, a proportional law takes over. With the error $e$ = distance − reference, \
     positive when the robot is too far away:",
    "Como en el trabajo original, el controlador tiene un tramo lejano y otro cercano. Lejos, la velocidad es aquella desde la que una deceleración \
     planificada $a$ termina exactamente en la referencia; cerca, donde esa raíz se hace muy empinada, actúa una ley proporcional. Con el error \
     $e$ = distancia − referencia, positivo cuando el robot está demasiado lejos:",
);
const LAW: Text = same(r"|v| = \min\left(v_{\max},\ \sqrt{2\,a\,|e|},\ k\,|e|\right)");
const LAW_NUMBERS: Text = t(
    "$v_{\\max}$ = 0.5 m/s, $a$ = 0.36 m/s², $k$ = 5 1/s. Both laws meet at $e = 2a/k^2$ = 2.9 cm. Within 1.5 mm the wheels are released.",
    "$v_{\\max}$ = 0,5 m/s, $a$ = 0,36 m/s², $k$ = 5 1/s. Ambas leyes se encuentran en $e = 2a/k^2$ = 2,9 cm. A menos de 1,5 mm las ruedas se \
     liberan.",
);
const LAW_CAPTION: Text = t(
    "The controller: speed over error. Far from the reference the root, near it the straight line.",
    "El controlador: velocidad en función del error. Lejos de la referencia, la raíz; cerca, la recta.",
);
const LAW_X: Text = t(
    "error: distance − reference (cm)",
    "error: distancia − referencia (cm)",
);
const LAW_Y: Text = t("speed (m/s)", "velocidad (m/s)");
const FAR: Text = t(
    "far: planned deceleration",
    "lejano: deceleración planificada",
);
const NEAR: Text = t("near: proportional", "cercano: proporcional");
const IN_FORCE: Text = t("in force", "aplicada");
const SOUND_WORDS: Text = t(
    "The echo line is high for the time $\\Delta t$ that the sound takes to the wall and back:",
    "La línea de eco permanece a nivel alto durante el tiempo $\\Delta t$ que el sonido tarda en ir a la pared y volver:",
);
const SOUND: Text = t(
    r"d = \frac{c\,\Delta t}{2}, \qquad c = 331.3\ \mathrm{m/s} + 0.606\ \mathrm{\frac{m}{s\,K}}\;T",
    r"d = \frac{c\,\Delta t}{2}, \qquad c = 331{,}3\ \mathrm{m/s} + 0{,}606\ \mathrm{\frac{m}{s\,K}}\;T",
);
const SOUND_NUMBERS: Text = t(
    "with the temperature $T$ in degrees Celsius. At 20 °C $c$ = 343.4 m/s and a centimetre of distance takes 58 µs. Ten degrees more are 1.8 % of \
     every distance, which no sensor of the robot can tell.",
    "con la temperatura $T$ en grados Celsius. A 20 °C $c$ = 343,4 m/s y cada centímetro de distancia supone 58 µs. Diez grados más \
     equivalen a un 1,8 % de cualquier distancia, algo que ningún sensor del robot puede detectar.",
);
const DISTANCES: Text = t(
    "Distance to the wall with its reference, and PWM of both wheels.",
    "Distancia a la pared con su referencia y PWM de ambas ruedas.",
);
const ERROR: Text = t(
    "Error of the distance over time: measured distance less reference.",
    "Evolución del error de distancia: distancia medida menos referencia.",
);
const CONTROL: Scheme = Scheme {
    input: t("reference", "referencia"),
    row: &[
        (Part::Sum("−", "+", ""), same("e")),
        (
            Part::Block(&[t("law", "ley"), t("far / near", "lejano/cercano")]),
            same("v"),
        ),
        (
            Part::Block(&[
                t("wheel speeds", "velocidades"),
                t("v ∓ b ω/2", "v ∓ b ω/2"),
            ]),
            same("ω*"),
        ),
        (
            Part::Block(&[
                t("speed loops", "lazos de velocidad"),
                t("(mode 5)", "(modo 5)"),
            ]),
            same("PWM"),
        ),
        (
            Part::Block(&[t("L298N,", "L298N,"), t("motors", "motores")]),
            same(""),
        ),
        (Part::Block(&[t("robot", "robot")]), same("d")),
    ],
    paths: &[
        Path {
            from: 5,
            to: 0,
            block: &[t(
                "HC-SR04 and range filter; encoders between two readings",
                "HC-SR04 y filtro; encoders entre dos lecturas",
            )],
            level: 2,
        },
        Path {
            from: 5,
            to: 2,
            block: &[t(
                "odometry: keeps the heading (ω)",
                "odometría: mantiene la orientación (ω)",
            )],
            level: 1,
        },
    ],
    from_above: &[],
};

/// The components, with the geometry of the robot that ran.
fn parts_of(language: Language, data: &Data) -> Vec<String> {
    let plant = data.outcome("mode1").map(|ran| ran.setup.robot.plant);
    let plant = plant.unwrap_or_default();
    let radius = language.short(CM * plant.wheels.left.radius_m, 2);
    let base = language.short(CM * plant.body.base_m, 1);
    let said = PARTS.iter().map(|part| part.of(language));
    said.map(|text| text.replace("{radius}", &radius).replace("{base}", &base))
        .collect()
}

fn write(page: &mut Page, data: &Data) {
    page.section(DESCRIPTION);
    page.p(WHAT);
    page.section(COMPONENTS);
    page.list_of(parts_of(page.language, data));
    parts::rig_figure(page, data, "mode1", "mode1");
    parts::wiring_figure(page, data, "mode1", "mode1", "mode_1");
    let timing = geometry::sonar_timing(page.language, page.say(TIMING));
    page.figure("sonar-timing", &timing, TIMING);
    parts::scheme(page, "mode1", SCHEME_WORDS, &CONTROL, SCHEME_CAPTION);
    page.p(LAW_WORDS);
    page.formula(LAW);
    page.p(LAW_NUMBERS);
    let law = law(page.language);
    page.figure("mode1-law", &law, LAW_CAPTION);
    page.section(ANALYSIS);
    page.p(SOUND_WORDS);
    page.formula(SOUND);
    page.p(SOUND_NUMBERS);
    let Some(outcome) = data.outcome("mode1") else {
        return;
    };
    page.section(RESULTS);
    let panels = vec![
        distance_panel(page.language, outcome),
        panels::pwm_panel(page.language, outcome),
    ];
    parts::timed(page, "mode1-distances", DISTANCES, panels);
    let error = difference(&outcome.range_cm(Place::Front), &outcome.reference(CM));
    let panel =
        Panel::new(page.say(ERROR_CM), vec![Curve::new("", Ink::First, error)]).at_least(-5.0, 5.0);
    parts::timed(page, "mode1-error", ERROR, vec![panel]);
    parts::limits(page, &[outcome]);
    beside::distance(page, data, "mode1", DISTANCE);
}

/// Speed over error, with the parameters' defaults.
fn law(language: Language) -> String {
    let errors = (-400..=800).map(|mm| f64::from(mm) * 1e-3);
    let (cruise, brake, kp) = (0.5_f64, 0.36, 5.0);
    let curve = |speed: fn(f64, f64, f64) -> f64| -> Vec<(f64, f64)> {
        errors
            .clone()
            .map(|e| (CM * e, e.signum() * speed(e.abs(), brake, kp)))
            .collect()
    };
    let applied: Vec<(f64, f64)> = errors
        .clone()
        .map(|e| {
            (
                CM * e,
                e.signum() * cruise.min((2.0 * brake * e.abs()).sqrt()).min(kp * e.abs()),
            )
        })
        .collect();
    let curves = vec![
        Curve::new(
            FAR.of(language),
            Ink::Third,
            curve(|e, a, _| (2.0 * a * e).sqrt()),
        ),
        Curve::new(NEAR.of(language), Ink::Second, curve(|e, _, k| k * e)),
        Curve::new(IN_FORCE.of(language), Ink::First, applied),
    ];
    let panel = Panel::new(LAW_Y.of(language), curves).exactly(-0.6, 0.8);
    Plot {
        x: LAW_X.of(language).to_owned(),
        x_range: Some([-40.0, 80.0]),
        panels: vec![panel],
    }
    .svg(language, LAW_CAPTION.of(language))
}

fn distance_panel(language: Language, outcome: &Outcome) -> Panel {
    let curves = vec![
        Curve::steps(
            REFERENCE.of(language),
            Ink::Reference,
            outcome.reference(CM),
        ),
        Curve::new(
            MEASURED.of(language),
            Ink::First,
            outcome.range_cm(Place::Front),
        ),
    ];
    Panel::new(DISTANCE.of(language), curves).at_least(0.0, 100.0)
}
