//! The report's wheel speed loops (sections 4.1 and 4.2): modes 5 and 6, and the lower layer of modes 7 and 8.

use super::chip::Chip;
use super::pid::{Gains, Pid};
use rumbo_control::{SIDES, Wheels};

/// Radius of the wheels in the program [m].
pub(super) const RADIUS_M: f64 = 0.0325;
/// Period of the timer that makes speeds of ticks [s].
pub(super) const TIMER_S: f64 = 0.05;
/// Speed of one tick per timer period [rpm]: 3.125.
const TICK_RPM: f64 = 60.0 / TIMER_S / 384.0;
pub(super) const RAD_S_PER_RPM: f64 = std::f64::consts::PI / 30.0;

/// One wheel: its direction as believed, its speed, its controller.
#[derive(Clone, Copy, Debug)]
struct Wheel {
    /// Direction of the last command, 0 once the timer has seen no tick.
    direction: i8,
    speed_rpm: f64,
    applied_rpm: f64,
    pid: Pid,
}

/// Both wheels' speed loops.
#[derive(Clone, Copy, Debug)]
pub(super) struct Speeds {
    wheels: Wheels<Wheel>,
    equilibrium: f64,
}

impl Speeds {
    pub(super) fn new(equilibrium: f64) -> Self {
        let pid = Pid::new(Gains(1.0, 0.001, 0.0), 255.0 - equilibrium);
        Self {
            wheels: Wheels::both(Wheel {
                direction: 0,
                speed_rpm: 0.0,
                applied_rpm: 0.0,
                pid,
            }),
            equilibrium,
        }
    }

    /// The timer, every 50 ms: a speed is the ticks of one period, its sign that of the last command.
    pub(super) fn timer(&mut self, chip: &mut Chip) {
        let ticks = chip.take_ticks();
        for side in SIDES {
            let wheel = &mut self.wheels[side];
            if ticks[side] == 0 {
                wheel.direction = 0;
            }
            let sign = if wheel.direction == 1 { 1.0 } else { -1.0 };
            wheel.speed_rpm = sign * f64::from(ticks[side]) * TICK_RPM + 0.0;
        }
    }

    /// Takes over new references: one that changes its sign is zero until the wheel stands.
    pub(super) fn refer(&mut self, reference_rpm: Wheels<f64>) {
        for side in SIDES {
            let wheel = &mut self.wheels[side];
            let reference = reference_rpm[side];
            let turned = sign(reference) != sign(wheel.applied_rpm);
            wheel.applied_rpm = if turned && wheel.direction != 0 {
                0.0
            } else {
                reference
            };
        }
    }

    /// Both wheels start together: while one waits, so does the other.
    pub(super) fn together(&mut self) {
        if self.applied_rpm().left == 0.0 || self.applied_rpm().right == 0.0 {
            for side in SIDES {
                self.wheels[side].applied_rpm = 0.0;
            }
        }
    }

    /// Adds to the references in force.
    pub(super) fn add(&mut self, rpm: Wheels<f64>) {
        for side in SIDES {
            self.wheels[side].applied_rpm += rpm[side];
        }
    }

    /// Steps the controllers and sets the bridges.
    pub(super) fn drive(&mut self, chip: &mut Chip) {
        let now_ms = chip.millis();
        let equilibrium = self.equilibrium;
        let mut pwm = Wheels::both(0.0);
        for side in SIDES {
            let wheel = &mut self.wheels[side];
            let output = wheel.pid.step(wheel.applied_rpm - wheel.speed_rpm, now_ms);
            let wanted = sign(wheel.applied_rpm);
            if wanted != 0 {
                wheel.direction = wanted;
                let ahead = f64::from(wanted);
                // The bridge's direction follows the reference; a negative demand is clamped to zero.
                pwm[side] = ahead * (ahead * output + equilibrium).clamp(0.0, 255.0);
            }
        }
        chip.drive(pwm);
    }

    /// Neither wheel has turned in the last timer period.
    pub(super) fn standing(&self) -> bool {
        self.wheels.left.direction == 0 && self.wheels.right.direction == 0
    }

    pub(super) fn speed_rpm(&self) -> Wheels<f64> {
        self.wheels.map(|wheel| wheel.speed_rpm)
    }

    pub(super) fn applied_rpm(&self) -> Wheels<f64> {
        self.wheels.map(|wheel| wheel.applied_rpm)
    }
}

fn sign(value: f64) -> i8 {
    i8::from(value > 0.0) - i8::from(value < 0.0)
}

/// Modes 5 and 6.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpeedMode {
    pub(super) speeds: Speeds,
    pub(super) reference_rpm: Wheels<f64>,
    /// Mode 6: the controller of the difference of the distances travelled [m].
    straight: Option<Pid>,
    travelled_m: Wheels<f64>,
}

impl SpeedMode {
    pub(super) fn new(straight: bool) -> Self {
        Self {
            speeds: Speeds::new(50.0),
            reference_rpm: Wheels::both(0.0),
            straight: straight.then(|| Pid::new(Gains(100.0, 0.000_001, 0.0), 5.0)),
            travelled_m: Wheels::both(0.0),
        }
    }

    pub(super) fn timer(&mut self, chip: &mut Chip) {
        self.speeds.timer(chip);
        let speed_rpm = self.speeds.speed_rpm();
        for side in SIDES {
            self.travelled_m[side] += speed_rpm[side] * RAD_S_PER_RPM * RADIUS_M * TIMER_S;
        }
    }

    /// One pass of the loop.
    pub(super) fn pass(&mut self, chip: &mut Chip) {
        self.speeds.refer(self.reference_rpm);
        let ahead = sign(self.reference_rpm.right);
        if let Some(pid) = &mut self.straight
            && self.speeds.applied_rpm().right != 0.0
        {
            // The slower wheel is given more, the faster one never less.
            let Wheels { left, right } = self.travelled_m;
            let more_rpm = pid.step(0.0 - (right - left), chip.millis());
            let extra = f64::from(ahead) * more_rpm.abs();
            self.speeds.add(if more_rpm < 0.0 {
                Wheels {
                    left: extra,
                    right: 0.0,
                }
            } else {
                Wheels {
                    left: 0.0,
                    right: extra,
                }
            });
        }
        self.speeds.drive(chip);
    }
}
