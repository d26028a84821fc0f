//! The range finders at the chip that measure by themselves.

use super::Mega;
use rumbo_emulator::devices::ports::Drive;
use rumbo_plant::contact::Pose;
use rumbo_plant::params;
use rumbo_plant::world::World;

impl Mega {
    /// The robot stands there now: its range finders measure, and do what they do up to a time.
    pub(crate) fn range_by_sound(
        &mut self,
        (world, pose): (&World, &Pose),
        sound: &params::Sonar,
        now_us: u64,
        end_us: u64,
    ) {
        let firmware = self.firmware.clone();
        let board = firmware.board();
        let sensors = firmware.maxsonars();
        self.ranging.resize_with(sensors.len(), Default::default);
        for (index, sensor) in sensors.iter().enumerate() {
            let rx = sensor.rx.and_then(|pin| board.pin(pin));
            let held = rx.is_some_and(|pin| self.chip.devices().drive(pin) == Drive::Low);
            let ranging = &mut self.ranging[index];
            ranging.range(sensor, held, now_us, (world, pose, sound));
            if sensor.analogue {
                if let Some(volts) = ranging.voltage(now_us) {
                    self.apply(sensor.pin, Some(volts));
                }
                continue;
            }
            while let Some((at_us, level)) = self.ranging[index].edge(end_us) {
                self.put(self.cycle_of(at_us), board.pin(sensor.pin), level);
            }
        }
    }

    /// What each measured last, by name: `maxsonar_front_m`.
    pub(super) fn read_ranges(&self) -> impl Iterator<Item = (String, f64)> {
        let sensors = self.firmware.maxsonars().iter().zip(&self.ranging);
        sensors.map(|(sensor, ranging)| (format!("maxsonar_{}_m", sensor.name), ranging.range_m))
    }
}
