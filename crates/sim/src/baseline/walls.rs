//! The report's modes 1 to 4: sonars polled one after the other, PWM about an equilibrium (sections 2 and 3).
//!
//! | mode | equilibrium | controllers |
//! |---|---|---|
//! | 1, 2 | 65 | distance [cm] to PWM: far 1.5, near 1 (mode 2: 3) + 0.0001 per ms, switched at 5 cm, +-50 |
//! | 2 | | orientation [deg] to PWM: 1 + 0.001 per ms, +-10, added to one wheel |
//! | 3, 4 | 45, cruise + 25 | distance [cm] to angle [deg]: 1 + 0.00005 per ms, +-10; angle to PWM: 1 + 0.0005 per ms, +-40, added to one wheel |
//!
//! The first sonar is the right one of the front pair and the front one of the side pair. Signs: a positive signal drives
//! away from the wall ahead in modes 1 and 2, forward in 3 and 4. The angle is positive when the left one of the front
//! pair, or the front one of the side pair, reads more.
//!
//! Modes 1 and 2 sum errors on while an output is at its limit; in mode 2 a signal of at most 2 stands for 0.

use super::chip::Chip;
use super::pid::{Gains, Pid};
use rumbo_control::{SonarId, Wheels};

/// `delay()` at the end of a pass, and what the pass takes besides its readings [us].
const PAUSE_US: u64 = 61_000;
/// What a reading takes besides waiting for its echo [us].
const READING_US: u64 = 1_100;
/// So often `pulseIn` is asked here whether its echo has ended [us].
const POLL_US: u64 = 100;
/// `pulseIn` gives up after this [us] and returns 0.
const PATIENCE_US: u64 = 1_000_000;
/// Microseconds of echo per centimetre: 292 / 10 * 2.
const US_PER_CM: f64 = 58.4;
/// Errors beyond this are the far controller's [cm].
const SWITCH_CM: f64 = 5.0;
const CRUISE_PWM: f64 = 25.0;
/// Mode 2 releases a wheel whose signal is no larger.
const QUIET_PWM: f64 = 2.0;
/// Readings whose median is the distance to hold (mode 3).
const FIRST: usize = 5;

/// Which of the four.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Task {
    /// Mode 1.
    Distance,
    /// Mode 2.
    Align,
    /// Mode 3.
    Hold,
    /// Mode 4.
    Follow,
}

/// Modes 1 to 4.
#[derive(Clone, Debug)]
pub(super) struct Walls {
    task: Task,
    /// The wall is on the right: the wheels change parts.
    mirrored: bool,
    gap_cm: f64,
    equilibrium: f64,
    near: Pid,
    far: Pid,
    orientation: Pid,
    pub(super) reference_cm: f64,
    distance_cm: f64,
    angle_deg: f64,
    first: Vec<f64>,
    /// The sonar that is being waited for, and since when.
    waiting: Option<(SonarId, u64)>,
    readings_cm: [f64; 2],
}

impl Walls {
    pub(super) fn new(task: Task, mirrored: bool) -> Self {
        let ahead = matches!(task, Task::Distance | Task::Align);
        let near = match task {
            Task::Distance => Pid::winding_up(Gains(1.0, 0.0001, 0.0), 50.0),
            Task::Align => Pid::winding_up(Gains(3.0, 0.0001, 0.0), 50.0),
            Task::Hold | Task::Follow => Pid::new(Gains(1.0, 0.000_05, 0.0), 10.0),
        };
        Self {
            task,
            mirrored,
            gap_cm: if ahead { 12.0 } else { 14.0 },
            equilibrium: if ahead { 65.0 } else { 45.0 },
            near,
            far: Pid::winding_up(Gains(1.5, 0.0, 0.0), 50.0),
            orientation: if ahead {
                Pid::winding_up(Gains(1.0, 0.001, 0.0), 10.0)
            } else {
                Pid::new(Gains(1.0, 0.0005, 0.0), 40.0)
            },
            reference_cm: if ahead { 30.0 } else { 50.0 },
            distance_cm: 0.0,
            angle_deg: 0.0,
            first: Vec::new(),
            waiting: None,
            readings_cm: [0.0; 2],
        }
    }

    /// One step of the loop; returns for how long it then waits [us], if it waits for an echo.
    pub(super) fn pass(&mut self, chip: &mut Chip) -> Option<u64> {
        let (first, last) = match self.task {
            Task::Distance => (SonarId::Front, SonarId::Front),
            Task::Align => (SonarId::Right, SonarId::Left),
            Task::Hold | Task::Follow => (SonarId::Left, SonarId::Right),
        };
        let Some((sonar, since_us)) = self.waiting else {
            return Some(self.fire(chip, first));
        };
        let silent = chip.now_us >= since_us + PATIENCE_US;
        if !chip.answered(sonar) && !silent {
            return Some(POLL_US);
        }
        let reading_cm = if silent {
            0.0
        } else {
            chip.width_us(sonar) / US_PER_CM
        };
        self.readings_cm[usize::from(sonar == last)] = reading_cm;
        if sonar != last {
            return Some(self.fire(chip, last));
        }
        self.waiting = None;
        self.act(chip);
        None
    }

    fn fire(&mut self, chip: &mut Chip, sonar: SonarId) -> u64 {
        chip.ping(sonar);
        self.waiting = Some((sonar, chip.now_us));
        POLL_US
    }

    /// How long a pass takes besides waiting for echoes [us].
    pub(super) fn pause_us(&self) -> u64 {
        let readings = match self.task {
            Task::Distance => 1,
            Task::Align | Task::Hold | Task::Follow => 2,
        };
        PAUSE_US + readings * READING_US
    }

