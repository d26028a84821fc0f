//! What a page may ask: JSON text to a checked order.

use crate::target::Choice;
use rumbo_control::Wheels;
use rumbo_control::mode::{ModeId, Movement};
use rumbo_wire::{Command, Level};
use serde::Deserialize;
use std::fmt;

/// Largest speed factor: more than a core can simulate does not help.
pub(crate) const MAX_SPEED: f64 = 100.0;
/// Longest name of a scenario or world.
const MAX_NAME: usize = 100;

/// What the session is to do.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Order {
    /// A command for the robot.
    Robot(Command),
    /// Seconds of the target per second of the wall clock; 0 pauses.
    Speed(f64),
    /// Start the simulation again.
    Reset(Choice),
}

/// The orders as they are to be obeyed when STOP was pressed (`stop`): no older command to the robot comes after it.
///
/// The flag is raised before STOP enters the queue, so a STOP that is not in `waiting` is newer than all that is.
pub(crate) fn stop_first(mut waiting: Vec<Order>, stop: bool) -> Vec<Order> {
    if !stop {
        return waiting;
    }
    let is_stop = |order: &Order| *order == Order::Robot(Command::Stop);
    let newer = match waiting.iter().rposition(is_stop) {
        Some(last) => waiting.split_off(last + 1),
        None => Vec::new(),
    };
    waiting.retain(|order| !matches!(order, Order::Robot(_)));
    [vec![Order::Robot(Command::Stop)], waiting, newer].concat()
}

/// Why a text is no order.
#[derive(Debug)]
pub(crate) struct BadOrder(String);

impl fmt::Display for BadOrder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "not understood: {}", self.0)
    }
}

/// The messages of a page, as they are written.
#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
enum Message {
    Stop {},
    Arm {},
    Disarm {},
    ClearFault {},
    Mode {
        mode: u8,
    },
    Reference {
        value: f32,
    },
    WheelReference {
        left: f32,
        right: f32,
    },
    MoveDuty {
        movement: u8,
        duty: f32,
    },
    MoveSpeed {
        movement: u8,
        speed_rad_s: f32,
    },
    SetParam {
        id: u8,
        value: f32,
    },
    ResetParams {},
    ResetPose {},
    Speed {
        factor: f64,
    },
    Reset {
        scenario: String,
        world: Option<String>,
        seed: u64,
    },
}

/// The order in a page's text.
///
/// # Errors
/// [`BadOrder`] with what is wrong; such a page is not ours and its connection is to be closed.
pub(crate) fn parse(text: &str) -> Result<Order, BadOrder> {
    let message: Message =
        serde_json::from_str(text).map_err(|error| BadOrder(error.to_string()))?;
    let order = match message {
        Message::Stop {} => Order::Robot(Command::Stop),
        Message::Arm {} => Order::Robot(Command::Arm),
        Message::Disarm {} => Order::Robot(Command::Disarm),
        Message::ClearFault {} => Order::Robot(Command::ClearFault),
        Message::Mode { mode } => Order::Robot(Command::Mode(
            ModeId::from_number(mode)
                .ok_or_else(|| BadOrder(format!("there is no mode {mode}")))?,
        )),
        Message::Reference { value } => Order::Robot(Command::Reference(finite("value", value)?)),
        Message::WheelReference { left, right } => Order::Robot(Command::WheelReference(Wheels {
            left: finite("left", left)?,
            right: finite("right", right)?,
        })),
        Message::MoveDuty { movement, duty } => {
            move_order(movement, Level::Duty(finite("duty", duty)?))?
        }
        Message::MoveSpeed {
            movement,
            speed_rad_s,
        } => move_order(movement, Level::Speed(finite("speed_rad_s", speed_rad_s)?))?,
        Message::SetParam { id, value } => Order::Robot(Command::SetParam {
            id,
            value: finite("value", value)?,
        }),
        Message::ResetParams {} => Order::Robot(Command::ResetParams),
        Message::ResetPose {} => Order::Robot(Command::ResetPose),
        Message::Speed { factor } if (0.0..=MAX_SPEED).contains(&factor) => Order::Speed(factor),
        Message::Speed { factor } => {
            return Err(BadOrder(format!(
                "factor {factor} is not within 0 to {MAX_SPEED}"
            )));
        }
        Message::Reset {
            scenario,
            world,
            seed,
        } => {
            if scenario.len() > MAX_NAME
                || world.as_ref().is_some_and(|world| world.len() > MAX_NAME)
            {
                return Err(BadOrder(format!("a name is longer than {MAX_NAME} bytes")));
            }
            Order::Reset(Choice {
                scenario,
                world,
                seed,
            })
        }
    };
    Ok(order)
}

fn move_order(movement: u8, level: Level) -> Result<Order, BadOrder> {
    let movement = Movement::ALL
        .into_iter()
        .find(|each| *each as u8 == movement)
        .ok_or_else(|| BadOrder(format!("there is no movement {movement}")))?;
    Ok(Order::Robot(Command::Move { movement, level }))
}

/// A number too large for the robot's 32 bits has become infinite.
fn finite(field: &str, value: f32) -> Result<f32, BadOrder> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(BadOrder(format!("{field} is too large")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_order_of_the_page_is_understood() {
        let reference = parse(r#"{"type":"reference","value":0.5}"#).unwrap();
        assert_eq!(reference, Order::Robot(Command::Reference(0.5)));
        assert_eq!(
            parse(r#"{"type":"stop"}"#).unwrap(),
            Order::Robot(Command::Stop)
        );
        assert_eq!(
            parse(r#"{"type":"mode","mode":1}"#).unwrap(),
            Order::Robot(Command::Mode(ModeId::FrontDistance))
        );
        let reset = parse(r#"{"type":"reset","scenario":"mode1","world":null,"seed":3}"#).unwrap();
        assert_eq!(
            reset,
            Order::Reset(Choice {
                scenario: "mode1".into(),
                world: None,
                seed: 3
            })
        );
    }

    #[test]
    fn nothing_asked_before_stop_is_done_after_it() {
        let robot = Order::Robot;
        let waiting = vec![
            robot(Command::Arm),
            Order::Speed(2.0),
            robot(Command::Stop),
            robot(Command::ClearFault),
        ];
        let obeyed = [
            robot(Command::Stop),
            Order::Speed(2.0),
            robot(Command::ClearFault),
        ];
        assert_eq!(stop_first(waiting, true), obeyed);
        assert_eq!(
            stop_first(vec![robot(Command::Arm)], true),
            [robot(Command::Stop)]
        );
        assert_eq!(
            stop_first(vec![robot(Command::Arm)], false),
            [robot(Command::Arm)]
        );
    }

    #[test]
    fn what_is_no_order_says_why() {
        for (text, why) in [
            ("\u{0}\u{1}", "expected value"),
            ("{}", "missing field `type`"),
            (r#"{"type":"fly"}"#, "unknown variant `fly`"),
            (r#"{"type":"stop","now":true}"#, "unknown field `now`"),
            (r#"{"type":"mode","mode":9}"#, "no mode 9"),
            (r#"{"type":"mode","mode":-1}"#, "invalid value"),
            (r#"{"type":"reference","value":"NaN"}"#, "invalid type"),
            (r#"{"type":"reference","value":1e300}"#, "too large"),
            (r#"{"type":"speed","factor":-1}"#, "not within"),
            (
                r#"{"type":"move_duty","movement":99,"duty":0.1}"#,
                "no movement 99",
            ),
        ] {
            let said = parse(text).unwrap_err().to_string();
            assert!(said.contains(why), "{text}: {said}");
        }
    }
}
