//! A small network that mode 9 drives by: integers of 8 bits, worked on by turns over the ticks of a decision.
//!
//! observation -> inputs -> layers of neurons -> left wheel, right wheel, servo. A value of -127..=127 stands for -1..=1.
//! A neuron is `(bias + sum of weight * value + half) >> shift`, clipped to -127..=127; sums have 32 bits. The network
//! lies beside the program, where a byte is read by its address. Layout, numbers least significant byte first:
//!
//! | bytes | what |
//! |---|---|
//! | 0..4 | [`MAGIC`] |
//! | 4, 5 | bytes in all, the CRC included |
//! | 6, 7 | inputs; layers |
//! | 8.. | neurons of each layer, a byte each |
//! | then 9 for each input | column of the observation ([`OBSERVED`]); centre, factor: `f32` |
//! | then for each neuron, layer by layer | shift; bias, `i32`; a weight for each value of the layer before |
//! | last 2 | CRC-16/MCRF4XX of all before |

use crate::math::{clamp, round};
use crate::range::REACH_M;
use crate::types::{AgedRange, Pose, Range, TICK_S, Wheels};

/// First bytes of a network; the last is the version of this layout.
pub const MAGIC: [u8; 4] = *b"RPN\x01";
/// Most inputs, and most neurons of a layer.
pub const MOST_VALUES: usize = 32;
/// Most layers, the last one included.
pub const MOST_LAYERS: usize = 3;
/// Values that the last layer has: left wheel, right wheel, servo.
pub const OUTPUTS: usize = 3;
/// Ticks of a decision: 0.1 s.
pub const DECISION_TICKS: u8 = 10;
/// Products of a tick: of the dearest network 2,144 in nine ticks, where no neuron is begun that the tick does not finish.
pub const PRODUCTS: u16 = 288;
/// The largest value.
pub const ONE: i8 = 127;
/// Bytes before the neurons of each layer.
pub const HEADER: u16 = 8;
/// Bytes of an input, and of a neuron beside its weights.
pub const INPUT: u16 = 9;
/// Shift and bias.
pub const NEURON: u16 = 5;
/// Largest shift.
pub const MOST_SHIFT: u8 = 15;

/// Ages of ranges end here [s].
const OLDEST_S: f32 = 1.0;

/// What the robot's program knows: the columns of an observation.
pub const OBSERVED: [&str; 14] = [
    "left_rad_s",
    "right_rad_s",
    "range_left_m",
    "range_right_m",
    "range_front_m",
    "age_left_s",
    "age_right_s",
    "age_front_s",
    "servo_rad",
    "x_m",
    "y_m",
    "heading_rad",
    "goal_ahead_m",
    "goal_left_m",
];

/// Numbers in the order of [`OBSERVED`].
pub type Observation = [f32; OBSERVED.len()];

/// What an observation is made of.
#[derive(Clone, Copy, Debug)]
pub struct Known<'a> {
    /// Signed wheel speeds [rad/s].
    pub wheel_rad_s: &'a Wheels<f32>,
    /// Each sonar's range in its present direction.
    pub ranges: &'a [AgedRange; 3],
    /// Where the servo points [rad].
    pub servo_rad: f32,
    /// The pose by odometry.
    pub pose: &'a Pose,
}

/// An observation, with the goal `(x, y)` [m] seen from where the pose has its origin.
///
/// Ranges are [`REACH_M`] where nothing is within reach, and 0 of a sonar that is faulty or not there; ages are at most a
/// second.
pub fn observe(known: &Known<'_>, goal_m: &(f32, f32)) -> Observation {
    let Known {
        wheel_rad_s,
        ranges: [left, right, front],
        servo_rad,
        pose,
    } = *known;
    let (ahead_m, left_m) = pose.to_local(goal_m.0, goal_m.1);
    [
        wheel_rad_s.left,
        wheel_rad_s.right,
        range_m(left),
        range_m(right),
        range_m(front),
        age_s(left),
        age_s(right),
        age_s(front),
        servo_rad,
        pose.x_m,
        pose.y_m,
        pose.heading_rad,
        ahead_m,
        left_m,
    ]
}

