//! Where the servo points while the robot regulates on a wall in front: ahead, and aside now and then.
//!
//! A sonar with the wall's normal within its beam measures the distance but not the bearing. Looking past the beam's
//! edge, to both sides of the normal in turn, measures it (docs/theory/wall.md). The schedule is: some pings ahead, one
//! to the left of the normal, some ahead, one to the right. The sonar pings only when the servo has arrived; nothing
//! waits for it.

use crate::estimate::Estimate;
use crate::math::{abs, clamp};
use crate::types::Look;
use crate::types::{ServoAngle, SonarId};

/// Farthest that the servo turns [rad].
const TRAVEL_RAD: f32 = 1.4;
/// Ticks of margin after the servo's estimated arrival.
const ARRIVAL_TICKS: u8 = 1;

/// Configuration of a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// How far to the side of the wall's normal [rad].
    pub aside_rad: f32,
    /// Pings ahead between two looks aside; none: straight from side to side.
    pub pings_ahead: u8,
}

/// State of a sweep; the default looks ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepState {
    servo_rad: f32,
    aside: bool,
    /// The next look aside goes to the right.
    right_next: bool,
    answers: u8,
    arrived_ticks: u8,
    looks: u8,
}

impl SweepState {
    /// Looks ahead, with this many looks aside done.
    pub fn after(looks: u8) -> Self {
        Self {
            looks,
            ..Self::default()
        }
    }

    /// Looks aside so far, at most 255.
    pub fn looks_aside(&self) -> u8 {
        self.looks
    }

    /// Whether an answer with the servo at `servo_rad` is from this sweep's present direction.
    pub fn is_from_here(&self, servo_rad: f32) -> bool {
        abs(servo_rad - self.servo_rad) < 1e-3
    }
}

impl Sweep {
    /// One tick; `bearing_rad` is that of the wall's normal.
    pub fn step(&self, state: &mut SweepState, estimate: &Estimate, bearing_rad: f32) -> Look {
        let answered = estimate.reading.is_some_and(|reading| {
            reading.sonar == SonarId::Front && state.is_from_here(reading.servo_rad)
        });
        state.answers = state.answers.saturating_add(u8::from(answered));
        let wanted = if state.aside { 1 } else { self.pings_ahead };
        if state.answers >= wanted {
            self.turn(state, bearing_rad);
        }
        state.arrived_ticks = if estimate.servo_arrived && state.is_from_here(estimate.servo_rad) {
            state.arrived_ticks.saturating_add(1)
        } else {
            0
        };
        let mut look = Look::only(SonarId::Front);
        look.servo = ServoAngle(state.servo_rad);
        if state.arrived_ticks <= ARRIVAL_TICKS {
            look.sonars = [false; 3];
        }
        look
    }

    fn turn(&self, state: &mut SweepState, bearing_rad: f32) {
        state.answers = 0;
        state.arrived_ticks = 0;
        if state.aside {
            state.looks = state.looks.saturating_add(1);
        }
        state.aside = !state.aside || self.pings_ahead == 0;
        state.servo_rad = if state.aside {
            let side = if state.right_next { -1.0 } else { 1.0 };
            state.right_next = !state.right_next;
            clamp(bearing_rad + side * self.aside_rad, -TRAVEL_RAD, TRAVEL_RAD)
        } else {
            0.0
        };
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::estimate::Estimator;
    use crate::params::Params;
    use crate::types::{Echo, Inputs, Micros, Wheels};
    use std::vec::Vec;

    /// Where the servo pointed at each ping, and the number of its tick, over some ticks with a sonar that answers 20 ms later.
    fn pings(sweep: &Sweep, bearing_rad: f32, ticks: u32) -> Vec<(u32, f32)> {
        let (mut estimator, mut state) = (Estimator::default(), SweepState::default());
        let (mut pings, mut last): (Vec<(u32, f32)>, _) = (Vec::new(), None);
        for tick in 0..ticks {
            let answered = last == Some(tick.wrapping_sub(2));
            let inputs = Inputs {
                now: Micros(tick * 10_000),
                echo: answered.then_some((SonarId::Front, Echo::Pulse(3_000))),
                ..Inputs::default()
            };
            let mut estimate = Estimate::default();
            estimator.step(
                &Params::default(),
                &inputs,
                Wheels::default(),
                &mut estimate,
            );
            let look = sweep.step(&mut state, &estimate, bearing_rad);
            let [_, _, front] = look.sonars;
            let ping = front && last.is_none_or(|last| tick >= last + 6);
            if ping {
                last = Some(tick);
                pings.push((tick, estimate.servo_rad));
            }
            estimator.commanded(look.servo, ping.then_some(SonarId::Front));
        }
        pings
    }

    #[test]
    fn it_looks_ahead_and_to_both_sides_of_the_normal_in_turn_and_pings_only_at_rest() {
        let sweep = Sweep {
            aside_rad: 0.65,
            pings_ahead: 2,
        };
        let seen: Vec<f32> = pings(&sweep, 0.1, 200)
            .into_iter()
            .map(|(_, servo_rad)| servo_rad)
            .collect();
        for (seen, expected) in seen
            .iter()
            .zip([0.0, 0.0, 0.75, 0.0, 0.0, -0.55, 0.0, 0.0, 0.75])
        {
            assert!((seen - expected).abs() < 1e-6, "{seen} for {expected}");
        }
        assert!(seen.len() >= 9);
    }

    #[test]
    fn a_look_aside_and_back_takes_less_than_a_third_of_a_second() {
        let sweep = Sweep {
            aside_rad: 0.65,
            pings_ahead: 2,
        };
        let ahead: Vec<u32> = pings(&sweep, 0.0, 300)
            .into_iter()
            .filter(|(_, servo_rad)| *servo_rad == 0.0)
            .map(|(tick, _)| tick)
            .collect();
        assert!(
            ahead.windows(2).all(|two| two[1] - two[0] <= 32),
            "{ahead:?}"
        );
    }

    #[test]
    fn without_pings_ahead_it_goes_straight_from_side_to_side() {
        let sweep = Sweep {
            aside_rad: 0.65,
            pings_ahead: 0,
        };
        let seen = pings(&sweep, 0.0, 200);
        assert!(
            seen.len() >= 5 && seen.iter().all(|(_, servo_rad)| servo_rad.abs() > 0.6),
            "{seen:?}"
        );
    }
}
