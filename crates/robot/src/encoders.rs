//! Detects failed encoders and held wheels. The robot must stop on either, since it drives by their edges.
//!
//! *Strained*: a wheel gets more duty than the speed that its edges show can need. The robot's own model of the wheel
//! tells what that needs ([`Feedforward`]); sound wheels get up to 1.7 times as much, on a bad floor or with an empty
//! battery twice, but then both do. The duty beyond is summed over time, so neither a late edge nor one that comes in
//! between matters. A wheel without edges, one that is held and creeps, and one that loses most of its edges are all
//! strained. If both are, the robot has met something.
//!
//! *Silent*: a rolling wheel must produce edges, since no wheel stops at once ([`WheelMotion::overdue`]); their absence
//! is detected within two ticks.
//!
//! *Implausible*: edges are missing, or are noise. The edges of a disc on a motor are regular: those of a tick come as
//! predicted by the motor's last turn, whatever friction, floor and battery do to the speed. Where they repeatedly do
//! not ([`WheelMotion::evenness`]), edges are lost or spurious. Of 2.5 million ticks of fast wheels in healthy runs none
//! is uneven; with poles displaced by up to 22 % of their pitch at most 0.23 % are; with a tenth of the edges lost 5 %,
//! and more with every other fault: docs/theory/wheel_speed.md.
//!
//! An encoder that constantly loses every second edge stays regular, and strains its wheel no more than a bad floor
//! does: it is not detected.

use rumbo_control::math::{abs, max, min};
use rumbo_control::params::Params;
use rumbo_control::speed::{Evenness, WheelMotion};
use rumbo_control::speed_loop::Feedforward;
use rumbo_control::{Duty, Fault, SIDES, Side, Wheels};

/// Overdue edges of a rolling wheel after which its encoder is silent.
const OVERDUE: u8 = 3;
/// So many of the other wheel at that instant, and both have stopped at once.
const OVERDUE_TOO: u8 = 2;
/// What an uneven tick adds to an encoder's doubt; an even one subtracts one, any other leaves it.
const UNEVEN: u8 = 24;
/// Doubt above which an encoder is implausible: four uneven ticks in quick succession, or one in twenty for long.
const IMPLAUSIBLE: u8 = 96;

/// Duty over what the measured speed needs that strains a wheel, if the other one gets no more than usual.
const UNUSUAL: f32 = 2.4;
/// The same over that of the other wheel, where this is more: both turn on the same floor, from the same battery. The
/// wheels of sound robots differ by a factor of 2.0 at most.
const APART: f32 = 2.1;
/// What a wheel that is not driven would be expected to get, over what it needs: the most that is usual.
const USUAL: f32 = 1.7;
/// Duty that moves any free wheel, whatever the other one does: the original needed 0.25 on the floor, 0.14 in the air.
const MOVES: f32 = 0.42;
/// Duty beyond that for the speed of a wheel that is not held [s/rad]: full duty turns any by 1.7 rad/s. Against a wall
/// tyres slip at up to 1.2 rad/s.
const MOVES_FASTER: f32 = 0.35;
/// Limit of the duty beyond these, summed over ticks. Sound robots reach 4.0, with 5 kg and on ice 6.1.
const STRAINED: f32 = 7.0;
/// The share of it with which a wheel is strained too, if the other one is or its own edges are in doubt.
const STRAINED_TOO: f32 = 0.5;
/// Least duty for a wheel's friction that is believed, should a parameter say less.
const LEAST_FRICTION: f32 = 0.1;
/// Least duty per speed that is believed [s/rad].
const LEAST_VELOCITY: f32 = 0.01;

/// Watches both encoders.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EncoderWatch {
    /// Duty beyond what the wheel can need, summed over ticks.
    strain: Wheels<f32>,
    doubt: Wheels<u8>,
}

/// The duty of a wheel, and what its speed needs.
#[derive(Clone, Copy, Debug, Default)]
struct Load {
    duty: f32,
    needed: f32,
    /// Duty that turns the wheel faster, unless it is held.
    moving: f32,
}

