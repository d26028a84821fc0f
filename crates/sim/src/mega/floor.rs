//! The reflectance sensors at the chip: levels, voltages and times by the floor below them.

use super::firmware::Firmware;
use super::{CYCLES_PER_US, Mega};
use crate::floor::{self, DarkLine, FloorReading, NOISE_V};
use crate::source;
use rumbo_emulator::devices::Input;
use rumbo_emulator::devices::ports::{Drive, Pin};
use rumbo_plant::contact::Pose;
use rumbo_plant::noise::Noise;

/// A sensor's pin that a program charges.
#[derive(Clone, Copy, Debug)]
pub(super) struct Charge {
    /// The sensor's number.
    sensor: usize,
    pin: Pin,
    charged: bool,
    /// The cycle at which it falls.
    falls: Option<u64>,
}

impl Charge {
    /// Those of a program.
    pub(super) fn of(firmware: &Firmware) -> Vec<Self> {
        let sensors = firmware.line_sensors().iter().enumerate();
        let sensors = sensors.filter(|(_, sensor)| sensor.reading == FloorReading::Discharge);
        let charge = |(index, pin)| Self {
            sensor: index,
            pin,
            charged: false,
            falls: None,
        };
        let pins =
            sensors.filter_map(|(index, sensor)| Some((index, firmware.board().pin(sensor.pin)?)));
        pins.map(charge).collect()
    }
}

impl Mega {
    /// The robot stands there now: its sensors see the floor.
    pub(crate) fn see_floor(
        &mut self,
        lines: &[DarkLine],
        pose: &Pose,
        now_us: u64,
        noise: &Noise,
    ) {
        let firmware = self.firmware.clone();
        let cycle = self.chip.cycle();
        self.floor
            .resize(firmware.line_sensors().len(), (f64::NAN, false));
        for (index, sensor) in firmware.line_sensors().iter().enumerate() {
            let (before, level_before) = self.floor[index];
            let darkness = floor::darkness(lines, sensor.place(pose));
            if let FloorReading::Volts(usual_v) = sensor.reading {
                let error_v = NOISE_V * noise.normal(source::FLOOR + index as u32, now_us);
                let channel = sensor.pin.saturating_sub(firmware.board().first_analogue);
                let volts = sensor.volts(usual_v, darkness) + error_v;
                self.chip.input(cycle, Input::Volts { channel, volts });
            }
            // digitalRead() works on the pin of an analogue one too.
            let level = sensor.level(darkness, level_before);
            let gives_level = sensor.reading != FloorReading::Discharge;
            if gives_level && (level != level_before || before.is_nan()) {
                self.put(cycle, firmware.board().pin(sensor.pin), level);
            }
            self.floor[index] = (darkness, level);
        }
    }

    /// The chip does something to a pin: it charges a sensor's, or lets it go.
    pub(super) fn charge(&mut self, cycle: u64, pin: Pin, drive: Drive) {
        let Some(index) = self.charges.iter().position(|charge| charge.pin == pin) else {
            return;
        };
        let Charge {
            sensor, charged, ..
        } = self.charges[index];
        let lets_go = charged && matches!(drive, Drive::Floating | Drive::PullUp);
        if lets_go {
            let darkness = self
                .floor
                .get(sensor)
                .map_or(0.0, |(darkness, _)| *darkness);
            let high = floor::discharge_us(darkness.max(0.0)) * CYCLES_PER_US as f64;
            self.charges[index].falls = Some(cycle + high as u64);
            self.put(cycle, Some(pin), true);
        } else if matches!(drive, Drive::High | Drive::Low) {
            self.charges[index].falls = None;
            self.put(cycle, Some(pin), false);
        }
        self.charges[index].charged = drive == Drive::High;
    }

    /// The cycle at which a charged pin falls next.
    pub(super) fn next_fall(&self) -> Option<u64> {
        self.charges.iter().filter_map(|charge| charge.falls).min()
    }

    /// Lets the pins fall that do up to a cycle.
    pub(super) fn fall_up_to(&mut self, cycle: u64) {
        for index in 0..self.charges.len() {
            let Charge { pin, falls, .. } = self.charges[index];
            if let Some(at) = falls.filter(|at| *at <= cycle) {
                self.charges[index].falls = None;
                self.put(at, Some(pin), false);
            }
        }
    }

    /// How dark it is below each sensor, by name: `line_left`.
    pub(super) fn read_floor(&self) -> impl Iterator<Item = (String, f64)> {
        let sensors = self.firmware.line_sensors().iter();
        let seen = sensors.zip(&self.floor);
        seen.map(|(sensor, (darkness, _))| (format!("line_{}", sensor.name), *darkness))
    }
}
