//! A robot's parameters as those of a node: the questions of the six services, and their answers.
//!
//! A number is a double with its range, a switch a bool, a choice one of some strings. A value that is not known yet is
//! not set.

use crate::bridge::ServiceType;
use crate::messages::Time;
use crate::service_messages::{
    Described, FloatingPointRange, ListParametersResult, Listed, Parameter, ParameterDescriptor,
    ParameterEvent, ParameterValue, Types, Values,
};
use crate::types::{decode, encode};
use rumbo_log::{Parameter as Entry, ParameterState};

/// Names and types of the services, in the order of [`question`].
pub const SERVICES: [(&str, ServiceType); 6] = [
    (
        "list_parameters",
        ServiceType {
            name: "rcl_interfaces/srv/ListParameters",
            hash: "RIHS01_3e6062bfbb27bfb8730d4cef2558221f51a11646d78e7bb30a1e83afac3aad9d",
        },
    ),
    (
        "describe_parameters",
        ServiceType {
            name: "rcl_interfaces/srv/DescribeParameters",
            hash: "RIHS01_845b484d71eb0673dae682f2e3ba3c4851a65a3dcfb97bddd82c5b57e91e4cff",
        },
    ),
    (
        "get_parameters",
        ServiceType {
            name: "rcl_interfaces/srv/GetParameters",
            hash: "RIHS01_bf9803d5c74cf989a5de3e0c2e99444599a627c7ff75f97b8c05b01003675cbc",
        },
    ),
    (
        "get_parameter_types",
        ServiceType {
            name: "rcl_interfaces/srv/GetParameterTypes",
            hash: "RIHS01_da199c878688b3e530bdfe3ca8f74cb9fa0c303101e980a9e8f260e25e1c80ca",
        },
    ),
    (
        "set_parameters",
        ServiceType {
            name: "rcl_interfaces/srv/SetParameters",
            hash: "RIHS01_56eed9a67e169f9cb6c1f987bc88f868c14a8fc9f743a263bc734c154015d7e0",
        },
    ),
    (
        "set_parameters_atomically",
        ServiceType {
            name: "rcl_interfaces/srv/SetParametersAtomically",
            hash: "RIHS01_0e192ef259c07fc3c07a13191d27002222e65e00ccec653ca05e856f79285fcd",
        },
    ),
];

/// Types of values (`rcl_interfaces/msg/ParameterType`).
const NOT_SET: u8 = 0;
const BOOL: u8 = 1;
const INTEGER: u8 = 2;
const DOUBLE: u8 = 3;
const STRING: u8 = 4;

/// A value that somebody sends.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `bool`.
    Bool(bool),
    /// `int64`.
    Integer(i64),
    /// `float64`.
    Double(f64),
    /// `string`.
    Text(String),
    /// An array, or none.
    Other,
}

/// What somebody wants of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// The names, of those that begin with one of these and a dot, or are one of these; without any of all.
    List(Vec<String>),
    /// What these are.
    Describe(Vec<String>),
    /// The values of these.
    Get(Vec<String>),
    /// The types of these.
    Types(Vec<String>),
    /// New values, each for itself.
    Set(Vec<(String, Value)>),
    /// New values, all or none.
    SetAtomically(Vec<(String, Value)>),
}

/// A value on the wire.
type Raw = (
    u8,
    bool,
    i64,
    f64,
    String,
    Vec<u8>,
    Vec<bool>,
    Vec<i64>,
    Vec<f64>,
    Vec<String>,
);

/// The question in a request to the service of this number; `None`: it cannot be decoded.
#[must_use]
pub fn question(service: usize, data: &[u8]) -> Option<Question> {
    let names = || decode::<(Vec<String>,)>(data).ok().map(|(names,)| names);
    let values = || {
        let (sent,) = decode::<(Vec<(String, Raw)>,)>(data).ok()?;
        let sent = sent.into_iter().map(|(name, raw)| {
            let value = match raw {
                (BOOL, value, ..) => Value::Bool(value),
                (INTEGER, _, value, ..) => Value::Integer(value),
                (DOUBLE, _, _, value, ..) => Value::Double(value),
                (STRING, _, _, _, value, ..) => Value::Text(value),
                _ => Value::Other,
            };
            (name, value)
        });
        Some(sent.collect())
    };
    match service {
        0 => decode::<(Vec<String>, u64)>(data)
            .ok()
            .map(|(prefixes, _)| Question::List(prefixes)),
        1 => names().map(Question::Describe),
        2 => names().map(Question::Get),
        3 => names().map(Question::Types),
        4 => values().map(Question::Set),
        5 => values().map(Question::SetAtomically),
        _ => None,
    }
}