fn range_m(aged: &AgedRange) -> f32 {
    match aged.range {
        Range::Valid(range_m) => range_m,
        Range::Clear => REACH_M,
        Range::Faulty => 0.0,
    }
}

fn age_s(aged: &AgedRange) -> f32 {
    let age_s = f32::from(aged.age_ticks) * TICK_S;
    clamp(age_s, 0.0, OLDEST_S)
}

/// Why bytes are no network.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NetworkError {
    /// They do not begin with [`MAGIC`].
    NotOne,
    /// Too many inputs, neurons or layers, or none; or the last layer has not [`OUTPUTS`] neurons.
    Shape,
    /// The bytes are not as many as the shape needs.
    Length,
}

/// How many inputs, layers and neurons a network has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NetworkShape {
    inputs: u8,
    layers: u8,
    neurons: [u8; MOST_LAYERS],
}

impl NetworkShape {
    /// A shape that can be evaluated.
    ///
    /// # Errors
    /// [`NetworkError::Shape`].
    pub fn new(inputs: usize, neurons: &[usize]) -> Result<Self, NetworkError> {
        let fits = |count: usize| (1..=MOST_VALUES).contains(&count);
        let is_whole = neurons.last() == Some(&OUTPUTS) && neurons.len() <= MOST_LAYERS;
        if !fits(inputs) || !is_whole || !neurons.iter().all(|count| fits(*count)) {
            return Err(NetworkError::Shape);
        }
        let mut shape = Self {
            inputs: (inputs & 0xFF) as u8,
            layers: (neurons.len() & 0xFF) as u8,
            neurons: [0; MOST_LAYERS],
        };
        for (slot, count) in shape.neurons.iter_mut().zip(neurons) {
            *slot = (count & 0xFF) as u8;
        }
        Ok(shape)
    }

    /// The shape of the network whose bytes `read` gives; their CRC is not looked at.
    ///
    /// # Errors
    /// They are no network.
    pub fn read(read: impl Fn(u16) -> u8) -> Result<Self, NetworkError> {
        if MAGIC
            .into_iter()
            .zip(0..)
            .any(|(byte, at)| read(at) != byte)
        {
            return Err(NetworkError::NotOne);
        }
        let (inputs, layers) = (read(6), read(7));
        let mut neurons = [0; MOST_LAYERS];
        for (slot, at) in neurons.iter_mut().take(usize::from(layers)).zip(HEADER..) {
            *slot = usize::from(read(at));
        }
        let counts = neurons.get(..usize::from(layers));
        let shape = Self::new(usize::from(inputs), counts.ok_or(NetworkError::Shape)?)?;
        match u16::from_le_bytes([read(4), read(5)]) == shape.bytes() {
            true => Ok(shape),
            false => Err(NetworkError::Length),
        }
    }

    /// Bytes in all.
    pub fn bytes(&self) -> u16 {
        let mut values = u16::from(self.inputs);
        let mut bytes = self.first_neuron();
        for neurons in self.neurons {
            bytes += u16::from(neurons) * (NEURON + values);
            values = u16::from(neurons);
        }
        bytes + 2
    }

    /// Where the inputs begin.
    pub fn first_input(&self) -> u16 {
        HEADER + u16::from(self.layers)
    }

    /// Where the neurons begin.
    pub fn first_neuron(&self) -> u16 {
        self.first_input() + INPUT * u16::from(self.inputs)
    }
}

#[cfg(feature = "names")]
impl core::fmt::Display for NetworkShape {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{} inputs", self.inputs)?;
        for neurons in self.neurons.iter().take(usize::from(self.layers)) {
            write!(f, ", {neurons}")?;
        }
        f.write_str(" neurons")
    }
}

