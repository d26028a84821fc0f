//! A policy file: the network that drives mode 9, in integers as the robot evaluates it ([`rumbo_control::policy`]).
//!
//! ```toml
//! title = "A goal among boxes"
//!
//! [[input]]                # an input of the network, as many as 32
//! of = "goal_ahead_m"      # a column of the observation (docs/python.md)
//! centre = 0.0             # what the input is 0 at, in the column's unit
//! scale = 4.0              # how much more makes it 1, where it ends
//!
//! [[layer]]                # as many as 3
//! neurons = [              # each: shift, bias, a weight for each value of the layer before
//!     [6, -310, 12, -127, 40],
//! ]
//! ```
//!
//! `rumbo export-policy` writes them.

use super::error::FileError;
use super::near::near_or_all;
use super::read::{Source, Table};
use super::value::{Allowed, Placed, shown};
use rumbo_control::policy::{
    MAGIC, MOST_LAYERS, MOST_SHIFT, MOST_VALUES, NetworkShape, OBSERVED, ONE,
};
use rumbo_wire::crc16;
use std::fmt::Write;
use std::sync::Arc;
use toml::de::DeValue;

const SHIFT: Allowed = Allowed::new(0.0, MOST_SHIFT as f64, "count");
const BIAS: Allowed = Allowed::new(-BIAS_LIMIT, BIAS_LIMIT, "count");
const WEIGHT: Allowed = Allowed::new(-(ONE as f64), ONE as f64, "count");
const CENTRE: Allowed = Allowed::new(-1e3, 1e3, "the column's unit");
const SCALE: Allowed = Allowed::new(1e-3, 1e3, "the column's unit");
/// With all products of a neuron besides, a sum stays within 32 bits.
pub(crate) const BIAS_LIMIT: f64 = (1 << 30) as f64;
const CRC_START: u16 = 0xFFFF;

/// A policy.
#[derive(Clone, Debug, PartialEq)]
pub struct PolicyFile {
    /// Its name: that of the file.
    pub name: String,
    /// One line that says what it does.
    pub title: String,
    /// The file's text.
    pub text: String,
    /// The network as it lies beside the robot's program.
    pub bytes: Arc<[u8]>,
    /// How many inputs and neurons it has.
    pub shape: NetworkShape,
}

/// The network in integers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Network {
    pub(crate) inputs: Vec<Input>,
    pub(crate) layers: Vec<Vec<Neuron>>,
}

/// An input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Input {
    /// The column of the observation.
    pub(crate) column: usize,
    pub(crate) centre: f32,
    pub(crate) scale: f32,
}

/// A neuron.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Neuron {
    pub(crate) shift: u8,
    pub(crate) bias: i32,
    pub(crate) weights: Vec<i8>,
}

impl PolicyFile {
    /// Reads a policy.
    ///
    /// # Errors
    /// All problems of the text, by line of `file`.
    pub fn parse(name: &str, file: &str, text: &str) -> Result<Self, FileError> {
        let source = Source::new(file, text);
        let parsed = source.parse()?;
        let root = source.root(&parsed);
        let title = root
            .required_text("title", "one line that says what the policy does")
            .value;
        let inputs = root.tables("input", MOST_VALUES);
        let inputs: Vec<Input> = inputs.into_iter().map(read_input).collect();
        let mut network = Network {
            inputs,
            layers: Vec::new(),
        };
        let mut values = network.inputs.len();
        for table in root.tables("layer", MOST_LAYERS) {
            let neurons = read_layer(&table, values);
            values = neurons.len();
            network.layers.push(neurons);
        }
        let shape = network.shape();
        if shape.is_none() {
            root.complain_here(&format!(
                "is no network: must have 1 to {MOST_VALUES} inputs and 1 to {MOST_LAYERS} layers of as many neurons, the last one 3"
            ));
        }
        root.finish();
        source.verdict()?;
        let shape = shape.ok_or_else(|| FileError::Setting(format!("{file}: is no network")))?;
        Ok(Self {
            name: name.into(),
            title,
            text: text.into(),
            bytes: network.bytes(&shape),
            shape,
        })
    }
}

