//! `[[fleet]]` of a scenario: several robots in one world, each with its own program, place and commands.
//!
//! ```toml
//! [[fleet]]
//! name = "north"               # in metrics, results and messages
//! start = { x_m = 1, y_m = 1, heading_deg = -135 }
//! program = "baseline"         # or "rumbo", ours, which is the default
//! [[fleet]]
//! name = "south"
//! firmware = "sketch.hex"      # an image beside this file, on an emulated chip
//! wiring = "final"             # may be missing, as with --wiring
//! [[fleet.command]]
//! at_s = 0.5
//! arm = true
//! ```
//!
//! An entry may have most keys of a scenario: robot, rig, mode, start, commands, parameters, plant, failing sonars and
//! wires. What it does not have is that of the scenario around it; its parameters and plant values come on top of those.

use super::{Member, NativeProgram, ScenarioFile, read_start};
use crate::files::commands::{MOST_COMMANDS, read_commands};
use crate::files::faults::{MOST_FAULTS, read_sonar_faults, read_wire_faults};
use crate::files::names::read_mode;
use crate::files::parameters::read_parameters;
use crate::files::read::Table;
use crate::files::robot::read_plant;
use std::collections::BTreeMap;

/// Robots of a scenario.
const MOST_ROBOTS: usize = 32;
/// It stands in the names of metrics and files.
const LONGEST_NAME: usize = 20;

/// Reads the robots, in order; `around` is the scenario without them.
pub(super) fn read_fleet(root: &Table<'_, '_>, around: &ScenarioFile) -> Vec<Member> {
    let mut lines = BTreeMap::new();
    let tables = root.tables("fleet", MOST_ROBOTS);
    let members = tables.iter().map(|table| {
        let name = table.required_text("name", "what the robot is called, e.g. \"north\"");
        let fits = |name: &str| {
            let may_be = |at: char| at.is_ascii_lowercase() || at.is_ascii_digit() || at == '_';
            name.len() <= LONGEST_NAME && name.chars().all(may_be)
        };
        if !fits(&name.value) {
            let remedy = "write at most 20 of a to z, 0 to 9 and _";
            table.complain("name", name.line, &name.value, remedy);
        }
        if let Some(first) = lines.insert(name.value.clone(), name.line)
            && !name.value.is_empty()
        {
            let remedy = format!("the robot of line {first} has that name; give each its own");
            table.complain("name", name.line, &name.value, &remedy);
        }
        read_member(table, name.value, around)
    });
    members.collect()
}

fn read_member(table: &Table<'_, '_>, name: String, around: &ScenarioFile) -> Member {
    let mut own = ScenarioFile {
        name,
        text: String::new(),
        limits: BTreeMap::new(),
        ..around.clone()
    };
    if let Some(robot) = table.text("robot") {
        own.robot = robot.value;
    }
    if let Some(rig) = table.text("rig") {
        own.rig = rig.value;
    }
    if let Some(mode) = read_mode(table) {
        own.mode = mode;
    }
    let start = read_start(&table.table("start"));
    if table.has("start") {
        own.start = start;
    }
    let commands = table.tables("command", MOST_COMMANDS);
    if !commands.is_empty() {
        (own.commands, own.texts) = read_commands(commands, Some(own.mode), own.duration_s);
    }
    let sonar_faults = table.tables("sonar_fault", MOST_FAULTS);
    if !sonar_faults.is_empty() {
        own.sonar_faults = read_sonar_faults(sonar_faults, own.duration_s);
    }
    let wire_faults = table.tables("wire_fault", MOST_FAULTS);
    if !wire_faults.is_empty() {
        own.wire_faults = read_wire_faults(wire_faults, own.duration_s);
    }
    own.parameters
        .extend(read_parameters(&table.table("parameters")));
    own.plant.extend(read_plant(&table.table("plant"), ""));
    let member = Member {
        program: read_program(table),
        firmware: table.text("firmware").map(|path| path.value.into()),
        wiring: table.text("wiring").map(|wiring| wiring.value),
        scenario: own,
    };
    table.finish();
    member
}

fn read_program(table: &Table<'_, '_>) -> NativeProgram {
    let Some(program) = table.text("program") else {
        return NativeProgram::Rumbo;
    };
    if table.has("firmware") {
        let remedy = "an image is a program: leave one of program and firmware out";
        table.complain("program", program.line, &program.value, remedy);
    }
    match program.value.as_str() {
        "rumbo" => NativeProgram::Rumbo,
        "baseline" => NativeProgram::Baseline,
        other => {
            let remedy = "write \"rumbo\" or \"baseline\", or firmware = \"image.hex\"";
            table.complain("program", program.line, other, remedy);
            NativeProgram::Rumbo
        }
    }
}
