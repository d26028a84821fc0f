//! Mode 8: goals, around obstacles, and a lane of boxes.

use super::maps;
use super::mode8_beside;
use super::mode8_machines as machines;
use super::panels;
use super::parts::{self, COMPONENTS, DESCRIPTION, RESULTS, SCHEME};
use super::{Experiment, Highlight};
use crate::data::Data;
use crate::drawing::geometry;
use crate::page::Page;
use crate::plot::{Curve, Ink, Map, Panel, Points};
use crate::signals::{Outcome, unwrapped};
use crate::text::{Language, Text, t};

const GOALS: Text = t("Goals", "Objetivos");
const LANE: Text = t("Lane", "Carril");
const OBSTACLES: Text = t("Obstacles", "Obstáculos");

const fn of(what: Text, scenario: &'static str, metric: &'static str, real: f64) -> Highlight {
    Highlight {
        scenario,
        metric,
        of: Some(what),
        real: Some(real),
    }
}

pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "mode8",
    number: "8",
    title: t(
        "Mode 8: goals, obstacles and lanes",
        "Modo 8: objetivos, obstáculos y carriles",
    ),
    scenarios: &["mode8-goals", "mode8-lane", "mode8-obstacles"],
    highlights: &[
        of(GOALS, "mode8-goals", "total_time_s", 32.0),
        of(LANE, "mode8-lane", "finish_s", 57.8),
        of(OBSTACLES, "mode8-obstacles", "total_time_s", 73.6),
        of(OBSTACLES, "mode8-obstacles", "path_m", 4.16),
    ],
    write,
};