fn read_input(table: Table<'_, '_>) -> Input {
    let of = table.required_text("of", "a column of the observation, e.g. \"goal_ahead_m\"");
    let column = OBSERVED.iter().position(|name| *name == of.value);
    if column.is_none() {
        let near = near_or_all(&of.value, OBSERVED).join(", ");
        let remedy = format!("must be a column of the observation, such as {near}");
        table.complain("of", of.line, &of.value, &remedy);
    }
    let centre = table.required_number("centre", CENTRE) as f32;
    let scale = table.required_number("scale", SCALE) as f32;
    table.finish();
    Input {
        column: column.unwrap_or_default(),
        centre,
        scale,
    }
}

/// The neurons of a layer behind one of as many values.
fn read_layer(table: &Table<'_, '_>, values: usize) -> Vec<Neuron> {
    let what = "a list of neurons, each [shift, bias, weights...]";
    table.require("neurons", what);
    let (_, items) = table.items("neurons", what).unwrap_or_default();
    let neurons = items.iter().enumerate();
    let neurons = neurons.map(|(number, item)| read_neuron(table, number + 1, item, values));
    let neurons = neurons.collect();
    table.finish();
    neurons
}

fn read_neuron(
    table: &Table<'_, '_>,
    number: usize,
    item: &Placed<&DeValue<'_>>,
    values: usize,
) -> Neuron {
    let key = format!("neurons[{number}]");
    let parts: Vec<_> = item
        .value
        .as_array()
        .map(|parts| parts.iter().map(|part| part.get_ref()).collect())
        .unwrap_or_default();
    let [shift, bias, weights @ ..] = &parts[..] else {
        table.complain(
            &key,
            item.line,
            &shown(item.value),
            "must be [shift, bias, weights...]",
        );
        return Neuron::default();
    };
    if weights.len() != values {
        let remedy = format!("must be {values}, one for each value of the layer before");
        table.complain(
            &key,
            item.line,
            &format!("{} weights", weights.len()),
            &remedy,
        );
    }
    let judged = |value: &DeValue<'_>, allowed| {
        let number = table.judge_number(&key, item.line, value, allowed);
        number.unwrap_or_default()
    };
    Neuron {
        shift: judged(shift, SHIFT) as u8,
        bias: judged(bias, BIAS) as i32,
        weights: weights
            .iter()
            .map(|weight| judged(weight, WEIGHT) as i8)
            .collect(),
    }
}

impl Network {
    fn shape(&self) -> Option<NetworkShape> {
        let neurons: Vec<usize> = self.layers.iter().map(Vec::len).collect();
        NetworkShape::new(self.inputs.len(), &neurons).ok()
    }

    /// As it lies beside the robot's program.
    fn bytes(&self, shape: &NetworkShape) -> Arc<[u8]> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(shape.bytes().to_le_bytes());
        bytes.extend([self.inputs.len() as u8, self.layers.len() as u8]);
        bytes.extend(self.layers.iter().map(|layer| layer.len() as u8));
        for input in &self.inputs {
            bytes.push(input.column as u8);
            bytes.extend(input.centre.to_le_bytes());
            bytes.extend((f32::from(ONE) / input.scale).to_le_bytes());
        }
        for neuron in self.layers.iter().flatten() {
            bytes.push(neuron.shift);
            bytes.extend(neuron.bias.to_le_bytes());
            bytes.extend(neuron.weights.iter().map(|weight| weight.cast_unsigned()));
        }
        let crc = bytes.iter().fold(CRC_START, |crc, byte| crc16(crc, *byte));
        bytes.extend(crc.to_le_bytes());
        bytes.into()
    }

    /// As a policy file.
    pub(crate) fn text(&self, title: &str) -> String {
        let mut text = format!("title = {}\n", toml::Value::from(title));
        // A string takes all that is written.
        for input in &self.inputs {
            let of = OBSERVED.get(input.column).copied().unwrap_or_default();
            let (centre, scale) = (input.centre, input.scale);
            let _ = write!(
                text,
                "\n[[input]]\nof = \"{of}\"\ncentre = {centre:?}\nscale = {scale:?}\n"
            );
        }
        for layer in &self.layers {
            text += "\n[[layer]]\nneurons = [\n";
            for neuron in layer {
                let _ = write!(text, "    [{}, {}", neuron.shift, neuron.bias);
                for weight in &neuron.weights {
                    let _ = write!(text, ", {weight}");
                }
                text += "],\n";
            }
            text += "]\n";
        }
        text
    }
}
