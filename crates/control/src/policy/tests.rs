extern crate std;

use super::*;
use std::vec::Vec;

/// Bytes of a network with these inputs (column, centre, factor) and layers of neurons (shift, bias, weights).
fn bytes(inputs: &[(u8, f32, f32)], layers: &[&[(u8, i32, &[i8])]]) -> Vec<u8> {
    let neurons: Vec<usize> = layers.iter().map(|layer| layer.len()).collect();
    let shape = NetworkShape::new(inputs.len(), &neurons).unwrap();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(shape.bytes().to_le_bytes());
    bytes.extend([inputs.len() as u8, layers.len() as u8]);
    bytes.extend(neurons.iter().map(|count| *count as u8));
    for (column, centre, factor) in inputs {
        bytes.push(*column);
        bytes.extend(centre.to_le_bytes());
        bytes.extend(factor.to_le_bytes());
    }
    for (shift, bias, weights) in layers.iter().flat_map(|layer| layer.iter()) {
        bytes.push(*shift);
        bytes.extend(bias.to_le_bytes());
        bytes.extend(weights.iter().map(|weight| weight.cast_unsigned()));
    }
    bytes.extend([0; 2]);
    assert_eq!(bytes.len(), usize::from(shape.bytes()));
    bytes
}

fn decided(bytes: &[u8], observation: &Observation) -> [i8; OUTPUTS] {
    let read = |at: u16| bytes[usize::from(at)];
    decide(&NetworkShape::read(read).unwrap(), read, observation)
}

/// An observation of which these columns differ from zero.
fn seen(values: &[(&str, f32)]) -> Observation {
    let mut observation = Observation::default();
    for (name, value) in values {
        let column = OBSERVED.iter().position(|own| own == name).unwrap();
        observation[column] = *value;
    }
    observation
}

#[test]
fn a_neuron_is_a_sum_of_products_shifted_rounded_and_clipped() {
    let network = bytes(
        &[(12, 0.0, 127.0), (13, 0.5, 254.0)],
        &[&[(0, 7, &[0, 0]), (6, 0, &[64, -64]), (7, -32, &[127, 127])]],
    );
    let observe = |ahead_m, left_m| {
        let seen = seen(&[("goal_ahead_m", ahead_m), ("goal_left_m", left_m)]);
        decided(&network, &seen)
    };
    // Inputs 64 and 0: 64 * 64 / 64, and (64 * 127 - 32) / 128 = 63.25.
    assert_eq!(observe(0.5, 0.5), [7, 64, 63]);
    // Inputs 127, -127, both at their ends; the sum of 16,256 is beyond what an output holds.
    assert_eq!(observe(9.0, -9.0), [7, 127, 0]);
    // Half is rounded up, towards zero where it is negative: inputs 1 and 0, then -1 and 0, of weight 64 and shift 7.
    let half = bytes(
        &[(12, 0.0, 127.0)],
        &[&[(7, 0, &[64]), (7, 0, &[-64]), (0, -500, &[0])]],
    );
    assert_eq!(
        decided(&half, &seen(&[("goal_ahead_m", 1.0 / 127.0)])),
        [1, 0, -127]
    );
}

#[test]
fn what_is_not_a_number_is_an_input_of_zero() {
    let network = bytes(
        &[(12, 0.0, 127.0)],
        &[&[(0, 1, &[1]), (0, 0, &[1]), (0, 0, &[1])]],
    );
    for value in [f32::NAN, -0.0] {
        assert_eq!(
            decided(&network, &seen(&[("goal_ahead_m", value)])),
            [1, 0, 0]
        );
    }
    let infinite = decided(&network, &seen(&[("goal_ahead_m", f32::INFINITY)]));
    assert_eq!(infinite, [127; 3]);
}

#[test]
fn the_dearest_network_is_done_when_its_decision_is_due() {
    let weights = [3_i8; MOST_VALUES];
    let inputs = [(12, 0.0, 30.0); MOST_VALUES];
    let wide = [(9, 100, &weights[..]); MOST_VALUES];
    let network = bytes(&inputs, &[&wide, &wide, &wide[..OUTPUTS]]);
    let read = |at: u16| network[usize::from(at)];
    let shape = NetworkShape::read(read).unwrap();
    let mut decision = Decision::begin(&shape, read, &seen(&[("goal_ahead_m", 1.0)]));
    let mut ticks = 0;
    while decision.outputs(&shape).is_none() {
        decision.work(&shape, read);
        ticks += 1;
    }
    assert!(ticks < DECISION_TICKS, "{ticks}");
    assert_eq!(
        decision.outputs(&shape),
        Some(decided(&network, &seen(&[("goal_ahead_m", 1.0)])))
    );
    let done = decision;
    decision.work(&shape, read);
    assert_eq!(decision, done, "nothing is left to do");
}

#[test]
fn a_shape_that_cannot_be_evaluated_is_refused() {
    for (inputs, neurons) in [
        (0, &[3][..]),
        (33, &[3]),
        (4, &[]),
        (4, &[4]),
        (4, &[0, 3]),
        (4, &[33, 3]),
        (4, &[8, 8, 8, 3]),
    ] {
        assert_eq!(
            NetworkShape::new(inputs, neurons),
            Err(NetworkError::Shape),
            "{inputs} {neurons:?}"
        );
    }
}

#[test]
fn bytes_that_are_no_network_are_told_apart() {
    let whole = bytes(
        &[(0, 0.0, 1.0)],
        &[&[(0, 0, &[1]), (0, 0, &[1]), (0, 0, &[1])]],
    );
    let read_with = |at: usize, value: u8| {
        let mut bytes = whole.clone();
        bytes[at] = value;
        NetworkShape::read(|at| bytes.get(usize::from(at)).copied().unwrap_or(0xFF))
    };
    assert!(read_with(0, MAGIC[0]).is_ok());
    assert_eq!(NetworkShape::read(|_| 0xFF), Err(NetworkError::NotOne));
    assert_eq!(
        read_with(3, 2),
        Err(NetworkError::NotOne),
        "another version"
    );
    assert_eq!(read_with(4, 0), Err(NetworkError::Length));
    for (at, value) in [(6, 0), (6, 99), (7, 0), (7, 200), (8, 2)] {
        assert_eq!(
            read_with(at, value),
            Err(NetworkError::Shape),
            "{at} {value}"
        );
    }
}
