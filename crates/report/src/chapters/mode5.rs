//! Mode 5: each wheel at a commanded speed.

use super::beside;
use super::panels;
use super::parts::{
    self, ANALYSIS, COMPONENTS, DESCRIPTION, ERROR_RPM, LEFT, REFERENCE, RESULTS, RIGHT, SPEED,
};
use super::{Experiment, highlight};
use crate::data::Data;
use crate::drawing::geometry;
use crate::drawing::scheme::{Part, Path, Scheme};
use crate::page::Page;
use crate::plot::{Curve, Ink, Panel};
use crate::respond::{self, Kind};
use crate::signals::{Outcome, Place, RPM, difference};
use crate::text::{Language, Text, same, t};
use rumbo_wire::text::Row;

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode5",
    number: "5",
    title: t(
        "Mode 5: speed of each wheel",
        "Modo 5: velocidad de cada rueda",
    ),
    scenarios: &["mode5", "mode5-reversal"],
    highlights: &[
        highlight("mode5", "step1.settling_s", Some(3.7)),
        highlight("mode5", "step3.settling_s", Some(1.8)),
        highlight("mode5", "step6.settling_s", Some(5.3)),
    ],
    write,
};

const WHAT: Text = t(
    "Each wheel turns at the speed that it is told, in both directions and through zero. Everything that asks for speeds (modes 1 to 4 and 6 to 8) \
     stands on these two loops. The staircase of the experiment is 60, 50, 100, 70, 0, −100, −50, 0 and 40 rpm, five seconds each; a second \
     run goes straight from 70 to −100 rpm and back.",
    "Cada rueda gira a la velocidad que se le ordena, en ambos sentidos y pasando por cero. Todos los modos que piden velocidades (1 a 4 y 6 a 8) \
     se apoyan en estos dos lazos. La escalera del experimento es 60, 50, 100, 70, 0, −100, −50, 0 y 40 rpm, cinco segundos cada una; una segunda \
     ejecución pasa directamente de 70 a −100 rpm y vuelve.",
);
const PARTS: Text = t(
    "The components of the modes before, and a Hall sensor at each motor: a disc with eight poles on the motor's shaft passes it, and both edges of its \
     signal are counted. One channel does not tell the direction; its sign is that in which the wheel was driven last.",
    "Los componentes de los modos anteriores y un sensor Hall en cada motor: ante él gira un disco de ocho polos montado en el eje del motor y se cuentan los dos \
     flancos de su señal. Un solo canal no informa del sentido de giro; el signo es el del último sentido en que se actuó sobre la rueda.",
);
const ENCODER: Text = t(
    "The Hall encoder: eight edges per turn of the motor, 384 per turn of the wheel.",
    "El encoder Hall: ocho flancos por vuelta del motor, 384 por vuelta de la rueda.",
);
const SCHEME_WORDS: Text = t(
    "The reference goes through a ramp that the motor can follow. The feedforward knows what PWM a speed takes, for each wheel and direction; what it \
     misses, a PI controller adds, whose integral is told what was really applied (anti-windup by back-calculation). The PWM never points against \
     the motion: for a change of sign the wheel is released until it stands, and both wheels start together.",
    "La referencia pasa por una rampa que el motor puede seguir. La prealimentación conoce la PWM que requiere cada velocidad, por rueda y sentido; \
     lo que le falta lo añade un controlador PI cuyo término integral sabe lo que realmente se aplicó (anti-windup por retrocálculo). La PWM nunca se opone \
     al movimiento: para cambiar de signo la rueda se libera hasta que se para, y ambas ruedas arrancan a la vez.",
);
const SCHEME_CAPTION: Text = t(
    "Control scheme of mode 5, the same for each wheel.",
    "Esquema de control del modo 5, idéntico para cada rueda.",
);
const COUNT: Text = t(
    "The original counts edges for 50 ms. With $n$ edges, a gear of 48:1 and 8 edges per turn of the motor:",
    "El programa original cuenta flancos durante 50 ms. Con $n$ flancos, una reductora de 48:1 y 8 flancos por vuelta del motor:",
);
const COUNTED: Text = t(
    r"\text{turns of the wheel} = \frac{n}{48 \cdot 8}, \qquad \omega = \frac{n}{48 \cdot 8}\cdot\frac{1000\ \mathrm{ms/s}}{50\ \mathrm{ms}}\cdot 60\ \mathrm{s/min} = 3.125\,n\ \mathrm{rpm}",
    r"\text{vueltas de la rueda} = \frac{n}{48 \cdot 8}, \qquad \omega = \frac{n}{48 \cdot 8}\cdot\frac{1000\ \mathrm{ms/s}}{50\ \mathrm{ms}}\cdot 60\ \mathrm{s/min} = 3{,}125\,n\ \mathrm{rpm}",
);
const TIME_WORDS: Text = t(
    "so a speed is known to 3.1 rpm only. Here the *time* between edges is measured, to 4 µs. Over one turn of the motor, from an edge to the same \
     edge eight later, the uneven spacing of the poles cancels:",
    "de modo que la velocidad solo se conoce con una resolución de 3,1 rpm. Aquí se mide el *tiempo* entre flancos, con una resolución de 4 µs. En una vuelta completa del \
     motor, de un flanco al mismo flanco ocho más tarde, la separación desigual de los polos se cancela:",
);
const TIMED: Text = same(r"\omega = \frac{2\pi/48}{t_k - t_{k-8}}");
const LAW_WORDS: Text = t(
    "The PWM, as a share of 255, with $k_s$ for each wheel and direction, and the PI on the error of the ramped reference $\\omega^*$:",
    "La PWM, como fracción de 255, con un $k_s$ por rueda y sentido, y el PI sobre el error respecto de la referencia en rampa $\\omega^*$:",
);
const LAW: Text = same(
    r"u = k_s + k_v\,\omega^* + k_a\,\frac{d\omega^*}{dt} + K_p\,(\omega^* - \omega) + K_i\int(\omega^* - \omega)\,dt",
);
const SPEEDS: Text = t(
    "Speeds of both wheels with their reference, and the PWM of each. In the steady parts the PWM is that of the static curve of its speed.",
    "Velocidad de ambas ruedas con su referencia y PWM de cada una. En régimen permanente la PWM es la de la característica estática para esa velocidad.",
);
const ERROR: Text = t(
    "Error of each wheel's speed: measured speed less reference. A reference is a step, so the error begins with the whole step.",
    "Error de velocidad de cada rueda: velocidad medida menos referencia. La referencia es un escalón, así que el error comienza con el escalón completo.",
);
const REVERSAL: Text = t(
    "Straight from one direction to the other: released until both wheels stand, then driven the other way.",
    "Paso directo de un sentido al otro: se libera hasta que ambas ruedas se paran y después se actúa en sentido contrario.",
);
const REAL_CAPTION: Text = t(
    "Speed of the right wheel (above) and of the left one (below): ours and the recorded run, with the same references at the same times.",
    "Velocidad de la rueda derecha (arriba) y de la izquierda (abajo): nuestro robot y el registro real, con las mismas referencias en los mismos instantes.",
);
const RIGHT_SPEED: Text = t("right wheel (rpm)", "rueda derecha (rpm)");
const LEFT_SPEED: Text = t("left wheel (rpm)", "rueda izquierda (rpm)");
const RIGHT_WHEEL: Text = t("Values of the right wheel.", "Valores de la rueda derecha.");

