//! Our robot as it runs on this machine: its ticks, and what stands for the chip's interrupts and timers.

use super::Sim;
use crate::board::{Board, micros};
use crate::files::FileError;
use rumbo_control::mode::ModeId;
use rumbo_control::params::ParamId;
use rumbo_control::{Inputs, OUTPUT_DELAY_US, Outputs, TICK_US};
use rumbo_robot::{Cell, Config, Robot};
use rumbo_wire::ResetCause;

/// The EEPROM's bytes; what has never been written is missing at the end.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory(pub(super) Vec<u8>);

impl Memory {
    fn write(&mut self, cell: Cell) {
        let at = usize::from(cell.address);
        if self.0.len() <= at {
            self.0.resize(at + 1, 0xFF);
        }
        if let Some(byte) = self.0.get_mut(at) {
            *byte = cell.value;
        }
    }
}

/// The robot, and what it has not done yet.
#[derive(Clone, Debug)]
pub(super) struct Native {
    robot: Robot,
    pub(super) board: Board,
    /// Its EEPROM.
    pub(super) memory: Memory,
    pub(super) next_tick_us: u64,
    /// Outputs and when they take effect.
    pub(super) pending: Option<(u64, Outputs)>,
}

impl Native {
    /// A robot with what its EEPROM holds, then these parameters, later ones in place of earlier ones.
    pub(super) fn new<'a>(
        memory: Memory,
        parameters: impl IntoIterator<Item = &'a (ParamId, f32)>,
    ) -> Result<Self, FileError> {
        let mut robot = Robot::new(Config {
            image: 0,
            reset: ResetCause::PowerOn,
        });
        robot.recall(|address| memory.0.get(usize::from(address)).copied().unwrap_or(0xFF));
        for (id, value) in parameters {
            set_param(&mut robot, *id, *value)?;
        }
        Ok(Self {
            robot,
            board: Board::default(),
            memory,
            next_tick_us: 0,
            pending: None,
        })
    }

    pub(super) fn mode_state(&self) -> Option<(ModeId, u8)> {
        self.robot.mode_state()
    }
}

fn set_param(robot: &mut Robot, id: ParamId, value: f32) -> Result<(), FileError> {
    robot
        .set_param(id as u8, value)
        .map(|_| ())
        .map_err(|refusal| {
            FileError::Setting(format!(
                "parameter {} = {value}: {}",
                id.name(),
                refusal.explanation()
            ))
        })
}

impl Sim {
    /// Lets robot and plant live until this time [us].
    pub(super) fn advance_native(&mut self, native: &mut Native, until_us: u64) {
        loop {
            let mut next_us = native.next_tick_us.min(until_us);
            if let Some((at_us, _)) = native.pending {
                next_us = next_us.min(at_us);
            }
            self.advance_plant(next_us, &mut |event| native.board.take(event));
            if let Some((at_us, outputs)) = native.pending
                && at_us == next_us
            {
                native.pending = None;
                self.apply(native, &outputs);
            }
            if native.next_tick_us == next_us && next_us < until_us {
                self.tick(native);
            }
            if next_us == until_us {
                return;
            }
        }
    }

    fn tick(&mut self, native: &mut Native) {
        let now_us = self.now_us();
        while let Some((_, byte)) = self.uplink.pop(now_us) {
            native.robot.receive(byte);
        }
        let echo = native
            .board
            .echo(now_us)
            .map(|answer| self.sonar_faults.answer(&self.noise, answer, now_us));
        let outputs = native.robot.tick(&Inputs {
            now: micros(now_us),
            encoders: native.board.encoders(),
            echo,
            battery_v: None,
        });
        // A byte takes 3.4 ms: the one before is written.
        if let Some(cell) = native.robot.store() {
            native.memory.write(cell);
        }
        native.pending = Some((now_us + u64::from(OUTPUT_DELAY_US), outputs));
        native.next_tick_us += u64::from(TICK_US);
        // The transmit interrupt hands a byte to the line whenever the line is free.
        while self.downlink.line_free_us() < native.next_tick_us {
            let Some(byte) = native.robot.transmit() else {
                break;
            };
            self.downlink.send(now_us, &[byte]);
        }
    }

    fn apply(&mut self, native: &mut Native, outputs: &Outputs) {
        self.set_bridges(outputs.drive);
        self.plant
            .set_servo(&mut self.state, f64::from(outputs.servo.0));
        if let Some(sonar) = outputs.ping {
            self.trigger(sonar);
            native.board.pinged(sonar, self.state.now_us());
        }
    }
}
