//! The report's program, as it runs on this machine: what it does takes effect at once.

use super::Sim;
use crate::baseline::Baseline;
use rumbo_control::SonarId;

impl Sim {
    /// Advances program and plant to this time [us].
    pub(super) fn advance_baseline(&mut self, baseline: &mut Baseline, until_us: u64) {
        loop {
            let next_us = baseline.next_us().max(self.now_us()).min(until_us);
            self.advance_plant(next_us, &mut |event| baseline.handle(event));
            if next_us == until_us {
                return;
            }
            self.tick_baseline(baseline);
        }
    }

    fn tick_baseline(&mut self, baseline: &mut Baseline) {
        let pins = baseline.tick(self.now_us());
        if let Some(drive) = pins.drive {
            self.set_bridges(drive);
        }
        if let Some(servo_rad) = pins.servo_rad {
            self.plant.set_servo(&mut self.state, servo_rad);
        }
        for sonar in SonarId::ALL {
            if pins.pings[sonar as usize] {
                self.trigger(sonar);
            }
        }
    }
}
