//! A robot's parameters as those of a node: the questions of the six services, and their answers.
//!
//! A number is a double with its range, a switch a bool, a choice one of some strings. A value that is not known yet is
//! not set.

use rumbo_ros::messages::Time;
use rumbo_ros::service_messages::{
    Described, FloatingPointRange, ListParametersResult, Listed, Parameter, ParameterDescriptor,
    ParameterEvent, ParameterValue, Types, Values,
};
use rumbo_ros::types::{decode, encode};
use serde::Deserialize;

/// A parameter of the robot, as the station has it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct ParameterState {
    /// Its number.
    pub(crate) id: u8,
    pub(crate) name: String,
    unit: String,
    min: f32,
    max: f32,
    /// `number`, `switch` or `choice`.
    #[serde(rename = "type")]
    kind: String,
    /// The names of the values of a choice.
    choices: Vec<String>,
    description: String,
    /// Once it is known.
    pub(crate) value: Option<f32>,
    /// It is on its way to the robot.
    pub(crate) pending: bool,
    /// Why the robot has not taken it.
    pub(crate) refused: Option<String>,
    /// Nobody sets it: the node's own.
    #[serde(skip)]
    read_only: bool,
}

impl ParameterState {
    /// What every node of ROS 2 has: whether its stamps are times of a simulation. Comes after the robot's, in number too.
    pub(crate) fn use_sim_time(simulated: bool, id: u8) -> Self {
        Self {
            id,
            name: "use_sim_time".to_owned(),
            unit: String::new(),
            min: 0.0,
            max: 1.0,
            kind: "switch".to_owned(),
            choices: Vec::new(),
            description: "stamps are times of the simulation, as on /clock".to_owned(),
            value: Some(f32::from(u8::from(simulated))),
            pending: false,
            refused: None,
            read_only: true,
        }
    }
}

/// Names and types of the services, in the order of [`question`].
pub(crate) const SERVICES: [(&str, &str); 6] = [
    ("list_parameters", "rcl_interfaces/srv/ListParameters"),
    (
        "describe_parameters",
        "rcl_interfaces/srv/DescribeParameters",
    ),
    ("get_parameters", "rcl_interfaces/srv/GetParameters"),
    (
        "get_parameter_types",
        "rcl_interfaces/srv/GetParameterTypes",
    ),
    ("set_parameters", "rcl_interfaces/srv/SetParameters"),
    (
        "set_parameters_atomically",
        "rcl_interfaces/srv/SetParametersAtomically",
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
pub(crate) enum Value {
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
pub(crate) enum Question {
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
pub(crate) fn question(service: usize, data: &[u8]) -> Option<Question> {
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
pub(crate) fn answer(
    question: &Question,
    parameters: &[ParameterState],
) -> Option<Result<Vec<u8>, cdr_encoding::Error>> {
    let find = |name: &String| parameters.iter().find(|each| each.name == *name);
    Some(match question {
        Question::List(prefixes) => {
            let names = parameters.iter().map(|each| each.name.clone());
            // None of the names has a dot.
            let names = names.filter(|name| prefixes.is_empty() || prefixes.contains(name));
            let names = names.collect();
            let prefixes = Vec::new();
            let result = ListParametersResult { names, prefixes };
            encode(&Listed { result })
        }
        Question::Describe(names) => {
            let descriptors = names.iter().map(|name| match find(name) {
                Some(known) => descriptor(known),
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
                Some(known) => kind(known),
                None => NOT_SET,
            });
            let types = types.collect();
            encode(&Types { types })
        }
        Question::Set(_) | Question::SetAtomically(_) => return None,
    })
}

fn kind(entry: &ParameterState) -> u8 {
    match entry.kind.as_str() {
        "switch" => BOOL,
        "choice" => STRING,
        _ => DOUBLE,
    }
}

/// The double that is written with the same digits.
fn double(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| value.into())
}

fn descriptor(entry: &ParameterState) -> ParameterDescriptor {
    let kind = kind(entry);
    let unit = match entry.unit.as_str() {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let range = FloatingPointRange {
        from_value: double(entry.min),
        to_value: double(entry.max),
        step: 0.0,
    };
    ParameterDescriptor {
        name: entry.name.clone(),
        kind,
        description: format!("{}{unit}", entry.description),
        additional_constraints: match kind {
            STRING => format!("one of {}", entry.choices.join(", ")),
            _ => String::new(),
        },
        floating_point_range: (kind == DOUBLE).then_some(range),
        read_only: entry.read_only,
        ..ParameterDescriptor::default()
    }
}

/// A parameter's value; not set while it is not known.
fn value(known: &ParameterState) -> ParameterValue {
    let Some(number) = known.value else {
        return ParameterValue::default();
    };
    let (kind, choices) = (kind(known), &known.choices);
    // As the robot reads it: the nearest.
    let chosen = choices.get(number.round() as usize);
    ParameterValue {
        kind,
        bool_value: kind == BOOL && number > 0.5,
        double_value: if kind == DOUBLE { double(number) } else { 0.0 },
        string_value: chosen
            .filter(|_| kind == STRING)
            .cloned()
            .unwrap_or_default(),
        ..ParameterValue::default()
    }
}

/// The number that a value means to the robot, which is in its range.
///
/// # Errors
/// Why it is none.
pub(crate) fn number(entry: &ParameterState, value: &Value) -> Result<f32, String> {
    let ParameterState { min, max, unit, .. } = entry;
    if entry.read_only {
        return Err("it tells whether the robot is simulated, and cannot be set".to_owned());
    }
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
    match (min..=max).contains(&&number) {
        true => Ok(number),
        false => Err(format!("{given} is not within {min} to {max} {unit}")
            .trim_end()
            .to_owned()),
    }
}

/// What has changed between two states of the same table; `None`: nothing has.
#[must_use]
pub(crate) fn changes(
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
        let earlier = before.iter().find(|each| each.id == known.id);
        let parameter = || Parameter {
            name: known.name.clone(),
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
