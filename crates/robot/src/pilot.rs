//! The control core put together: estimators -> mode -> drive layer, with the parameters and the setpoint.
//!
//! The outputs of a tick wait for the estimators and the drive layer only. The mode decides after they have left, from
//! the same estimates, and its request is driven from the next tick on: it may take the rest of the period, and its
//! loops lag those of the wheel speeds by 10 ms.

use rumbo_control::drive::DriveLayer;
use rumbo_control::estimate::{Estimate, Estimator};
use rumbo_control::math::round;
use rumbo_control::mode::{Action, ActiveMode, ModeId, MovementLevel, Reference, SetpointError};
use rumbo_control::params::{ParamId, Params};
use rumbo_control::policy::{Known, NetworkShape, observe};
use rumbo_control::rig::Rig;
use rumbo_control::{
    Drive, Duty, Fault, Inputs, Outputs, Range, ServoAngle, SonarId, Velocity, Wheels,
};
use rumbo_wire::{Command, Refusal, Telemetry};

use crate::encoders::EncoderWatch;
use crate::report::Signals;
use crate::sonars::PingSchedule;

/// Ticks of low battery that stop the robot: 0.5 s, since the voltage dips when the wheels start.
const LOW_BATTERY_TICKS: u8 = 50;

/// The heading's sine and cosine are recomputed every so many ticks, or one later: not in a tick with a reading.
const REFRESH_TICKS: u8 = 4;
/// The first time between two samples of telemetry.
const FIRST_REFRESH_TICKS: u8 = 2;

/// Reference of the chip's converter, its supply, and its resolution.
const CONVERTER_V: f32 = 5.0;
const CONVERTER_COUNTS: f32 = 1_024.0;

/// Controllers and their state.
#[derive(Clone, Debug)]
pub(crate) struct Pilot {
    params: Params,
    estimator: Estimator,
    estimate: Estimate,
    mode: ActiveMode,
    /// The mode's request after the last tick.
    action: Action,
    reached: bool,
    unreachable: bool,
    drive: DriveLayer,
    wheel_ref_rad_s: Wheels<f32>,
    duty: Wheels<Duty>,
    pings: PingSchedule,
    encoders: EncoderWatch,
    low_battery_ticks: u8,
    refresh_in: u8,
    /// Of the network of mode 9, if there is one.
    network: Option<NetworkShape>,
}

/// An outcome of the mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found {
    /// It reached its reference at this tick.
    pub(crate) reached: bool,
    /// It stopped trying to reach its goal at this tick: every way was tried, or else its time \[s\] was over.
    pub(crate) unreachable: Option<Result<(), u16>>,
}

impl Default for Pilot {
    // Not derived: it would be inlined, and the robot built on the stack first, in two kilobytes.
    fn default() -> Self {
        Self {
            params: Params::default(),
            estimator: Estimator::default(),
            estimate: Estimate::default(),
            mode: ActiveMode::default(),
            action: Action::default(),
            reached: false,
            unreachable: false,
            drive: DriveLayer::default(),
            wheel_ref_rad_s: Wheels::both(0.0),
            duty: Wheels::both(Duty::RELEASED),
            pings: PingSchedule::default(),
            encoders: EncoderWatch::default(),
            low_battery_ticks: 0,
            refresh_in: FIRST_REFRESH_TICKS,
            network: None,
        }
    }
}

impl Pilot {
    /// The part of a tick that the outputs depend on: estimates, and drives as the mode requested after the previous
    /// tick. Releases the wheels on a fault and unless `armed`. The servo goes to `aim` if there is one, whatever the mode
    /// requested.
    #[inline]
    pub(crate) fn step(
        &mut self,
        inputs: &Inputs,
        armed: bool,
        aim: Option<ServoAngle>,
    ) -> (Outputs, Option<Fault>) {
        self.estimator.step(
            &self.params,
            inputs,
            self.drive.directions(),
            &mut self.estimate,
        );
        self.watch_battery(inputs.battery_v);
        let fault = self.act(inputs.battery_v, armed).err();
        if !armed || fault.is_some() {
            self.release();
            self.action = self.at_rest();
        }
        let mut look = self.action.look;
        look.servo = aim.unwrap_or(look.servo);
        let ping = self.pings.next(self.carried(look.sonars));
        self.estimator.commanded(look.servo, ping);
        let outputs = Outputs {
            drive: self.duty,
            servo: look.servo,
            ping,
        };
        (outputs, fault)
    }

