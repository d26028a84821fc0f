//! Metrics of a way to the goal of a random world: whether the robot got there, how long its way was beside the shortest one, and whether
//! it was right about a goal that cannot be reached.

use super::Metrics;
use crate::files::Setup;
use crate::random_world::Journey;
use crate::sim::Sim;
use crate::trace::{Sample, Trace};
use rumbo_wire::{Command, EventKind, FromRobot};

/// How far from the goal the robot may think that it is there: 4 cm, and what odometry loses on the way.
const GOAL_ERROR_M: f64 = 0.04;
const GOAL_ERROR_OF_WAY: f64 = 0.02;

/// What the robot said about its goal, and when the station heard it.
struct Verdict {
    t_s: f64,
    reached: bool,
}

/// The first word of the robot about a goal commanded at `from_s`.
fn verdict(trace: &Trace, from_s: f64) -> Option<Verdict> {
    let heard = trace.heard.iter().filter(|heard| heard.t_s >= from_s);
    heard
        .filter_map(|heard| match heard.what {
            FromRobot::Event(event) => match event.kind {
                EventKind::Reached => Some((heard.t_s, true)),
                EventKind::Unreachable => Some((heard.t_s, false)),
                _ => None,
            },
            _ => None,
        })
        .map(|(t_s, reached)| Verdict { t_s, reached })
        .next()
}

fn way_m(samples: &[Sample]) -> f64 {
    let steps = samples.windows(2);
    steps
        .map(|two| (two[1].x_m - two[0].x_m).hypot(two[1].y_m - two[0].y_m))
        .sum()
}

/// The metrics of a scenario whose goal is that of its world; none for others.
pub(super) fn journey(setup: &Setup, sim: &Sim, trace: &Trace, metrics: &mut Metrics) {
    let mut goals = setup.scenario.commands.iter();
    let goal =
        goals.find(|timed| timed.goal_of_world && matches!(timed.command, Command::Goal { .. }));
    let (
        Some(Journey {
            goal_m,
            blocked,
            shortest,
        }),
        Some(goal),
    ) = (&setup.world.journey, goal)
    else {
        return;
    };
    let share = |is: bool| if is { 1.0 } else { 0.0 };
    let mut put = |name: &str, value: f64| metrics.insert(name.into(), value);
    let verdict = verdict(trace, goal.at_s);
    let until_s = verdict
        .as_ref()
        .map_or(f64::INFINITY, |verdict| verdict.t_s);
    let samples = trace.between(goal.at_s, until_s);
    let path_m = way_m(samples);
    let left_m = samples.last().map_or(f64::NAN, |last| {
        (goal_m[0] - last.x_m).hypot(goal_m[1] - last.y_m)
    });
    let said_reached = verdict.as_ref().is_some_and(|verdict| verdict.reached);
    let reached = said_reached && left_m <= GOAL_ERROR_M + GOAL_ERROR_OF_WAY * path_m;
    put("reachable", share(shortest.is_some()));
    put("blocked", share(*blocked));
    put("reached", share(reached));
    put(
        "unreachable_reported",
        share(verdict.as_ref().is_some_and(|verdict| !verdict.reached)),
    );
    put(
        "time_s",
        verdict
            .as_ref()
            .map_or(f64::NAN, |verdict| verdict.t_s - goal.at_s),
    );
    put("path_m", path_m);
    put("contact_speed_m_s", sim.worst_contact_m_s());
    if said_reached {
        put("goal_error_m", left_m);
    }
    if let Some(shortest) = shortest {
        put("shortest_m", shortest.length_m);
        if reached {
            // What is left to the goal counts as driven: who stops short gains nothing.
            put("path_ratio", (path_m + left_m) / shortest.length_m);
        }
    }
}
