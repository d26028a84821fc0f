//! `rumbo list`: the available names and values.

use crate::args::{ListArgs, Topic};
use crate::failure::Failure;
use crate::logs;
use crate::new_robot;
use crate::output::{self, figure};
use rumbo_control::mode::{ModeId, ReferenceDescription, ReferenceKind};
use rumbo_control::params::ParamId;
use rumbo_control::rig::Rig;
use rumbo_experiment::files::{FileError, Kind, Library, MOVEMENTS, parameters::exact};
use rumbo_plant::params::{Limit, Params};
use rumbo_plant::plant::{Mount, Mounts};
use rumbo_sim::wiring::SONARS;
use serde_json::{Map, Value, json};

/// Longest list of names on a line of the overview \[characters\].
const NAMES: usize = 60;

/// Lists one topic, or gives an overview; as JSON, all but the plant's numbers.
pub(crate) fn list(args: &ListArgs) -> Result<(), Failure> {
    if let (Some(topic), Some(name)) = (args.topic, &args.name) {
        let kind = match topic {
            Topic::Robots => Kind::Robot,
            Topic::Worlds => Kind::World,
            Topic::Scenarios => Kind::Scenario,
            Topic::Policies => Kind::Policy,
            _ => {
                return Err(Failure::input(
                    "only robots, worlds, scenarios and policies are files: leave the name out",
                ));
            }
        };
        return new_robot::print(kind, name);
    }
    let library = Library::new();
    let topics = match args.topic {
        Some(topic) => vec![topic],
        None => vec![
            Topic::Modes,
            Topic::Scenarios,
            Topic::Worlds,
            Topic::Rigs,
            Topic::Robots,
            Topic::Policies,
            Topic::Sketches,
            Topic::Parameters,
        ],
    };
    let mut all = Map::new();
    for topic in topics {
        let entries = entries(&library, topic)?;
        if args.json || args.topic.is_none() {
            all.insert(name(topic).to_owned(), Value::Array(entries));
        } else if topic == Topic::Scenarios {
            print_scenarios(&entries)?;
        } else {
            output::line(name(topic))?;
            output::table(&entries.iter().map(row).collect::<Vec<_>>())?;
            if topic == Topic::Robots {
                output::line(
                    "rumbo list robots NAME prints the file of one; rumbo new robot NAME --like ROBOT begins one with it",
                )?;
            }
            if topic == Topic::Logs {
                output::line(&logs::total(&entries))?;
            }
        }
    }
    if args.json {
        output::json(&all)
    } else if args.topic.is_none() {
        overview(&all)
    } else {
        Ok(())
    }
}

/// What there is, on one screen.
fn overview(all: &Map<String, Value>) -> Result<(), Failure> {
    let entries = |topic| all[name(topic)].as_array().map_or(&[][..], Vec::as_slice);
    let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    output::line("modes")?;
    let mode = |entry: &Value| {
        let number = entry["number"].to_string();
        vec![number, text(entry, "name"), text(entry, "help")]
    };
    output::table(&entries(Topic::Modes).iter().map(mode).collect::<Vec<_>>())?;
    output::line("scenarios, for rumbo run and rumbo lab --scenario")?;
    let groups = entries(Topic::Scenarios).chunk_by(|one, other| one["group"] == other["group"]);
    let group = |group: &[Value]| vec![text(&group[0], "group"), names(group)];
    output::table(&groups.map(group).collect::<Vec<_>>())?;
    let others = [
        Topic::Worlds,
        Topic::Rigs,
        Topic::Robots,
        Topic::Policies,
        Topic::Sketches,
        Topic::Parameters,
    ];
    let other = |topic| vec![name(topic).to_owned(), names(entries(topic))];
    output::table(&others.map(other))?;
    output::line(
        "More of each: rumbo list modes, rumbo list scenarios, ...; topics: rumbo list --help",
    )
}

/// The names of entries, the first ones if they are too many for a line.
fn names(entries: &[Value]) -> String {
    let mut line = String::new();
    let mut left = entries.len();
    for name in entries.iter().filter_map(|entry| entry["name"].as_str()) {
        if line.len() + name.len() > NAMES {
            return format!("{line}, {left} more");
        }
        line += if line.is_empty() { "" } else { ", " };
        line += name;
        left -= 1;
    }
    line
}

/// The scenarios below the headings of their groups.
fn print_scenarios(entries: &[Value]) -> Result<(), Failure> {
    for group in entries.chunk_by(|one, other| one["group"] == other["group"]) {
        output::line(group[0]["group"].as_str().unwrap_or("scenarios"))?;
        output::table(&group.iter().map(row).collect::<Vec<_>>())?;
    }
    Ok(())
}

