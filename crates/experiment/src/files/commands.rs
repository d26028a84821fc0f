//! The `[[command]]` tables of a scenario: what the station sends to the robot, and when.
//!
//! Each has `at_s` and one action. With `after_reached = true` it is sent earlier, as soon as the robot reports that it
//! has reached the previous command's reference: `at_s` is then the latest time.
//!
//! | keys | does |
//! |---|---|
//! | `arm = true`, `disarm = true`, `stop = true` | arm and start the mode; end it; release the wheels at once |
//! | `clear_fault = true`, `reset_pose = true` | clear a latched fault; make the present pose the origin |
//! | `mode = "wheel_speed"` | select a mode (the robot must be disarmed) |
//! | `reference_m = 0.3` | modes `front_distance`, `front_align`, `wall_follow`: the distance to hold |
//! | `speed_rpm = 60` | modes `wheel_speed`, `straight_line` |
//! | `left_rpm = 60` and `right_rpm = 50` | mode `wheel_speed` |
//! | `goal_m = [1.0, 0.5]` | modes `mission`, `waypoints`: a point to go to |
//! | `goal = "world"` | the same with the goal of a random world |
//! | `route_m = [[1, 0], [1, 1, 90]]` | mode `waypoints`: positions, each with an optional heading in deg |
//! | the same with `repeat = true`, `frame = "relative"` | repeatedly; relative to the pose where the robot starts |
//! | `lane = true` | mode `mission`: follow a lane |
//! | `move = "turn_left"` with `duty = 0.4` or `speed_rpm = 60` | mode `manual`, a basic movement |
//! | the same with `duty = 0`, `ramp_to_duty = 0.4`, `ramp_s = 12` | open loop, the duty moves by one count of PWM at a time |
//! | `parameter = "name"` and `value = 1.5` | set a control parameter |
//! | `press = "start"`, with `to = 0.7` or `to = "ok"` | press a button, put a switch or a potentiometer, press a key of a remote control |
//! | `text = "F"` or `usb = "F"`, `line_ending = "none"` | type a line: [`typed`] |

use super::error::FileError;
use super::names::{find_mode, find_movement};
use super::parameters;
use super::read::{Allowed, Source, Table};
use super::route::{self, GOAL, read_route};
use super::typed::{self, TimedText, read_typed};
use super::word::WordError;
use rumbo_control::mode::{Description, ModeId, Movement, ReferenceKind, Takes};
use rumbo_control::{Duty, Wheels};
use rumbo_wire::message::{Command, MovementLevel};
use std::f64::consts::PI;

const DISTANCE: Allowed = Allowed::new(0.02, 2.5, "m");
const SPEED: Allowed = Allowed::new(-200.0, 200.0, "rpm");
const MOVE_SPEED: Allowed = Allowed::new(0.0, 200.0, "rpm");
const DUTY: Allowed = Allowed::new(0.0, 1.0, "");
/// Commands of a scenario or of one of its robots. A person types no more in an hour.
pub(super) const MOST_COMMANDS: usize = 10_000;
/// Minimum time between the commands of a ramp: each is answered before the next is sent.
const RAMP_STEP_S: f64 = 0.1;

/// The actions that are a bare `true`.
const FLAGS: [(&str, Command); 6] = [
    ("arm", Command::Arm),
    ("disarm", Command::Disarm),
    ("stop", Command::Stop),
    ("clear_fault", Command::ClearFault),
    ("reset_pose", Command::ResetPose),
    ("lane", Command::Lane),
];
/// The keys that select the action of a command.
const ACTIONS: [&str; 15] = [
    "arm",
    "disarm",
    "stop",
    "clear_fault",
    "reset_pose",
    "lane",
    "mode",
    "reference_m",
    "goal_m",
    "goal",
    "route_m",
    "move",
    "speed_rpm",
    "left_rpm",
    "parameter",
];
/// The keys that only go with an action.
const COMPANIONS: [&str; 5] = ["right_rpm", "value", "duty", "ramp_to_duty", "ramp_s"];

