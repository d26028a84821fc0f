//! Orders of a page: parses JSON text into a checked order.

use crate::program::{GivenProgram, SketchFile};
use crate::world::{WorldAct, WorldOrder};
use rumbo_control::mode::waypoints::{MAX_WAYPOINTS, Waypoint};
use rumbo_control::mode::{ModeId, Movement};
use rumbo_control::params::ParamId;
use rumbo_control::rig::Rig;
use rumbo_control::{Velocity, Wheels};
use rumbo_log::Choice;
use rumbo_wire::{Command, LineEnding, MovementLevel};
use serde::Deserialize;
use serde_json::{Number, Value};
use std::fmt;
use std::str::FromStr;

/// Largest speed factor: more than a core can simulate does not help.
pub const MAX_SPEED: f64 = 100.0;
/// Longest name of a scenario or world.
const MAX_NAME: usize = 100;
/// Largest seed of a page, whose numbers are exact up to there: 2^53 - 1.
const MAX_SEED: u64 = (1 << 53) - 1;
/// Longest line typed.
const MAX_LINE: usize = 200;

/// Longest order; only one with a program is longer than [`WORLD_ORDER`] \[bytes\].
pub const MAX_ORDER: usize = 1_500_000;
/// Longest order without a program or a world \[bytes\].
pub const SHORT_ORDER: usize = 4_096;
/// Longest order with a world, which has some hundreds of shapes \[bytes\].
pub const WORLD_ORDER: usize = 100_000;

/// What the session is to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// A command for the robot.
    Robot(Command),
    /// A movement that lasts while the page repeats it, as long as a key is held down.
    Hold(Command),
    /// A velocity for mode 10, which the sender repeats while the robot is to move. Only the newest one is sent.
    Velocity(Velocity),
    /// A route for the robot: the command that begins it and its waypoints.
    Route(Vec<Command>),
    /// A line for a USART of an emulated chip.
    Type(u8, String),
    /// Seconds of the target per second of the wall clock; 0 pauses.
    Speed(f64),
    /// Start the simulation again.
    Reset(Choice),
    /// Let the robot calibrate itself.
    Calibrate,
    /// Start again, and let the scenario command the robot.
    Play,
    /// Show a log from this time on \[s\].
    Seek(f64),
    /// Show a log this many telemetry frames further on, or back.
    Step(i32),
    /// Take control for the page, even from another one; the session need not know.
    TakeControl,
    /// Release the page's control; the session need not know.
    ReleaseControl,
    /// Start the ghost again where the robot is.
    RestartGhost,
    /// Run this program on the emulated chip.
    Program(GivenProgram),
    /// Show the source of the program that runs, or of an example by its name, in answer to this ticket.
    Sketch(u32, Option<String>),
    /// A request of the Debug Adapter Protocol to the debugger of the program that runs.
    Debug(Value),
    /// Count the cycles of the program on the emulated chip, from zero, or no longer.
    Profile(bool),
    /// Show, check or drive in a world that the page edits.
    World(WorldOrder),
}

/// The orders to execute when STOP was pressed (`stop`): no older command to the robot comes after it.
///
/// The flag is raised before STOP enters the queue, so a STOP that is not in `waiting` is newer than all that is.
/// Of several resets only the last one counts: the others would only delay a STOP.
pub fn stop_first(mut waiting: Vec<Order>, stop: bool) -> Vec<Order> {
    let is_reset = |order: &Order| matches!(order, Order::Reset(_));
    if let Some(last) = waiting.iter().rposition(is_reset) {
        let mut number = 0..;
        waiting.retain(|order| number.next() == Some(last) || !is_reset(order));
    }
    if !stop {
        return waiting;
    }
    let is_stop = |order: &Order| *order == Order::Robot(Command::Stop);
    let newer = match waiting.iter().rposition(is_stop) {
        Some(last) => waiting.split_off(last + 1),
        None => Vec::new(),
    };
    waiting.retain(|order| matches!(order, Order::Speed(_) | Order::Reset(_) | Order::World(_)));
    [vec![Order::Robot(Command::Stop)], waiting, newer].concat()
}

