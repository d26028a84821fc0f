//! The light sensors at the chip.

use super::Mega;
use crate::floor::NOISE_V;
use crate::light::{Light, LightReading};
use crate::source;
use rumbo_plant::contact::Pose;
use rumbo_plant::noise::Noise;
use rumbo_plant::world::World;

impl Mega {
    /// The robot stands there now: its sensors see the light.
    pub(crate) fn see_light(
        &mut self,
        light: &Light,
        world: &World,
        pose: &Pose,
        now_us: u64,
        noise: &Noise,
    ) {
        let firmware = self.firmware.clone();
        self.light.resize(firmware.light_sensors().len(), None);
        for (index, sensor) in firmware.light_sensors().iter().enumerate() {
            let before = self.light[index];
            let lux = sensor.lux(light, world, pose, now_us);
            let lit = sensor.respond(lux, now_us, (index, noise), before);
            let error_v = match sensor.reading {
                LightReading::Volts(_) => {
                    NOISE_V * noise.normal(source::LIGHT + index as u32, now_us)
                }
                LightReading::Level(_) => 0.0,
            };
            if error_v != 0.0 || before.is_none_or(|before| before.volts != lit.volts) {
                self.apply(sensor.pin, Some((lit.volts + error_v).clamp(0.0, 5.0)));
            }
            self.light[index] = Some(lit);
        }
    }

    /// How bright it is at each sensor, by name: `light_left_lux`.
    pub(super) fn read_light(&self) -> impl Iterator<Item = (String, f64)> {
        let sensors = self.firmware.light_sensors().iter();
        let lit = sensors.zip(&self.light);
        lit.filter_map(|(sensor, lit)| Some((format!("light_{}_lux", sensor.name), (*lit)?.lux)))
    }
}
