//! Robots of the same kind: what identification has to tell apart, drawn at random.

use crate::problem::UNKNOWNS;
use rumbo_plant::noise::{Noise, source};
use rumbo_plant::params::Params;

/// By how much such robots differ: standard deviation of the logarithm.
const SPREAD: f64 = 0.15;
/// The right motor against the left one: 3 % of the whole, since the logarithm counts from the lower limit.
const SPREAD_OF_STRENGTH: f64 = 0.06;
/// Numbers of [`source::DRAW`] from here on draw them.
const DRAWS: u32 = source::DRAW + 200;

/// Values for the parameters that identification fits, for another robot like this one.
#[must_use]
pub fn of_the_same_kind(params: &Params, seed: u64) -> Vec<(String, f64)> {
    let noise = Noise::new(seed, 0);
    let limits = Params::limits();
    let mut values = Vec::new();
    for (draw, unknown) in (DRAWS..).zip(&UNKNOWNS) {
        let normal = noise.normal(draw, 0);
        for key in unknown.keys {
            let limit = limits.iter().find(|limit| limit.key == *key);
            let (Some(limit), Some(value)) = (limit, params.get(key)) else {
                continue;
            };
            let spread = match *key {
                "wheels.right.strength" => SPREAD_OF_STRENGTH,
                _ => SPREAD,
            };
            // A robot without it is not like another one with a little of it.
            let value = match unknown.believed {
                Some(believed) if value <= limit.min => believed,
                _ => value,
            };
            let above = (value - limit.min) * (spread * normal).exp();
            values.push(((*key).to_owned(), (limit.min + above).min(limit.max)));
        }
    }
    values
}