const WHAT: Text = t(
    "The robot goes to a point that it is given, finds what stands in the way, goes around it and on to the point. There it calls its place the new origin and waits for the \
     next goal. With another command it follows a lane between boxes instead, for ever.",
    "El robot va a un punto dado, detecta lo que se interpone, lo rodea y sigue hasta el punto. Allí toma su posición como nuevo origen y espera el \
     siguiente objetivo. Con otra orden recorre, en cambio, un carril entre cajas, sin término fijado.",
);
const IDEA: Text = t(
    "How an obstacle is passed: the servo looks to both sides, the robot passes the edge that makes the shorter way and goes on as soon as the way to the goal is clear.",
    "Cómo se rodea un obstáculo: el servo mira a ambos lados, el robot pasa por la esquina que supone menos camino y continúa en cuanto queda libre el camino al objetivo.",
);
const PARTS: Text = t(
    "The final build: one HC-SR04 on each side, and the one ahead on a servo that turns it 90 degrees to both sides. All echo lines are on pins with external interrupts, so that measuring \
     a pulse stops nothing else: with the servo and the odometry running, no wait is allowed.",
    "El montaje final: un HC-SR04 en cada lateral y el delantero sobre un servomotor que lo orienta hasta 90 grados a cada lado. Todas las líneas de eco van a pines con interrupción externa, de modo que medir \
     un pulso no detiene nada más: con el servo y la odometría en marcha no cabe ninguna espera.",
);
const SCHEME_WORDS: Text = t(
    "State machines above the loops of mode 7. For a goal, echoes are remembered as points; what hangs together with a point on the line to the goal is the obstacle, and its two ends are \
     the directions that just pass it. The robot leaves it as soon as the line to the goal is clear and leads nearer than where the detour began, so every detour ends; once its whole outline has been seen \
     without a way through, the goal is given up.",
    "Máquinas de estados por encima de los lazos del modo 7. Para un objetivo, los ecos se recuerdan como puntos; lo que está unido a un punto sobre la recta al objetivo es el obstáculo, y sus dos extremos dan \
     las direcciones que pasan justo a su lado. El robot deja de rodearlo en cuanto la recta al objetivo queda libre y él está más cerca de este que al empezar el rodeo, de modo que todo rodeo termina; si ha visto todo el contorno \
     sin hallar paso, abandona el objetivo.",
);
const GOAL_MACHINE: Text = t(
    "State machine for a goal among obstacles.",
    "Máquina de estados para un objetivo entre obstáculos.",
);
const LANE_WORDS: Text = t(
    "In a lane the robot drives straight on until a face is 25 cm ahead, looks to both sides, and turns by a quarter to the open one. The lateral sonar must agree: it looks where the robot would go.",
    "En un carril el robot avanza recto hasta tener una cara a 25 cm, mira a ambos lados y gira un cuarto de vuelta hacia el lado abierto. El sensor lateral debe confirmarlo: mira hacia donde iría el robot.",
);
const LANE_MACHINE: Text = t(
    "State machine for a lane of boxes.",
    "Máquina de estados para un carril entre cajas.",
);
const GOALS_WORDS: Text = t(
    "Four goals, each sent when the one before is reached: (1, 1), (0.5, −0.5), (0.5, −0.5) and (−1, −1). At each one the origin moves there, so that pose and heading start again from zero.",
    "Cuatro objetivos, cada uno enviado al alcanzar el anterior: (1; 1), (0,5; −0,5), (0,5; −0,5) y (−1; −1). En cada uno el origen se traslada allí, de modo que la pose vuelve a empezar desde cero.",
);
const GOALS_POSE: Text = t(
    "Goals: coordinates asked for and reached, and heading with its reference.",
    "Objetivos: coordenadas pedidas y alcanzadas, y orientación con su referencia.",
);
const GOALS_SPEEDS: Text = t(
    "Goals: speed references of both wheels.",
    "Objetivos: referencias de velocidad de ambas ruedas.",
);
const GOALS_WAY: Text = t(
    "Goals: the true way, beside the straight lines between the places reached.",
    "Objetivos: trayectoria real frente a las rectas entre los puntos alcanzados.",
);
const GOALS_STATES: Text = t(
    "Goals: states over time.",
    "Objetivos: estados a lo largo del tiempo.",
);
const LANE_EXPERIMENT: Text = t(
    "Boxes make a lane of four straights with a turn to the left and two to the right.",
    "Las cajas forman un carril de cuatro tramos rectos con un giro a la izquierda y dos a la derecha.",
);
const LANE_SPEEDS: Text = t(
    "Lane: speed references of both wheels. Straights have one sign, turns opposite ones.",
    "Carril: referencias de velocidad de ambas ruedas. En los tramos rectos tienen el mismo signo; en los giros, signos opuestos.",
);
const LANE_WAY: Text = t(
    "Lane: the way between the boxes.",
    "Carril: trayectoria entre las cajas.",
);
const LANE_RANGES: Text = t(
    "Lane: the three ranges. The peaks of the front one are the sweeps of the servo that find the open side; gaps are times in which nothing is within reach.",
    "Carril: las tres distancias medidas. Los picos de la frontal son los barridos del servo que encuentran el lado abierto; los huecos corresponden a instantes sin nada al alcance.",
);
const LANE_POSE: Text = t(
    "Lane: pose, and heading with its reference.",
    "Carril: pose y orientación con su referencia.",
);
const LANE_STATES: Text = t(
    "Lane: states over time.",
    "Carril: estados a lo largo del tiempo.",
);
const OBSTACLES_WORDS: Text = t(
    "A goal 2.5 m ahead, behind a box and a block of two.",
    "Un objetivo a 2,5 m, detrás de una caja y de un bloque de dos.",
);
const OBSTACLES_WAY: Text = t(
    "Obstacles: the way around the boxes to the goal, beside the straight line to it.",
    "Obstáculos: trayectoria alrededor de las cajas hasta el objetivo, frente a la recta que lleva a él.",
);
const OBSTACLES_POSE: Text = t(
    "Obstacles: coordinates of goal and robot, and heading with its reference.",
    "Obstáculos: coordenadas del objetivo y del robot, y orientación con su referencia.",
);
const OBSTACLES_SPEEDS: Text = t(
    "Obstacles: speed references of both wheels.",
    "Obstáculos: referencias de velocidad de ambas ruedas.",
);
const OBSTACLES_RANGES: Text = t(
    "Obstacles: the three ranges.",
    "Obstáculos: las tres distancias medidas.",
);
const OBSTACLES_STATES: Text = t(
    "Obstacles: states over time.",
    "Obstáculos: estados a lo largo del tiempo.",
);
const GOAL_X: Text = t("goal x", "x objetivo");
const GOAL_Y: Text = t("goal y", "y objetivo");
const POSITION: Text = t("position (m)", "posición (m)");
pub(super) const HEADING: Text = t("heading (°)", "orientación (°)");
const HEADING_NAME: Text = t("heading", "orientación");
const HEADING_REFERENCE: Text = t("heading reference", "referencia de orientación");
const STRAIGHT: Text = t("straight line", "línea recta");
const TRUE: Text = t("true", "real");
const START: Text = t("start", "salida");

