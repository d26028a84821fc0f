//! The reflectance sensors at the chip: levels and voltages by the floor below them.

use super::Mega;
use crate::floor::{self, Line, NOISE_V};
use rumbo_emulator::devices::Input;
use rumbo_plant::contact::Pose;
use rumbo_plant::noise::Noise;

/// First noise source; each sensor takes one.
const SOURCE: u32 = 960;

impl Mega {
    /// The robot stands there now: its sensors see the floor.
    pub(crate) fn see_floor(&mut self, lines: &[Line], pose: &Pose, now_us: u64, noise: &Noise) {
        let firmware = self.firmware.clone();
        let cycle = self.chip.cycle();
        self.floor
            .resize(firmware.line_sensors().len(), (f64::NAN, false));
        for (index, sensor) in firmware.line_sensors().iter().enumerate() {
            let (before, level_before) = self.floor[index];
            let darkness = floor::darkness(lines, sensor.place(pose));
            if sensor.analogue {
                let error_v = NOISE_V * noise.normal(SOURCE + index as u32, now_us);
                let channel = sensor.pin.saturating_sub(firmware.board().first_analogue);
                let volts = sensor.volts(darkness) + error_v;
                self.chip.input(cycle, Input::Volts { channel, volts });
            }
            // digitalRead() works on the pin of an analogue one too.
            let level = sensor.level(darkness, level_before);
            if level != level_before || before.is_nan() {
                self.put(cycle, firmware.board().pin(sensor.pin), level);
            }
            self.floor[index] = (darkness, level);
        }
    }

    /// How dark it is below each sensor, by name: `line_left`.
    pub(super) fn read_floor(&self) -> impl Iterator<Item = (String, f64)> {
        let sensors = self.firmware.line_sensors().iter();
        let seen = sensors.zip(&self.floor);
        seen.map(|(sensor, (darkness, _))| (format!("line_{}", sensor.name), *darkness))
    }
}
