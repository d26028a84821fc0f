//! The robot: bytes and sensor readings in, duty and bytes out.
//!
//! At a tick the caller hands over the bytes that arrived ([`Robot::receive`]), then what the sensors latched
//! ([`Robot::tick`]); once it has the outputs there is time for the rest ([`Robot::report`]). It empties the transmit ring at its
//! own pace ([`Robot::transmit`]). Nothing here waits, reads a clock or knows a pin, so the firmware, the emulated chip
//! and the simulator run the same robot.

#[cfg(not(target_arch = "avr"))]
use crate::loops::Loops;
#[cfg(not(target_arch = "avr"))]
use rumbo_control::drive::DriveLayer;
use rumbo_control::mode::ModeId;
use rumbo_control::params::{ParamId, SCHEMA};
use rumbo_control::{Fault, Inputs, Outputs, ServoAngle};
use rumbo_wire::text::TextCommand;
use rumbo_wire::{
    Ack, COMMAND_LIFE_MS, Command, Decoder, EventKind, FrameBody, FrameMessage, Hello,
    PROTOCOL_VERSION, Received, Refusal, ResetCause, RobotTime, StatusReport, ToRobot,
    VELOCITY_LIFE_MS, codec,
};

use crate::clock::Clock;
use crate::governor::Governor;
use crate::ledger::{Ledger, Verdict};
use crate::pilot::Pilot;
use crate::policy;
use crate::report::{Language, Reporter};
use crate::store::{Cell, Store};
use crate::supervisor::Supervisor;
use crate::text::{self, Translated};

/// Longest line of text that is understood.
const LINE: usize = 48;
/// Without a tick for this long [us], the robot does not know what it drives through.
const TICK_LOST_US: u32 = 100_000;

/// What the robot needs to know about itself at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotConfig {
    /// Hash of the program image; 0 for the native build.
    pub image: u32,
    /// Why the program started.
    pub reset: ResetCause,
    /// Number of this start, wrapping: another one than at the starts before.
    pub start: u8,
}

/// The whole robot, but for its hardware.
#[derive(Clone, Debug)]
pub struct Robot {
    start: u8,
    clock: Clock,
    decoder: Decoder<LINE>,
    ledger: Ledger,
    supervisor: Supervisor,
    pilot: Pilot,
    governor: Governor,
    reporter: Reporter,
    battery_v: Option<f32>,
    store: Store,
}

impl Robot {
    /// A robot at rest, disarmed whatever the cause of its start.
    pub fn new(config: RobotConfig) -> Robot {
        let hello = Hello {
            protocol: PROTOCOL_VERSION,
            schema: SCHEMA,
            image: config.image,
            reset: config.reset,
        };
        Robot {
            start: config.start,
            clock: Clock::default(),
            decoder: Decoder::default(),
            ledger: Ledger::default(),
            supervisor: Supervisor::default(),
            pilot: Pilot::default(),
            governor: Governor::default(),
            reporter: Reporter::new(hello),
            battery_v: None,
            store: Store::default(),
        }
    }

    /// Takes a byte from the link; what it completes is applied at once.
    pub fn receive(&mut self, byte: u8) {
        self.receive_judging(byte, true);
    }

    /// The same for a simulated robot that gets what another one is given: by that one's clock, so no command is too old.
    #[cfg(not(target_arch = "avr"))]
    pub fn receive_as_ghost(&mut self, byte: u8) {
        self.receive_judging(byte, false);
    }

    fn receive_judging(&mut self, byte: u8, age: bool) {
        match self.decoder.push(byte) {
            None => {}
            Some(Received::Frame(body)) => self.take_frame(&body, age),
            Some(Received::Line(line)) => {
                let parsed = TextCommand::parse(line);
                self.take_line(parsed.ok());
            }
        }
    }

