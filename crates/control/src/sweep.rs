//! Where the servo looks while the robot regulates on a wall in front: ahead, and aside now and then.
//!
//! A sonar that looks at a wall within its beam reads the distance and nothing of the bearing. Looking past the beam's edge, to both
//! sides of the wall's normal in turn, gives it (docs/theory/wall.md). The schedule is: some pings ahead, one to the left of the normal,
//! some ahead, one to the right. The sonar pings only when the servo has arrived; nothing waits for it.

use crate::estimate::Estimate;
use crate::math::{abs, clamp};
use crate::mode::Look;
use crate::types::{ServoAngle, SonarId};

/// Farthest that the servo turns [rad].
const TRAVEL_RAD: f32 = 1.4;
/// Ticks that the servo gets beyond its reckoned arrival.
const ARRIVAL_TICKS: u8 = 1;

/// How to look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// How far to the side of the wall's normal [rad].
    pub aside_rad: f32,
    /// Pings ahead between two looks aside; none: straight from side to side.
    pub pings_ahead: u8,
}

/// Memory of a sweep; the default looks ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepState {
    servo_rad: f32,
    aside: bool,
    /// The next look aside goes to the right.
    right_next: bool,
    heard: u8,
    arrived_ticks: u8,
    looks: u8,
}

impl SweepState {
    /// Looks ahead, with so many looks aside done.
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

    /// Whether an answer with the servo at `servo_rad` comes from where this sweep looks now.
    pub fn is_from_here(&self, servo_rad: f32) -> bool {
        abs(servo_rad - self.servo_rad) < 1e-3
    }
}

impl Sweep {
    /// One tick; `bearing_rad` is that of the wall's normal.
    pub fn step(&self, state: &mut SweepState, estimate: &Estimate, bearing_rad: f32) -> Look {
        let heard = estimate.reading.is_some_and(|reading| {
            reading.sonar == SonarId::Front && state.is_from_here(reading.servo_rad)
        });
        state.heard = state.heard.saturating_add(u8::from(heard));
        let wanted = if state.aside { 1 } else { self.pings_ahead };
        if state.heard >= wanted {
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
        state.heard = 0;
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
