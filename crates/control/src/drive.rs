//! From a mode's request to the duty of each bridge. Derivation: docs/theory/drive.md.
//!
//! ```text
//! speed reference -> ramp -> feedforward kS + kV w + kA a --+
//!                     |                                     v
//!                     +------> PID (w_ref - w_est) -------> + -> limits 0..1 -> duty in the driven direction
//! ```
//!
//! Everything is computed in the direction in which the wheel is driven, so the duty never brakes by reversing. A
//! change of direction goes through zero: the bridge is released until the edges have stopped, and only then does the
//! driven direction change sign, since one Hall channel does not measure direction. A wheel that stands although it has
//! a reference gets a kick that grows until edges come.
//!
//! Both wheels of a movement start together. While one still rolls against its new direction, the other waits released
//! if it stands, and gains no speed if it rolls the right way. From rest no wheel waits for the other to break away:
//! the ramp takes both through it within 30 ms, and holding back the first one made their start less even.

use crate::math::{abs, clamp, is_finite, max, round};
use crate::params::{ParamId, Params};
#[cfg(not(target_arch = "avr"))]
use crate::pid::Terms;
use crate::pid::{NotFinite, PidState};
use crate::speed::WheelMotion;
use crate::speed_loop::{Feedforward, SpeedLoop};
#[cfg(not(target_arch = "avr"))]
use crate::types::Side;
use crate::types::{Drive, Duty, SIDES, TICK_S, Wheels};

/// References below this are a standstill [rad/s]: half a turn per minute. No wheel moves at a duty of that number.
const STANDSTILL_RAD_S: f32 = 0.05;
/// Growth of the kick of a wheel that still stands [1/s].
const KICK_GROWTH: f32 = 1.5;

/// What a wheel's speed loop adds up, as parts of full duty, forward positive: for people to see. The duty differs from
/// the sum where it is limited, and where a standing wheel gets its kick.
#[cfg(not(target_arch = "avr"))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WheelTerms {
    /// Of the controller.
    pub pid: Terms,
    /// Duty from the reference alone, by the battery's voltage.
    pub feedforward: f32,
    /// The ramped reference [rad/s].
    pub ramp_rad_s: f32,
}

/// The direction in which a wheel was last driven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WheelDirection {
    /// Forward; also before it was ever driven.
    #[default]
    Forward,
    /// Backward.
    Backward,
}

impl WheelDirection {
    /// `value` with the sign of this direction.
    pub fn sign(self, value: f32) -> f32 {
        match self {
            WheelDirection::Forward => value,
            WheelDirection::Backward => -value,
        }
    }

    fn of(value: f32) -> WheelDirection {
        if value < 0.0 {
            WheelDirection::Backward
        } else {
            WheelDirection::Forward
        }
    }
}

/// State of one wheel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct WheelState {
    direction: WheelDirection,
    pid: PidState,
    /// The ramped reference in the driven direction [rad/s]; `None` while the wheel is not regulated.
    ramp_rad_s: Option<f32>,
    /// How long the wheel has stood although it is driven [s].
    held_s: f32,
    /// It has come to rest, and waits for the other wheel to do so.
    waits: bool,
}

/// State of the drive layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveLayer {
    wheels: Wheels<WheelState>,
}

/// Output of the drive layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Driven {
    /// PWM of both wheels.
    pub duty: Wheels<Duty>,
    /// Speed references of both wheels [rad/s]; 0 when driven open loop.
    pub wheel_ref_rad_s: Wheels<f32>,
}

impl DriveLayer {
    /// The direction in which each wheel turns if it turns.
    pub fn directions(&self) -> Wheels<WheelDirection> {
        self.wheels.map(|wheel| wheel.direction)
    }