fn name(topic: Topic) -> &'static str {
    match topic {
        Topic::Scenarios => "scenarios",
        Topic::Worlds => "worlds",
        Topic::Robots => "robots",
        Topic::Policies => "policies",
        Topic::Rigs => "rigs",
        Topic::Modes => "modes",
        Topic::Movements => "movements",
        Topic::Parameters => "parameters",
        Topic::Plant => "plant",
        Topic::Logs => "logs",
        Topic::Ports => "ports",
        Topic::Sketches => "sketches",
    }
}

fn entries(library: &Library, topic: Topic) -> Result<Vec<Value>, Failure> {
    let titled = |(name, title): (String, String)| json!({ "name": name, "title": title });
    Ok(match topic {
        Topic::Scenarios => {
            let mut entries = files(library, Kind::Scenario, |name| {
                let file = library.scenario(name)?;
                Ok(
                    json!({ "name": name, "title": file.title, "group": file.group,
                    "mode": file.mode.name(), "rig": file.rig, "world": file.world }),
                )
            })?;
            // Stable: by name within a group.
            entries.sort_by(|one, other| one["group"].as_str().cmp(&other["group"].as_str()));
            entries
        }
        Topic::Worlds => files(library, Kind::World, |name| {
            Ok(json!({ "name": name, "title": library.world(name)?.title }))
        })?,
        Topic::Robots => files(library, Kind::Robot, |name| {
            let file = library.robot(name)?;
            let rigs: Vec<_> = file.rigs.keys().collect();
            Ok(
                json!({ "name": name, "title": file.title, "board": file.board.name,
                "driver": file.driver.in_words(), "rigs": rigs }),
            )
        })?,
        Topic::Policies => files(library, Kind::Policy, |name| {
            Ok(json!({ "name": name, "title": library.policy(name)?.title }))
        })?,
        Topic::Modes => ModeId::ALL.map(mode_entry).into(),
        Topic::Rigs => {
            let rigs = files(library, Kind::Robot, |robot| {
                let file = library.robot(robot)?;
                let rigs = file.rigs.iter();
                let entry = |(name, rig)| json!({ "name": name, "robot": robot, "sonars": sonars(rig, &file.other_sonars) });
                Ok(rigs.map(entry).collect::<Vec<_>>())
            })?;
            rigs.concat()
        }
        Topic::Movements => {
            let movements = MOVEMENTS.iter();
            movements.map(|(_, name)| json!({ "name": name })).collect()
        }
        Topic::Parameters => ParamId::ALL.into_iter().map(parameter_entry).collect(),
        Topic::Ports => {
            let ports = rumbo_station::port::serial_ports().map_err(Failure::input)?;
            ports.into_iter().map(titled).collect()
        }
        Topic::Logs => logs::entries()?,
        Topic::Sketches => rumbo_sketch::examples().into_iter().map(titled).collect(),
        Topic::Plant => Params::limits().iter().map(plant_entry).collect(),
    })
}

/// What is said of each file of a kind.
fn files<T>(
    library: &Library,
    kind: Kind,
    entry: impl Fn(&str) -> Result<T, FileError>,
) -> Result<Vec<T>, Failure> {
    let names = library.list(kind);
    let entries = names.iter().map(|name| entry(name));
    entries.collect::<Result<_, _>>().map_err(Failure::input)
}

fn plant_entry(limit: &Limit) -> Value {
    json!({ "name": limit.key, "min": limit.min, "max": limit.max,
            "default": limit.nominal, "unit": limit.unit, "help": limit.help })
}

fn parameter_entry(id: ParamId) -> Value {
    let limits = id.limits();
    json!({ "name": id.name(), "min": exact(limits.min), "max": exact(limits.max),
            "default": exact(limits.default), "unit": id.unit(), "help": id.help(),
            "type": id.kind().name(), "choices": id.kind().names(),
            "modes": id.modes().map(ModeId::name).collect::<Vec<_>>() })
}

/// A mode's description, with its reference in the units that people use.
fn mode_entry(mode: ModeId) -> Value {
    let about = mode.description();
    let rpm = |rad_s: f32| (f64::from(rad_s) * 30.0 / std::f64::consts::PI).round();
    let cm = |distance_m: f32| (f64::from(distance_m) * 1e3).round() / 10.0;
    let reference = about.reference.map(
        |ReferenceDescription {
             kind,
             min,
             max,
             commanded,
             ..
         }| {
            let (what, unit, min, max) = match kind {
                ReferenceKind::Distance => ("distance", "cm", cm(min), cm(max)),
                ReferenceKind::WheelSpeed => ("speed of each wheel", "rpm", rpm(min), rpm(max)),
                ReferenceKind::Speed => ("speed", "rpm", rpm(min), rpm(max)),
                ReferenceKind::Goal => ("x and y", "m", exact(min), exact(max)),
            };
            json!({ "what": what, "unit": unit, "min": min, "max": max, "commanded": commanded })
        },
    );
    let states = about.states.iter().map(|state| state.name);
    let groups = about.parameters.iter().map(|group| {
        let names = group.parameters.iter().map(|id| id.name());
        json!({ "title": group.title, "parameters": names.collect::<Vec<_>>() })
    });
    json!({ "name": about.name, "number": about.number, "help": about.about, "reference": reference,
            "rigs": about.rigs.iter().map(Rig::name).collect::<Vec<_>>(),
            "states": states.collect::<Vec<_>>(), "parameters": groups.collect::<Vec<_>>() })
}