impl Load {
    fn new(feedforward: &Feedforward, motion: &WheelMotion, duty: Duty) -> Self {
        let friction = if duty.counts() < 0 {
            feedforward.static_backward
        } else {
            feedforward.static_forward
        };
        let (friction, velocity) = (
            max(friction, LEAST_FRICTION),
            max(feedforward.velocity, LEAST_VELOCITY),
        );
        Self {
            duty: abs(f32::from(duty.counts())) * (1.0 / Duty::MAX as f32),
            needed: friction + velocity * motion.speed_rad_s,
            moving: MOVES + MOVES_FASTER * motion.speed_rad_s,
        }
    }

    /// Duty beyond what the wheel can need; negative if it can.
    fn excess(&self, other: &Load) -> f32 {
        let least = self.duty - min(UNUSUAL * self.needed, self.moving);
        // Mostly so: it spares the division.
        if least <= 0.0 {
            return least;
        }
        let others = if other.duty > 0.0 {
            other.duty / other.needed
        } else {
            USUAL
        };
        let apart = max(UNUSUAL, APART * others);
        self.duty - min(apart * self.needed, self.moving)
    }
}

impl EncoderWatch {
    /// One tick: `motion` since the previous one, and the duty of each wheel.
    ///
    /// # Errors
    /// An encoder is silent or implausible, or the robot is held.
    pub(crate) fn step(
        &mut self,
        params: &Params,
        motion: &Wheels<WheelMotion>,
        duty: Wheels<Duty>,
    ) -> Result<(), Fault> {
        let load = |side: Side| {
            Load::new(
                &params.speed_loop(side).feedforward,
                &motion[side],
                duty[side],
            )
        };
        let loads = Wheels {
            left: load(Side::Left),
            right: load(Side::Right),
        };
        for &side in &SIDES {
            let doubt = &mut self.doubt[side];
            *doubt = match motion[side].evenness {
                Evenness::Uneven => doubt.saturating_add(UNEVEN),
                Evenness::Even => doubt.saturating_sub(1),
                Evenness::Unknown => *doubt,
            };
            let excess = loads[side].excess(&loads[side.other()]);
            let strain = &mut self.strain[side];
            *strain = max(*strain + excess, 0.0);
        }
        SIDES.iter().try_for_each(|&side| self.judge(side, motion))
    }