    /// What both speed loops added up at the last tick, of which this is the state `before`, with the inputs that it had;
    /// `None` for a wheel that is released or driven open loop.
    ///
    /// Worked out afterwards: neither the chip nor the robot's state has anything of it.
    #[cfg(not(target_arch = "avr"))]
    pub fn terms(
        &self,
        before: &DriveLayer,
        params: &Params,
        motion: &Wheels<WheelMotion>,
        battery_v: Option<f32>,
    ) -> Wheels<Option<WheelTerms>> {
        let compensation = compensation(params, battery_v);
        let of = |side: Side| {
            let measured_rad_s = motion[side].believed_rad_s;
            let wheel_loop = params.speed_loop(side);
            self.wheels[side].terms(
                &before.wheels[side],
                wheel_loop,
                measured_rad_s,
                compensation,
            )
        };
        Wheels {
            left: of(Side::Left),
            right: of(Side::Right),
        }
    }

    /// One tick: `motion` is measured from the edges, `battery_v` the battery's voltage if it is measured.
    ///
    /// # Errors
    /// [`NotFinite`] when the request is not a finite number.
    pub fn step(
        &mut self,
        params: &Params,
        drive: &Drive,
        motion: &Wheels<WheelMotion>,
        battery_v: Option<f32>,
    ) -> Result<Driven, NotFinite> {
        let compensation = compensation(params, battery_v);
        let mut driven = Driven::default();
        let (open_loop, wanted) = match *drive {
            Drive::Release => {
                self.wheels.left.release();
                self.wheels.right.release();
                return Ok(driven);
            }
            Drive::Duty(duty) => (true, duty),
            Drive::WheelSpeed(references) => (false, references),
            Drive::Twist {
                forward_m_s,
                yaw_rad_s,
            } => (
                false,
                params.geometry().wheels_from_body(forward_m_s, yaw_rad_s),
            ),
        };
        if !open_loop {
            driven.wheel_ref_rad_s = wanted;
        }
        let stopping = Wheels {
            left: self.wheels.left.must_stop(wanted.left, &motion.left),
            right: self.wheels.right.must_stop(wanted.right, &motion.right),
        };
        for &side in &SIDES {
            let (wheel, motion) = (&mut self.wheels[side], &motion[side]);
            driven.duty[side] = if open_loop {
                wheel.open_loop(wanted[side], motion, stopping[side.other()])?
            } else {
                wheel.speed(
                    params.speed_loop(side),
                    wanted[side],
                    motion,
                    compensation,
                    stopping[side.other()],
                )?
            };
        }
        Ok(driven)
    }
}

/// Factor on the feedforward for a battery that is not at its nominal voltage; 1 where it is not measured.
fn compensation(params: &Params, battery_v: Option<f32>) -> f32 {
    match battery_v {
        Some(volts) if volts > 1.0 => clamp(params.get(ParamId::NominalBattery) / volts, 0.5, 2.0),
        _ => 1.0,
    }
}

impl WheelState {
    fn release(&mut self) {
        self.pid.reset();
        self.ramp_rad_s = None;
        self.held_s = 0.0;
    }

    /// Whether the wheel still rolls against its reference.
    fn must_stop(&self, reference_rad_s: f32, motion: &WheelMotion) -> bool {
        abs(reference_rad_s) >= STANDSTILL_RAD_S
            && WheelDirection::of(reference_rad_s) != self.direction
            && !motion.standing
    }

    /// Adopts the direction of `request` if the wheel stands; returns whether it may be driven that way.
    fn may_drive(&mut self, request: f32, motion: &WheelMotion) -> bool {
        let wanted = WheelDirection::of(request);
        if wanted == self.direction {
            return true;
        }
        if motion.standing {
            self.direction = wanted;
            self.release();
        }
        motion.standing
    }

    /// Whether the wheel waits for the other one to come to rest. A late edge of a wheel at rest neither ends the waiting
    /// nor gives a speed to start from.
    fn waits(&mut self, motion: &WheelMotion, partner_stops: bool) -> bool {
        self.waits = partner_stops && (motion.standing || self.waits);
        self.waits
    }

    fn open_loop(
        &mut self,
        duty: f32,
        motion: &WheelMotion,
        partner_stops: bool,
    ) -> Result<Duty, NotFinite> {
        if !is_finite(duty) {
            return Err(NotFinite);
        }
        self.release();
        let waits = self.waits(motion, partner_stops);
        let counts = counts(abs(duty));
        Ok(if counts > 0 && self.may_drive(duty, motion) && !waits {
            self.duty(counts)
        } else {
            Duty::RELEASED
        })
    }

