//! A simulation with an emulated chip, as debuggers hold it: it advances until the program halts. A clone is a snapshot.

use crate::mega::Mega;
use crate::sim::Sim;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::cpu::Stopped;

/// A simulation that has an emulated chip.
#[derive(Clone)]
pub struct Emulated(Sim);

impl Emulated {
    /// The simulation, if it has one.
    #[must_use]
    pub fn of(sim: Sim) -> Option<Self> {
        sim.mega().is_some().then_some(Self(sim))
    }

    /// The simulation.
    #[must_use]
    pub fn sim(&self) -> &Sim {
        &self.0
    }

    /// The same, to act on it. It keeps its chip.
    pub fn sim_mut(&mut self) -> &mut Sim {
        &mut self.0
    }

    /// Advances to this time \[us\], or until the program halts.
    pub fn advance(&mut self, until_us: u64) -> Stopped {
        self.0.advance(until_us);
        if let Some(stopped) = self.mega_mut().take_halt() {
            return stopped;
        }
        match self.chip().cpu().verdict() {
            Some(verdict) => Stopped::Ended(verdict.clone()),
            None => Stopped::Reached,
        }
    }

    /// The board.
    #[must_use]
    pub fn mega(&self) -> &Mega {
        match self.0.mega() {
            Some(mega) => mega,
            None => unreachable!("there was one at the beginning"),
        }
    }

    /// The same, to change it.
    pub fn mega_mut(&mut self) -> &mut Mega {
        match self.0.mega_mut() {
            Some(mega) => mega,
            None => unreachable!("there was one at the beginning"),
        }
    }

    /// The chip.
    #[must_use]
    pub fn chip(&self) -> &Chip {
        self.mega().chip()
    }

    /// The board's pins that are named, and their levels.
    #[must_use]
    pub fn pins(&self) -> Vec<(String, bool)> {
        let devices = self.chip().devices();
        let signals = self.mega().firmware().signals().into_iter();
        signals
            .map(|(name, pin)| (name, devices.level(pin)))
            .collect()
    }
}
