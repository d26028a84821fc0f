//! Detects failed encoders. The robot must stop on either kind of failure, since it drives by their edges.
//!
//! *Silent*: a rolling wheel must produce edges, since no wheel stops at once ([`WheelMotion::overdue`]); their absence
//! is detected within two ticks. A standing wheel that is driven and produces none is blocked, or its encoder is cut,
//! and the speed loop would push ever harder blindly. A wheel counts as driven when it gets more duty than any free
//! wheel needs, or when its speed loop has had a reference for long enough: the loop finds the duty by itself, and slow
//! turns take little.
//!
//! *Implausible*: edges are missing, or are noise. The edges of a disc on a motor are regular: those of a tick come as
//! predicted by the motor's last turn, whatever friction, floor and battery do to the speed. Where they repeatedly do
//! not ([`WheelMotion::evenness`]), edges are lost or spurious. Of 2.5 million ticks of fast wheels in healthy runs none
//! is uneven; with poles displaced by up to 22 % of their pitch at most 0.23 % are; with a tenth of the edges lost 5 %,
//! and more with every other fault: docs/theory/wheel_speed.md.
//!
//! An encoder that constantly loses every second edge stays regular and is not detected. A motor model cannot detect it
//! either: the duty for a speed differs by more between sound robots.

use rumbo_control::math::abs;
use rumbo_control::speed::{Evenness, WheelMotion};
use rumbo_control::{Duty, Fault, SIDES, Side, TICK_S, Wheels};

/// Duty that eventually moves any free wheel: the original needed 65 of 255 on the floor, 35 in the air.
const HARD: u16 = Duty::MAX as u16 * 2 / 5;
/// Limit of duty beyond [`HARD`], summed over the ticks without an edge: 7 % of full duty for a second. Sound robots
/// break away with 2 % at most, and with 6 % at twice the floor's friction or a battery of 5.2 V.
const PUSHED: u16 = 1_700;
/// Limit of ticks with a speed reference but no edge: 0.4 s.
const PATIENCE_TICKS: u8 = 40;
/// Speed references below this count as standing [rad/s].
const STANDING_RAD_S: f32 = 0.5;
/// Limit of the commanded angle in one direction without an edge: 73 edges [rad].
const ASKED_RAD: f32 = 1.2;
/// Overdue edges of a rolling wheel after which its encoder is silent.
const OVERDUE: u8 = 3;
/// What an uneven tick adds to an encoder's doubt; an even one subtracts one, any other leaves it.
const UNEVEN: u8 = 24;
/// Doubt above which an encoder is implausible: four uneven ticks in quick succession, or one in twenty for long.
const IMPLAUSIBLE: u8 = 96;

/// Watches both encoders.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EncoderWatch {
    missing: Wheels<Missing>,
    doubt: Wheels<u8>,
}

/// Drive without response since a wheel's last edge.
#[derive(Clone, Copy, Debug, Default)]
struct Missing {
    /// Duty beyond [`HARD`], summed over the ticks [counts].
    pushed: u16,
    /// Ticks with a speed reference, less those with a reference to stand.
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
            // References too small to break away, alternating with rests as long, do not add up.
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
    /// One tick: `motion` since the previous one, and the drive of each wheel. References are 0 in open loop.
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
                evenness,
                overdue,
                ..
            } = motion[side];
            let doubt = &mut self.doubt[side];
            *doubt = match evenness {
                Evenness::Uneven => doubt.saturating_add(UNEVEN),
                Evenness::Even => doubt.saturating_sub(1),
                Evenness::Unknown => *doubt,
            };
            let silent = if edges > 0 {
                self.missing[side] = Missing::default();
                false
            } else {
                self.missing[side].step(duty[side], reference_rad_s[side]) || overdue >= OVERDUE
            };
            // A faulty encoder may lose several edges in a row.
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
            evenness: Evenness::Even,
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

    /// Ticks until a right wheel without edges is detected, at this duty and with these speed references in turn
    /// [rad/s].
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

    /// The tick at which a left encoder that is uneven once in so many ticks is found implausible.
    fn doubted(ticks: usize) -> Option<usize> {
        let mut watch = EncoderWatch::default();
        let step = |tick: usize| {
            let mut motion = motion(1, 1);
            if tick.is_multiple_of(ticks) {
                motion.left.evenness = Evenness::Uneven;
            }
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
        assert_eq!(doubted(1), Some(3));
        assert!(doubted(20).is_some_and(|tick| tick < 700));
        assert_eq!(doubted(30), None, "a knock now and then");
    }
}
