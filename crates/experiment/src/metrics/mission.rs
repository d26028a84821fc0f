//! Metrics of mode 8: each goal's time and true error, the total way, the goals reached; and how a lane was followed.

use super::Metrics;
use crate::files::Setup;
use rumbo_control::params::ParamId;
use rumbo_sim::trace::{Trace, TruthSample};
use rumbo_wire::{Command, EventKind, FromRobot};

/// A goal may be missed by 4 cm and 2 % of the way to it.
const ALLOWED_M: f64 = 0.04;
const ALLOWED_OF_WAY: f64 = 0.02;

/// Time of an event of the robot.
fn said(trace: &Trace, what: EventKind) -> impl Iterator<Item = f64> + '_ {
    trace
        .messages
        .iter()
        .filter(
            move |message| matches!(message.what, FromRobot::Event(event) if event.kind == what),
        )
        .map(|message| message.t_s)
}

pub(super) fn way_m(samples: &[TruthSample]) -> f64 {
    let steps = samples.windows(2);
    steps
        .map(|two| (two[1].x_m - two[0].x_m).hypot(two[1].y_m - two[0].y_m))
        .sum()
}

/// The metrics of a mission whose goals the scenario itself gives; none for others.
pub(super) fn mission(setup: &Setup, worst_contact_m_s: f64, trace: &Trace, metrics: &mut Metrics) {
    let commands = || setup.scenario.commands.iter();
    let goals: Vec<_> = commands()
        .filter(|timed| !timed.goal_of_world)
        .filter_map(|timed| match timed.command {
            Command::Goal { x_m, y_m } => Some([f64::from(x_m), f64::from(y_m)]),
            _ => None,
        })
        .collect();
    let armed = commands().find(|timed| timed.command == Command::Arm);
    let (Some(armed), false) = (armed, goals.is_empty()) else {
        return;
    };
    let moves_origin = setup
        .scenario
        .parameters
        .iter()
        .rev()
        .find(|(id, _)| *id == ParamId::MissionResetOrigin)
        .is_none_or(|(_, value)| *value > 0.5);
    let reached: Vec<f64> = said(trace, EventKind::Reached).collect();
    let mut put = |name: String, value: f64| metrics.insert(name, value);
    put("reached".into(), reached.len() as f64);
    let unreachable = said(trace, EventKind::Unreachable).count();
    put("unreachable".into(), unreachable as f64);
    put("contact_speed_m_s".into(), worst_contact_m_s);
    let mut from_s = armed.at_s;
    let mut origin = trace.samples.first();
    for (number, goal_m) in (1..).zip(&goals) {
        let until_s = reached.get(number - 1).copied().unwrap_or(f64::NAN);
        put(format!("goal{number}.time_s"), until_s - from_s);
        let end = trace.between(from_s, until_s).last();
        let error_m = match (origin, end) {
            (Some(origin), Some(end)) if until_s.is_finite() => error_m(origin, *goal_m, end),
            _ => f64::NAN,
        };
        let straight_m = goal_m[0].hypot(goal_m[1]);
        put(format!("goal{number}.error_m"), error_m);
        put(
            format!("goal{number}.excess_m"),
            error_m - ALLOWED_M - ALLOWED_OF_WAY * straight_m,
        );
        from_s = until_s;
        if moves_origin {
            origin = end;
        }
    }
    put("total_time_s".into(), from_s - armed.at_s);
    let until_s = if from_s.is_finite() {
        from_s
    } else {
        f64::INFINITY
    };
    put("path_m".into(), way_m(trace.between(armed.at_s, until_s)));
}

/// How far from a goal, seen from an origin, the robot is.
fn error_m(origin: &TruthSample, goal_m: [f64; 2], end: &TruthSample) -> f64 {
    let (sin, cos) = origin.heading_rad.sin_cos();
    let x_m = origin.x_m + cos * goal_m[0] - sin * goal_m[1];
    let y_m = origin.y_m + sin * goal_m[0] + cos * goal_m[1];
    (x_m - end.x_m).hypot(y_m - end.y_m)
}