/// A command and when the station sends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedCommand {
    /// Time since the start, in s.
    pub at_s: f64,
    /// It is sent earlier, as soon as the robot reports that it has reached the previous command's reference.
    pub after_reached: bool,
    /// What is sent, in the units of the link (m, rad/s, fraction of full PWM).
    pub command: Command,
    /// The goal is the one of the seed's world: `command` is put in by [`super::Setup::of_seed`].
    pub goal_of_world: bool,
}

/// Reads all commands and typed lines; `mode` is the mode selected at the start, if valid: mistakes in it have been
/// reported.
pub(crate) fn read_commands(
    tables: Vec<Table<'_, '_>>,
    mut mode: Option<ModeId>,
    duration_s: f64,
) -> (Vec<TimedCommand>, Vec<TimedText>) {
    let (mut commands, mut texts): (Vec<TimedCommand>, _) = (Vec::new(), Vec::new());
    let mut earliest_s = 0.0;
    for table in tables {
        let at = table.placed_number("at_s", Allowed::new(0.0, duration_s, "s"));
        if !table.has("at_s") {
            table.complain_here("at_s is missing: the time of the command in s since the start");
        }
        let at_s = at.map_or(earliest_s, |at| at.value);
        if let Some(at) = at
            && at.value < earliest_s
        {
            let remedy = format!(
                "must be {earliest_s} or more: commands stand in order of time, after the end of a ramp"
            );
            table.complain("at_s", at.line, &at.value.to_string(), &remedy);
        }
        if table.has(typed::PRESS) {
            texts.extend(typed::read_press(&table, at_s));
            earliest_s = at_s.max(earliest_s);
            table.finish();
            continue;
        }
        if table.has(typed::PLACE) {
            texts.extend(typed::read_place(&table, at_s));
            earliest_s = at_s.max(earliest_s);
            table.finish();
            continue;
        }
        if let Some(port) = typed::PORTS.into_iter().find(|(key, _)| table.has(key)) {
            texts.extend(read_typed(&table, at_s, port));
            earliest_s = at_s.max(earliest_s);
            table.finish();
            continue;
        }
        let after_reached = table.flag("after_reached").is_some_and(|flag| flag.value);
        let mut group = read_command(&table, at_s, &mut mode, duration_s);
        if let Some(first) = group.first_mut() {
            first.after_reached = after_reached;
        }
        commands.append(&mut group);
        earliest_s = commands
            .last()
            .map_or(earliest_s, |last| last.at_s.max(earliest_s));
        table.finish();
    }
    (commands, texts)
}

/// Reads the keys of one command, without `at_s`, for a robot in this mode: at once, so that no ramp is among them.
///
/// # Errors
/// All problems of the text.
pub(crate) fn read_one(text: &str, mode: ModeId) -> Result<Vec<TimedCommand>, FileError> {
    let source = Source::new("command", text);
    let parsed = source.parse()?;
    let table = source.root(&parsed);
    for key in ["at_s", "after_reached", "ramp_to_duty", "ramp_s"] {
        if table.has(key) {
            table.complain_here(&format!(
                "{key} goes with the commands of a scenario; this one is applied at once"
            ));
        }
    }
    let commands = read_command(&table, 0.0, &mut Some(mode), 0.0);
    table.finish();
    drop(table);
    source.verdict()?;
    Ok(commands)
}

/// One command: a list, since a ramp or a route is many.
fn read_command(
    table: &Table<'_, '_>,
    at_s: f64,
    mode: &mut Option<ModeId>,
    duration_s: f64,
) -> Vec<TimedCommand> {
    let given: Vec<&str> = ACTIONS.into_iter().filter(|key| table.has(key)).collect();
    let single = |command| {
        vec![TimedCommand {
            at_s,
            command,
            after_reached: false,
            goal_of_world: false,
        }]
    };
    match given[..] {
        ["move"] | ["move", "speed_rpm"] => {
            needs_mode(
                table,
                "move",
                |mode| mode.takes == Some(Takes::Movements),
                *mode,
            );
            read_move(table, at_s, duration_s)
        }
        ["goal"] => {
            needs_mode(table, "goal", takes(&[ReferenceKind::Goal]), *mode);
            read_goal_of_world(table, at_s)
        }
        ["route_m"] => {
            let route = |mode: &Description| matches!(mode.takes, Some(Takes::Route(_)));
            needs_mode(table, "route_m", route, *mode);
            read_route(table).into_iter().flat_map(single).collect()
        }
        [key] => read_simple(table, key, mode)
            .map(single)
            .unwrap_or_default(),
        _ => {
            complain_of_actions(table, &given);
            Vec::new()
        }
    }
}