    fn speed(
        &mut self,
        wheel_loop: &SpeedLoop,
        reference_rad_s: f32,
        motion: &WheelMotion,
        compensation: f32,
        partner_stops: bool,
    ) -> Result<Duty, NotFinite> {
        if !is_finite(reference_rad_s) {
            return Err(NotFinite);
        }
        let standstill = abs(reference_rad_s) < STANDSTILL_RAD_S;
        let waits = self.waits(motion, partner_stops);
        if standstill || !self.may_drive(reference_rad_s, motion) || waits {
            self.release();
            if waits {
                self.ramp_rad_s = Some(0.0);
            }
            return Ok(Duty::RELEASED);
        }
        let target_rad_s = abs(reference_rad_s);
        let measured_rad_s = motion.believed_rad_s;
        // A wheel that still rolls is taken over at the speed it has.
        let before_rad_s = self.ramp_rad_s.unwrap_or(measured_rad_s);
        let ramp_rad_s = wheel_loop.ramp(before_rad_s, target_rad_s, measured_rad_s, partner_stops);
        let slope_rad_s2 = (ramp_rad_s - before_rad_s) * (1.0 / TICK_S);
        self.ramp_rad_s = Some(ramp_rad_s);

        let Feedforward {
            static_forward,
            static_backward,
            velocity,
            acceleration,
        } = wheel_loop.feedforward;
        let friction = match self.direction {
            WheelDirection::Forward => static_forward,
            WheelDirection::Backward => static_backward,
        };
        let mut feedforward = friction + velocity * ramp_rad_s + acceleration * slope_rad_s2;
        if compensation != 1.0 {
            feedforward *= compensation;
        }
        let mut duty = wheel_loop.pid.step(
            &mut self.pid,
            ramp_rad_s,
            measured_rad_s,
            feedforward,
            TICK_S,
        )?;
        if motion.standing {
            duty = clamp(
                max(
                    duty,
                    (wheel_loop.kick + KICK_GROWTH * self.held_s) * compensation,
                ),
                0.0,
                1.0,
            );
            self.held_s += TICK_S;
        } else {
            self.held_s = 0.0;
        }
        Ok(self.duty(counts(duty)))
    }

    #[cfg(not(target_arch = "avr"))]
    fn terms(
        &self,
        before: &WheelState,
        wheel_loop: &SpeedLoop,
        measured_rad_s: f32,
        compensation: f32,
    ) -> Option<WheelTerms> {
        let ramp_rad_s = self.ramp_rad_s.filter(|_| !self.waits)?;
        // A wheel that changes its direction begins again.
        let (pid, ramp_before_rad_s) = if before.direction == self.direction {
            (before.pid, before.ramp_rad_s)
        } else {
            (PidState::default(), None)
        };
        let slope_rad_s2 =
            (ramp_rad_s - ramp_before_rad_s.unwrap_or(measured_rad_s)) * (1.0 / TICK_S);
        let gains = &wheel_loop.feedforward;
        let friction = match self.direction {
            WheelDirection::Forward => gains.static_forward,
            WheelDirection::Backward => gains.static_backward,
        };
        let feedforward =
            friction + gains.velocity * ramp_rad_s + gains.acceleration * slope_rad_s2;
        let terms = wheel_loop
            .pid
            .terms(&pid, ramp_rad_s, measured_rad_s, TICK_S);
        let signed = |value| self.direction.sign(value);
        Some(WheelTerms {
            pid: Terms {
                proportional: signed(terms.proportional),
                integral: signed(terms.integral),
                derivative: signed(terms.derivative),
            },
            feedforward: signed(compensation * feedforward),
            ramp_rad_s: signed(ramp_rad_s),
        })
    }

    fn duty(&self, counts: i16) -> Duty {
        match self.direction {
            WheelDirection::Forward => Duty::new(counts),
            WheelDirection::Backward => Duty::new(-counts),
        }
    }
}

/// PWM counts of a duty in 0..=1.
fn counts(duty: f32) -> i16 {
    i16::try_from(round(clamp(duty, 0.0, 1.0) * f32::from(Duty::MAX))).unwrap_or(0)
}

#[cfg(test)]
mod tests;