    fn judge(&self, side: Side, motion: &Wheels<WheelMotion>) -> Result<(), Fault> {
        let (own, other) = (&motion[side], &motion[side.other()]);
        let silent = own.overdue >= OVERDUE;
        let strained = self.strain[side] >= STRAINED;
        let strained_too = |side: Side| self.strain[side] >= STRAINED_TOO * STRAINED;
        if (strained && strained_too(side.other())) || (silent && other.overdue >= OVERDUE_TOO) {
            return Err(Fault::Blocked);
        }
        let doubt = self.doubt[side];
        // A faulty encoder may lose several edges in a row, and few of a slow wheel's edges can be judged.
        let implausible = doubt >= IMPLAUSIBLE
            || (silent && doubt >= UNEVEN)
            || (strained_too(side) && doubt >= 2 * UNEVEN)
            || (strained && !own.standing);
        match side {
            Side::Left if implausible => Err(Fault::LeftEncoderImplausible),
            Side::Right if implausible => Err(Fault::RightEncoderImplausible),
            Side::Left if silent || strained => Err(Fault::LeftEncoderSilent),
            Side::Right if silent || strained => Err(Fault::RightEncoderSilent),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::params::ParamId;

    /// Wheels of these speeds with edges, all of them even, or standing [rad/s].
    fn motion(left: f32, right: f32) -> Wheels<WheelMotion> {
        Wheels { left, right }.map(|speed_rad_s| WheelMotion {
            speed_rad_s,
            believed_rad_s: speed_rad_s,
            edges: u16::from(speed_rad_s > 0.0),
            standing: speed_rad_s == 0.0,
            evenness: Evenness::Even,
            overdue: 0,
        })
    }

    fn duties(left: i16, right: i16) -> Wheels<Duty> {
        Wheels {
            left: Duty::new(left),
            right: Duty::new(right),
        }
    }

    /// The fault of wheels driven like this for 5 s, and its tick.
    fn fault(motion: &Wheels<WheelMotion>, duty: Wheels<Duty>) -> Option<(usize, Fault)> {
        let (mut watch, params) = (EncoderWatch::default(), Params::default());
        (0..500).find_map(|tick| Some((tick, watch.step(&params, motion, duty).err()?)))
    }

    fn named(left: (f32, i16), right: (f32, i16)) -> Option<Fault> {
        let duty = duties(left.1, right.1);
        fault(&motion(left.0, right.0), duty).map(|(_, fault)| fault)
    }

    #[test]
    fn a_rolling_wheel_that_owes_edges_is_a_fault_at_once() {
        let mut motion = motion(6.0, 6.0);
        motion.right.overdue = OVERDUE;
        let duty = duties(70, 70);
        assert_eq!(fault(&motion, duty), Some((0, Fault::RightEncoderSilent)));
        motion.left.overdue = OVERDUE_TOO;
        assert_eq!(fault(&motion, duty), Some((0, Fault::Blocked)));
    }

    #[test]
    fn a_driven_wheel_without_edges_is_a_fault_of_its_side() {
        let driven = |counts| Some((counts, Fault::RightEncoderSilent));
        assert_eq!(fault(&motion(6.0, 0.0), duties(80, -255)), driven(12));
        assert_eq!(fault(&motion(6.0, 0.0), duties(80, 150)), driven(41));
        let left = Some(Fault::LeftEncoderSilent);
        assert_eq!(named((0.0, 200), (6.0, -80)), left);
        assert_eq!(named((0.0, 200), (0.0, 0)), left);
    }

    #[test]
    fn a_wheel_with_one_edge_in_ten_is_a_fault_of_its_side() {
        // Full duty turns a wheel by 13 rad/s.
        let right = Some(Fault::RightEncoderImplausible);
        assert_eq!(named((6.0, 90), (1.3, 255)), right);
        assert_eq!(named((6.0, 70), (3.9, 255)), right);
        assert_eq!(named((6.0, -90), (1.3, 255)), right);
    }

    #[test]
    fn a_robot_whose_wheels_both_creep_has_met_something() {
        let (ticks, fault) = fault(&motion(0.8, 0.3), duties(255, 255)).unwrap();
        assert_eq!(fault, Fault::Blocked);
        assert!(ticks < 30, "{ticks}");
    }

    #[test]
    fn no_wheel_is_strained_by_a_bad_floor_or_an_empty_battery() {
        assert_eq!(named((4.0, 255), (4.2, 255)), None, "both are slow");
        assert_eq!(named((9.0, 180), (0.0, 0)), None, "it drives alone");
        assert_eq!(named((6.0, 160), (6.0, 90)), None, "they differ");
        assert_eq!(named((0.0, 70), (6.0, 70)), None, "below the dead zone");
    }

    #[test]
    fn short_pushes_with_rests_as_long_do_not_add_up() {
        let (mut watch, params) = (EncoderWatch::default(), Params::default());
        for tick in 0..500 {
            let duty = if tick % 20 < 10 { 200 } else { 0 };
            let end = watch.step(&params, &motion(6.0, 0.0), duties(80, duty));
            assert_eq!(end, Ok(()), "{tick}");
        }
    }

    #[test]
    fn parameters_of_zero_strain_no_wheel() {
        let (mut watch, mut params) = (EncoderWatch::default(), Params::default());
        for id in [
            ParamId::StaticLeftForward,
            ParamId::StaticRightForward,
            ParamId::Velocity,
        ] {
            params.set(id, 0.0).unwrap();
        }
        for _ in 0..500 {
            assert_eq!(
                watch.step(&params, &motion(6.0, 6.0), duties(90, 90)),
                Ok(())
            );
        }
    }

    /// The tick at which a left encoder that is uneven once in so many ticks is found implausible.
    fn doubted(ticks: usize) -> Option<usize> {
        let (mut watch, params) = (EncoderWatch::default(), Params::default());
        let step = |tick: usize| {
            let mut motion = motion(6.0, 6.0);
            if tick.is_multiple_of(ticks) {
                motion.left.evenness = Evenness::Uneven;
            }
            let end = watch.step(&params, &motion, duties(70, 70));
            end == Err(Fault::LeftEncoderImplausible)
        };
        (0..2_000).map(step).position(|fault| fault)
    }

    #[test]
    fn uneven_edges_are_doubted_when_they_come_often() {
        assert_eq!(doubted(1), Some(3));
        assert!(doubted(20).is_some_and(|tick| tick < 700));
        assert_eq!(doubted(30), None, "a knock now and then");
    }
}
