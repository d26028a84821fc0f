//! Velocities of ROS 2: the one way from `/cmd_vel` to the wheels.

use super::{AGAIN, Live, SHOWN, is_due};
use crate::node::{BadVelocity, Velocity};
use crate::station::Order;
use std::time::{Duration, Instant};

/// Oldest velocity that is passed on [s]; the robot judges by the same, from there on.
const OLDEST_S: f64 = 0.3;
/// Without a velocity for this long they need no control; the robot has released its wheels.
const SILENCE: Duration = Duration::from_millis(500);
/// Two who send velocities within this time drive by turns.
const ALTERNATING: Duration = Duration::from_millis(500);

/// What is known of those who send velocities.
#[derive(Default)]
pub(super) struct Driving {
    /// Who sent the last one, and when it came.
    last: Option<([u8; 16], Instant)>,
    /// Another one has sent one within [`ALTERNATING`] of it.
    alternating: Option<Instant>,
    /// When one was passed on.
    passed: Option<Instant>,
    /// Why one was not passed on, and when.
    refused: Option<(String, Instant)>,
    /// The same of what was said on the terminal.
    said: Option<(String, Instant)>,
}

impl Driving {
    /// Velocities drive the robot.
    pub(super) fn lasts(&self) -> bool {
        self.passed.is_some_and(|passed| passed.elapsed() < SILENCE)
    }

    /// What diagnostics warn of.
    pub(super) fn warning(&self) -> Option<String> {
        let refused = self.refused.as_ref();
        let refused = refused.filter(|(_, since)| since.elapsed() < SHOWN);
        let refused = refused.map(|(why, _)| format!("cmd_vel: {why}"));
        let alternating = self
            .alternating
            .is_some_and(|since| since.elapsed() < SHOWN);
        let turns = "cmd_vel: two publishers drive by turns, the newest counts";
        refused.or_else(|| alternating.then(|| turns.to_owned()))
    }
}

impl Live {
    /// Passes a velocity on, or says why not.
    pub(super) fn drive(&mut self, velocity: Result<Velocity, BadVelocity>) {
        let passed = velocity
            .map_err(|BadVelocity| "it cannot be decoded".to_owned())
            .and_then(|velocity| self.pass_on(velocity));
        let Err(why) = passed else {
            return;
        };
        if is_due(self.driving.said.as_ref(), AGAIN) {
            self.note(&format!("cmd_vel: {why}"));
            self.driving.said = Some((why.clone(), Instant::now()));
        }
        self.driving.refused = Some((why, Instant::now()));
    }

    fn pass_on(&mut self, velocity: Velocity) -> Result<(), String> {
        let now = Instant::now();
        if let Some((before, since)) = self.driving.last.replace((velocity.sender, now))
            && before != velocity.sender
            && since.elapsed() < ALTERNATING
        {
            self.driving.alternating = Some(now);
        }
        self.check_age(&velocity)?;
        // What would move nothing takes no control from the pages.
        if self.mode() != "twist" {
            return Err("refused, the robot is in another mode; call mode/twist".into());
        }
        if !self.state.robot.armed {
            return Err("refused, the robot is off; call arm".into());
        }
        // What is out of range is refused by the session; a number that is none does not get there.
        let number = |value: f64, what: &str| match value as f32 {
            value if value.is_finite() => Ok(value),
            _ => Err(format!("refused, its {what} is not a finite number")),
        };
        self.station.order(Order::Velocity {
            forward_m_s: number(velocity.forward_m_s, "forward speed")?,
            yaw_rad_s: number(velocity.yaw_rad_s, "yaw rate")?,
        })?;
        self.driving.passed = Some(now);
        Ok(())
    }

    /// Refuses what is old, or of another time.
    fn check_age(&self, velocity: &Velocity) -> Result<(), String> {
        let now_ns = self.now_ns() as f64;
        let stamp_s = velocity
            .stamp_ns
            .map(|stamp_ns| (now_ns - stamp_ns as f64) / 1e9);
        for (age_s, of) in [(velocity.age_s, "sent"), (stamp_s, "stamped")] {
            match age_s {
                Some(age_s) if age_s > OLDEST_S => {
                    return Err(format!("refused, it was {of} {age_s:.1} s ago"));
                }
                Some(age_s) if age_s < -OLDEST_S => {
                    let ahead_s = -age_s;
                    return Err(format!(
                        "refused, it is {of} {ahead_s:.1} s ahead of the time here; do the clocks agree?"
                    ));
                }
                _ => {}
            }
        }
        Ok(())
    }
}
