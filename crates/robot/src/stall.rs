//! A wheel that is driven and gives no edges: held, or its encoder is cut. Either way the robot must not go on,
//! since the speed loop would push ever harder against what it cannot see.
//!
//! Driven is what gets a duty that moves any free wheel, and what its speed loop has been asked to turn for long enough: the loop finds
//! the duty by itself, and slow turns take little.

use rumbo_control::math::abs;
use rumbo_control::{Duty, Fault, SIDES, Side, TICK_S, Wheels};

/// Duty that moves a free wheel for sure: the original needed 65 of 255 on the floor, 35 in the air.
const HARD: i16 = Duty::MAX * 3 / 5;
/// Ticks of being driven without an edge that are too many: 0.4 s. Breaking away takes less than a quarter of it.
const PATIENCE_TICKS: u8 = 40;
/// Speed references below this are for standing [rad/s].
const STANDING_RAD_S: f32 = 0.5;
/// Angle that a wheel has been asked to turn, one way, without an edge: 73 of them [rad].
const ASKED_RAD: f32 = 1.2;

/// Watches both wheels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StallWatch {
    wheels: Wheels<Missing>,
}

/// What a wheel did not answer, since its last edge.
#[derive(Clone, Copy, Debug, Default)]
struct Missing {
    /// Ticks of hard duty, one after the other.
    hard_ticks: u8,
    /// Ticks of a speed reference.
    asked_ticks: u8,
    /// Angle that it amounts to [rad].
    asked_rad: f32,
}

impl Missing {
    fn step(&mut self, duty: Duty, reference_rad_s: f32) -> bool {
        self.hard_ticks = if duty.counts().abs() >= HARD {
            self.hard_ticks.saturating_add(1)
        } else {
            0
        };
        // Without duty it waits for a wheel to stop.
        if duty.counts() != 0 && abs(reference_rad_s) >= STANDING_RAD_S {
            self.asked_ticks = self.asked_ticks.saturating_add(1);
            self.asked_rad += reference_rad_s * TICK_S;
        }
        self.hard_ticks >= PATIENCE_TICKS
            || (self.asked_ticks >= PATIENCE_TICKS && abs(self.asked_rad) >= ASKED_RAD)
    }
}

impl StallWatch {
    /// One tick: `edges` seen since the one before; `duty` and the speeds asked for, in force meanwhile. References are 0 in open loop.
    pub(crate) fn step(
        &mut self,
        edges: Wheels<u16>,
        duty: Wheels<Duty>,
        reference_rad_s: Wheels<f32>,
    ) -> Option<Fault> {
        for side in SIDES {
            if edges[side] > 0 {
                self.wheels[side] = Missing::default();
            } else if self.wheels[side].step(duty[side], reference_rad_s[side]) {
                *self = Self::default();
                return Some(match side {
                    Side::Left => Fault::LeftEncoderSilent,
                    Side::Right => Fault::RightEncoderSilent,
                });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(edges: Wheels<u16>, right: i16) -> Option<Fault> {
        let mut watch = StallWatch::default();
        let duty = Wheels {
            left: Duty::new(200),
            right: Duty::new(right),
        };
        (0..150).find_map(|_| watch.step(edges, duty, Wheels::both(0.0)))
    }

    /// After how many ticks of this duty a right wheel without edges is noticed whose loop is asked for these speeds in turn [rad/s].
    fn noticed(duty: i16, references_rad_s: &[f32]) -> Option<usize> {
        let mut watch = StallWatch::default();
        let edges = Wheels { left: 1, right: 0 };
        let asked = references_rad_s.iter().cycle().take(2_000);
        let step = |reference_rad_s: &f32| {
            let duty = Wheels::both(Duty::new(duty));
            watch
                .step(edges, duty, Wheels::both(*reference_rad_s))
                .is_some()
        };
        asked.map(step).position(|fault| fault)
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
    fn a_driven_wheel_without_edges_is_a_fault_of_its_side() {
        assert_eq!(
            faults(Wheels { left: 1, right: 0 }, -200),
            Some(Fault::RightEncoderSilent)
        );
        assert_eq!(
            faults(Wheels { left: 0, right: 1 }, 200),
            Some(Fault::LeftEncoderSilent)
        );
    }

    #[test]
    fn a_wheel_that_turns_or_is_driven_below_its_dead_zone_is_none() {
        assert_eq!(faults(Wheels::both(1), 255), None);
        assert_eq!(faults(Wheels { left: 1, right: 0 }, 70), None);
    }
}