const CONTROL: Scheme = Scheme {
    input: t("reference", "referencia"),
    row: &[
        (Part::Block(&[t("ramp", "rampa")]), same("ω*")),
        (Part::Sum("+", "−", ""), same("e")),
        (
            Part::Block(&[t("PI,", "PI,"), t("anti-windup", "anti-windup")]),
            same(""),
        ),
        (Part::Sum("+", "", "+"), same("u")),
        (
            Part::Block(&[
                t("limits,", "límites,"),
                t("safe reversal", "inversión segura"),
            ]),
            same("PWM"),
        ),
        (
            Part::Block(&[t("L298N,", "L298N,"), t("motor", "motor")]),
            same(""),
        ),
        (Part::Block(&[t("wheel", "rueda")]), same("ω")),
    ],
    paths: &[
        Path {
            from: 0,
            to: 3,
            block: &[t(
                "feedforward: kₛ + kᵥ ω* + kₐ dω*/dt",
                "prealimentación: kₛ + kᵥ ω* + kₐ dω*/dt",
            )],
            level: -1,
        },
        Path {
            from: 6,
            to: 1,
            block: &[t(
                "Hall encoder: time between edges",
                "encoder Hall: tiempo entre flancos",
            )],
            level: 1,
        },
    ],
    from_above: &[],
};

