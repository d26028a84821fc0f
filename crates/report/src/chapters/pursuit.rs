//! Pure pursuit: the extension of the report.

use super::maps;
use super::parts::{self, ANALYSIS, DESCRIPTION, RESULTS};
use super::{Experiment, Highlight};
use crate::data::Data;
use crate::drawing::geometry;
use crate::page::Page;
use crate::plot::{Curve, Ink, Map, Panel, Points};
use crate::signals::{CM, Outcome};
use crate::text::{Text, same, t};

const LINE: Text = t("Line", "Recta");
const CURVE: Text = t("Curve", "Curva");

const fn of(what: Text, scenario: &'static str, metric: &'static str) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: Some(what),
        real: None,
    }
}

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "pursuit",
    number: "9",
    title: t(
        "Extension: pure pursuit",
        "Ampliación: persecución pura (pure pursuit)",
    ),
    scenarios: &["pursuit-line", "pursuit-curve"],
    highlights: &[
        of(LINE, "pursuit-line", "odometry_rms_m"),
        of(CURVE, "pursuit-curve", "odometry_rms_m"),
    ],
    write,
};

const WHAT: Text = t(
    "A tracker that follows a path without stopping at its corners: the robot steers towards a point that is always a little ahead on the path. It is driven here along a line of 3 m, \
     from 18 degrees off it, and along one period of a sine.",
    "Un seguidor que recorre un camino sin detenerse en sus esquinas: el robot se dirige hacia un punto que está siempre algo por delante sobre el camino. Aquí recorre una recta de 3 m, \
     partiendo girado 18 grados respecto a ella, y un periodo de una senoide.",
);
const LOOKAHEAD: Text = t(
    "The lookahead at the distance L on the path, and the circle that is tangent to the robot's heading and goes through it. The dots are the waypoints of the original's version, which takes the one after the nearest.",
    "El punto de mira a la distancia L sobre el camino y la circunferencia tangente a la orientación del robot que pasa por él. Marcados, los puntos de paso de la versión original, que toma el siguiente al más cercano.",
);
const LAW: Text = t(
    "Seen by the robot the lookahead is at $(x, y)$. The circle has the curvature $\\kappa$, and the yaw rate follows from the speed:",
    "Visto desde el robot, el punto de mira está en $(x, y)$. La circunferencia tiene curvatura $\\kappa$ y la velocidad de giro se obtiene de la de avance:",
);
const LAW_FORMULA: Text = same(r"\kappa = \frac{2y}{x^2 + y^2}, \qquad \omega = \kappa\,v");
const STABILITY: Text = t(
    "Near a straight path the distance $c$ from it obeys",
    "Cerca de un camino recto, la separación $c$ cumple",
);
const STABILITY_FORMULA: Text = same(r"\ddot c + \frac{2v}{L}\,\dot c + \frac{2v^2}{L^2}\,c = 0");
const STABILITY_END: Text = t(
    "with a damping of 0.71 whatever $L$ and $v$ are. The lag of the wheels asks for a lookahead that grows with the speed: 0.5 s, at least 12 cm.",
    "con un amortiguamiento de 0,71 para cualesquiera $L$ y $v$. El retardo de las ruedas exige un punto de mira que se aleje con la velocidad: 0,5 s y al menos 12 cm.",
);
const LINE_WAY: Text = t(
    "Line: the path, the way by odometry, and the true one.",
    "Recta: el camino, la trayectoria según la odometría y la real.",
);
const CURVE_WAY: Text = t(
    "Curve: the path, the way by odometry, and the true one.",
    "Curva: el camino, la trayectoria según la odometría y la real.",
);
const OFF: Text = t(
    "Distance from the path by odometry over time, on the line and on the curve.",
    "Separación del camino según la odometría a lo largo del tiempo, en la recta y en la curva.",
);
const OFF_AXIS: Text = t("off the path (cm)", "separación (cm)");

fn write(page: &mut Page, data: &Data) {
    page.section(DESCRIPTION);
    page.p(WHAT);
    page.section(ANALYSIS);
    let lookahead = geometry::lookahead(page.language, page.say(LOOKAHEAD));
    page.figure("pursuit-lookahead", &lookahead, LOOKAHEAD);
    page.p(LAW);
    page.formula(LAW_FORMULA);
    page.p(STABILITY);
    page.formula(STABILITY_FORMULA);
    page.p(STABILITY_END);
    page.section(RESULTS);
    let mut off = Vec::new();
    for (scenario, name, ink, caption) in [
        ("pursuit-line", LINE, Ink::First, LINE_WAY),
        ("pursuit-curve", CURVE, Ink::Second, CURVE_WAY),
    ] {
        let Some(outcome) = data.outcome(scenario) else {
            continue;
        };
        let route = maps::route(outcome);
        let map = Map {
            curves: maps::ways(page.language, outcome, route.clone()),
            ..maps::map(page.language)
        };
        let svg = map.svg(page.language, page.say(caption));
        page.figure(&format!("{scenario}-way"), &svg, caption);
        off.push(Curve::new(
            page.say(name),
            ink,
            off_path_cm(outcome, &route),
        ));
    }
    let panel = Panel::new(page.say(OFF_AXIS), off);
    parts::timed(page, "pursuit-off", OFF, vec![panel]);
    parts::limits(page, &data.of(&EXPERIMENT));
}

fn off_path_cm(outcome: &Outcome, route: &Points) -> Points {
    let [x, ..] = outcome.pose();
    let times = x.iter().map(|(t_s, _)| *t_s).filter(|t_s| *t_s >= 0.0);
    times
        .zip(outcome.told_way())
        .map(|(t_s, place)| (t_s, CM * maps::off_route(route, place)))
        .collect()
}