/// Complains of a command without an action, or with several.
fn complain_of_actions(table: &Table<'_, '_>, given: &[&str]) {
    let known = [
        &["at_s", "after_reached"][..],
        &ACTIONS,
        &COMPANIONS,
        &route::COMPANIONS,
        &typed::PORTS.map(|(key, _)| key),
        &[typed::ENDING, typed::PRESS, typed::VALUE, typed::HELD],
    ]
    .concat();
    for key in &known {
        table.value(key);
    }
    // An unknown key is probably the missing action, and is reported anyway.
    let all_known = table.keys().iter().all(|key| known.contains(&key.value));
    match given {
        [] if all_known => table.complain_here(&format!(
            "has no action: give one of {}",
            ACTIONS.join(", ")
        )),
        [] => {}
        _ => table.complain_here(&format!(
            "has more than one action ({}): give each its own [[command]]",
            given.join(", ")
        )),
    }
}

fn read_simple(table: &Table<'_, '_>, key: &str, mode: &mut Option<ModeId>) -> Option<Command> {
    if let Some((_, command)) = FLAGS.into_iter().find(|(flag, _)| *flag == key) {
        let flag = table.flag(key)?;
        if !flag.value {
            let remedy = "must be true, or leave the command out";
            table.complain(key, flag.line, "false", remedy);
        }
        if command == Command::Lane {
            needs_mode(table, key, |mode| mode.takes == Some(Takes::Lane), *mode);
        }
        return Some(command);
    }
    match key {
        "mode" => {
            let word = table.word(key)?;
            *mode = find_mode(&word.value)
                .map_err(|remedy| table.complain(key, word.line, &word.value, &remedy.to_string()))
                .ok();
            mode.map(Command::Mode)
        }
        "reference_m" => {
            needs_mode(table, key, takes(&[ReferenceKind::Distance]), *mode);
            Some(Command::Reference(table.number(key, DISTANCE)? as f32))
        }
        "goal_m" => {
            needs_mode(table, key, takes(&[ReferenceKind::Goal]), *mode);
            let [x_m, y_m] = table.pair(key, GOAL)?.map(|place| place as f32);
            Some(Command::Goal { x_m, y_m })
        }
        "speed_rpm" => {
            let kinds = [ReferenceKind::WheelSpeed, ReferenceKind::Speed];
            needs_mode(table, key, takes(&kinds), *mode);
            Some(Command::Reference(rad_s(table.number(key, SPEED)?)))
        }
        "left_rpm" => {
            needs_mode(table, key, takes(&[ReferenceKind::WheelSpeed]), *mode);
            let left = table.number(key, SPEED);
            let right = rad_s(table.required_number("right_rpm", SPEED));
            let left = rad_s(left?);
            Some(Command::WheelReference(Wheels { left, right }))
        }
        "parameter" => {
            let name = table.text(key)?;
            let given = format!("{:?}", name.value);
            let unknown =
                |remedy: WordError| table.complain(key, name.line, &given, &remedy.to_string());
            let id = parameters::find(&name.value).map_err(unknown).ok()?;
            let value = parameters::required(table, "value", id)?;
            let id = id as u8;
            Some(Command::SetParam { id, value })
        }
        _ => None,
    }
}

