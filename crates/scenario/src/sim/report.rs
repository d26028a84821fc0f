//! The report's program, as it runs on this machine: what it does takes effect at once.

use super::Sim;
use crate::original::Original;
use rumbo_control::SonarId;

impl Sim {
    /// Lets program and plant live until this time [us].
    pub(super) fn advance_original(&mut self, original: &mut Original, until_us: u64) {
        loop {
            let next_us = original.next_us().max(self.now_us()).min(until_us);
            self.advance_plant(next_us, &mut |event| original.take(event));
            if next_us == until_us {
                return;
            }
            self.tick_original(original);
        }
    }

    fn tick_original(&mut self, original: &mut Original) {
        let pins = original.tick(self.now_us());
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
