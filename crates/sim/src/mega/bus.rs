//! The two-wire bus at the chip: bytes to its devices and back, what they measure, what they show.

use super::pins::DriverInput;
use super::{CYCLES_PER_US, Mega, PARTS};
use crate::bus::{DeviceKind, Interrupt, Motion};
use rumbo_emulator::devices::{Input, Pwm, Transfer};
use rumbo_plant::noise::Noise;

/// How often it is looked whether a display has changed [us].
const LOOK_US: u64 = 200_000;
/// How often inertial sensors measure [us].
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

    /// What the inertial sensors measure, by name: `imu_forward_m_s2`.
    pub(super) fn read_imus(&mut self) -> Vec<(String, f64)> {
        let mut shown = Vec::new();
        for (device, imu) in self.bus.imus() {
            let names = ["forward_m_s2", "left_m_s2", "up_m_s2", "yaw_rad_s"];
            let named = names.iter().zip(imu.shown());
            shown.extend(named.map(|(name, value)| (format!("{}_{name}", device.name), value)));
        }
        shown
    }
}
