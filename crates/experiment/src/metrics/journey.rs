//! Metrics of a way to the goal of a random world: whether the robot reached it, its way relative to the shortest one,
//! and whether it was right about an unreachable goal.

use super::Metrics;
use super::mission::way_m;
use crate::files::Setup;
use crate::random_world::Journey;
use rumbo_sim::trace::Trace;
use rumbo_wire::{Command, EventKind, FromRobot};

/// Distance from the goal at which *reached* is right: 4 cm, plus the odometry error of the way.
const GOAL_ERROR_M: f64 = 0.04;
const GOAL_ERROR_OF_WAY: f64 = 0.02;

/// Events about the goal, with the time of their arrival at the station.
struct Verdict {
    t_s: f64,
    is: EventKind,
}

/// The robot's first event about a goal commanded at `from_s`.
fn verdict(trace: &Trace, from_s: f64) -> Option<Verdict> {
    let messages = trace
        .messages
        .iter()
        .filter(|message| message.t_s >= from_s);
    messages
        .filter_map(|message| match message.what {
            FromRobot::Event(event) => match event.kind {
                EventKind::Reached | EventKind::Unreachable | EventKind::GaveUp { .. } => {
                    Some(Verdict {
                        t_s: message.t_s,
                        is: event.kind,
                    })
                }
                _ => None,
            },
            _ => None,
        })
        .next()
}

/// The metrics of a scenario whose goal is that of its world; none for others.
pub(super) fn journey(setup: &Setup, worst_contact_m_s: f64, trace: &Trace, metrics: &mut Metrics) {
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
    let said = verdict.as_ref().map(|verdict| verdict.is);
    let said_reached = said == Some(EventKind::Reached);
    let reached = said_reached && left_m <= GOAL_ERROR_M + GOAL_ERROR_OF_WAY * path_m;
    put("reachable", share(shortest.is_some()));
    put("blocked", share(*blocked));
    put("reached", share(reached));
    let unreachable = said == Some(EventKind::Unreachable);
    let gave_up = matches!(said, Some(EventKind::GaveUp { .. }));
    put("unreachable_reported", share(unreachable));
    put("gave_up", share(gave_up));
    put(
        "given_up_wrongly",
        share((unreachable || gave_up) && shortest.is_some()),
    );
    put(
        "time_s",
        verdict
            .as_ref()
            .map_or(f64::NAN, |verdict| verdict.t_s - goal.at_s),
    );
    put("path_m", path_m);
    put("contact_speed_m_s", worst_contact_m_s);
    if said_reached {
        put("goal_error_m", left_m);
    }
    if let Some(shortest) = shortest {
        put("shortest_m", shortest.length_m);
        if reached {
            // The rest to the goal counts as driven: stopping short gains nothing.
            put("path_ratio", (path_m + left_m) / shortest.length_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::{Library, Overrides};
    use rumbo_sim::trace::TimedMessage;
    use rumbo_sim::trace::TruthSample;
    use rumbo_wire::Event;

    /// Metrics of a robot that drives straight from the start to a point of a world, in 10 s, and then says something.
    fn metrics(setup: &Setup, to_m: [f64; 2], says: EventKind) -> Metrics {
        let at = |step: u32| {
            let part = f64::from(step) / 1000.0;
            TruthSample {
                t_s: 0.5 + 10.0 * part,
                x_m: part * to_m[0],
                y_m: part * to_m[1],
                heading_rad: 0.0,
                wrapped_rad: 0.0,
                wheel_rad_s: [0.0; 2],
                duty: [0; 2],
                seen_m: Some([f64::INFINITY; _]),
                servo_rad: 0.0,
                battery_v: 7.4,
                touching: false,
            }
        };
        let event = Event {
            t_ms: 0,
            kind: says,
        };
        let trace = Trace {
            messages: vec![TimedMessage {
                t_s: 10.6,
                what: FromRobot::Event(event),
            }],
            samples: (0..=1000).map(at).collect(),
            ..Trace::default()
        };
        let mut metrics = Metrics::new();
        journey(setup, 0.0, &trace, &mut metrics);
        metrics
    }

    /// A seed whose straight line is free, and one whose goal cannot be reached.
    fn setups() -> [Setup; 2] {
        let setup = Library::new()
            .setup("mode8-random", &Overrides::default())
            .unwrap();
        let first = |is: &dyn Fn(&Journey) -> bool| {
            (1..)
                .map(|seed| setup.of_seed(seed).unwrap().into_owned())
                .find(|setup| setup.world.journey.as_ref().is_some_and(is))
                .unwrap()
        };
        [
            first(&|one| !one.blocked),
            first(&|one| one.shortest.is_none()),
        ]
    }

    #[test]
    fn straight_to_a_free_goal_is_a_ratio_of_one_wherever_the_robot_stops_short() {
        let [free, _] = setups();
        let goal_m = free.world.journey.as_ref().unwrap().goal_m;
        for share in [1.0, 0.99] {
            let metrics = metrics(&free, goal_m.map(|place| share * place), EventKind::Reached);
            assert_eq!(metrics["reached"], 1.0);
            assert!((metrics["path_ratio"] - 1.0).abs() < 1e-9, "{metrics:?}");
            assert!((metrics["time_s"] - 10.1).abs() < 0.01, "{metrics:?}");
        }
    }

    #[test]
    fn a_goal_reported_from_afar_is_not_reached() {
        let [free, _] = setups();
        let goal_m = free.world.journey.as_ref().unwrap().goal_m;
        let metrics = metrics(&free, goal_m.map(|place| 0.9 * place), EventKind::Reached);
        assert_eq!(metrics["reached"], 0.0);
        assert!(!metrics.contains_key("path_ratio"));
        assert!(metrics["goal_error_m"] > 0.15);
    }

    #[test]
    fn a_goal_that_cannot_be_reached_is_rightly_called_so() {
        let [_, walled_in] = setups();
        let metrics = metrics(&walled_in, [1.0, 0.0], EventKind::Unreachable);
        assert_eq!(
            [
                "reachable",
                "reached",
                "unreachable_reported",
                "given_up_wrongly"
            ]
            .map(|name| metrics[name]),
            [0.0, 0.0, 1.0, 0.0]
        );
    }

    #[test]
    fn a_robot_whose_time_is_over_has_not_called_its_goal_unreachable() {
        for (setup, wrongly) in setups().iter().zip([1.0, 0.0]) {
            let metrics = metrics(setup, [0.1, 0.0], EventKind::GaveUp { after_s: 5 });
            assert_eq!(
                ["unreachable_reported", "gave_up", "given_up_wrongly"].map(|name| metrics[name]),
                [0.0, 1.0, wrongly]
            );
        }
    }
}
