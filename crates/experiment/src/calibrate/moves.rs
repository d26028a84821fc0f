//! The movements of a calibration: a leg along the wall, a turn on the spot, a slow ramp of the duty.

use super::error::CalibrateError;
use super::sample::Sample;
use super::station::Station;
use rumbo_control::mode::{ModeId, Movement, MovementLevel};
use rumbo_control::{SIDES, SonarId, Wheels};
use rumbo_wire::{Command, Waypoint};

/// The robot goes no nearer than this to what is ahead of its front sonar [m].
const AHEAD_M: f64 = 0.30;
/// Nor to the wall beside it, from the sonar [m].
const BESIDE_M: f64 = 0.12;
/// A leg ends when the distance to the wall has changed by this [m]: the wheels' ratio is still poorly known.
const ASTRAY_M: f64 = 0.10;
/// Deceleration of mode 6, on its parameter's default, on the way to zero [m/s^2].
const BRAKE_M_S2: f64 = 0.26;
/// Delay from a telemetry sample to the effect of a command [s].
const LATENCY_S: f64 = 0.12;
/// Below this a wheel stands [rad/s].
const STANDING_RAD_S: f64 = 0.05;
/// Largest turn between two waypoints [rad]: well below half a turn, so that its sense is clear.
const PART_RAD: f64 = 2.4;
/// The ramp of the duty: from, to, per second.
const RAMP: (f64, f64, f64) = (0.12, 0.50, 0.08);
/// Time between two steps of the ramp [s].
const RAMP_STEP_S: f64 = 0.04;
/// Delay from a wheel breaking away to the telemetry that shows it turning, in which the ramp rises on [s].
const SEEN_AFTER_S: f64 = 0.03;

/// Whether both wheels stand.
fn stands(sample: &Sample) -> bool {
    SIDES
        .iter()
        .all(|side| sample.wheel_rad_s[*side].abs() < STANDING_RAD_S)
}

impl Station {
    /// Selects a mode and arms it.
    async fn start(&mut self, mode: ModeId) -> Result<(), CalibrateError> {
        self.command(Command::Disarm).await?;
        self.command(Command::Mode(mode)).await?;
        Ok(())
    }

    /// Waits until the robot has stood for a moment, and disarms it.
    async fn rest(&mut self) -> Result<(), CalibrateError> {
        let mut still = 0;
        let rests = self
            .until(3.0, |_, sample| {
                still = if stands(sample) { still + 1 } else { 0 };
                still >= 6
            })
            .await?;
        self.command(Command::Disarm).await?;
        if rests {
            Ok(())
        } else {
            Err(CalibrateError::TooSlow("coming to rest"))
        }
    }

    /// Drives straight on by `way_m` (negative: backward) at a wheel speed; returns the telemetry from start to rest.
    pub(super) async fn leg(
        &mut self,
        side: SonarId,
        way_m: f64,
        wheel_rad_s: f64,
        radius_m: f64,
    ) -> Result<Vec<Sample>, CalibrateError> {
        let forward = way_m > 0.0;
        let speed_m_s = wheel_rad_s * radius_m;
        let braking_m = speed_m_s * speed_m_s / (2.0 * BRAKE_M_S2) + speed_m_s * LATENCY_S;
        self.start(ModeId::StraightLine).await?;
        let from = self.last()?;
        let first = self.samples.len();
        self.command(Command::Arm).await?;
        let speed = if forward { wheel_rad_s } else { -wheel_rad_s };
        self.command(Command::Reference(speed as f32)).await?;
        let arrived = self
            .until(3.0 + way_m.abs() / speed_m_s * 1.5, |_, now| {
                let gone_m = (now.x_m - from.x_m).hypot(now.y_m - from.y_m);
                let ahead = now.range_m(SonarId::Front);
                let blind = now.faulty[SonarId::Front as usize];
                let near = forward && (blind || ahead.is_some_and(|m| m < AHEAD_M + braking_m));
                let beside = now.range_m(side);
                let astray = match (beside, from.range_m(side)) {
                    (Some(now_m), Some(then_m)) => {
                        forward && (now_m < BESIDE_M || (now_m - then_m).abs() > ASTRAY_M)
                    }
                    _ => forward,
                };
                gone_m + braking_m >= way_m.abs() || near || astray
            })
            .await?;
        self.command(Command::Reference(0.0)).await?;
        self.rest().await?;
        if !arrived {
            return Err(CalibrateError::TooSlow("a leg along the wall"));
        }
        Ok(self.samples[first..].to_vec())
    }

    /// Turns on the spot by any angle, as measured by odometry.
    pub(super) async fn turn(&mut self, turn_rad: f64) -> Result<(), CalibrateError> {
        self.start(ModeId::Waypoints).await?;
        self.command(Command::Route {
            repeat: false,
            relative: true,
        })
        .await?;
        let parts = (turn_rad.abs() / PART_RAD).ceil().max(1.0);
        for part in 1..=parts as u32 {
            let heading_rad = turn_rad * f64::from(part) / parts;
            let turns = (heading_rad / std::f64::consts::TAU).round();
            let wrapped_rad = heading_rad - std::f64::consts::TAU * turns;
            self.command(Command::Waypoint(Waypoint {
                x_m: 0.0,
                y_m: 0.0,
                heading_rad: Some(wrapped_rad as f32),
            }))
            .await?;
        }
        self.command(Command::Arm).await?;
        let done = self
            .until(6.0 + 4.0 * parts, |station, _| station.reached)
            .await?;
        self.rest().await?;
        if done {
            Ok(())
        } else {
            Err(CalibrateError::TooSlow("a turn on the spot"))
        }
    }

    /// Raises the duty of both wheels slowly until both turn; returns the duty at which each broke away.
    pub(super) async fn break_away(
        &mut self,
        movement: Movement,
    ) -> Result<Wheels<Option<f64>>, CalibrateError> {
        let (from, to, per_s) = RAMP;
        self.start(ModeId::Manual).await?;
        let mut found = Wheels::both(None);
        let mut moving = 0;
        let start_s = self.now_s();
        let mut armed = false;
        loop {
            let duty = from + per_s * (self.now_s() - start_s);
            if duty > to {
                break;
            }
            self.command(Command::Move {
                movement,
                level: MovementLevel::Duty(duty as f32),
            })
            .await?;
            if !armed {
                self.command(Command::Arm).await?;
                armed = true;
            }
            self.until(RAMP_STEP_S, |_, sample| {
                for side in SIDES {
                    if found[side].is_none() && sample.wheel_rad_s[side].abs() > STANDING_RAD_S {
                        found[side] = Some(sample.duty[side].abs() - per_s * SEEN_AFTER_S);
                    }
                }
                false
            })
            .await?;
            if found.left.is_some() && found.right.is_some() {
                moving += 1;
            }
            if moving > 1 {
                break;
            }
        }
        self.command(Command::Stop).await?;
        self.rest().await?;
        Ok(found)
    }
}
