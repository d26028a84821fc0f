//! A network in floats, as a learner writes it, made into the integers of a policy file.
//!
//! Values of -1..=1 become -127..=127. A neuron's weights are scaled by the largest power of two that keeps them within
//! -127..=127, which is its shift: docs/theory/policy.md.

use crate::files::policy::{BIAS_LIMIT, Input, Network, Neuron};
use crate::files::{FileError, PolicyFile, near_or_all};
use rumbo_control::policy::{MOST_SHIFT, OBSERVED, ONE};
use serde::Deserialize;
use std::fmt;

/// A network in floats: `x = clip((column - centre) / scale, -1, 1)`, then `clip(weights x + biases, -1, 1)` for each layer.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Floats {
    /// Its inputs.
    pub inputs: Vec<FloatInput>,
    /// Its layers, the outputs last: left wheel, right wheel, servo.
    pub layers: Vec<FloatLayer>,
}

/// An input.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FloatInput {
    /// The column of the observation.
    pub of: String,
    /// What the input is 0 at, in the column's unit.
    pub centre: f64,
    /// How much more makes it 1.
    pub scale: f64,
}

/// A layer.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FloatLayer {
    /// Of each neuron, for each value of the layer before.
    pub weights: Vec<Vec<f64>>,
    /// Of each neuron.
    pub biases: Vec<f64>,
}

/// Why a network cannot be quantised.
#[derive(Clone, Debug, PartialEq)]
pub enum QuantiseError {
    /// An input is no column of the observation.
    Column(String),
    /// A layer has not as many weights or biases as it must: which, and what is wrong.
    Count(String, usize, usize),
    /// A number is not finite, or too large.
    Number(String, f64),
    /// The robot cannot evaluate a network of this shape.
    Shape(FileError),
}

impl fmt::Display for QuantiseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Column(name) => {
                let near = near_or_all(name, OBSERVED).join(", ");
                write!(
                    f,
                    "`{name}` is no column of the observation; did you mean {near}?"
                )
            }
            Self::Count(what, count, needed) => {
                write!(f, "{what} has {count} values: must be {needed}")
            }
            Self::Number(what, value) => write!(
                f,
                "{what} = {value}: must be a finite number that 8 bits can hold, less than 127; train with smaller weights"
            ),
            Self::Shape(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for QuantiseError {}

/// The policy of a network, in a file of this title.
///
/// # Errors
/// Why there is none.
pub fn quantise(floats: &Floats, title: &str) -> Result<PolicyFile, QuantiseError> {
    let inputs = floats.inputs.iter().map(input);
    let mut network = Network {
        inputs: inputs.collect::<Result<_, _>>()?,
        layers: Vec::new(),
    };
    let mut values = network.inputs.len();
    for (number, layer) in (1..).zip(&floats.layers) {
        let what = format!("layer {number}");
        if layer.biases.len() != layer.weights.len() {
            let (biases, neurons) = (layer.biases.len(), layer.weights.len());
            return Err(QuantiseError::Count(
                format!("biases of {what}"),
                biases,
                neurons,
            ));
        }
        let neurons = layer.weights.iter().zip(&layer.biases);
        let neurons = (1..).zip(neurons).map(|(number, (weights, bias))| {
            neuron(
                &format!("neuron {number} of {what}"),
                weights,
                *bias,
                values,
            )
        });
        network.layers.push(neurons.collect::<Result<_, _>>()?);
        values = layer.weights.len();
    }
    let text = network.text(title);
    PolicyFile::parse("policy", "policy", &text).map_err(QuantiseError::Shape)
}

fn input(input: &FloatInput) -> Result<Input, QuantiseError> {
    let FloatInput { of, centre, scale } = input;
    let column = OBSERVED.iter().position(|name| name == of);
    for (what, value, is_fine) in [
        ("centre", centre, centre.is_finite()),
        ("scale", scale, scale.is_finite() && *scale > 0.0),
    ] {
        if !is_fine {
            return Err(QuantiseError::Number(format!("{what} of {of}"), *value));
        }
    }
    Ok(Input {
        column: column.ok_or_else(|| QuantiseError::Column(of.clone()))?,
        centre: *centre as f32,
        scale: *scale as f32,
    })
}

fn neuron(what: &str, weights: &[f64], bias: f64, values: usize) -> Result<Neuron, QuantiseError> {
    if weights.len() != values {
        return Err(QuantiseError::Count(what.to_owned(), weights.len(), values));
    }
    let one = f64::from(ONE);
    let wrong = |value: f64| Err(QuantiseError::Number(what.to_owned(), value));
    let is_wrong = |weight: &&f64| !weight.is_finite() || weight.abs() > one;
    if let Some(weight) = weights.iter().find(is_wrong) {
        return wrong(*weight);
    }
    let largest = weights
        .iter()
        .fold(0.0_f64, |most, weight| most.max(weight.abs()));
    let scale = |shift: u8| f64::from(1_u32 << shift);
    let fits = |shift: &u8| (largest * scale(*shift)).round() <= one;
    let shift = (0..=MOST_SHIFT).rev().find(fits).unwrap_or_default();
    let scaled = (bias * one * scale(shift)).round();
    if !scaled.is_finite() || scaled.abs() > BIAS_LIMIT {
        return wrong(bias);
    }
    Ok(Neuron {
        shift,
        bias: scaled as i32,
        weights: weights
            .iter()
            .map(|weight| (weight * scale(shift)).round() as i8)
            .collect(),
    })
}