/// Why a text is not an order.
#[derive(Debug)]
pub struct BadOrder(String);

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
    TakeControl {},
    ReleaseControl {},
    RestartGhost {},
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
        #[serde(default)]
        held: bool,
    },
    MoveSpeed {
        movement: u8,
        speed_rad_s: f32,
        #[serde(default)]
        held: bool,
    },
    Velocity {
        forward_m_s: f32,
        yaw_rad_s: f32,
    },
    Goal {
        x_m: f32,
        y_m: f32,
    },
    Lane {},
    Route {
        repeat: bool,
        relative: bool,
        waypoints: Vec<Place>,
    },
    Waypoint(Place),
    Rig {
        rig: String,
    },
    SetParam {
        id: u8,
        value: f32,
    },
    ResetParams {},
    SaveParams {},
    ResetPose {},
    Calibrate {},
    Play {},
    Type {
        usart: u8,
        text: String,
        /// LF where it is left out.
        ending: Option<String>,
    },
    Speed {
        factor: f64,
    },
    Program {
        name: String,
        /// An only file, in base 64.
        data: Option<String>,
        #[serde(default)]
        files: Vec<SketchFile>,
        #[serde(default)]
        debug: bool,
        robot: Option<String>,
    },
    Sketch {
        ticket: u32,
        example: Option<String>,
    },
    Debug {
        request: Value,
    },
    Profile {
        on: bool,
    },
    World {
        ticket: u32,
        act: WorldAct,
        #[serde(default)]
        text: String,
    },
    Seek {
        t_s: f64,
    },
    Step {
        frames: i32,
    },
    Reset {
        scenario: String,
        world: Option<String>,
        #[serde(default)]
        rig: Option<String>,
        seed: Number,
    },
}

/// A waypoint of a route, as it is written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Place {
    x_m: f32,
    y_m: f32,
    #[serde(default)]
    heading_rad: Option<f32>,
}

/// A line as a person types it.
fn text_line(text: String, ending: Option<&str>) -> Result<String, BadOrder> {
    let ending = ending.map_or(Some(LineEnding::default()), LineEnding::named);
    let ending = ending.ok_or_else(|| {
        let known = LineEnding::ALL.map(LineEnding::name).join(", ");
        BadOrder(format!("the ending of a line is one of {known}"))
    })?;
    let printable = text.bytes().all(|byte| (b' '..=b'~').contains(&byte));
    let bytes = ending.typed(&text).collect();
    match String::from_utf8(bytes) {
        Ok(line) if printable && text.len() <= MAX_LINE => Ok(line),
        _ => Err(BadOrder(format!(
            "a line is at most {MAX_LINE} characters of ASCII"
        ))),
    }
}

impl FromStr for Order {
    type Err = BadOrder;

