//! Networks in floats, made into the integers of a policy file.

use rumbo_control::policy::{OBSERVED, Observation, decide};
use rumbo_experiment::files::PolicyFile;
use rumbo_experiment::quantise::{CLIP, FloatInput, FloatLayer, Floats, quantise};

/// A network of two layers with weights that differ.
fn floats() -> Floats {
    let input = |of: &str, scale| FloatInput {
        of: of.into(),
        centre: 0.1,
        scale,
    };
    let weight = |row: usize, column: usize| f64::from((7 * row + 5 * column) as u32).sin() * 0.9;
    let layer = |neurons: usize, values: usize| FloatLayer {
        weights: (0..neurons)
            .map(|row| (0..values).map(|column| weight(row, column)).collect())
            .collect(),
        biases: (0..neurons).map(|row| 0.2 * weight(row, 9)).collect(),
    };
    Floats {
        activation: CLIP.into(),
        inputs: vec![
            input("goal_ahead_m", 4.0),
            input("goal_left_m", 4.0),
            input("range_front_m", 1.0),
        ],
        layers: vec![layer(8, 3), layer(3, 8)],
    }
}

/// What the floats make of an observation.
fn by_floats(network: &Floats, observation: &Observation) -> Vec<f64> {
    let inputs = network.inputs.iter().map(|input| {
        let column = OBSERVED.iter().position(|name| *name == input.of).unwrap();
        ((f64::from(observation[column]) - input.centre) / input.scale).clamp(-1.0, 1.0)
    });
    network
        .layers
        .iter()
        .fold(inputs.collect(), |values: Vec<f64>, layer| {
            let neurons = layer.weights.iter().zip(&layer.biases);
            let sum = |(weights, bias): (&Vec<f64>, &f64)| {
                let products = weights
                    .iter()
                    .zip(&values)
                    .map(|(weight, value)| weight * value);
                (bias + products.sum::<f64>()).clamp(-1.0, 1.0)
            };
            neurons.map(sum).collect()
        })
}

#[test]
fn integers_decide_as_the_floats_do_to_some_hundredths() {
    let network = floats();
    let policy = quantise(&network, "Two layers").unwrap();
    let read = |at: u16| policy.bytes[usize::from(at)];
    for step in 0..200 {
        let mut observation = Observation::default();
        for (column, value) in observation.iter_mut().enumerate() {
            *value = 3.0 * ((step * 13 + column * 29) as f32).sin();
        }
        let integers = decide(&policy.shape, read, &observation);
        for (integer, float) in integers.iter().zip(by_floats(&network, &observation)) {
            let off = f64::from(*integer) / 127.0 - float;
            assert!(off.abs() < 0.05, "step {step}: {integer} for {float}");
        }
    }
}

#[test]
fn the_file_of_a_policy_is_read_as_the_same_network() {
    let policy = quantise(&floats(), "A \"quoted\" title").unwrap();
    let again = PolicyFile::parse("policy", "policy", &policy.text).unwrap();
    assert_eq!(again, policy);
    assert_eq!(again.title, "A \"quoted\" title");
    assert_eq!(again.shape.to_string(), "3 inputs, 8, 3 neurons");
}

#[test]
fn what_cannot_be_quantised_is_refused_with_its_place() {
    let change = |change: &dyn Fn(&mut Floats)| {
        let mut network = floats();
        change(&mut network);
        quantise(&network, "Wrong").unwrap_err().to_string()
    };
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 127.6] {
        let why = change(&|it| it.layers[0].weights[2][1] = value);
        assert!(why.starts_with("neuron 3 of layer 1 = "), "{why}");
    }
    for value in [f64::NAN, f64::INFINITY, 1e9] {
        let why = change(&|it| it.layers[1].biases[0] = value);
        assert!(why.starts_with("neuron 1 of layer 2 = "), "{why}");
    }
    for (expected, why) in [
        (
            "scale of goal_ahead_m = 0: must be a finite number above 0",
            change(&|it| it.inputs[0].scale = 0.0),
        ),
        (
            "activation = \"tanh\": the robot's neurons are clipped",
            change(&|it| it.activation = "tanh".into()),
        ),
        (
            "input `target_range_m`: mode 9 has no source for it",
            change(&|it| it.inputs[0].of = "target_range_m".into()),
        ),
        (
            "neurons of layer 1: there are 64, must be 1 to 32",
            change(&|it| it.layers[0].weights = vec![vec![0.0; 3]; 64]),
        ),
        (
            "centre of goal_left_m = NaN: must be a finite number",
            change(&|it| it.inputs[1].centre = f64::NAN),
        ),
        (
            "`goal_ahed_m` is no column",
            change(&|it| it.inputs[0].of = "goal_ahed_m".into()),
        ),
        (
            "neuron 1 of layer 1 has 3 values: must be 2",
            change(&|it| it.inputs.truncate(2)),
        ),
        (
            "neuron 2 of layer 1 has 2 values: must be 3",
            change(&|it| it.layers[0].weights[1].truncate(2)),
        ),
        (
            "biases of layer 1 has 7 values: must be 8",
            change(&|it| it.layers[0].biases.truncate(7)),
        ),
        (
            "neurons of layer 1: there are 8, must be 3",
            change(&|it| it.layers.truncate(1)),
        ),
        (
            "layers: there are 0, must be 1 to 3",
            change(&|it| it.layers.clear()),
        ),
    ] {
        assert!(why.contains(expected), "{why}");
    }
}

#[test]
fn a_mistake_in_a_policy_file_is_named_with_its_line() {
    let good = quantise(&floats(), "Two layers").unwrap().text;
    let wrong = |from: &str, to: &str| {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        PolicyFile::parse("x", "x.toml", &text)
            .unwrap_err()
            .to_string()
    };
    for (why, part) in [
        (
            wrong("goal_ahead_m", "goal"),
            "x.toml:4: input[1].of = goal: must be a column",
        ),
        (
            wrong("scale = 4.0", "scale = 0.0"),
            "scale = 0.0: must be within",
        ),
        (wrong("title", "titel"), "title is missing"),
        (wrong("    [", "    [99, "), "99"),
        (
            wrong("neurons = [", "neurons = [1, "),
            "neurons[1] = 1: must be [shift, bias, weights...]",
        ),
        (
            wrong("[[layer]]", "[[layers]]"),
            "unknown key; did you mean `layer`?",
        ),
    ] {
        assert!(why.contains(part), "{why}");
    }
}
