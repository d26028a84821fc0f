//! The spread of robots, batteries and floors from seed to seed.
//!
//! A seed stands for one robot on one day: no controller may rely on the nominal numbers. Uniform within the bounds
//! below, except the battery, which is uniform over its whole range of use. The pattern of the encoder's poles and
//! the changing slip and floor need no drawing here: they follow from the seed itself.

use crate::noise::{Noise, source};
use crate::params::Params;

/// Wheel radii, each, relative.
const RADIUS: f64 = 0.005;
/// Distance between the wheels, relative.
const BASE: f64 = 0.02;
/// Dry friction of each wheel's gears and of the floor, relative; breakaway friction follows.
const FRICTION: f64 = 0.15;
/// Battery's open-circuit voltage, V.
const BATTERY_V: (f64, f64) = (6.8, 8.4);
/// Speed of sound, relative.
const SOUND: f64 = 0.009;

impl Params {
    /// The robot of this seed: these parameters with the spread that every scenario applies unless it says otherwise.
    #[must_use]
    pub fn draw(&self, seed: u64, robot: u32) -> Self {
        let noise = Noise::new(seed, robot);
        let within = |index: u32, relative: f64| {
            1.0 + relative * (2.0 * noise.uniform(source::DRAW + index, 0) - 1.0)
        };
        let mut drawn = *self;

        drawn.wheels.left.radius_m *= within(0, RADIUS);
        drawn.wheels.right.radius_m *= within(1, RADIUS);
        drawn.body.base_m *= within(2, BASE);
        for (wheel, index) in [(&mut drawn.wheels.left, 3), (&mut drawn.wheels.right, 4)] {
            let friction = within(index, FRICTION);
            wheel.coulomb_forward_n_m *= friction;
            wheel.coulomb_backward_n_m *= friction;
        }
        drawn.floor.friction_scale *= within(5, FRICTION);
        let (low_v, high_v) = BATTERY_V;
        drawn.battery.open_circuit_v =
            low_v + (high_v - low_v) * noise.uniform(source::DRAW + 6, 0);
        drawn.sonar.temperature_c = at_sound_scale(drawn.sonar.temperature_c, within(7, SOUND));
        drawn
    }
}

/// Temperature at which sound is faster by `scale` than at `temperature_c`: speed = 331.3 + 0.606 T.
fn at_sound_scale(temperature_c: f64, scale: f64) -> f64 {
    let speed_m_s = 331.3 + 0.606 * temperature_c;
    (speed_m_s * scale - 331.3) / 0.606
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_draw_is_valid_and_within_its_bounds() {
        let nominal = Params::default();
        for seed in 0..2000 {
            let drawn = nominal.draw(seed, 0);
            assert_eq!(drawn.check(), Ok(()));
            assert!((drawn.body.base_m / nominal.body.base_m - 1.0).abs() <= BASE);
            assert!((6.8..8.4).contains(&drawn.battery.open_circuit_v));
            let sound = (331.3 + 0.606 * drawn.sonar.temperature_c) / (331.3 + 0.606 * 20.0);
            assert!((sound - 1.0).abs() <= SOUND + 1e-12);
        }
    }

    #[test]
    fn the_draws_fill_their_range() {
        let volts: Vec<f64> = (0..500)
            .map(|seed| Params::default().draw(seed, 0).battery.open_circuit_v)
            .collect();
        assert!(volts.iter().any(|&v| v < 6.85) && volts.iter().any(|&v| v > 8.35));
    }

    #[test]
    fn a_seed_is_a_robot() {
        let nominal = Params::default();
        assert_eq!(nominal.draw(7, 0), nominal.draw(7, 0));
        assert_ne!(nominal.draw(7, 0), nominal.draw(8, 0));
        assert_ne!(nominal.draw(7, 0), nominal.draw(7, 1));
    }
}