    /// The rest of a tick: checks the encoders, and lets the mode decide the request for the next tick.
    ///
    /// # Errors
    /// Why the robot must stop.
    pub(crate) fn think(&mut self, armed: bool) -> Result<Found, Fault> {
        self.action = self.at_rest();
        if armed {
            let motion = &self.estimate.motion;
            self.encoders.step(&self.params, motion, self.duty)?;
            self.estimate.face_reading();
            self.action = self.mode.step(&self.params, &self.estimate)?;
        }
        if self.action.new_origin {
            self.estimator.reset_pose();
        }
        self.refresh_in = self.refresh_in.saturating_sub(1);
        if self.refresh_in == 0 && !self.has_reading() {
            self.refresh_in = REFRESH_TICKS;
            self.estimator.refresh();
        }
        let Action {
            reached,
            unreachable,
            out_of_time,
            ..
        } = self.action;
        let before = (self.reached, self.unreachable);
        (self.reached, self.unreachable) = (reached, unreachable);
        Ok(Found {
            reached: reached && !before.0,
            unreachable: (unreachable && !before.1).then(|| match out_of_time {
                true => Err(round(self.params.get(ParamId::MissionGiveUp)) as u16),
                false => Ok(()),
            }),
        })
    }

    /// Sets the network of mode 9.
    pub(crate) fn learn(&mut self, network: Option<NetworkShape>) {
        self.network = network;
    }

    /// Works on a decision of mode 9, of whose network `read` gives the bytes.
    pub(crate) fn decide(&mut self, read: impl Fn(u16) -> u8) {
        let (estimator, estimate) = (&self.estimator, &self.estimate);
        if let Some(shape) = &self.network {
            self.mode.decide(shape, read, |goal_m| {
                let known = Known {
                    wheel_rad_s: &estimate.wheel_rad_s,
                    ranges: &estimator.shown(estimate),
                    servo_rad: estimate.servo_rad,
                    pose: &estimate.pose,
                };
                observe(&known, goal_m)
            });
        }
    }

    /// A sonar answered at this tick, which makes the tick a long one.
    pub(crate) fn has_reading(&self) -> bool {
        self.estimate.reading.is_some()
    }

    /// The wanted sonars that the rig has.
    fn carried(&self, mut wanted: [bool; 3]) -> [bool; 3] {
        for &sonar in &SonarId::ALL {
            wanted[sonar as usize] &= self.params.carries(sonar);
        }
        wanted
    }

    fn act(&mut self, battery_v: Option<f32>, armed: bool) -> Result<(), Fault> {
        if !armed {
            return Ok(());
        }
        if self.is_battery_low() {
            return Err(Fault::BatteryLow);
        }
        let drive = self.action.drive;
        self.apply(&drive, battery_v)
    }

    fn at_rest(&self) -> Action {
        Action {
            look: self.mode.look(),
            ..Action::default()
        }
    }

    fn watch_battery(&mut self, battery_v: Option<f32>) {
        let low = battery_v.is_some_and(|volts| volts < self.params.get(ParamId::LowBattery));
        self.low_battery_ticks = if low {
            self.low_battery_ticks.saturating_add(1)
        } else {
            0
        };
    }

    fn is_battery_low(&self) -> bool {
        self.low_battery_ticks >= LOW_BATTERY_TICKS
    }

