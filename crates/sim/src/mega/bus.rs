//! The two-wire bus at the chip: bytes to its devices and back, what they measure, what they show.

use super::pins::DriverInput;
use super::{CYCLES_PER_US, Mega, PARTS};
use crate::bus::vl53l0x::sight::{Eyes, Sight};
use crate::bus::{DeviceKind, Interrupt, Motion};
use rumbo_emulator::devices::{Input, Pwm, Transfer};
use rumbo_plant::noise::Noise;
use rumbo_plant::world::World;

/// How often it is looked whether a display has changed [us].
const LOOK_US: u64 = 200_000;
/// How often inertial sensors and compasses may measure [us].
const MEASURING_US: u64 = 1_000;
/// How long INT is active where it is a pulse (register map, INT_PIN_CFG).
const PULSE_CYCLES: u64 = 50 * CYCLES_PER_US;

impl Mega {
    /// A byte begins on the bus in this cycle.
    pub(super) fn transfer(&mut self, cycle: u64, transfer: Transfer) {
        if transfer == Transfer::End {
            self.switch_shield(cycle);
        }
        if let Some(reply) = self.bus.transfer(transfer, cycle) {
            self.chip.input(cycle, Input::TwoWire(reply));
            if transfer == Transfer::Read {
                self.raise_interrupts(cycle, |_| false);
            }
        }
    }

    /// The inputs of the motors that are on the outputs of a shield's chip.
    fn switch_shield(&mut self, cycle: u64) {
        let Some(chip) = self.bus.shield() else {
            return;
        };
        let period_cycles = Some(chip.period_cycles());
        let wired = self.firmware.wires().bridges;
        for (half, inputs) in self.bridges.iter_mut().zip(wired) {
            for (line, input) in half.lines.iter_mut().zip(inputs) {
                if let DriverInput::Output(output) = input {
                    let share = chip.share(output);
                    let moves = share > 0.0 && share < 1.0;
                    line.set(cycle, share == 1.0);
                    line.modulate(moves.then_some(Pwm {
                        share,
                        period_cycles,
                    }));
                }
            }
        }
    }

    /// The robot moves so: its inertial sensors measure it, in whole milliseconds.
    pub(crate) fn feel(&mut self, motion: Motion, now_us: u64, noise: &Noise) {
        if !now_us.is_multiple_of(MEASURING_US) {
            return;
        }
        let mut fresh = Vec::new();
        for (device, imu) in self.bus.imus() {
            let DeviceKind::Mpu6050 { at_m, .. } = device.kind else {
                continue;
            };
            let due_us = imu.next_us();
            imu.measure(motion, at_m, now_us, noise);
            fresh.push(imu.next_us() != due_us);
        }
        if !fresh.is_empty() {
            self.raise_interrupts(self.chip.cycle(), |index| fresh[index]);
        }
    }

    /// North is so far to the left of ahead \[rad\]: its compasses measure it, in whole milliseconds.
    pub(crate) fn orient(&mut self, north_rad: f64, now_us: u64, noise: &Noise) {
        if now_us.is_multiple_of(MEASURING_US) {
            self.bus.orient(north_rad, now_us, noise);
        }
    }

    /// The robot stands there now: its sensors of distance look at the world, as far as a measurement ends before the next time.
    pub(crate) fn range_by_light(
        &mut self,
        world: &World,
        eyes: &Eyes,
        now_us: u64,
        noise: &Noise,
    ) {
        let cycle = self.cycle_of(now_us);
        let until = cycle + MEASURING_US * CYCLES_PER_US;
        for (device, ranger) in self.bus.rangers() {
            let DeviceKind::Vl53l0x { mount, .. } = device.kind else {
                continue;
            };
            if ranger.ends_within(cycle, until) {
                let sight = Sight::of(world, eyes, &mount, now_us);
                ranger.see(sight, noise);
            }
        }
    }

    /// The INT outputs that are wired; `fresh` of each sensor: a value has just come.
    fn raise_interrupts(&mut self, cycle: u64, fresh: impl Fn(usize) -> bool) {
        let board = self.firmware.board();
        let mut levels = Vec::new();
        for (index, (device, imu)) in self.bus.imus().enumerate() {
            let DeviceKind::Mpu6050 {
                interrupt: Some(number),
                ..
            } = device.kind
            else {
                continue;
            };
            match imu.interrupt(fresh(index)) {
                Some(Interrupt::Level(level)) => levels.push((cycle, number, level)),
                Some(Interrupt::Pulse { active }) => {
                    levels.push((cycle, number, active));
                    levels.push((cycle + PULSE_CYCLES, number, !active));
                }
                None => {}
            }
        }
        for (cycle, number, level) in levels {
            self.put(cycle, board.pin(number), level);
        }
    }

    /// Says on the console of the parts what displays show that have changed.
    pub(crate) fn look_at_displays(&mut self, now_us: u64) {
        if now_us.is_multiple_of(LOOK_US) {
            let console = &mut self.consoles[usize::from(PARTS)];
            let lines = self.bus.changed();
            let bytes = lines.iter().flat_map(|line| line.bytes());
            bytes.for_each(|byte| console.push(byte));
        }
    }

    /// What its sensors measure, by name: `imu_forward_m_s2`, `compass_azimuth_rad`, `tof_range_m`.
    pub(super) fn read_bus(&mut self) -> Vec<(String, f64)> {
        let mut shown = Vec::new();
        for (device, imu) in self.bus.imus() {
            let names = ["forward_m_s2", "left_m_s2", "up_m_s2", "yaw_rad_s"];
            let named = names.iter().zip(imu.shown());
            shown.extend(named.map(|(name, value)| (format!("{}_{name}", device.name), value)));
        }
        let azimuths = self.bus.azimuths();
        shown.extend(azimuths.map(|(device, rad)| (format!("{}_azimuth_rad", device.name), rad)));
        let rangers = self.bus.rangers();
        shown.extend(
            rangers.map(|(device, ranger)| (format!("{}_range_m", device.name), ranger.shown_m())),
        );
        shown
    }
}