fn write(page: &mut Page, data: &Data) {
    page.section(DESCRIPTION);
    page.p(WHAT);
    let idea = geometry::around_box(page.language, page.say(IDEA));
    page.figure("mode8-idea", &idea, IDEA);
    page.section(COMPONENTS);
    page.p(PARTS);
    let any = EXPERIMENT
        .scenarios
        .iter()
        .find(|name| data.outcome(name).is_some());
    if let Some(scenario) = any {
        parts::rig_figure(page, data, "mode8", scenario);
        parts::wiring_figure(page, data, "mode8", scenario, "final");
    }
    page.section(SCHEME);
    page.p(SCHEME_WORDS);
    let goal = machines::GOAL.svg(page.language, page.say(GOAL_MACHINE));
    page.figure("mode8-goal-machine", &goal, GOAL_MACHINE);
    page.p(LANE_WORDS);
    let lane = machines::LANE.svg(page.language, page.say(LANE_MACHINE));
    page.figure("mode8-lane-machine", &lane, LANE_MACHINE);
    page.section(RESULTS);
    goals(page, data);
    lane_results(page, data);
    obstacles(page, data);
    parts::limits(page, &data.of(&EXPERIMENT));
    for scenario in EXPERIMENT.scenarios {
        mode8_beside::write(page, data, scenario);
    }
}

/// Panels until a little after the end of what the run is about: the last goal reached, or the end of the lane.
fn until(page: &mut Page, outcome: &Outcome, id: &str, caption: Text, panels: Vec<Panel>) {
    let end_s = end_s(outcome).map_or(outcome.duration_s(), |end_s| end_s + 2.0);
    parts::timed_within(
        page,
        id,
        caption,
        panels,
        Some([0.0, end_s.min(outcome.duration_s())]),
    );
}

/// When the run was done, since the arming [s]; `None` if it never was.
pub(super) fn end_s(outcome: &Outcome) -> Option<f64> {
    let lane = outcome
        .metric("finish_s")
        .filter(|finish_s| finish_s.is_finite());
    lane.or_else(|| outcome.reached_s().last().copied())
}

fn goals(page: &mut Page, data: &Data) {
    let Some(outcome) = data.outcome("mode8-goals") else {
        return;
    };
    page.subsection(page.say(GOALS));
    page.p(GOALS_WORDS);
    let language = page.language;
    let panels = pose_panels(language, outcome, true);
    until(page, outcome, "mode8-goals-pose", GOALS_POSE, panels);
    let panel = panels::references_panel(language, outcome);
    until(
        page,
        outcome,
        "mode8-goals-speeds",
        GOALS_SPEEDS,
        vec![panel],
    );
    let start = outcome.setup.scenario.start;
    let mut ideal = vec![(start.x_m, start.y_m)];
    ideal.extend(outcome.reached_s().iter().map(|t_s| outcome.place_at(*t_s)));
    let mut marks = vec![(start.x_m, start.y_m, page.say(START).to_owned())];
    marks.extend(
        ideal
            .iter()
            .skip(1)
            .zip(1..)
            .map(|((x, y), number)| (*x, *y, format!("{number}"))),
    );
    let curves = vec![
        Curve::new(page.say(STRAIGHT), Ink::Reference, ideal),
        Curve::new(page.say(TRUE), Ink::Third, outcome.way()),
    ];
    let svg = Map {
        curves,
        marks,
        ..maps::map(language)
    }
    .svg(language, page.say(GOALS_WAY));
    page.figure("mode8-goals-way", &svg, GOALS_WAY);
    let panel = panels::state_panel(language, outcome, &machines::STATES);
    until(
        page,
        outcome,
        "mode8-goals-states",
        GOALS_STATES,
        vec![panel],
    );
}

