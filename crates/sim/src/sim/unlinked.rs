//! Our native robot without its link: the caller commands it at once and looks at what its program knows.
//!
//! For callers that stand in for a program on the robot, such as a policy that learns: what they decide takes no way over
//! a serial line. The robot sends nothing, which saves its time, and it misses no heartbeat. Where its link is tapped it
//! speaks as any other, to the tap alone, which changes nothing for it.

use super::native::{Native, SESSION};
use super::{Controller, Sim};
use rumbo_control::{Fault, ServoAngle, Wheels};
use rumbo_robot::Loops;
use rumbo_wire::{Command, FrameMessage, Refusal, RobotTime, Telemetry, ToRobot};

impl Sim {
    /// Takes our native robot off its link: from now on it gets its commands by [`Sim::instruct`] and sends nothing. False
    /// for any other program, which stays on its link.
    pub fn unlink(&mut self) -> bool {
        let native = self.native_mut();
        let is_native = native.is_some();
        if let Some(native) = native {
            native.is_unlinked = true;
        }
        is_native
    }

    /// Applies a command at once, without a link; gives the value in force, 0 where there is none.
    ///
    /// # Errors
    /// Why the robot refuses it; `None` if the program is not our native one.
    pub fn instruct(&mut self, command: &Command) -> Result<f32, Option<Refusal>> {
        let native = self.native_mut().ok_or(None)?;
        let result = native.order(command);
        if self.is_tapped() && is_told(command) {
            self.tell(command, result);
        }
        result.map_err(Some)
    }

    /// Hands a command and its answer to the tap.
    fn tell(&mut self, command: &Command, result: Result<f32, Refusal>) {
        let Some(native) = self.native_mut() else {
            return;
        };
        let (number, said) = (native.answer(result), native.said());
        let message = ToRobot::Command {
            session: SESSION,
            number,
            command: *command,
            seen: RobotTime::default(),
        };
        self.note(true, message.frame(0).bytes());
        self.note(false, &said);
    }

    /// Has a robot without a link introduce itself to the tap.
    pub(super) fn greet_unlinked(&mut self) {
        if let Some(native) = self.native_mut().filter(|native| native.is_unlinked) {
            native.greet();
        }
    }

    /// Points the servo of our native robot, whatever its mode requests; `None` leaves it to the mode again.
    pub fn aim(&mut self, servo: Option<ServoAngle>) {
        if let Some(native) = self.native_mut() {
            native.aim = servo;
        }
    }

    /// Drives the wheels of our native robot open loop, by shares of the full PWM of -1 to 1, whatever its mode requests;
    /// `None` leaves them to the mode. It must be armed.
    pub fn drive_duty(&mut self, duty: Option<Wheels<f32>>) {
        if let Some(native) = self.native_mut() {
            native.duty = duty;
        }
    }

    /// What our native robot knows after its last tick; `None` for any other program.
    pub fn knowledge(&self) -> Option<Telemetry> {
        match &self.controller {
            Some(Controller::Rumbo(native)) => Some(native.knowledge()),
            _ => None,
        }
    }

    /// What the control loops of our native robot added up at its last tick; `None` for any other program.
    pub fn loops(&self) -> Option<Loops> {
        match &self.controller {
            Some(Controller::Rumbo(native)) => Some(native.loops()),
            _ => None,
        }
    }

    /// The fault that our native robot has latched.
    pub fn fault(&self) -> Option<Fault> {
        match &self.controller {
            Some(Controller::Rumbo(native)) => native.fault(),
            _ => None,
        }
    }

    fn native_mut(&mut self) -> Option<&mut Native> {
        match &mut self.controller {
            Some(Controller::Rumbo(native)) => Some(native),
            _ => None,
        }
    }
}

/// Whether a command is an event: neither the next of many setpoints nor a look at a parameter.
fn is_told(command: &Command) -> bool {
    !matches!(
        command,
        Command::WheelReference(_) | Command::GetParam { .. }
    )
}
