//! The simulation of the lab as a debugger holds it: a clone is a snapshot, which goes on bit for bit the same.

use crate::sight;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;
use rumbo_emulator::gdb::{DebuggedWorld, Machine};
use rumbo_session::{SLICE_US, Shown};
use rumbo_sim::Sim;
use rumbo_sim::emulated::Emulated;
use rumbo_sim::mega::USB;

/// The stream of what the robot sends over the link; the others are USARTs.
pub(crate) const LINK: u8 = u8::MAX;

/// A simulation with an emulated chip, in the session's slices of time.
#[derive(Clone)]
pub struct Live {
    world: Emulated,
    slice_us: u64,
    reading_due_us: u64,
    /// Part of the world, so that a snapshot goes on averaging where it was.
    shown: Option<Shown>,
}

impl Live {
    /// The simulation, if it has an emulated chip.
    #[must_use]
    pub fn of(sim: Sim) -> Option<Self> {
        Some(Self {
            slice_us: sim.now_us(),
            reading_due_us: sim.now_us(),
            world: Emulated::of(sim)?,
            shown: None,
        })
    }

    pub(crate) fn sim(&self) -> &Sim {
        self.world.sim()
    }

    pub(crate) fn sim_mut(&mut self) -> &mut Sim {
        self.world.sim_mut()
    }

    /// What its instruments have shown last, and when the next reading is due \[us\].
    pub(crate) fn shown(&self) -> (Option<&Shown>, u64) {
        (self.shown.as_ref(), self.reading_due_us)
    }
}

impl Machine for Live {
    fn chip(&self) -> &Chip {
        self.world.chip()
    }

    fn chip_mut(&mut self) -> &mut Chip {
        self.world.mega_mut().chip_mut()
    }

    fn go(&mut self) -> Stopped {
        if self.now_us() >= self.slice_us {
            self.slice_us = (self.now_us() / SLICE_US + 1) * SLICE_US;
            if sight::reading_due(self.world.sim(), &mut self.reading_due_us) {
                self.shown = sight::shown(self.world.sim_mut());
            }
        }
        self.world.advance(self.slice_us)
    }

    fn step(&mut self) -> Stopped {
        self.world.mega_mut().step();
        self.go()
    }
}

impl DebuggedWorld for Live {
    fn halt_at(&mut self, cycle: Option<u64>) {
        self.world.mega_mut().halt_at(cycle);
    }

    fn now_us(&self) -> u64 {
        self.world.sim().now_us()
    }

    fn take_output(&mut self) -> Vec<(u8, Vec<u8>)> {
        let sim = self.world.sim_mut();
        let mut output = sight::consoles(sim);
        let mut link = Vec::new();
        sim.receive(&mut link);
        output.push((LINK, link));
        output
    }

    fn type_in(&mut self, bytes: &[u8]) {
        self.world.mega_mut().type_in(USB, bytes);
    }

    fn pins(&self) -> Vec<(String, bool)> {
        self.world.pins()
    }
}