/// `goal = "world"`: the position is known once the seed is.
fn read_goal_of_world(table: &Table<'_, '_>, at_s: f64) -> Vec<TimedCommand> {
    if let Some(word) = table.text("goal")
        && word.value != "world"
    {
        let remedy = "must be \"world\", the goal of a random world; a place is goal_m = [x, y]";
        table.complain("goal", word.line, &format!("{:?}", word.value), remedy);
    }
    vec![TimedCommand {
        at_s,
        command: Command::Goal { x_m: 0.0, y_m: 0.0 },
        after_reached: false,
        goal_of_world: true,
    }]
}

fn read_move(table: &Table<'_, '_>, at_s: f64, duration_s: f64) -> Vec<TimedCommand> {
    let movement = table.text("move").and_then(|name| {
        find_movement(&name.value)
            .map_err(|remedy| {
                table.complain(
                    "move",
                    name.line,
                    &format!("{:?}", name.value),
                    &remedy.to_string(),
                )
            })
            .ok()
    });
    let (duty, speed_rpm) = (
        table.number("duty", DUTY),
        table.number("speed_rpm", MOVE_SPEED),
    );
    let movement = movement.unwrap_or_default();
    if table.has("duty") == table.has("speed_rpm") && movement != Movement::Stop {
        table.complain_here("needs either duty (0..1, open loop) or speed_rpm (closed loop)");
    }
    if table.has("ramp_to_duty") || table.has("ramp_s") {
        return read_ramp(table, at_s, duration_s, movement, duty.unwrap_or(0.0));
    }
    let level = match speed_rpm {
        Some(rpm) => MovementLevel::Speed(rad_s(rpm)),
        None => MovementLevel::Duty(duty.unwrap_or(0.0) as f32),
    };
    vec![TimedCommand {
        at_s,
        command: Command::Move { movement, level },
        after_reached: false,
        goal_of_world: false,
    }]
}

/// A ramp of the duty: one command per count of PWM, evenly spaced from `at_s` to `at_s + ramp_s`.
fn read_ramp(
    table: &Table<'_, '_>,
    at_s: f64,
    duration_s: f64,
    movement: Movement,
    from: f64,
) -> Vec<TimedCommand> {
    let full = f64::from(Duty::MAX);
    let to = table.required_number("ramp_to_duty", DUTY);
    let (first, last) = ((from * full).round(), (to * full).round());
    let steps = (last - first).abs();
    let allowed = Allowed::new(
        (steps * RAMP_STEP_S).max(RAMP_STEP_S),
        (duration_s - at_s).max(RAMP_STEP_S),
        "s",
    );
    let ramp_s = table.required_number("ramp_s", allowed);
    (0..=steps as u32)
        .map(|step| {
            let part = f64::from(step) / steps.max(1.0);
            let level = MovementLevel::Duty(((first + part * (last - first)) / full) as f32);
            TimedCommand {
                at_s: at_s + part * ramp_s,
                command: Command::Move { movement, level },
                after_reached: false,
                goal_of_world: false,
            }
        })
        .collect()
}

/// Whether a command sets the mode's reference, and it is one of these.
fn takes(kinds: &[ReferenceKind]) -> impl Fn(&Description) -> bool {
    |mode| {
        let reference = mode.reference.filter(|reference| reference.commanded);
        reference.is_some_and(|reference| kinds.contains(&reference.kind))
    }
}

/// Reports a mode that does not accept the command.
fn needs_mode(
    table: &Table<'_, '_>,
    key: &str,
    takes_it: impl Fn(&Description) -> bool,
    mode: Option<ModeId>,
) {
    if let Some(mode) = mode
        && !takes_it(mode.description())
    {
        let names: Vec<String> = ModeId::ALL
            .iter()
            .filter(|needed| takes_it(needed.description()))
            .map(|needed| format!("`{}`", needed.name()))
            .collect();
        let text = format!(
            "{key} is for mode {}, and the mode here is `{}`",
            names.join(" or "),
            mode.name()
        );
        table.complain_here(&text);
    }
}

fn rad_s(rpm: f64) -> f32 {
    (rpm * PI / 30.0) as f32
}