/// A decision that is being worked on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decision {
    /// The layer whose neurons are next, and the first of these.
    layer: u8,
    neuron: u8,
    /// Where that begins.
    at: u16,
    /// Values of the layer before, and how many.
    values: [i8; MOST_VALUES],
    count: u8,
    /// Those of this layer, as far as they are there.
    next: [i8; MOST_VALUES],
}

impl Decision {
    /// Begins with an observation.
    pub fn begin(
        shape: &NetworkShape,
        read: impl Fn(u16) -> u8,
        observation: &Observation,
    ) -> Self {
        let mut decision = Self {
            at: shape.first_neuron(),
            count: shape.inputs,
            ..Self::default()
        };
        let mut at = shape.first_input();
        let inputs = decision.values.iter_mut().take(usize::from(shape.inputs));
        for value in inputs {
            let column = usize::from(read(at));
            let centre = float(&read, at + 1);
            let factor = float(&read, at + 5);
            let seen = observation.get(column).copied().unwrap_or(0.0);
            *value = clipped(round((seen - centre) * factor));
            at += INPUT;
        }
        decision
    }

    /// Works on it, for [`PRODUCTS`] at most.
    pub fn work(&mut self, shape: &NetworkShape, read: impl Fn(u16) -> u8) {
        let mut left = PRODUCTS;
        while let Some(neurons) = self.neurons(shape) {
            let products = u16::from(self.count);
            if products > left {
                return;
            }
            left -= products;
            self.one(&read);
            if self.neuron == neurons {
                self.values = self.next;
                self.count = neurons;
                self.neuron = 0;
                self.layer += 1;
            }
        }
    }

    /// The outputs; `None` while there is work to do.
    pub fn outputs(&self, shape: &NetworkShape) -> Option<[i8; OUTPUTS]> {
        let [left, right, servo, ..] = self.values;
        self.neurons(shape)
            .is_none()
            .then_some([left, right, servo])
    }

    /// Neurons of the layer that is worked on; `None` at the end.
    fn neurons(&self, shape: &NetworkShape) -> Option<u8> {
        let layer = self.layer;
        (layer < shape.layers)
            .then(|| shape.neurons.get(usize::from(layer)).copied())
            .flatten()
    }

    /// One neuron.
    fn one(&mut self, read: &impl Fn(u16) -> u8) {
        let shift = read(self.at) & MOST_SHIFT;
        let bytes = [1, 2, 3, 4].map(|offset| read(self.at + offset));
        let mut sum = i32::from_le_bytes(bytes);
        self.at += NEURON;
        for value in self.values.iter().take(usize::from(self.count)) {
            let product = i16::from(read(self.at).cast_signed()) * i16::from(*value);
            sum = sum.wrapping_add(i32::from(product));
            self.at += 1;
        }
        if let Some(slot) = self.next.get_mut(usize::from(self.neuron)) {
            let half = (1_i32 << shift) >> 1;
            *slot = clipped(sum.wrapping_add(half) >> shift);
        }
        self.neuron += 1;
    }
}

/// What a network makes of an observation, at once.
pub fn decide(
    shape: &NetworkShape,
    read: impl Fn(u16) -> u8,
    observation: &Observation,
) -> [i8; OUTPUTS] {
    let mut decision = Decision::begin(shape, &read, observation);
    for _ in 1..DECISION_TICKS {
        decision.work(shape, &read);
    }
    decision.outputs(shape).unwrap_or_default()
}

fn float(read: &impl Fn(u16) -> u8, at: u16) -> f32 {
    f32::from_le_bytes([0, 1, 2, 3].map(|offset| read(at + offset)))
}

fn clipped(value: i32) -> i8 {
    let one = i32::from(ONE);
    value.clamp(-one, one) as i8
}

#[cfg(test)]
mod tests;
