//! A robot of a scenario with a program image, as a debugger holds it: a clone is a snapshot, and nothing is recorded.

use crate::files::{FileError, Setup};
use crate::operator::Operator;
use crate::run::of_seed;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::gdb::{DebuggedWorld, Machine};
use rumbo_sim::emulated::Emulated;
use rumbo_sim::mega::USB;
use rumbo_sim::trace::SAMPLE_US;
use std::sync::Arc;

/// A robot and what its scenario sends to it: step for step as in a run.
#[derive(Clone)]
pub struct Debugged {
    world: Emulated,
    operator: Operator<Arc<Setup>>,
    /// End of the current sample [us].
    sample_us: u64,
    end_us: u64,
}

impl Debugged {
    /// With the robot at its start.
    ///
    /// # Errors
    /// There is no image in the robot, or several robots; the setup's values do not fit together.
    pub fn new(setup: &Arc<Setup>, seed: u64) -> Result<Self, FileError> {
        let name = &setup.scenario.name;
        if setup.robots().len() > 1 {
            return Err(FileError::Setting(format!(
                "scenario {name} has several robots; debug in one with one robot"
            )));
        }
        let setup = of_seed(setup, seed)?;
        let mut sim = setup.sim(seed)?;
        let mut operator = Operator::new(setup.clone());
        operator.brief(&mut sim)?;
        let none = || FileError::Setting("there is no program image to debug".into());
        let end_us = (setup.scenario.duration_s * 1e6) as u64;
        Ok(Debugged {
            sample_us: sim.now_us(),
            world: Emulated::of(sim).ok_or_else(none)?,
            operator,
            end_us,
        })
    }
}

impl Machine for Debugged {
    fn chip(&self) -> &Chip {
        self.world.chip()
    }

    fn chip_mut(&mut self) -> &mut Chip {
        self.world.mega_mut().chip_mut()
    }

    fn go(&mut self) -> Stopped {
        if self.now_us() >= self.sample_us {
            self.operator.step(self.world.sim_mut());
            self.sample_us = (self.now_us() + SAMPLE_US).min(self.end_us);
        }
        self.world.advance(self.sample_us)
    }

    fn step(&mut self) -> Stopped {
        self.world.mega_mut().step();
        self.go()
    }

    fn is_over(&self) -> bool {
        self.now_us() >= self.end_us || self.world.sim().verdict().is_some()
    }
}

impl DebuggedWorld for Debugged {
    fn halt_at(&mut self, cycle: Option<u64>) {
        self.world.mega_mut().halt_at(cycle);
    }

    fn now_us(&self) -> u64 {
        self.world.sim().now_us()
    }

    fn take_output(&mut self) -> Vec<(u8, Vec<u8>)> {
        vec![(USB, self.world.mega_mut().take_console(USB))]
    }

    fn type_in(&mut self, bytes: &[u8]) {
        self.world.mega_mut().type_in(USB, bytes);
    }

    fn pins(&self) -> Vec<(String, bool)> {
        self.world.pins()
    }
}
