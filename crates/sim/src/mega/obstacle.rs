//! The infrared sensors for obstacles at the chip.

use super::Mega;
use rumbo_plant::contact::Pose;
use rumbo_plant::world::World;

impl Mega {
    /// The robot stands there now: its sensors look at the world.
    pub(crate) fn see_obstacles(&mut self, world: &World, pose: &Pose, now_us: u64) {
        let firmware = self.firmware.clone();
        self.obstacles
            .resize(firmware.obstacle_sensors().len(), None);
        for (index, sensor) in firmware.obstacle_sensors().iter().enumerate() {
            let before = self.obstacles[index];
            let Some(seen) = sensor.look(world, pose, now_us, before) else {
                continue;
            };
            if before.is_none_or(|before| before.volts != seen.volts) {
                self.apply(sensor.pin, Some(seen.volts));
            }
            self.obstacles[index] = Some(seen);
        }
    }

    /// How far away each sensor sees something, by name: `obstacle_left_m`.
    pub(super) fn read_obstacles(&self) -> impl Iterator<Item = (String, f64)> {
        let sensors = self.firmware.obstacle_sensors().iter();
        let seen = sensors.zip(&self.obstacles);
        seen.filter_map(|(sensor, seen)| {
            Some((format!("obstacle_{}_m", sensor.name), (*seen)?.range_m))
        })
    }
}