    /// The order in a page's text. A page that sends anything else is not ours, and its connection is to be closed.
    fn from_str(text: &str) -> Result<Self, BadOrder> {
        let longest = match text {
            _ if text.starts_with("{\"type\":\"program\"") => usize::MAX,
            _ if text.starts_with("{\"type\":\"world\"") => WORLD_ORDER,
            _ => SHORT_ORDER,
        };
        if text.len() > longest {
            return Err(BadOrder(format!("longer than {longest} bytes")));
        }
        // The error repeats an unknown name as it was sent, ends of lines included.
        let one_line = |why: String| why.replace(char::is_control, "\u{fffd}");
        let message: Message =
            serde_json::from_str(text).map_err(|error| BadOrder(one_line(error.to_string())))?;
        let order = match message {
            Message::Stop {} => Order::Robot(Command::Stop),
            Message::TakeControl {} => Order::TakeControl,
            Message::ReleaseControl {} => Order::ReleaseControl,
            Message::RestartGhost {} => Order::RestartGhost,
            Message::Arm {} => Order::Robot(Command::Arm),
            Message::Disarm {} => Order::Robot(Command::Disarm),
            Message::ClearFault {} => Order::Robot(Command::ClearFault),
            Message::Mode { mode } => Order::Robot(Command::Mode(
                ModeId::from_number(mode)
                    .ok_or_else(|| BadOrder(format!("there is no mode {mode}")))?,
            )),
            Message::Reference { value } => {
                Order::Robot(Command::Reference(finite("value", value)?))
            }
            Message::WheelReference { left, right } => {
                Order::Robot(Command::WheelReference(Wheels {
                    left: finite("left", left)?,
                    right: finite("right", right)?,
                }))
            }
            Message::MoveDuty {
                movement,
                duty,
                held,
            } => move_order(movement, MovementLevel::Duty(finite("duty", duty)?), held)?,
            Message::MoveSpeed {
                movement,
                speed_rad_s,
                held,
            } => move_order(
                movement,
                MovementLevel::Speed(finite("speed_rad_s", speed_rad_s)?),
                held,
            )?,
            Message::Velocity {
                forward_m_s,
                yaw_rad_s,
            } => Order::Velocity(Velocity {
                forward_m_s: finite("forward_m_s", forward_m_s)?,
                yaw_rad_s: finite("yaw_rad_s", yaw_rad_s)?,
            }),
            Message::Goal { x_m, y_m } => Order::Robot(Command::Goal {
                x_m: finite("x_m", x_m)?,
                y_m: finite("y_m", y_m)?,
            }),
            Message::Lane {} => Order::Robot(Command::Lane),
            Message::Route {
                repeat,
                relative,
                waypoints,
            } => route(Command::Route { repeat, relative }, waypoints)?,
            Message::Waypoint(place) => Order::Robot(waypoint(place)?),
            Message::Rig { rig } => Order::Robot(rig_command(&rig)?),
            Message::SetParam { id, value } => Order::Robot(Command::SetParam {
                id,
                value: finite("value", value)?,
            }),
            Message::ResetParams {} => Order::Robot(Command::ResetParams),
            Message::SaveParams {} => Order::Robot(Command::SaveParams),
            Message::ResetPose {} => Order::Robot(Command::ResetPose),
            Message::Calibrate {} => Order::Calibrate,
            Message::Play {} => Order::Play,
            Message::Type {
                usart,
                text,
                ending,
            } => Order::Type(usart, text_line(text, ending.as_deref())?),
            Message::Speed { factor } if (0.0..=MAX_SPEED).contains(&factor) => {
                Order::Speed(factor)
            }
            Message::Speed { factor } => {
                return Err(BadOrder(format!(
                    "factor {factor} is not within 0 to {MAX_SPEED}"
                )));
            }
            Message::Program {
                name,
                data,
                files,
                debug,
                robot,
            } => Order::Program(GivenProgram {
                robot,
                ..GivenProgram::of(name, data, files, debug).map_err(BadOrder)?
            }),
            Message::Sketch { ticket, example } => Order::Sketch(ticket, example),
            Message::Debug { request } => Order::Debug(request),
            Message::Profile { on } => Order::Profile(on),
            Message::World { ticket, act, text } => Order::World(WorldOrder { ticket, act, text }),
            Message::Seek { t_s } if t_s.is_finite() => Order::Seek(t_s),
            Message::Seek { .. } => return Err(BadOrder("t_s is too large".into())),
            Message::Step { frames } => Order::Step(frames),
            Message::Reset {
                scenario,
                world,
                rig,
                seed,
            } => {
                let names = [Some(&scenario), world.as_ref(), rig.as_ref()];
                if names
                    .into_iter()
                    .flatten()
                    .any(|name| name.len() > MAX_NAME)
                {
                    return Err(BadOrder(format!("a name is longer than {MAX_NAME} bytes")));
                }
                let exact = seed.as_u64().filter(|seed| *seed <= MAX_SEED);
                Order::Reset(Choice {
                    scenario,
                    world,
                    rig,
                    seed: exact.ok_or_else(|| {
                        BadOrder(format!(
                            "seed {seed} is no whole number from 0 to {MAX_SEED}; give one"
                        ))
                    })?,
                })
            }
        };
        Ok(order)
    }
}

/// A route in the commands that make it.
fn route(begin: Command, places: Vec<Place>) -> Result<Order, BadOrder> {
    if places.is_empty() || places.len() > MAX_WAYPOINTS {
        let count = places.len();
        return Err(BadOrder(format!(
            "a route has 1 to {MAX_WAYPOINTS} waypoints, not {count}"
        )));
    }
    let waypoints = places.into_iter().map(waypoint);
    let commands = std::iter::once(Ok(begin)).chain(waypoints);
    Ok(Order::Route(commands.collect::<Result<_, _>>()?))
}

fn waypoint(place: Place) -> Result<Command, BadOrder> {
    Ok(Command::Waypoint(Waypoint {
        x_m: finite("x_m", place.x_m)?,
        y_m: finite("y_m", place.y_m)?,
        heading_rad: match place.heading_rad {
            Some(heading_rad) => Some(finite("heading_rad", heading_rad)?),
            None => None,
        },
    }))
}

/// The commands that set the robot's rig.
fn rig_command(name: &str) -> Result<Command, BadOrder> {
    let rig = Rig::ALL.into_iter().find(|rig| rig.name() == name);
    let rig = rig.ok_or_else(|| {
        let known = Rig::ALL.map(Rig::name).join(", ");
        BadOrder(format!("there is no rig `{name}`; known are {known}"))
    })?;
    Ok(Command::SetParam {
        id: ParamId::Rig as u8,
        value: f32::from(rig as u8),
    })
}

fn move_order(movement: u8, level: MovementLevel, held: bool) -> Result<Order, BadOrder> {
    let movement = Movement::from_number(movement)
        .ok_or_else(|| BadOrder(format!("there is no movement {movement}")))?;
    let command = Command::Move { movement, level };
    Ok(if held {
        Order::Hold(command)
    } else {
        Order::Robot(command)
    })
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
mod tests;