fn write(page: &mut Page, data: &Data) {
    page.section(DESCRIPTION);
    page.p(WHAT);
    page.section(COMPONENTS);
    page.p(PARTS);
    let encoder = geometry::encoder(page.language, page.say(ENCODER));
    page.figure("mode5-encoder", &encoder, ENCODER);
    parts::wiring_figure(page, data, "mode5", "mode5", "modes_5_to_7");
    parts::scheme(page, "mode5", SCHEME_WORDS, &CONTROL, SCHEME_CAPTION);
    page.section(ANALYSIS);
    page.p(COUNT);
    page.formula(COUNTED);
    page.p(TIME_WORDS);
    page.formula(TIMED);
    page.p(LAW_WORDS);
    page.formula(LAW);
    page.section(RESULTS);
    if let Some(outcome) = data.outcome("mode5") {
        let panels = vec![
            speed_panel(page.language, outcome),
            panels::pwm_panel(page.language, outcome),
        ];
        parts::timed(page, "mode5-speeds", SPEEDS, panels);
        let panel = Panel::new(page.say(ERROR_RPM), errors(page.language, outcome));
        parts::timed(page, "mode5-error", ERROR, vec![panel]);
    }
    if let Some(outcome) = data.outcome("mode5-reversal") {
        let panels = vec![
            speed_panel(page.language, outcome),
            panels::pwm_panel(page.language, outcome),
        ];
        parts::timed(page, "mode5-reversal", REVERSAL, panels);
    }
    parts::limits(page, &data.of(&EXPERIMENT));
    beside(page, data);
}

/// Speeds of both wheels with the reference of the commands.
pub(super) fn speed_panel(language: Language, outcome: &Outcome) -> Panel {
    let curve =
        |name: Text, ink, wheel| Curve::new(name.of(language), ink, outcome.speed_rpm(wheel));
    Panel::new(
        SPEED.of(language),
        vec![
            Curve::steps(
                REFERENCE.of(language),
                Ink::Reference,
                outcome.reference(RPM),
            ),
            curve(LEFT, Ink::First, Place::Left),
            curve(RIGHT, Ink::Second, Place::Right),
        ],
    )
}

fn errors(language: Language, outcome: &Outcome) -> Vec<Curve> {
    let reference = outcome.reference(RPM);
    [
        (LEFT, Ink::First, Place::Left),
        (RIGHT, Ink::Second, Place::Right),
    ]
    .into_iter()
    .map(|(name, ink, wheel)| {
        Curve::new(
            name.of(language),
            ink,
            difference(&outcome.speed_rpm(wheel), &reference),
        )
    })
    .collect()
}

fn beside(page: &mut Page, data: &Data) {
    let Some((ours, recording)) = data.beside("mode5") else {
        return;
    };
    beside::heading(page, &recording.file, true);
    let language = page.language;
    let real = |wheel| {
        recording.signal(|row| match row {
            Row::Speed(row) if wheel == Place::Left => Some(f64::from(row.wheel_rpm.left)),
            Row::Speed(row) => Some(f64::from(row.wheel_rpm.right)),
            _ => None,
        })
    };
    let panel = |name: Text, wheel| {
        let mut curves = vec![Curve::steps(
            REFERENCE.of(language),
            Ink::Reference,
            ours.reference(RPM),
        )];
        curves.extend(beside::both(
            language,
            recording,
            ours.speed_rpm(wheel),
            real(wheel),
        ));
        Panel::new(name.of(language), curves)
    };
    let panels = vec![
        panel(RIGHT_SPEED, Place::Right),
        panel(LEFT_SPEED, Place::Left),
    ];
    parts::timed(page, "mode5-real", REAL_CAPTION, panels);
    let references: Vec<(f64, f64)> = recording
        .references()
        .iter()
        .map(|(t_s, rad_s)| (*t_s, RPM * rad_s))
        .collect();
    page.p(RIGHT_WHEEL);
    beside::steps(
        page,
        recording,
        Kind::Speed,
        &respond::responses(Kind::Speed, &references, &ours.speed_rpm(Place::Right)),
        &respond::responses(Kind::Speed, &references, &real(Place::Right)),
    );
}