fn lane_results(page: &mut Page, data: &Data) {
    let Some(outcome) = data.outcome("mode8-lane") else {
        return;
    };
    page.subsection(page.say(LANE));
    page.p(LANE_EXPERIMENT);
    let language = page.language;
    let panel = panels::references_panel(language, outcome);
    until(page, outcome, "mode8-lane-speeds", LANE_SPEEDS, vec![panel]);
    let svg = way_map(page, outcome, Points::new()).svg(language, page.say(LANE_WAY));
    page.figure("mode8-lane-way", &svg, LANE_WAY);
    let panels = panels::range_panels(language, outcome);
    until(page, outcome, "mode8-lane-ranges", LANE_RANGES, panels);
    let panels = pose_panels(language, outcome, false);
    until(page, outcome, "mode8-lane-pose", LANE_POSE, panels);
    let names: &[Text] = if outcome.tells_in_text() {
        &machines::ORIGINAL_LANE
    } else {
        &machines::STATES
    };
    let panel = panels::state_panel(language, outcome, names);
    until(page, outcome, "mode8-lane-states", LANE_STATES, vec![panel]);
}

fn obstacles(page: &mut Page, data: &Data) {
    let Some(outcome) = data.outcome("mode8-obstacles") else {
        return;
    };
    page.subsection(page.say(OBSTACLES));
    page.p(OBSTACLES_WORDS);
    let language = page.language;
    let start = outcome.setup.scenario.start;
    let straight = vec![(start.x_m, start.y_m), (start.x_m + 2.5, start.y_m)];
    let svg = way_map(page, outcome, straight).svg(language, page.say(OBSTACLES_WAY));
    page.figure("mode8-obstacles-way", &svg, OBSTACLES_WAY);
    let panels = pose_panels(language, outcome, true);
    until(
        page,
        outcome,
        "mode8-obstacles-pose",
        OBSTACLES_POSE,
        panels,
    );
    let panel = panels::references_panel(language, outcome);
    parts::timed(
        page,
        "mode8-obstacles-speeds",
        OBSTACLES_SPEEDS,
        vec![panel],
    );
    let panels = panels::range_panels(language, outcome);
    until(
        page,
        outcome,
        "mode8-obstacles-ranges",
        OBSTACLES_RANGES,
        panels,
    );
    let panel = panels::state_panel(language, outcome, &machines::STATES);
    parts::timed(
        page,
        "mode8-obstacles-states",
        OBSTACLES_STATES,
        vec![panel],
    );
}

/// Ways between boxes, and where the robot began.
pub(super) fn way_map(page: &Page, outcome: &Outcome, ideal: Points) -> Map {
    let language = page.language;
    let mut curves = maps::ways(language, outcome, ideal);
    if curves[0].points.is_empty() {
        curves.remove(0);
    } else {
        curves[0].name = page.say(STRAIGHT).to_owned();
    }
    let start = outcome.setup.scenario.start;
    let arena = &outcome.setup.world.arena;
    Map {
        // A lane has an end, the robot's way has none.
        range: Some([
            [arena.from_m[0], arena.to_m[0]],
            [arena.from_m[1], arena.to_m[1]],
        ]),
        shapes: maps::shapes(outcome),
        curves,
        marks: vec![(start.x_m, start.y_m, page.say(START).to_owned())],
        ..maps::map(language)
    }
}

/// Coordinates, with those of the goal, and heading with its reference.
fn pose_panels(language: Language, outcome: &Outcome, goal: bool) -> Vec<Panel> {
    let [x, y, heading] = outcome.pose();
    let mut position = Vec::new();
    if goal {
        let [goal_x, goal_y] = outcome.goal_m();
        position.push(Curve::steps(GOAL_X.of(language), Ink::Reference, goal_x));
        position.push(Curve::steps(GOAL_Y.of(language), Ink::Fourth, goal_y));
    }
    position.push(Curve::new("x", Ink::First, x));
    position.push(Curve::new("y", Ink::Second, y));
    let headings = vec![
        Curve::steps(
            HEADING_REFERENCE.of(language),
            Ink::Reference,
            unwrapped(outcome.heading_reference_deg()),
        ),
        Curve::new(HEADING_NAME.of(language), Ink::Third, heading),
    ];
    vec![
        Panel::new(POSITION.of(language), position),
        Panel::new(HEADING.of(language), headings).exactly(-190.0, 190.0),
    ]
}
