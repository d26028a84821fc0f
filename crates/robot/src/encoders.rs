//! Encoders that cannot be believed. The robot must not go on with either kind: what it drives by is what they say.
//!
//! *Silent*: a rolling wheel owes edges, since no wheel stops at once ([`WheelMotion::overdue`]); that is noticed within two ticks.
//! A wheel that stands is driven and gives none: it is held, or its encoder is cut, and the speed loop would push ever harder against
//! what it cannot see. Driven is what gets more duty than any free wheel needs, and what its speed loop has been asked to turn for
//! long enough: the loop finds the duty by itself, and slow turns take little.
//!
//! *Implausible*: edges are missing, or are noise. A disc that turns with a motor keeps time: the edges of a tick come as the last turn of
//! the motor leads to expect, whatever friction, floor and battery do to the speed. Where they do not, again and again ([`WheelMotion::uneven`]), some
//! are lost, or none of the disc's. Of 2.5 million ticks of fast wheels in healthy runs none is uneven; with poles displaced by up to 22 % of
//! their pitch 0.23 % are at most; with a tenth of the edges lost 5 %, and more with every other fault: docs/theory/wheel_speed.md.
//!
//! What this cannot see is an encoder that loses every second edge for ever, which keeps time. The motor's model cannot either: the duty that a
//! speed takes differs by more between sound robots.

use rumbo_control::math::abs;
use rumbo_control::speed::WheelMotion;
use rumbo_control::{Duty, Fault, SIDES, Side, TICK_S, Wheels};

/// Duty that moves any free wheel in the end: the original needed 65 of 255 on the floor, 35 in the air.
const HARD: u16 = Duty::MAX as u16 * 2 / 5;
/// Duty beyond [`HARD`], summed over the ticks without an edge, that is too much: 7 % of full duty for a second. To break away takes
/// sound robots 2 % at most, and 6 % with twice the friction of the floor or a battery of 5.2 V.
const PUSHED: u16 = 1_700;
/// Ticks of being asked to turn without an edge that are too many: 0.4 s.
const PATIENCE_TICKS: u8 = 40;
/// Speed references below this are for standing [rad/s].
const STANDING_RAD_S: f32 = 0.5;
/// Angle that a wheel has been asked to turn, one way, without an edge: 73 of them [rad].
const ASKED_RAD: f32 = 1.2;
/// Overdue edges of a rolling wheel that make its encoder silent.
const OVERDUE: u8 = 3;
/// What an uneven tick adds to an encoder's doubt; any other one takes one off.
const UNEVEN: u8 = 24;
/// Doubt that makes an encoder implausible: six uneven ticks soon after each other, or one of twenty for long.
const IMPLAUSIBLE: u8 = 144;

/// Watches both encoders.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EncoderWatch {
    missing: Wheels<Missing>,
    doubt: Wheels<u8>,
}

/// What a wheel did not answer, since its last edge.
#[derive(Clone, Copy, Debug, Default)]
struct Missing {
    /// Duty beyond [`HARD`], summed over the ticks [counts].
    pushed: u16,
    /// Ticks of a speed reference, less those in which it was asked to stand.
    asked_ticks: u8,
    /// Angle that it amounts to [rad].
    asked_rad: f32,
}

impl Missing {
    fn step(&mut self, duty: Duty, reference_rad_s: f32) -> bool {
        let beyond = duty.counts().unsigned_abs().saturating_sub(HARD);
        self.pushed = self.pushed.saturating_add(beyond);
        if duty.counts() == 0 {
            self.pushed = 0;
        }
        if reference_rad_s == 0.0 {
            // Orders too small to break away, with rests as long, do not add up.
            self.asked_ticks = self.asked_ticks.saturating_sub(1);
            if self.asked_ticks == 0 {
                self.asked_rad = 0.0;
            }
        } else if duty.counts() != 0 && abs(reference_rad_s) >= STANDING_RAD_S {
            // Without duty it waits for a wheel to stop.
            self.asked_ticks = self.asked_ticks.saturating_add(1);
            self.asked_rad += reference_rad_s * TICK_S;
        }
        self.pushed >= PUSHED
            || (self.asked_ticks >= PATIENCE_TICKS && abs(self.asked_rad) >= ASKED_RAD)
    }
}

