//! `route_m = [[x, y], [x, y, heading_deg], ...]` of a command: the waypoints of mode 7.

use super::read::{Allowed, Table};
use super::value::{ANGLE, shown};
use rumbo_control::mode::waypoints::{FARTHEST_M, MAX_WAYPOINTS};
use rumbo_wire::message::{Command, Waypoint};

/// Coordinates of a waypoint or a goal.
pub(crate) const GOAL: Allowed = Allowed::new(-FARTHEST_M as f64, FARTHEST_M as f64, "m");
/// The keys that only go with a route.
pub(crate) const COMPANIONS: [&str; 2] = ["repeat", "frame"];

/// The commands that a route is sent as: its beginning, then a waypoint each.
pub(crate) fn read_route(table: &Table<'_, '_>) -> Vec<Command> {
    let repeat = table.flag("repeat").is_some_and(|flag| flag.value);
    let relative = table.text("frame").is_some_and(|frame| {
        let known = ["relative", "absolute"].contains(&frame.value.as_str());
        if !known {
            let remedy = "must be \"absolute\" (from the origin) or \"relative\" (from where the robot starts)";
            table.complain("frame", frame.line, &format!("{:?}", frame.value), remedy);
        }
        frame.value == "relative"
    });
    let what = "a list of waypoints [x, y] in m or [x, y, heading_deg]";
    let Some((line, items)) = table.items("route_m", what) else {
        return Vec::new();
    };
    if items.len() > MAX_WAYPOINTS {
        let remedy = format!("at most {MAX_WAYPOINTS} fit");
        table.complain(
            "route_m",
            line,
            &format!("{} waypoints", items.len()),
            &remedy,
        );
    }
    let mut commands = vec![Command::Route { repeat, relative }];
    for (number, item) in items.iter().enumerate() {
        let key = format!("route_m[{}]", number + 1);
        let parts: Vec<_> = item
            .value
            .as_array()
            .map(|parts| parts.iter().map(|part| part.get_ref()).collect())
            .unwrap_or_default();
        let (x, y, heading) = match parts[..] {
            [x, y] => (x, y, None),
            [x, y, heading] => (x, y, Some(heading)),
            _ => {
                let remedy = "must be [x, y] in m or [x, y, heading_deg]";
                table.complain(&key, item.line, &shown(item.value), remedy);
                continue;
            }
        };
        let judged = |value, allowed| table.judge_number(&key, item.line, value, allowed);
        let place = (judged(x, GOAL), judged(y, GOAL));
        let heading_deg = heading.map(|heading| judged(heading, ANGLE));
        if let ((Some(x_m), Some(y_m)), None | Some(Some(_))) = (place, heading_deg) {
            commands.push(Command::Waypoint(Waypoint {
                x_m: x_m as f32,
                y_m: y_m as f32,
                heading_rad: heading_deg.flatten().map(|deg| deg.to_radians() as f32),
            }));
        }
    }
    commands
}
