//! `rumbo list`: what there is to choose from.

use crate::args::{ListArgs, Topic};
use crate::failure::Failure;
use crate::output::{self, figure};
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_plant::params::Params;
use rumbo_scenario::files::{FileError, Kind, Library, MOVEMENTS, parameters::exact};
use serde_json::{Map, Value, json};

/// Lists one topic, or all but the plant's numbers.
pub(crate) fn list(args: &ListArgs) -> Result<(), Failure> {
    let library = Library::new();
    let topics = match args.topic {
        Some(topic) => vec![topic],
        None => vec![
            Topic::Scenarios,
            Topic::Worlds,
            Topic::Robots,
            Topic::Modes,
            Topic::Parameters,
        ],
    };
    let mut all = Map::new();
    for topic in topics {
        let entries = entries(&library, topic)?;
        if args.json {
            all.insert(name(topic).to_owned(), Value::Array(entries));
        } else {
            output::line(name(topic))?;
            output::table(&entries.iter().map(row).collect::<Vec<_>>())?;
        }
    }
    if args.json {
        output::json(&all)
    } else {
        Ok(())
    }
}

fn name(topic: Topic) -> &'static str {
    match topic {
        Topic::Scenarios => "scenarios",
        Topic::Worlds => "worlds",
        Topic::Robots => "robots",
        Topic::Modes => "modes",
        Topic::Movements => "movements",
        Topic::Parameters => "parameters",
        Topic::Plant => "plant",
    }
}

fn entries(library: &Library, topic: Topic) -> Result<Vec<Value>, Failure> {
    let wrong = |error: FileError| Failure::input(error);
    let mut entries = Vec::new();
    match topic {
        Topic::Scenarios => {
            for name in library.list(Kind::Scenario) {
                let file = library.scenario(&name).map_err(wrong)?;
                entries.push(json!({ "name": name, "title": file.title }));
            }
        }
        Topic::Worlds => {
            for name in library.list(Kind::World) {
                let file = library.world(&name).map_err(wrong)?;
                entries.push(json!({ "name": name, "title": file.title }));
            }
        }
        Topic::Robots => {
            for name in library.list(Kind::Robot) {
                let file = library.robot(&name).map_err(wrong)?;
                let rigs: Vec<_> = file.rigs.keys().collect();
                entries.push(json!({ "name": name, "title": file.title, "rigs": rigs }));
            }
        }
        Topic::Modes => {
            entries.extend(
                ModeId::ALL
                    .iter()
                    .map(|mode| json!({ "name": mode.name(), "number": *mode as u8 })),
            );
        }
        Topic::Movements => {
            entries.extend(MOVEMENTS.iter().map(|(_, name)| json!({ "name": name })))
        }
        Topic::Parameters => entries.extend(ParamId::ALL.iter().map(|id| {
            let limits = id.limits();
            json!({ "name": id.name(), "min": exact(limits.min), "max": exact(limits.max),
                    "default": exact(limits.default), "unit": id.unit(), "help": id.help(),
                    "mode": id.mode().map(ModeId::name) })
        })),
        Topic::Plant => entries.extend(Params::limits().iter().map(|limit| {
            json!({ "name": limit.key, "min": limit.min, "max": limit.max, "default": limit.nominal,
                    "unit": limit.unit, "help": limit.help })
        })),
    }
    Ok(entries)
}

/// An entry as a row of a table: its name, then whatever it has of the rest.
fn row(entry: &Value) -> Vec<String> {
    let text = |key: &str| entry[key].as_str().unwrap_or_default().to_owned();
    let number = |key: &str| entry[key].as_f64().map(figure);
    let mut row = vec![text("name")];
    if let (Some(min), Some(max), Some(default)) = (number("min"), number("max"), number("default"))
    {
        row.extend([default, format!("{min}..{max}"), text("unit"), text("help")]);
    } else if let Some(number) = number("number") {
        row.push(number);
    } else if let Some(rigs) = entry["rigs"].as_array() {
        let rigs: Vec<_> = rigs.iter().filter_map(Value::as_str).collect();
        row.push(format!("{} (rigs: {})", text("title"), rigs.join(", ")));
    } else {
        row.push(text("title"));
    }
    row
}
