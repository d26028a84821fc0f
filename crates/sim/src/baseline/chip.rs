//! The hardware of the report's program: encoder ticks, echoes, the clock, the serial line, the pins.

use rumbo_control::{Duty, SonarId, Wheels};
use rumbo_plant::drivetrain::Side;
use rumbo_plant::plant::Event;
use rumbo_wire::FromRobot;

/// One byte at 9600 baud, 8N1 [us].
const BYTE_US: u64 = 1042;
/// The serial library's buffer [bytes]: what is in it does not block the program.
const BUFFER: u64 = 64;

/// What the program has written to its pins since the last call.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pins {
    /// PWM and direction of both bridges, if it wrote them.
    pub(crate) drive: Option<Wheels<Duty>>,
    /// Where the servo is to point [rad], if it wrote it.
    pub(crate) servo_rad: Option<f64>,
    /// Sonars triggered, by `SonarId` number.
    pub(crate) pings: [bool; 3],
}

/// The echo line of one sonar, as the program keeps it.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    rise_us: u64,
    answered: bool,
    width_us: f64,
}

/// The chip under the program.
#[derive(Clone, Debug, Default)]
pub(super) struct Chip {
    pub(super) now_us: u64,
    ticks: Wheels<u32>,
    lines: [Line; 3],
    /// When the serial line will have sent all that was printed [us].
    sent_us: u64,
    pub(super) pins: Pins,
    /// What it sent, as messages of our link, so that one metric serves both programs.
    pub(super) messages: Vec<FromRobot>,
}

impl Chip {
    /// The program's clock [ms].
    pub(super) fn millis(&self) -> u64 {
        self.now_us / 1000
    }

    /// An edge of an input pin; returns the sonar whose echo has just ended.
    pub(super) fn handle(&mut self, event: Event) -> Option<SonarId> {
        match event {
            Event::Edge { wheel, .. } => match wheel {
                Side::Left => self.ticks.left += 1,
                Side::Right => self.ticks.right += 1,
            },
            Event::EchoRise { sonar, at_us } => self.lines[sonar.index()].rise_us = at_us,
            Event::EchoFall { sonar, at_us } => {
                let line = &mut self.lines[sonar.index()];
                line.width_us = (at_us - line.rise_us) as f64;
                line.answered = true;
                return SonarId::ALL.get(sonar.index()).copied();
            }
            Event::Contact { .. } => {}
        }
        None
    }

    /// Ticks of both encoders since they were last taken.
    pub(super) fn take_ticks(&mut self) -> Wheels<u32> {
        std::mem::take(&mut self.ticks)
    }

    /// Triggers a sonar.
    pub(super) fn ping(&mut self, sonar: SonarId) {
        self.pins.pings[sonar as usize] = true;
        self.lines[sonar as usize].answered = false;
    }

    /// Whether the echo line has fallen since the last trigger.
    pub(super) fn answered(&self, sonar: SonarId) -> bool {
        self.lines[sonar as usize].answered
    }

    /// The last width of an echo [us], however absurd.
    pub(super) fn width_us(&self, sonar: SonarId) -> f64 {
        self.lines[sonar as usize].width_us
    }

    /// Sets PWM and direction of both bridges; 0 releases.
    pub(super) fn drive(&mut self, pwm: Wheels<f64>) {
        self.pins.drive = Some(pwm.map(|pwm| Duty::new(pwm as i16)));
    }

    /// PWM of both bridges, as last written in this pass.
    pub(super) fn driven(&self) -> Wheels<Duty> {
        self.pins.drive.unwrap_or_default()
    }

    /// Points the servo [deg], positive to the left.
    pub(super) fn point(&mut self, angle_deg: f64) {
        self.pins.servo_rad = Some(angle_deg.to_radians());
    }

    /// Prints a line; returns for how long that blocks [us].
    pub(super) fn print(&mut self, bytes: usize) -> u64 {
        self.sent_us = self.sent_us.max(self.now_us) + bytes as u64 * BYTE_US;
        self.sent_us.saturating_sub(self.now_us + BUFFER * BYTE_US)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_sets_the_period_of_a_loop_that_prints_more_than_it_takes() {
        let mut chip = Chip::default();
        for _ in 0..5 {
            chip.now_us += chip.print(80);
        }
        let before_us = chip.now_us;
        chip.now_us += chip.print(80);
        assert_eq!(chip.now_us - before_us, 80 * BYTE_US);
        chip.now_us += 300_000;
        assert_eq!(chip.print(80), 16 * BYTE_US);
    }
}