    fn apply(&mut self, drive: &Drive, battery_v: Option<f32>) -> Result<(), Fault> {
        let driven = self
            .drive
            .step(&self.params, drive, &self.estimate.motion, battery_v)
            .map_err(|_| Fault::NotFinite)?;
        self.duty = driven.duty;
        self.wheel_ref_rad_s = driven.wheel_ref_rad_s;
        Ok(())
    }

    fn release(&mut self) {
        self.encoders = EncoderWatch::default();
        // Releasing cannot fail, as it involves no number. Even if it did, the wheels are released.
        if self.apply(&Drive::Release, None).is_err() {
            self.duty = Wheels::both(Duty::RELEASED);
        }
    }

    /// Takes the place of what the mode requested of the wheels.
    #[cfg(not(target_arch = "avr"))]
    pub(crate) fn request_duty(&mut self, duty: Wheels<f32>) {
        self.action.drive = Drive::Duty(duty);
    }

    /// The duty that was let through.
    pub(crate) fn drove(&mut self, duty: Wheels<Duty>) {
        self.duty = duty;
    }

    /// The analogue input with the battery's voltage.
    pub(crate) fn battery_input(&self) -> Option<u8> {
        let input = round(self.params.get(ParamId::BatteryInput));
        (self.params.get(ParamId::BatteryRatio) > 0.0).then_some((input & 0xF) as u8)
    }

    /// Battery voltage from its conversion [V].
    pub(crate) fn battery_v(&self, counts: u16) -> f32 {
        f32::from(counts)
            * (CONVERTER_V / CONVERTER_COUNTS)
            * self.params.get(ParamId::BatteryRatio)
    }

    /// The last tick's signals for telemetry.
    pub(crate) fn signals(&self) -> Signals {
        Signals {
            telemetry: Telemetry {
                pose: self.estimate.pose,
                wheel_rad_s: [self.estimate.wheel_rad_s; 2],
                wheel_ref_rad_s: self.wheel_ref_rad_s,
                duty: self.duty,
                state: self.action.state,
                servo_rad: self.estimate.servo_rad,
                ranges: self.estimator.shown(&self.estimate),
                ..Telemetry::default()
            },
            heading_ref_rad: self.action.heading_ref_rad,
        }
    }

    /// The state of the drive layer.
    #[cfg(not(target_arch = "avr"))]
    pub(crate) fn drive_layer(&self) -> &DriveLayer {
        &self.drive
    }

    /// What the control loops added up at the last tick, before which the drive layer was in this state.
    #[cfg(not(target_arch = "avr"))]
    pub(crate) fn loops(&self, before: &DriveLayer, battery_v: Option<f32>) -> crate::Loops {
        let motion = &self.estimate.motion;
        let request = self.action.drive;
        crate::Loops {
            wheels: self.drive.terms(before, &self.params, motion, battery_v),
            request,
            mode: match request {
                Drive::Release => None,
                _ => self.mode.terms(&self.params, &self.estimate),
            },
        }
    }

    /// The selected mode.
    pub(crate) fn mode(&self) -> ModeId {
        self.mode.id()
    }

    /// The setpoint in force, as in [`rumbo_wire::StatusReport`].
    pub(crate) fn reference(&self) -> Reference {
        self.mode.reference()
    }

    /// Selects a mode, with its default setpoint.
    pub(crate) fn select(&mut self, mode: ModeId) {
        self.mode = ActiveMode::new(mode);
    }

    /// Whether battery and the mode's sensors are good enough to arm.
    pub(crate) fn ready(&self) -> Result<(), Refusal> {
        if self.is_battery_low() {
            Err(Refusal::BatteryLow)
        } else if !self.mode.fits(self.params.rig()) {
            Err(Refusal::WrongRig)
        } else if self.mode.id() == ModeId::Policy && self.network.is_none() {
            Err(Refusal::NoPolicy)
        } else if self.mode.is_ready(&self.params, &self.estimate) {
            Ok(())
        } else if self.lacks_readings() {
            Err(Refusal::SonarNotReady)
        } else {
            Err(Refusal::NoWall)
        }
    }

