//! A fit says what the runs say, wherever it begins.

use super::{exercise, log, recorded};
use crate::problem::Problem;
use crate::unknowns::{UNKNOWNS, Unknown};
use crate::{FitProgress, Identified, identify};
use rumbo_plant::params::Params;

#[test]
fn two_fits_from_far_apart_end_at_the_same_values() {
    let mut robot = Params::default();
    robot.motor.inertia_kg_m2 *= 1.2;
    let run = [log(&recorded(&robot, exercise, 9.0))];
    let mut far = Params::default();
    far.motor.resistance_ohm *= 1.2;
    far.motor.inertia_kg_m2 *= 0.7;
    far.floor.rolling_n_m *= 0.7;
    let fitted = |start: &Params| {
        identify(&run, start, 0, &FitProgress::none())
            .unwrap()
            .parameters
    };
    let off = |(one, other): (&Identified, &Identified)| {
        (other.value - one.value).abs() / (1.96 * one.uncertainty)
    };
    let (one, other) = (fitted(&Params::default()), fitted(&far));
    for pair in one.iter().zip(&other) {
        assert!(off(pair) < 0.2, "{pair:?}");
    }
}

#[test]
fn an_unknown_near_its_limit_still_has_a_slope() {
    let run = [log(&recorded(&Params::default(), exercise, 3.0))];
    let problem = Problem::new(&UNKNOWNS, &run, &Params::default());
    let ratio = |unknown: &Unknown| unknown.keys[0].ends_with("onset_ratio");
    let index = UNKNOWNS.iter().position(ratio).unwrap();
    let value = |z| problem.value(index, z);
    // As believed: a logarithmic standard deviation of 0.5 about 0.7 above the limit 0.1.
    assert!((value(0.0) - 0.8).abs() < 1e-9 && (problem.slope(index, 0.0) - 0.35).abs() < 1e-9);
    for z in [-3.0, 0.0, 1.5, 3.0] {
        let slope = (value(z + 1e-5) - value(z - 1e-5)) / 2e-5;
        assert!((problem.slope(index, z) - slope).abs() < 1e-6, "at {z}");
        assert!(slope > 0.0 && (0.1..1.0).contains(&value(z)), "at {z}");
    }
    assert!(value(1e3) <= 1.0 && value(-1e3) >= 0.1);
}