impl EncoderWatch {
    /// One tick: `motion` since the one before, and what drives each wheel. References are 0 in open loop.
    ///
    /// # Errors
    /// An encoder is silent or implausible.
    pub(crate) fn step(
        &mut self,
        motion: &Wheels<WheelMotion>,
        duty: Wheels<Duty>,
        reference_rad_s: Wheels<f32>,
    ) -> Result<(), Fault> {
        for side in SIDES {
            let WheelMotion {
                edges,
                uneven,
                overdue,
                ..
            } = motion[side];
            let doubt = &mut self.doubt[side];
            *doubt = if uneven {
                doubt.saturating_add(UNEVEN)
            } else {
                doubt.saturating_sub(1)
            };
            let silent = if edges > 0 {
                self.missing[side] = Missing::default();
                false
            } else {
                self.missing[side].step(duty[side], reference_rad_s[side]) || overdue >= OVERDUE
            };
            // An encoder that loses edges may lose some in a row.
            let implausible = *doubt >= IMPLAUSIBLE || (silent && *doubt >= UNEVEN);
            match (side, implausible) {
                (Side::Left, true) => return Err(Fault::LeftEncoderImplausible),
                (Side::Right, true) => return Err(Fault::RightEncoderImplausible),
                (Side::Left, false) if silent => return Err(Fault::LeftEncoderSilent),
                (Side::Right, false) if silent => return Err(Fault::RightEncoderSilent),
                (_, false) => {}
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wheels with so many edges, all of them even.
    fn motion(left: u16, right: u16) -> Wheels<WheelMotion> {
        Wheels { left, right }.map(|edges| WheelMotion {
            edges,
            ..WheelMotion::default()
        })
    }

    #[test]
    fn a_rolling_wheel_that_owes_edges_is_a_fault_at_once() {
        let mut motion = motion(1, 0);
        motion.right.overdue = OVERDUE;
        let end =
            EncoderWatch::default().step(&motion, Wheels::both(Duty::new(70)), Wheels::both(6.0));
        assert_eq!(end, Err(Fault::RightEncoderSilent));
    }

    fn fault(motion: &Wheels<WheelMotion>, right: i16) -> Option<Fault> {
        let mut watch = EncoderWatch::default();
        let duty = Wheels {
            left: Duty::new(200),
            right: Duty::new(right),
        };
        (0..150).find_map(|_| watch.step(motion, duty, Wheels::both(0.0)).err())
    }

    /// After how many ticks of this duty a right wheel without edges is noticed whose loop is asked for these speeds in turn [rad/s].
    fn noticed(duty: i16, references_rad_s: &[f32]) -> Option<usize> {
        let mut watch = EncoderWatch::default();
        let asked = references_rad_s.iter().cycle().take(2_000);
        let step = |reference_rad_s: &f32| {
            let duty = Wheels::both(Duty::new(duty));
            watch
                .step(&motion(1, 0), duty, Wheels::both(*reference_rad_s))
                .is_err()
        };
        asked.map(step).position(|fault| fault)
    }

    /// The tick in which a left encoder is called implausible that is uneven once in so many ticks.
    fn doubted(ticks: usize) -> Option<usize> {
        let mut watch = EncoderWatch::default();
        let step = |tick: usize| {
            let mut motion = motion(1, 1);
            motion.left.uneven = tick.is_multiple_of(ticks);
            let end = watch.step(&motion, Wheels::both(Duty::new(70)), Wheels::both(6.0));
            end == Err(Fault::LeftEncoderImplausible)
        };
        (0..2_000).map(step).position(|fault| fault)
    }

    #[test]
    fn a_slow_wheel_is_missed_after_the_angle_it_was_asked_for() {
        assert_eq!(noticed(70, &[6.0]), Some(39));
        let ticks = noticed(70, &[1.5]).unwrap();
        assert!((78..=81).contains(&ticks), "{ticks}");
    }

    #[test]
    fn a_wheel_asked_to_stand_or_to_and_fro_or_to_wait_is_not_missed() {
        assert_eq!(noticed(0, &[6.0]), None);
        assert_eq!(noticed(70, &[0.4]), None);
        assert_eq!(noticed(70, &[1.0, -1.0]), None);
    }

    #[test]
    fn orders_with_rests_as_long_do_not_add_up() {
        let mut orders = [1.0; 60];
        orders[40..].fill(0.0);
        assert!(noticed(70, &orders).is_some_and(|ticks| ticks < 200));
        orders[30..].fill(0.0);
        assert_eq!(noticed(70, &orders), None);
    }

    #[test]
    fn a_driven_wheel_without_edges_is_a_fault_of_its_side() {
        let right = Some(Fault::RightEncoderSilent);
        assert_eq!(fault(&motion(1, 0), -200), right);
        let left = Some(Fault::LeftEncoderSilent);
        assert_eq!(fault(&motion(0, 1), 200), left);
    }

    #[test]
    fn a_wheel_that_turns_or_is_driven_below_its_dead_zone_is_none() {
        assert_eq!(fault(&motion(1, 1), 255), None);
        assert_eq!(fault(&motion(1, 0), 70), None);
    }

    #[test]
    fn uneven_edges_are_doubted_when_they_come_often() {
        assert_eq!(doubted(1), Some(5));
        assert!(doubted(20).is_some_and(|tick| tick < 700));
        assert_eq!(doubted(30), None, "a knock now and then");
    }
}