    /// One tick: judges, estimates, drives as the mode asked after the tick before. The outputs take effect
    /// [`OUTPUT_DELAY_US`](rumbo_control::OUTPUT_DELAY_US) after the tick. [`Robot::report`] follows.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        self.tick_aiming(inputs, None)
    }

    /// The same, with the servo where a caller without a link points it, whatever the mode requested.
    #[inline]
    pub fn tick_aiming(&mut self, inputs: &Inputs, aim: Option<ServoAngle>) -> Outputs {
        let elapsed_us = self.clock.advance(inputs.now);
        if elapsed_us > TICK_LOST_US {
            self.fail(Fault::Overrun);
        }
        let timeout = match self.reporter.language() {
            Language::Binary => ParamId::LinkTimeout,
            Language::Text => ParamId::TextTimeout,
        };
        let timeout_us = self.pilot.link_timeout_us(timeout);
        if let Some(event) = self.supervisor.watch_link(inputs.now, timeout_us) {
            self.released_by(event);
        }
        let armed = self.supervisor.is_armed();
        let (outputs, fault) = self.pilot.step(inputs, armed, aim);
        if let Some(fault) = fault {
            self.fail(fault);
        }
        let armed = self.supervisor.is_armed();
        let drive = self.governor.pass(outputs.drive, armed);
        self.pilot.drove(drive);
        self.battery_v = inputs.battery_v;
        Outputs { drive, ..outputs }
    }

    /// The analogue input, 0..=15, that a divider brings the battery's voltage to; `None` where none is wired (parameter
    /// `battery_ratio` 0).
    pub fn battery_input(&self) -> Option<u8> {
        self.pilot.battery_input()
    }

    /// The battery's voltage [V] of a conversion by that input, 0..=1023 of 5 V.
    pub fn battery_v(&self, counts: u16) -> f32 {
        self.pilot.battery_v(counts)
    }

    /// The active mode and the state of its machine at the last tick; `None` while the wheels are released.
    pub fn mode_state(&self) -> Option<(ModeId, u8)> {
        let armed = self.supervisor.is_armed();
        armed.then(|| (self.pilot.mode(), self.pilot.signals().telemetry.state))
    }

    /// The rest of a tick, which its outputs do not wait for: the mode decides what the next tick is to do, then the robot sends what
    /// is due. Where there was much to do, with a sonar's reading or at a goal, that waits a tick.
    pub fn report(&mut self) {
        let mut busy = self.pilot.has_reading();
        match self.pilot.think(self.supervisor.is_armed()) {
            Err(fault) => self.fail(fault),
            Ok(found) => {
                busy |= found.reached || found.unreachable.is_some();
                if found.reached {
                    self.event(EventKind::Reached);
                }
                match found.unreachable {
                    Some(Ok(())) => self.event(EventKind::Unreachable),
                    Some(Err(after_s)) => self.event(EventKind::GaveUp { after_s }),
                    None => {}
                }
            }
        }
        let status = self.status();
        let (now, t_ms) = (self.clock.now(), self.clock.t_ms());
        self.reporter
            .tick(now, t_ms, busy, &status, || self.pilot.signals());
    }

    /// Looks for a network of mode 9, before the robot starts; `read` gives a byte of where one may be. A damaged one is
    /// none.
    pub fn learn(&mut self, read: impl Fn(u16) -> u8) {
        self.pilot.learn(policy::find(read));
    }

    /// After [`Robot::report`]: works on a decision of mode 9, of whose network `read` gives the bytes.
    pub fn decide(&mut self, read: impl Fn(u16) -> u8) {
        if self.supervisor.is_armed() {
            self.pilot.decide(read);
        }
    }

    /// The next byte for the link, if any waits. Called for each of a frame's 30 bytes in a tick, hence inlined.
    #[inline(always)]
    pub fn transmit(&mut self) -> Option<u8> {
        self.reporter.transmit()
    }

    /// Sets the pose relative to the origin: for a simulated robot that is placed elsewhere.
    #[cfg(not(target_arch = "avr"))]
    pub fn set_pose(&mut self, pose: rumbo_control::Pose) {
        self.pilot.set_pose(pose);
    }

    /// Applies a command that arrives without a link, from a program on this machine; it is a sign of life.
    ///
    /// # Errors
    /// Why the robot refuses it.
    #[cfg(not(target_arch = "avr"))]
    pub fn order(&mut self, command: &Command) -> Result<f32, Refusal> {
        self.stay_alive();
        self.apply(command)
    }

    /// Acknowledges such a command as one that came over the link.
    #[cfg(not(target_arch = "avr"))]
    pub fn acknowledge(&mut self, ack: Ack) {
        self.reporter.acknowledge(ack);
    }

    /// Counts as a heartbeat from the caller that commands the robot without a link.
    #[cfg(not(target_arch = "avr"))]
    pub fn stay_alive(&mut self) {
        self.supervisor.sign_of_life(self.clock.now());
    }

    /// [`Robot::report`] without the report: the mode decides, and nothing is sent.
    #[cfg(not(target_arch = "avr"))]
    pub fn think(&mut self) {
        if let Err(fault) = self.pilot.think(self.supervisor.is_armed()) {
            self.fail(fault);
        }
    }

    /// What the robot knows after the last tick: as in its telemetry, but not rounded, at every tick, with the ages of the
    /// ranges and without a time.
    #[cfg(not(target_arch = "avr"))]
    pub fn knowledge(&self) -> rumbo_wire::Telemetry {
        rumbo_wire::Telemetry {
            armed: self.supervisor.is_armed(),
            faulted: self.supervisor.fault().is_some(),
            ..self.pilot.signals().telemetry
        }
    }

    /// Has the wheels driven open loop at the next tick, by shares of the full PWM of -1 to 1, whatever the mode requested:
    /// for a caller without a link.
    #[cfg(not(target_arch = "avr"))]
    pub fn request_duty(&mut self, duty: rumbo_control::Wheels<f32>) {
        self.pilot.request_duty(duty);
    }

    /// The state of the drive layer, for [`Robot::loops`].
    #[cfg(not(target_arch = "avr"))]
    pub fn drive_layer(&self) -> &DriveLayer {
        self.pilot.drive_layer()
    }

    /// What the control loops added up at the last tick, before which the drive layer was in this state.
    #[cfg(not(target_arch = "avr"))]
    pub fn loops(&self, before: &DriveLayer) -> Loops {
        self.pilot.loops(before, self.battery_v)
    }

    /// The latched fault.
    #[cfg(not(target_arch = "avr"))]
    pub fn fault(&self) -> Option<Fault> {
        self.supervisor.fault()
    }

    /// Sets a parameter before the robot starts, as the overrides of a robot file do in a simulation.
    ///
    /// # Errors
    /// As for [`Command::SetParam`].
    pub fn set_param(&mut self, id: u8, value: f32) -> Result<f32, Refusal> {
        self.pilot.set_param(id, value)
    }

    /// Takes the parameters that were saved, before the robot starts; `read` gives a byte of the EEPROM, 0..4096. Without a
    /// good copy the defaults stay; which copy it was is reported after each HELLO.
    pub fn recall(&mut self, read: impl FnMut(u16) -> u8) {
        let recalled = self.store.recall(self.pilot.params_mut(), read);
        self.reporter.recalled(recalled);
    }

    /// The next byte for the EEPROM, if a save is under way. To be called when the byte before has been written, at most
    /// once a tick.
    pub fn store(&mut self) -> Option<Cell> {
        let (cell, done) = self.store.next(self.pilot.params_mut());
        if done {
            self.event(EventKind::Saved);
        }
        cell
    }

    /// Takes a frame, and judges the age of a command in it if that is wanted.
    fn take_frame(&mut self, body: &FrameBody, judge_age: bool) {
        let Ok(message) = ToRobot::from_body(body) else {
            if let Some((session, number)) = codec::command_number(body) {
                self.reporter.addressed_in(Language::Binary);
                self.reporter.acknowledge(Ack {
                    session,
                    number,
                    result: Err(Refusal::Malformed),
                });
            }
            return;
        };
        self.reporter.addressed_in(Language::Binary);
        match message {
            ToRobot::Hello => self.reporter.introduce(),
            ToRobot::Heartbeat => {}
            ToRobot::Command {
                session,
                number,
                command,
                seen,
            } => match self.ledger.judge(session, number, &command) {
                Verdict::New => {
                    let result = if judge_age && self.is_too_old(&command, seen) {
                        Err(Refusal::TooOld)
                    } else {
                        self.apply(&command)
                    };
                    let ack = Ack {
                        session,
                        number,
                        result,
                    };
                    self.ledger.record(ack, &command);
                    self.reporter.acknowledge(ack);
                }
                Verdict::Repeated(ack) => self.reporter.acknowledge(ack),
                Verdict::Late => {}
            },
            ToRobot::Velocity { velocity, seen } => {
                let age_ms = self.time().since(seen);
                if !judge_age || age_ms.is_some_and(|ms| ms <= VELOCITY_LIFE_MS) {
                    self.pilot.set_velocity(velocity);
                }
            }
        }
        // Only now: a start that comes alone, out of a silent link, finds it dead.
        self.supervisor.sign_of_life(self.clock.now());
    }

    /// A line of text; `None` if it is no command. Bytes inside a frame can look like a line, so that alone says nothing.
    fn take_line(&mut self, command: Option<TextCommand>) {
        let Some(command) = command else {
            if self.reporter.language() == Language::Text {
                self.reporter.refuse_line(Refusal::Malformed);
            }
            return;
        };
        self.reporter.addressed_in(Language::Text);
        // Text has no heartbeat: the line that starts the robot is its own sign of life.
        self.supervisor.sign_of_life(self.clock.now());
        if let Err(refusal) = self.apply_text(command) {
            self.reporter.refuse_line(refusal);
        }
    }

    fn apply_text(&mut self, command: TextCommand) -> Result<f32, Refusal> {
        match text::translate(command, self.pilot.mode(), self.pilot.reference())? {
            // Text has no command of its own for it: who says OFF knows that the robot stands.
            Translated::Command(Command::Disarm) => {
                self.apply(&Command::Disarm)?;
                self.apply(&Command::ClearFault)
            }
            Translated::Command(command) => self.apply(&command),
            Translated::Params(values) => {
                self.store.changed();
                self.pilot.set_params(&values)
            }
        }
    }

    /// What the link held back is not done later.
    fn is_too_old(&self, command: &Command, seen: RobotTime) -> bool {
        let age_ms = self.time().since(seen);
        command.is_timed() && age_ms.is_none_or(|ms| ms > COMMAND_LIFE_MS)
    }

    /// The time of the last tick.
    fn time(&self) -> RobotTime {
        RobotTime {
            start: self.start,
            ms: self.clock.ms(),
        }
    }

    /// Applies a command; gives the value in force, 0 where there is none.
    fn apply(&mut self, command: &Command) -> Result<f32, Refusal> {
        if matches!(command, Command::SetParam { .. } | Command::ResetParams) {
            self.store.changed();
        }
        match *command {
            Command::Stop | Command::Disarm => {
                let event = self.supervisor.disarm();
                Ok(self.happened(event))
            }
            Command::Arm => {
                let event = self.supervisor.arm(self.pilot.ready())?;
                if event.is_some() {
                    self.pilot.start();
                }
                Ok(self.happened(event))
            }
            Command::ClearFault => {
                let event = self.supervisor.clear();
                Ok(self.happened(event))
            }
            // A jump of gains, of the heading that a mode keeps, or of the sonars, is not for a moving robot.
            Command::Mode(_) | Command::ResetParams | Command::ResetPose
                if self.supervisor.is_armed() =>
            {
                Err(Refusal::Armed)
            }
            Command::SetParam { id, .. }
                if id == ParamId::Rig as u8 && self.supervisor.is_armed() =>
            {
                Err(Refusal::Armed)
            }
            Command::Mode(mode) => {
                self.pilot.select(mode);
                self.event(EventKind::ModeChanged(mode));
                Ok(f32::from(mode as u8))
            }
            Command::SetParam { id, value } => self.pilot.set_param(id, value),
            Command::GetParam { id } => self.pilot.param(id),
            Command::ResetParams => {
                self.pilot.reset_params();
                Ok(0.0)
            }
            Command::SaveParams => {
                self.store.save();
                Ok(0.0)
            }
            Command::ResetPose => {
                self.pilot.reset_pose();
                Ok(0.0)
            }
            Command::Reference(_)
            | Command::WheelReference(_)
            | Command::Move { .. }
            | Command::Goal { .. }
            | Command::Lane
            | Command::Route { .. }
            | Command::Waypoint(_) => self.pilot.command(command),
        }
    }

    /// Reports an event, if there is one; no value is in force.
    fn happened(&mut self, event: Option<EventKind>) -> f32 {
        if let Some(event) = event {
            self.event(event);
        }
        0.0
    }

    fn fail(&mut self, fault: Fault) {
        if let Some(event) = self.supervisor.fail(fault) {
            self.released_by(event);
        }
    }

    fn released_by(&mut self, event: EventKind) {
        self.event(event);
        self.event(EventKind::Disarmed);
    }

    fn event(&mut self, kind: EventKind) {
        self.reporter.event(self.clock.t_ms(), kind);
    }

    fn status(&self) -> StatusReport {
        let low = |counter: u16| (counter & 0xFF) as u8;
        StatusReport {
            mode: self.pilot.mode(),
            armed: self.supervisor.is_armed(),
            fault: self.supervisor.fault(),
            battery_v: self.battery_v,
            reference: self.pilot.reference(),
            crc_errors: low(self.decoder.crc_errors()),
            dropped: self.reporter.dropped(),
            overruns: self.clock.overruns(),
            rig: self.pilot.rig(),
            at: self.time(),
        }
    }
}