    /// Controls on the readings of this pass.
    fn act(&mut self, chip: &mut Chip) {
        let now_ms = chip.millis();
        self.locate();
        let error_cm = self.reference_cm - self.distance_cm;
        let [a, b] = match self.task {
            Task::Distance => [self.ranged(error_cm, now_ms); 2],
            Task::Align => {
                let signal = self.ranged(error_cm, now_ms);
                let more = self.orientation.step(0.0 - self.angle_deg, now_ms);
                shared(signal, more, signal >= 0.0)
            }
            Task::Hold if self.first.len() < FIRST => {
                self.first.push(self.distance_cm);
                self.first.sort_by(f64::total_cmp);
                self.reference_cm = self.first[self.first.len() / 2];
                return;
            }
            Task::Hold | Task::Follow => {
                let angle_ref_deg = self.near.step(error_cm, now_ms);
                let more = self
                    .orientation
                    .step(angle_ref_deg - self.angle_deg, now_ms);
                shared(CRUISE_PWM, more, true)
            }
        };
        let [a, b] = [a, b].map(|signal| self.pwm(signal));
        // Motor A is the right wheel when the wall is ahead or on the left.
        chip.drive(if self.mirrored {
            Wheels { left: a, right: b }
        } else {
            Wheels { left: b, right: a }
        });
    }

    /// The distance controller in force; the other one forgets.
    fn ranged(&mut self, error_cm: f64, now_ms: u64) -> f64 {
        if error_cm.abs() > SWITCH_CM {
            self.near.reset();
            self.far.step(error_cm, now_ms)
        } else {
            self.far.reset();
            self.near.step(error_cm, now_ms)
        }
    }

    /// Distance and angle from the readings. The listing counts the half gap with the wrong sign at negative angles: the
    /// recorded run of mode 2 has it so, that of mode 3 has it right. Mode 2 keeps its distance when both readings agree.
    fn locate(&mut self) {
        let [d1, d2] = self.readings_cm;
        match self.task {
            Task::Distance => self.distance_cm = d2,
            Task::Align => {
                let angle_rad = ((d2 - d1) / self.gap_cm).atan();
                let (sin, cos) = angle_rad.sin_cos();
                if d1 != d2 {
                    self.distance_cm = d1.max(d2) * cos - 0.5 * self.gap_cm * sin;
                }
                self.angle_deg = angle_rad.to_degrees();
            }
            Task::Hold | Task::Follow => {
                let angle_rad = ((d1 - d2) / self.gap_cm).atan();
                self.distance_cm = 0.5 * (d1 + d2) * angle_rad.cos();
                self.angle_deg = angle_rad.to_degrees();
            }
        }
    }

    /// A signal with the equilibrium; what it means for the wheel.
    fn pwm(&self, signal: f64) -> f64 {
        let away = matches!(self.task, Task::Distance | Task::Align);
        let forward = if away { -signal } else { signal };
        let quiet = if self.task == Task::Align {
            QUIET_PWM
        } else {
            0.0
        };
        if forward.abs() <= quiet {
            return 0.0;
        }
        forward + self.equilibrium.copysign(forward)
    }
}

/// The signal for motors A and B: the correction goes to one of them, so that it adds to its speed.
fn shared(signal: f64, more: f64, positive: bool) -> [f64; 2] {
    if (more > 0.0) == positive && more != 0.0 {
        [signal, signal + more]
    } else {
        [signal - more, signal]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance [cm] after these pairs of readings [cm], first sonar and second.
    fn distance_cm(task: Task, readings_cm: [[f64; 2]; 2]) -> f64 {
        let mut walls = Walls::new(task, false);
        for readings_cm in readings_cm {
            walls.readings_cm = readings_cm;
            walls.locate();
        }
        walls.distance_cm
    }

    #[test]
    fn beside_a_wall_the_distance_is_that_of_the_middle_at_either_sign_of_the_angle() {
        let away = distance_cm(Task::Hold, [[50.0; 2], [52.0, 50.0]]);
        let towards = distance_cm(Task::Hold, [[50.0; 2], [50.0, 52.0]]);
        assert!((away - 50.49).abs() < 0.01 && (away - towards).abs() < 1e-9);
    }

    #[test]
    fn before_a_wall_the_distance_depends_on_the_sign_of_the_angle() {
        let left_longer = distance_cm(Task::Align, [[50.0; 2], [50.0, 52.0]]);
        let right_longer = distance_cm(Task::Align, [[50.0; 2], [52.0, 50.0]]);
        assert!((left_longer - 50.30).abs() < 0.01, "{left_longer}");
        assert!((right_longer - 52.28).abs() < 0.02, "{right_longer}");
    }

    #[test]
    fn mode_2_alone_keeps_its_distance_when_both_readings_agree() {
        let readings_cm = [[50.0, 51.0], [40.0; 2]];
        assert_eq!(distance_cm(Task::Follow, readings_cm), 40.0);
        assert!(distance_cm(Task::Align, readings_cm) > 50.0);
    }

    #[test]
    fn mode_2_alone_releases_a_wheel_whose_signal_is_small() {
        let pwm = |task, signal| Walls::new(task, false).pwm(signal);
        assert_eq!(
            [2.0, -3.0].map(|signal| pwm(Task::Align, signal)),
            [0.0, 68.0]
        );
        assert_eq!(pwm(Task::Distance, -1.0), 66.0);
    }
}