/// Direction of each sonar of a rig.
fn sonars(rig: &Mounts, others: &[String]) -> Map<String, Value> {
    let names = SONARS.into_iter();
    let names = names.chain(others.iter().map(String::as_str));
    let carried = names
        .zip(rig.mounts())
        .filter_map(|(name, mount)| Some((name, mount?)));
    carried
        .map(|(name, mount)| {
            let Mount {
                x_m,
                y_m,
                angle_rad,
                on_servo,
            } = mount;
            let angle_deg = angle_rad.to_degrees().round();
            let place =
                json!({ "x_m": x_m, "y_m": y_m, "angle_deg": angle_deg, "on_servo": on_servo });
            (name.to_owned(), place)
        })
        .collect()
}

/// A mode as a row: number, name, what it does, its reference, its rigs, its states.
fn mode_row(entry: &Value) -> Vec<String> {
    let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    let reference = &entry["reference"];
    let limit = |key: &str| reference[key].as_f64().map_or_else(String::new, figure);
    let reference = match (reference["what"].as_str(), reference["unit"].as_str()) {
        (Some(what), Some(unit)) if reference["commanded"] == true => {
            format!("{what} {}..{} {unit}", limit("min"), limit("max"))
        }
        _ => "no setpoint".into(),
    };
    let words = |key: &str| {
        let words = entry[key].as_array().into_iter().flatten();
        words
            .filter_map(Value::as_str)
            .collect::<Vec<_>>()
            .join(", ")
    };
    let rigs = match entry["rigs"].as_array().map(Vec::len) {
        Some(all) if all == Rig::ALL.len() => "any rig".into(),
        _ => format!("rigs: {}", words("rigs")),
    };
    vec![
        entry["number"].to_string(),
        text("name"),
        text("help"),
        reference,
        rigs,
        format!("states: {}", words("states")),
    ]
}

/// A rig as a row: name, robot, and direction of each sonar.
fn rig_row(entry: &Value) -> Vec<String> {
    let looks = |(name, mount): (&String, &Value)| {
        let direction = match mount["angle_deg"].as_f64() {
            Some(0.0) => "ahead".to_owned(),
            Some(90.0) => "to the left".to_owned(),
            Some(-90.0) => "to the right".to_owned(),
            angle_deg => format!("at {} deg", figure(angle_deg.unwrap_or_default())),
        };
        let servo = if mount["on_servo"] == true {
            ", on the servo"
        } else {
            ""
        };
        format!(
            "{name} looks {direction}{servo} from ({}, {}) m",
            mount["x_m"], mount["y_m"]
        )
    };
    let sonars: Vec<_> = entry["sonars"]
        .as_object()
        .into_iter()
        .flatten()
        .map(looks)
        .collect();
    let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    vec![text("name"), text("robot"), sonars.join("; ")]
}

/// A switch or a choice as a row: name, default, type, no unit, what it is with its values; `None` for a number.
fn named_row(entry: &Value) -> Option<Vec<String>> {
    let choices: Vec<_> = entry["choices"]
        .as_array()?
        .iter()
        .filter_map(Value::as_str)
        .collect();
    let default = *choices.get(entry["default"].as_f64()? as usize)?;
    let text = |key: &str| entry[key].as_str().unwrap_or_default();
    let help = format!("{} Values: {}", text("help"), choices.join(", "));
    Some(
        [text("name"), default, text("type"), "", &help]
            .map(str::to_owned)
            .to_vec(),
    )
}

/// An entry as a row of a table: its name, then its other fields.
fn row(entry: &Value) -> Vec<String> {
    if entry.get("states").is_some() {
        return mode_row(entry);
    }
    if entry.get("sonars").is_some() {
        return rig_row(entry);
    }
    if entry.get("bytes").is_some() {
        return logs::row(entry);
    }
    if let Some(row) = named_row(entry) {
        return row;
    }
    let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    let number = |key: &str| entry[key].as_f64().map(figure);
    let mut row = vec![text("name")];
    if let (Some(min), Some(max), Some(default)) = (number("min"), number("max"), number("default"))
    {
        row.extend([default, format!("{min}..{max}"), text("unit"), text("help")]);
    } else if let Some(rigs) = entry["rigs"].as_array() {
        let rigs: Vec<_> = rigs.iter().filter_map(Value::as_str).collect();
        let rigs = match rigs[..] {
            [] => "no sonar".to_owned(),
            _ => format!("rigs: {}", rigs.join(", ")),
        };
        row.push(format!(
            "{} ({rigs}; driver: {})",
            text("title"),
            text("driver")
        ));
    } else {
        row.push(text("title"));
    }
    row
}
