//! The emulated Mega and the plant in lockstep.
//!
//! The plant looks at most a millisecond ahead on a copy of its state, and announces the edges it finds. The chip runs, each
//! edge in place at its cycle, until it does something that the robot feels. Then the plant follows to that microsecond for
//! good, takes it in, and looks ahead again: what was announced for later is taken back, none of it has reached the chip.

use super::Sim;
use super::touches::Touches;
use crate::bus::Motion;
use crate::bus::vl53l0x::sight::Eyes;
use crate::mega::{Action, Faults, Mega, Pause};
use rumbo_control::{Duty, SonarId};
use rumbo_plant::drivetrain::{Bridge, Side};

/// How far the plant looks ahead, and the grid it keeps to [us].
const AHEAD_US: u64 = 1_000;
/// Bits of a byte of the link.
const BYTE_BITS: u64 = 10;

impl Sim {
    /// Advances chip and plant to this time [us], or to a breakpoint.
    pub(super) fn advance_mega(&mut self, mega: &mut Mega, until_us: u64) {
        while self.now_us() < until_us {
            let end_us = ((self.now_us() / AHEAD_US + 1) * AHEAD_US).min(until_us);
            self.bytes_to(mega, end_us);
            mega.supply(self.plant.battery_v(&self.state));
            if !mega.firmware().line_sensors().is_empty() {
                mega.see_floor(&self.lines, &self.pose(), self.now_us(), &self.noise);
            }
            if !mega.firmware().obstacle_sensors().is_empty() {
                mega.see_obstacles(self.world(), &self.pose(), self.now_us());
            }
            if !mega.firmware().light_sensors().is_empty() {
                let (now_us, pose) = (self.now_us(), self.pose());
                mega.see_light(&self.light, self.world(), &pose, now_us, &self.noise);
            }
            if !mega.firmware().maxsonars().is_empty() {
                let (from, sound) = ((self.world(), &self.pose()), &self.params.sonar);
                mega.range_by_sound(from, sound, self.now_us(), end_us);
            }
            if !mega.firmware().bus().is_empty() {
                let [forward_m_s, yaw_rad_s] = self.state.speed();
                let motion = Motion {
                    forward_m_s,
                    yaw_rad_s,
                };
                mega.feel(motion, self.now_us(), &self.noise);
                let north_rad = self.north_rad - self.pose().heading_rad;
                mega.orient(north_rad, self.now_us(), &self.noise);
                let eyes = Eyes {
                    pose: self.pose(),
                    servo_rad: self.state.servo_rad(),
                };
                mega.range_by_light(self.world(), &eyes, self.now_us(), &self.noise);
                mega.look_at_displays(self.now_us());
            }
            mega.send_infrared(self.now_us(), end_us);
            if !self.wire_faults.is_empty() {
                let now_us = self.now_us();
                mega.disturb(
                    now_us,
                    end_us,
                    &mut Faults {
                        sonars: &mut self.sonar_faults,
                        wires: &mut self.wire_faults,
                        noise: &self.noise,
                    },
                );
            }
            let halted = self.lockstep(mega, end_us);
            for (at_us, byte) in mega.take_sent() {
                // The link counts the byte's own time, which has passed on the chip's line.
                self.downlink
                    .send(at_us.saturating_sub(self.byte_us()), &[byte]);
            }
            if halted {
                return;
            }
        }
    }

    /// A byte's time on the link [us].
    fn byte_us(&self) -> u64 {
        (BYTE_BITS * 1_000_000).div_ceil(u64::from(self.baud))
    }

    /// Bytes whose first bit reaches the chip before this time.
    fn bytes_to(&mut self, mega: &mut Mega, end_us: u64) {
        while let Some((at_us, byte)) = self.uplink.pop(end_us + self.byte_us()) {
            mega.receive(at_us, byte, self.baud);
        }
    }

    /// One look-ahead; returns whether a breakpoint ended it.
    fn lockstep(&mut self, mega: &mut Mega, end_us: u64) -> bool {
        loop {
            mega.look_ahead();
            let mut ahead = self.state;
            let mut touches = Touches::default();
            self.plant.advance(&mut ahead, end_us, &mut |event| {
                touches.note(&event);
                mega.expect(event);
            });
            let pause = mega.run(
                end_us,
                &mut Faults {
                    sonars: &mut self.sonar_faults,
                    wires: &mut self.wire_faults,
                    noise: &self.noise,
                },
            );
            let at_us = match pause {
                Pause::Reached => {
                    self.state = ahead;
                    self.touches.0.append(&mut touches.0);
                    self.watch_reverse();
                    return false;
                }
                Pause::Act(at_us) | Pause::Halted(at_us) => at_us,
            };
            self.follow(mega, at_us);
            for action in mega.take_actions() {
                self.act(action);
            }
            if matches!(pause, Pause::Halted(_)) {
                return true;
            }
        }
    }

    /// The plant follows the chip for good. Its step differs from the look-ahead's, so an edge may fall a little
    /// otherwise.
    fn follow(&mut self, mega: &mut Mega, at_us: u64) {
        let mut faults = Faults {
            sonars: &mut self.sonar_faults,
            wires: &mut self.wire_faults,
            noise: &self.noise,
        };
        let touches = &mut self.touches;
        self.plant.advance(&mut self.state, at_us, &mut |event| {
            touches.note(&event);
            mega.correct(event, &mut faults);
        });
    }

    pub(super) fn act(&mut self, action: Action) {
        match action {
            Action::Bridge(side, bridge, modulation) => {
                let bridge = match self.motors_cut {
                    true => Bridge::Released,
                    false => bridge,
                };
                self.plant
                    .set_bridge_at(&mut self.state, side, bridge, modulation);
                let mut duty = self.duty;
                match side {
                    Side::Left => duty.left = duty_of(bridge),
                    Side::Right => duty.right = duty_of(bridge),
                }
                self.driven(duty);
            }
            Action::Servo(angle_rad) => self.plant.set_servo(&mut self.state, angle_rad),
            Action::Trigger(sonar) => match SonarId::ALL.get(sonar.index()) {
                Some(own) => self.trigger(*own),
                None => drop(self.plant.trigger(&mut self.state, sonar)),
            },
        }
    }
}

/// A bridge in counts of PWM; a motor that is shorted is not driven.
fn duty_of(bridge: Bridge) -> Duty {
    let share = match bridge {
        Bridge::Forward(share) => share,
        Bridge::Backward(share) => -share,
        Bridge::Released | Bridge::Brake(_) => 0.0,
    };
    Duty::new((share * f64::from(Duty::MAX)).round() as i16)
}
