//! The echo lines between sonars and chip. Failures of a sonar happen here: its line has another width than the
//! plant's.

use super::Faults;
use rumbo_plant::sonar::SonarId;

/// The same sonar as the control core's type, which has no other ones: to those nothing happens.
pub(super) fn of_core(sonar: SonarId) -> Option<rumbo_control::SonarId> {
    rumbo_control::SonarId::ALL.get(sonar.index()).copied()
}

/// One line.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    /// Level at the sonar.
    level: bool,
    rise_us: u64,
    /// The line falls at this time, whatever the sonar measured.
    forced_us: Option<u64>,
    /// The sonar's own fall does not reach the chip.
    ignored: bool,
}

/// The lines of all sonars.
#[derive(Clone, Debug, Default)]
pub(super) struct Echoes {
    lines: [Line; SonarId::ALL.len()],
}

impl Echoes {
    /// The level at the sonar.
    pub(super) fn level(&self, sonar: SonarId) -> bool {
        self.lines[sonar.index()].level
    }

    /// An edge at the sonar; returns whether the chip sees it.
    pub(super) fn edge(
        &mut self,
        sonar: SonarId,
        level: bool,
        at_us: u64,
        faults: &mut Faults<'_>,
    ) -> bool {
        let line = &mut self.lines[sonar.index()];
        line.level = level;
        if level {
            if line.forced_us.is_some() {
                // Still held high by the fault.
                line.ignored = true;
                return false;
            }
            line.rise_us = at_us;
            let width_us =
                of_core(sonar).and_then(|sonar| faults.sonars.width_us(faults.noise, sonar, at_us));
            line.ignored = width_us.is_some();
            line.forced_us = width_us.map(|width_us| at_us + width_us.max(1));
            return true;
        }
        if line.ignored {
            return false;
        }
        let width_us = at_us - line.rise_us;
        if let Some(sonar) = of_core(sonar) {
            faults.sonars.sounded(sonar, width_us, at_us);
        }
        true
    }

    /// When a fault next lets a line fall [us].
    pub(super) fn next_forced_us(&self) -> Option<u64> {
        self.lines.iter().filter_map(|line| line.forced_us).min()
    }

    /// Lets the line fall that is due first.
    pub(super) fn take_forced(&mut self) -> Option<(u64, SonarId)> {
        let at_us = self.next_forced_us()?;
        let mut sonars = SonarId::ALL.into_iter();
        let sonar = sonars.find(|sonar| self.lines[sonar.index()].forced_us == Some(at_us))?;
        self.lines[sonar.index()].forced_us = None;
        Some((at_us, sonar))
    }
}