    /// One of the sonars that the mode needs gives no reading at all, not even *clear*.
    fn lacks_readings(&self) -> bool {
        let needed = self.carried(self.mode.look().sonars);
        SonarId::ALL.iter().any(|&sonar| {
            let stale_s = self.params.get(ParamId::StaleRange);
            let reading = self.estimate.range(sonar);
            needed[sonar as usize] && (reading.range == Range::Faulty || reading.is_older(stale_s))
        })
    }

    /// The wheels have been armed.
    pub(crate) fn start(&mut self) {
        self.mode.start();
        self.action = self.at_rest();
        self.reached = false;
        self.unreachable = false;
    }

    /// The sonars of the configured rig.
    pub(crate) fn rig(&self) -> Rig {
        self.params.rig()
    }

    /// Applies a command for the mode; returns the value in force, 0 where there is none.
    pub(crate) fn command(&mut self, command: &Command) -> Result<f32, Refusal> {
        let mode = &mut self.mode;
        let done = match *command {
            Command::Reference(value) => mode.set_reference(value),
            Command::WheelReference(wheels) => mode.set_wheel_reference(wheels),
            Command::Move { movement, level } => mode.set_movement(movement, level),
            Command::Goal { x_m, y_m } => mode.set_goal(x_m, y_m),
            Command::Lane => mode.follow_lane(),
            Command::Route { repeat, relative } => mode.begin_route(repeat, relative),
            Command::Waypoint(waypoint) => mode.add_waypoint(waypoint),
            _ => Err(SetpointError::NotInThisMode),
        };
        done?;
        Ok(match *command {
            Command::Reference(_) | Command::WheelReference(_) => mode.reference().numbers()[0],
            Command::Move { level, .. } => {
                let (MovementLevel::Duty(value) | MovementLevel::Speed(value)) = level;
                value
            }
            _ => 0.0,
        })
    }

    /// Takes a velocity; one that the mode refuses changes nothing, and nobody waits for an answer.
    pub(crate) fn set_velocity(&mut self, velocity: Velocity) {
        self.mode.set_velocity(velocity).ok();
    }

    /// A parameter's value.
    pub(crate) fn param(&self, number: u8) -> Result<f32, Refusal> {
        let id = ParamId::from_number(number).ok_or(Refusal::UnknownParam)?;
        Ok(self.params.get(id))
    }

    /// Sets a parameter; returns the value in force.
    pub(crate) fn set_param(&mut self, number: u8, value: f32) -> Result<f32, Refusal> {
        let id = ParamId::from_number(number).ok_or(Refusal::UnknownParam)?;
        Ok(self.params.set(id, value)?)
    }

    /// The parameters, for saving.
    pub(crate) fn params_mut(&mut self) -> &mut Params {
        &mut self.params
    }

    /// Sets several parameters, or none.
    pub(crate) fn set_params(&mut self, values: &[(ParamId, f32)]) -> Result<f32, Refusal> {
        for &(id, value) in values {
            id.check(value)?;
        }
        for &(id, value) in values {
            self.params.set(id, value)?;
        }
        Ok(0.0)
    }

    /// Sets every parameter to its default.
    pub(crate) fn reset_params(&mut self) {
        self.params.reset();
    }

    /// Sets the estimated pose, relative to the origin.
    #[cfg(not(target_arch = "avr"))]
    pub(crate) fn set_pose(&mut self, pose: rumbo_control::Pose) {
        self.estimator.set_pose(pose);
    }

    /// Makes the present pose the origin.
    pub(crate) fn reset_pose(&mut self) {
        self.estimator.reset_pose();
    }

    /// Link time-out [us].
    pub(crate) fn link_timeout_us(&self, id: ParamId) -> u32 {
        // At most an hour, which 32 bits hold.
        round(self.params.get(id) * 1_000.0).unsigned_abs() * 1_000
    }
}
