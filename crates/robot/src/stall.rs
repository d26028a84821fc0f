//! A wheel that is driven hard and gives no edges: held, or its encoder is cut. Either way the robot must not go on,
//! since the speed loop would push ever harder against what it cannot see.

use rumbo_control::{Duty, Fault, SIDES, Side, Wheels};

/// Duty that moves a free wheel for sure: the original needed 65 of 255 on the floor, 35 in the air.
const HARD: i16 = Duty::MAX * 3 / 5;
/// Ticks of such duty without an edge that are too many: 0.4 s. Breaking away takes less than a quarter of it.
const PATIENCE_TICKS: u8 = 40;

/// Watches both wheels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StallWatch {
    ticks: Wheels<u8>,
}

impl StallWatch {
    /// One tick: `edges` seen since the one before, `duty` in force meanwhile.
    pub(crate) fn step(&mut self, edges: Wheels<u16>, duty: Wheels<Duty>) -> Option<Fault> {
        for side in SIDES {
            let suspicious = edges[side] == 0 && duty[side].counts().abs() >= HARD;
            self.ticks[side] = if suspicious {
                self.ticks[side].saturating_add(1)
            } else {
                0
            };
            if self.ticks[side] >= PATIENCE_TICKS {
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
        (0..150).find_map(|_| watch.step(edges, duty))
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
