//! What was done by hand in a run, as changes of commands: a link carries them, and repeats them to the microsecond.
//!
//! In a link it is a text such as `0.5 arm*2.345 reference 0.4*7 route true false and waypoint 1 0`: the changes, each
//! with its time \[s\] and its commands, which are named as the page's orders are, with their values in order.

use rumbo_log::parameters;
use rumbo_session::Order;
use rumbo_wire::{Command, MovementLevel};
use serde_json::{Map, Value};
use std::collections::VecDeque;
use std::fmt::Display;

/// Most changes in a link.
pub(crate) const MOST: usize = 16;
/// Between changes, and between the commands of one.
const NEXT: &str = "*";
const AND: &str = " and ";

/// The orders with values that a link may give, besides [`Command::NAMED`]; those of a route are waypoints.
const ORDERS: [(&str, &[&str]); 9] = [
    ("mode", &["mode"]),
    ("reference", &["value"]),
    ("wheel_reference", &["left", "right"]),
    ("move_duty", &["movement", "duty"]),
    ("move_speed", &["movement", "speed_rad_s"]),
    ("goal", &["x_m", "y_m"]),
    ("set_param", &["id", "value"]),
    ("waypoint", &["x_m", "y_m", "heading_rad"]),
    (ROUTE, &["repeat", "relative"]),
];
const ROUTE: &str = "route";

/// Commands that the operator gave together, at this time of the target \[us\].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Change {
    pub(crate) t_us: u64,
    pub(crate) commands: Vec<Command>,
}

/// The text of these changes.
pub(crate) fn to_text(changes: &[Change]) -> String {
    let changes = changes.iter().map(|change| {
        let commands: Vec<String> = change.commands.iter().map(words).collect();
        format!("{} {}", change.t_us as f64 / 1e6, commands.join(AND))
    });
    changes.collect::<Vec<_>>().join(NEXT)
}

/// The orders in a text, in order of time, at most [`MOST`], and how many there are in it.
///
/// # Errors
/// What is wrong, and where.
pub(crate) fn from_text(text: &str) -> Result<(VecDeque<(u64, Order)>, usize), String> {
    let mut last_us = 0;
    let mut orders = VecDeque::new();
    for change in text.split(NEXT) {
        let wrong = |why: &dyn Display| format!("{change:?}: {why}");
        let (t_s, commands) = change.split_once(' ').unwrap_or((change, ""));
        let t_s = t_s.parse::<f64>().map_err(|error| wrong(&error))?;
        let t_us = (t_s * 1e6).round() as u64;
        if !t_s.is_finite() || t_s < 0.0 || t_us < last_us {
            return Err(wrong(&"times are in s, in order"));
        }
        last_us = t_us;
        orders.push_back((t_us, order(commands).map_err(|why| wrong(&why))?));
    }
    let count = orders.len();
    orders.truncate(MOST);
    Ok((orders, count))
}

/// The command as an order in words.
fn words(command: &Command) -> String {
    match command {
        Command::Mode(mode) => format!("mode {}", *mode as u8),
        Command::Reference(value) => format!("reference {value}"),
        Command::WheelReference(wheels) => {
            format!("wheel_reference {} {}", wheels.left, wheels.right)
        }
        Command::Move { movement, level } => {
            let movement = *movement as u8;
            match level {
                MovementLevel::Duty(duty) => format!("move_duty {movement} {duty}"),
                MovementLevel::Speed(speed_rad_s) => format!("move_speed {movement} {speed_rad_s}"),
            }
        }
        Command::Goal { x_m, y_m } => format!("goal {x_m} {y_m}"),
        Command::SetParam { id, value } => {
            let name = rumbo_log::parameter(*id).map_or("", |parameter| parameter.name);
            format!("set_param {name} {value}")
        }
        Command::Route { repeat, relative } => format!("{ROUTE} {repeat} {relative}"),
        Command::Waypoint(at) => match at.heading_rad {
            Some(heading_rad) => format!("waypoint {} {} {heading_rad}", at.x_m, at.y_m),
            None => format!("waypoint {} {}", at.x_m, at.y_m),
        },
        // Nobody gives any other: the session asks by itself.
        other => {
            let mut named = Command::NAMED.into_iter();
            named
                .find(|(_, command)| command == other)
                .map_or_else(String::new, |(name, _)| name.into())
        }
    }
}

