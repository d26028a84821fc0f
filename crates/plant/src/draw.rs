//! The spread of robots, batteries and floors from seed to seed.
//!
//! A seed stands for one robot on one day: no controller may rely on the nominal numbers. Uniform within the bounds of
//! [`Spread`](crate::params::Spread). The pattern of the encoder's poles and the changing slip and floor need no drawing
//! here: they follow from the seed itself.

use crate::noise::{Noise, source};
use crate::params::Params;

impl Params {
    /// The robot of this seed: these parameters with their [`Spread`](crate::params::Spread), which every scenario
    /// applies unless it says otherwise. The same seed and number of the robot are the same robot.
    #[must_use]
    pub fn draw(&self, seed: u64, robot: u32) -> Self {
        let noise = Noise::new(seed, robot);
        let uniform = |index: u32| noise.uniform(source::DRAW + index, 0);
        let within = |index: u32, relative: f64| 1.0 + relative * (2.0 * uniform(index) - 1.0);
        let spread = &self.spread;
        let mut drawn = *self;

        drawn.wheels.left.radius_m *= within(0, spread.radius);
        drawn.wheels.right.radius_m *= within(1, spread.radius);
        drawn.body.base_m *= within(2, spread.base);
        let (static_ratio, memory, onset_ratio) = (
            within(10, spread.static_ratio),
            within(11, spread.friction_memory),
            within(15, spread.onset_ratio),
        );
        for (wheel, index) in [(&mut drawn.wheels.left, 3), (&mut drawn.wheels.right, 4)] {
            let friction = within(index, spread.friction);
            wheel.coulomb_forward_n_m *= friction;
            wheel.coulomb_backward_n_m *= friction;
            wheel.static_ratio = (wheel.static_ratio * static_ratio).max(1.0);
            wheel.friction_memory_s *= memory;
            wheel.onset_ratio = (wheel.onset_ratio * onset_ratio).clamp(0.1, 1.0);
        }
        drawn.floor.friction_scale *= within(5, spread.floor);
        drawn.battery.open_circuit_v =
            spread.battery_min_v + (spread.battery_max_v - spread.battery_min_v) * uniform(6);
        drawn.sonar.temperature_c =
            at_sound_scale(drawn.sonar.temperature_c, within(7, spread.sound));
        drawn.motor.back_emf_v_s *= within(8, spread.back_emf);
        drawn.wheels.right.strength *= within(9, spread.strength);
        drawn.body.yaw_inertia_kg_m2 *= within(12, spread.yaw_inertia);
        drawn.floor.yaw_damping_n_m_s *= within(13, spread.yaw_damping);
        drawn.floor.scrub_n_m *= within(14, spread.scrub);
        drawn.sonar.noise_growth *= within(16, spread.noise_growth);
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
            assert!((drawn.body.base_m / nominal.body.base_m - 1.0).abs() <= nominal.spread.base);
            assert!((6.8..8.4).contains(&drawn.battery.open_circuit_v));
            let sound = (331.3 + 0.606 * drawn.sonar.temperature_c) / (331.3 + 0.606 * 20.0);
            assert!((sound - 1.0).abs() <= nominal.spread.sound + 1e-12);
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