/// The answer to a question that changes nothing; `None` if it is not one.
///
/// # Errors
/// What CDR cannot express.
#[must_use]
pub fn answer(
    question: &Question,
    parameters: &[ParameterState],
) -> Option<Result<Vec<u8>, cdr_encoding::Error>> {
    let find = |name: &String| parameters.iter().find(|each| each.entry.name == name);
    Some(match question {
        Question::List(prefixes) => {
            let names = parameters.iter().map(|each| each.entry.name.to_owned());
            // None of the names has a dot.
            let names = names.filter(|name| prefixes.is_empty() || prefixes.contains(name));
            let names = names.collect();
            let prefixes = Vec::new();
            let result = ListParametersResult { names, prefixes };
            encode(&Listed { result })
        }
        Question::Describe(names) => {
            let descriptors = names.iter().map(|name| match find(name) {
                Some(known) => descriptor(&known.entry),
                None => ParameterDescriptor {
                    name: name.clone(),
                    ..ParameterDescriptor::default()
                },
            });
            let descriptors = descriptors.collect();
            encode(&Described { descriptors })
        }
        Question::Get(names) => {
            let values = names.iter().map(|name| match find(name) {
                Some(known) => value(known),
                None => ParameterValue::default(),
            });
            let values = values.collect();
            encode(&Values { values })
        }
        Question::Types(names) => {
            let types = names.iter().map(|name| match find(name) {
                Some(known) => kind(&known.entry),
                None => NOT_SET,
            });
            let types = types.collect();
            encode(&Types { types })
        }
        Question::Set(_) | Question::SetAtomically(_) => return None,
    })
}

fn kind(entry: &Entry) -> u8 {
    match entry.kind {
        "switch" => BOOL,
        "choice" => STRING,
        _ => DOUBLE,
    }
}

/// The double that is written with the same digits.
fn double(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| value.into())
}

fn descriptor(entry: &Entry) -> ParameterDescriptor {
    let kind = kind(entry);
    let unit = match entry.unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let range = FloatingPointRange {
        from_value: double(entry.min),
        to_value: double(entry.max),
        step: 0.0,
    };
    ParameterDescriptor {
        name: entry.name.to_owned(),
        kind,
        description: format!("{}{unit}", entry.description),
        additional_constraints: match kind {
            STRING => format!("one of {}", entry.choices.join(", ")),
            _ => String::new(),
        },
        floating_point_range: (kind == DOUBLE).then_some(range),
        ..ParameterDescriptor::default()
    }
}

/// A parameter's value; not set while it is not known.
fn value(known: &ParameterState) -> ParameterValue {
    let Some(number) = known.value else {
        return ParameterValue::default();
    };
    let (kind, choices) = (kind(&known.entry), known.entry.choices);
    // As the robot reads it: the nearest.
    let chosen = choices.get(number.round() as usize).copied();
    ParameterValue {
        kind,
        bool_value: kind == BOOL && number > 0.5,
        double_value: if kind == DOUBLE { double(number) } else { 0.0 },
        string_value: chosen.filter(|_| kind == STRING).unwrap_or("").to_owned(),
        ..ParameterValue::default()
    }
}

/// The number that a value means to the robot, which is in its range.
///
/// # Errors
/// Why it is none.
pub fn number(entry: &Entry, value: &Value) -> Result<f32, String> {
    let Entry { min, max, unit, .. } = *entry;
    let (wanted, given) = match (kind(entry), value) {
        (BOOL, Value::Bool(value)) => return Ok(f32::from(u8::from(*value))),
        (STRING, Value::Text(name)) => {
            let number = entry.choices.iter().position(|choice| choice == name);
            let names = || format!("`{name}` is none of {}", entry.choices.join(", "));
            return number.map(|number| number as f32).ok_or_else(names);
        }
        (DOUBLE, Value::Double(value)) => ("", *value),
        // `ros2 param set` makes an integer of a number without a point.
        (DOUBLE, Value::Integer(value)) => ("", *value as f64),
        (BOOL, _) => ("a bool", 0.0),
        (STRING, _) => ("a string", 0.0),
        _ => ("a number", 0.0),
    };
    if !wanted.is_empty() {
        return Err(format!("it is {wanted}"));
    }
    let number = given as f32;
    match (min..=max).contains(&number) {
        true => Ok(number),
        false => Err(format!("{given} is not within {min} to {max} {unit}")
            .trim_end()
            .to_owned()),
    }
}

/// What has changed between two states of the same table; `None`: nothing has.
#[must_use]
pub fn changes(
    node: &str,
    stamp: Time,
    before: &[ParameterState],
    now: &[ParameterState],
) -> Option<ParameterEvent> {
    let mut event = ParameterEvent {
        stamp,
        node: node.to_owned(),
        ..ParameterEvent::default()
    };
    for known in now {
        let earlier = before.iter().find(|each| each.entry.id == known.entry.id);
        let parameter = || Parameter {
            name: known.entry.name.to_owned(),
            value: value(known),
        };
        match (earlier.and_then(|each| each.value), known.value) {
            (None, Some(_)) => event.new_parameters.push(parameter()),
            (Some(_), None) => event.deleted_parameters.push(parameter()),
            (Some(old), Some(new)) if old != new => event.changed_parameters.push(parameter()),
            _ => {}
        }
    }
    let lists = [
        &event.new_parameters,
        &event.changed_parameters,
        &event.deleted_parameters,
    ];
    let is_empty = lists.iter().all(|list| list.is_empty());
    (!is_empty).then_some(event)
}