/// The order of these commands, by the checks of the page's orders.
fn order(commands: &str) -> Result<Order, String> {
    let mut messages = commands.split(AND).map(message);
    let mut first = messages.next().ok_or("no command")??;
    let more = messages.collect::<Result<Vec<_>, _>>()?;
    if first.get("type").is_some_and(|kind| kind == ROUTE) {
        let waypoints = more.into_iter().map(|mut waypoint| {
            waypoint.remove("type");
            Value::from(waypoint)
        });
        first.insert("waypoints".into(), waypoints.collect());
    } else if !more.is_empty() {
        return Err("only a route has more than one command".into());
    }
    let json = Value::from(first).to_string();
    json.parse::<Order>().map_err(|error| error.to_string())
}

/// A command as a page writes it.
fn message(words: &str) -> Result<Map<String, Value>, String> {
    let mut words = words.split_whitespace();
    let kind = words.next().unwrap_or_default();
    let named = Command::NAMED.map(|(name, _)| (name, &[][..]));
    let mut orders = named.into_iter().chain(ORDERS);
    let (_, fields) = orders
        .find(|(name, _)| *name == kind)
        .ok_or_else(|| format!("there is no command `{kind}`"))?;
    let mut message = Map::from_iter([("type".to_owned(), Value::from(kind))]);
    for (field, word) in fields.iter().zip(&mut words) {
        let value = match *field {
            "id" => parameters()
                .position(|parameter| parameter.name == word)
                .map(Value::from)
                .ok_or_else(|| format!("there is no parameter `{word}`"))?,
            _ => word
                .parse::<Value>()
                .map_err(|_| format!("`{word}` is no value"))?,
        };
        message.insert((*field).to_owned(), value);
    }
    match words.next() {
        Some(more) => Err(format!("`{more}` is one value too many")),
        None => Ok(message),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::Wheels;
    use rumbo_control::mode::waypoints::Waypoint;
    use rumbo_control::mode::{ModeId, Movement};
    use rumbo_control::params::ParamId;

    #[test]
    fn what_is_written_is_read_to_the_last_bit() {
        let third = 1.0_f32 / 3.0;
        let valued = [
            Command::Mode(ModeId::WallFollow),
            Command::Reference(third),
            Command::Reference(1e-7),
            Command::WheelReference(Wheels {
                left: -third,
                right: 6.283_185_5,
            }),
            Command::Move {
                movement: Movement::ArcLeft,
                level: MovementLevel::Duty(0.4),
            },
            Command::Move {
                movement: Movement::Backward,
                level: MovementLevel::Speed(third),
            },
            Command::Goal {
                x_m: -0.05,
                y_m: third,
            },
            Command::SetParam {
                id: ParamId::FrontKp as u8,
                value: third,
            },
        ];
        let place = |heading_rad| {
            Command::Waypoint(Waypoint {
                x_m: 1.0,
                y_m: -third,
                heading_rad,
            })
        };
        let route = vec![
            Command::Route {
                repeat: true,
                relative: false,
            },
            place(None),
            place(Some(third)),
        ];
        let named = Command::NAMED.map(|(_, command)| command);
        for (number, command) in (1..).zip(named.into_iter().chain(valued)) {
            let t_us = number * 4_005_000;
            let commands = vec![command];
            let text = to_text(&[Change { t_us, commands }]);
            let (orders, count) = from_text(&text).unwrap();
            assert_eq!(orders, [(t_us, Order::Robot(command))], "{text}");
            assert_eq!(count, 1);
        }
        let (t_us, commands) = (1_000_000, route.clone());
        let text = to_text(&[Change { t_us, commands }]);
        assert_eq!(from_text(&text).unwrap().0, [(t_us, Order::Route(route))]);
    }

    #[test]
    fn a_text_that_is_none_says_where_and_one_that_is_too_long_is_cut() {
        let why = |text| from_text(text).unwrap_err();
        for (text, part) in [
            ("", "empty string"),
            ("1", "there is no command ``"),
            ("1 fly", "\"1 fly\": there is no command `fly`"),
            ("2 arm*1 stop", "\"1 stop\": times are in s, in order"),
            ("NaN arm", "times are in s"),
            ("1 reference", "missing field"),
            ("1 reference 1 2", "`2` is one value too many"),
            ("1 reference 1e60", "too large"),
            ("1 set_param warp 9", "there is no parameter `warp`"),
            ("1 mode 77", "there is no mode 77"),
            ("1 arm and stop", "only a route"),
            ("1 route true false and arm", "missing field"),
            ("1 reference [1]", "invalid type"),
        ] {
            assert!(why(text).contains(part), "{text}: {}", why(text));
        }
        let many = vec!["1 stop"; MOST + 4].join(NEXT);
        let (orders, count) = from_text(&many).unwrap();
        assert_eq!((orders.len(), count), (MOST, MOST + 4));
    }
}
