//! The speed that a program would have shown of a wheel that turned like this.
//!
//! The report's counts edges in a window: the mean over it. Ours joins the mean of the last motor turn with that of the
//! newest edges ([`rumbo_control::speed`]), which leads while the wheel speeds up and lags while it slows down. Where the
//! edges were no log tells, so both means are read from the angle.

use crate::log::RobotProgram;
use crate::row::Window;
use rumbo_control::speed::{self, fuse};

/// Angle of one edge, and of one motor turn, rad.
pub(crate) const EDGE_RAD: f64 = speed::EDGE_RAD as f64;
pub(crate) const MOTOR_TURN_RAD: f64 = 8.0 * EDGE_RAD;
/// The newest edges are those of a tick.
const FRESH_MS: usize = 10;
/// Longest motor turn that is looked for.
const LONGEST_TURN_MS: usize = 150;

/// Angles of one wheel at each millisecond.
#[derive(Clone, Copy)]
pub(crate) struct Angles<'a> {
    /// Of both wheels, rad.
    pub(crate) angle_rad: &'a [[f64; 2]],
    /// When the first one is.
    pub(crate) from_ms: usize,
    /// Which wheel.
    pub(crate) wheel: usize,
}

impl Angles<'_> {
    /// The speed shown with this window, rad/s. What is before the first angle or after the last one stands still.
    pub(crate) fn shown(&self, program: RobotProgram, window: Window) -> f64 {
        match program {
            RobotProgram::Rumbo => self.fused(window),
            RobotProgram::Original | RobotProgram::Another => self.mean(window),
        }
    }

    fn at(&self, ms: usize) -> f64 {
        let index = ms.saturating_sub(self.from_ms);
        self.angle_rad[index.min(self.angle_rad.len() - 1)][self.wheel]
    }

    fn mean(&self, Window { end_ms, length_ms }: Window) -> f64 {
        (self.at(end_ms) - self.at(end_ms.saturating_sub(length_ms))) * 1000.0 / length_ms as f64
    }

    fn fused(&self, window: Window) -> f64 {
        let end_ms = window.end_ms;
        let newest_rad = self.at(end_ms) - self.at(end_ms.saturating_sub(FRESH_MS));
        let fresh_rad_s = newest_rad.abs() * 1e3 / FRESH_MS as f64;
        let Some(turn_ms) = self.turn_ms(window) else {
            return fresh_rad_s.copysign(newest_rad);
        };
        let turn_rad_s = MOTOR_TURN_RAD * 1e3 / turn_ms;
        // There were as many edges in a tick or one more, each as often as the angle says.
        let edges = newest_rad.abs() / EDGE_RAD;
        let fewest = edges.floor().max(1.0);
        let fused = |new: f64| f64::from(fuse(turn_rad_s as f32, fresh_rad_s as f32, new as u16));
        let more = (edges - fewest).clamp(0.0, 1.0);
        ((1.0 - more) * fused(fewest) + more * fused(fewest + 1.0)).copysign(newest_rad)
    }

    /// Time of the motor turn up to the window's end, ms; none if the wheel has not turned so far since it stood.
    fn turn_ms(&self, window: Window) -> Option<f64> {
        let end_ms = window.end_ms;
        let end_rad = self.at(end_ms);
        let turned = |ms: usize| (end_rad - self.at(end_ms.saturating_sub(ms))).abs();
        let mut ms = window.length_ms.max(1);
        while turned(ms) < MOTOR_TURN_RAD {
            // Standing.
            if ms >= LONGEST_TURN_MS || turned(ms + 1) <= turned(ms) {
                return None;
            }
            ms += 1;
        }
        while ms > 1 && turned(ms - 1) >= MOTOR_TURN_RAD {
            ms -= 1;
        }
        let (less, more) = (turned(ms - 1), turned(ms));
        Some((ms - 1) as f64 + (MOTOR_TURN_RAD - less) / (more - less))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::speed::SpeedEstimator;
    use rumbo_control::types::{Edges, Micros};

    /// What the robot shows at 1 s and what is expected of it, rad/s, of a wheel at this angle, rad, after so many seconds;
    /// its edges may lie anywhere.
    fn shown_and_expected(angle_rad: impl Fn(f64) -> f64) -> (f64, f64) {
        const PLACES: usize = 40;
        let shown = |place: usize| {
            let edge_at = |us: u32| {
                let edges = angle_rad(f64::from(us) * 1e-6) / EDGE_RAD;
                (edges + place as f64 / PLACES as f64).floor() as i64
            };
            let (mut estimator, mut times, mut shown) =
                (SpeedEstimator::default(), Vec::new(), 0.0);
            let mut before = edge_at(0);
            for us in (0..=1_000_000).step_by(20) {
                let now = edge_at(us);
                times.extend((before..now).map(|_| us));
                before = now;
                if us % 10_000 == 0 {
                    let back = |edges: usize| times.len().checked_sub(edges).map(|i| times[i]);
                    let last = back(1).unwrap_or(0);
                    let edges = Edges {
                        count: times.len() as u16,
                        last: Micros(last),
                        turn_us: back(9).map_or(0, |turn| last - turn),
                    };
                    shown = f64::from(estimator.step(&edges, Micros(us)).speed_rad_s);
                }
            }
            shown
        };
        let mean = (0..PLACES).map(shown).sum::<f64>() / PLACES as f64;
        let angles: Vec<[f64; 2]> = (0..=1_000)
            .map(|ms| [angle_rad(f64::from(ms) * 1e-3); 2])
            .collect();
        let angles = Angles {
            angle_rad: &angles,
            from_ms: 0,
            wheel: 0,
        };
        let edge_ms = 1e3 * EDGE_RAD / mean;
        let window = Window {
            end_ms: (1e3 - 0.5 * edge_ms).round() as usize,
            length_ms: (8.0 * edge_ms).round() as usize,
        };
        (mean, angles.shown(RobotProgram::Rumbo, window))
    }

    #[test]
    fn a_wheel_that_speeds_up_or_slows_down_is_shown_as_the_robot_shows_it() {
        for (speed_rad_s, slope_rad_s2) in [
            (2.0, 0.0),
            (12.0, 0.0),
            (3.0, 25.0),
            (6.0, 30.0),
            (15.0, 20.0),
            (4.0, -15.0),
            (15.0, -25.0),
        ] {
            // At 1 s it has that speed; it began to change 0.1 s before.
            let angle_rad = |s: f64| {
                let changing_s = (s - 0.9_f64).max(0.0);
                (speed_rad_s - 0.1 * slope_rad_s2) * s
                    + 0.5 * slope_rad_s2 * changing_s * changing_s
            };
            let (shown, expected) = shown_and_expected(angle_rad);
            assert!(
                (shown - expected).abs() < 0.02 * shown,
                "{speed_rad_s} rad/s, {slope_rad_s2} rad/s2: {shown} shown, {expected} expected"
            );
        }
    }

    #[test]
    fn a_wheel_that_stands_has_no_speed() {
        let angles = Angles {
            angle_rad: &[[0.3; 2]; 200],
            from_ms: 0,
            wheel: 1,
        };
        let window = Window {
            end_ms: 190,
            length_ms: 40,
        };
        assert_eq!(angles.shown(RobotProgram::Rumbo, window), 0.0);
    }
}
