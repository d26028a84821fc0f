//! A network in floats, as a learner writes it, made into the integers of a policy file.
//!
//! Values of -1..=1 become -127..=127. A neuron's weights are scaled by the largest power of two that keeps them within
//! -127..=127, which is its shift: docs/theory/policy.md.

use crate::files::policy::{BIAS_LIMIT, Input, Network, Neuron};
use crate::files::{FileError, PolicyFile, near_or_all};
use rumbo_control::policy::{MOST_LAYERS, MOST_SHIFT, MOST_VALUES, OBSERVED, ONE, OUTPUTS};
use serde::Deserialize;
use std::ops::RangeInclusive;
use thiserror::Error;

/// A network in floats: `x = clip((column - centre) / scale, -1, 1)`, then `clip(weights x + biases, -1, 1)` for each layer.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Floats {
    /// What a neuron does with its sum: [`CLIP`], which is all that the robot does. Written down, so that no network of
    /// another kind is taken for one of these.
    pub activation: String,
    /// Its inputs.
    pub inputs: Vec<FloatInput>,
    /// Its layers, the outputs last: left wheel, right wheel, servo.
    pub layers: Vec<FloatLayer>,
}

/// Clipped to -1..1: `jnp.clip(x, -1, 1)`, `torch.nn.Hardtanh()`.
pub const CLIP: &str = "clip";

/// Columns that the environments of other tasks have in place of the goal's, each with what it is.
const SETPOINTS: [(&str, &str); 5] = [
    ("target_left_rad_s", "a wheel speed"),
    ("target_right_rad_s", "a wheel speed"),
    ("target_range_m", "a distance to a wall"),
    ("corner_ahead_m", "a corner of a course"),
    ("corner_left_m", "a corner of a course"),
];

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
#[derive(Clone, Debug, PartialEq, Error)]
pub enum QuantiseError {
    /// Its neurons do something else than the robot's.
    #[error(
        "activation = {0:?}: the robot's neurons are clipped to -1..1, so that they need no table; train with \
         torch.nn.Hardtanh or jnp.clip, and say \"clip\""
    )]
    Activation(String),
    /// An input is no column of the observation.
    #[error("`{0}` is no column of the observation; did you mean {near}?", near = near_or_all(.0, OBSERVED).join(", "))]
    Column(String),
    /// An input is the setpoint of a task, for which mode 9 has no source; what it is.
    #[error(
        "input `{0}`: mode 9 has no source for it: on the robot it is given a goal, never {1}; only policies of \
         the goal task can be exported"
    )]
    Setpoint(String, &'static str),
    /// A layer has not as many weights or biases as it must: which, and what is wrong.
    #[error("{0} has {1} values: must be {2}")]
    Count(String, usize, usize),
    /// A weight or bias is not finite, or too large.
    #[error(
        "{0} = {1}: must be a finite number that 8 bits can hold, less than 127; train with smaller weights"
    )]
    Number(String, f64),
    /// The centre or scale of an input makes no sense, and what it must be.
    #[error("{0} = {1}: must be {2}")]
    Input(String, f64, &'static str),
    /// There are too many or too few of something; the robot's limits.
    #[error("{0}: there are {1}, must be {limits}", limits = within(.2))]
    Shape(String, usize, RangeInclusive<usize>),
    /// The file that was made is not read.
    #[error(transparent)]
    File(FileError),
}

fn within(limits: &RangeInclusive<usize>) -> String {
    match (limits.start(), limits.end()) {
        (least, most) if least == most => most.to_string(),
        (least, most) => format!("{least} to {most}"),
    }
}

/// The policy of a network, in a file of this title.
///
/// # Errors
/// Why there is none.
pub fn quantise(floats: &Floats, title: &str) -> Result<PolicyFile, QuantiseError> {
    if floats.activation != CLIP {
        return Err(QuantiseError::Activation(floats.activation.clone()));
    }
    check_shape(floats)?;
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
    PolicyFile::parse("policy", "policy", &text).map_err(QuantiseError::File)
}

/// The robot has room and time for a network of this shape.
fn check_shape(floats: &Floats) -> Result<(), QuantiseError> {
    let within =
        |what: &str, count: usize, limits: RangeInclusive<usize>| match limits.contains(&count) {
            true => Ok(()),
            false => Err(QuantiseError::Shape(what.to_owned(), count, limits)),
        };
    within("inputs", floats.inputs.len(), 1..=MOST_VALUES)?;
    within("layers", floats.layers.len(), 1..=MOST_LAYERS)?;
    for (number, layer) in (1..).zip(&floats.layers) {
        let limits = match number == floats.layers.len() {
            true => OUTPUTS..=OUTPUTS,
            false => 1..=MOST_VALUES,
        };
        within(
            &format!("neurons of layer {number}"),
            layer.weights.len(),
            limits,
        )?;
    }
    Ok(())
}

fn input(input: &FloatInput) -> Result<Input, QuantiseError> {
    let FloatInput { of, centre, scale } = input;
    let column = OBSERVED.iter().position(|name| name == of);
    if let Some((name, what)) = SETPOINTS.iter().find(|(name, _)| name == of) {
        return Err(QuantiseError::Setpoint((*name).to_owned(), what));
    }
    let has_scale = scale.is_finite() && *scale > 0.0;
    for (what, value, is_fine, must) in [
        ("centre", centre, centre.is_finite(), "a finite number"),
        ("scale", scale, has_scale, "a finite number above 0"),
    ] {
        if !is_fine {
            let what = format!("{what} of {of}");
            return Err(QuantiseError::Input(what, *value, must));
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
