//! What was done to a robot since its start: with its setup and seed, all that defines it. Done again, here or in another
//! process, it leads to the same robot, bit for bit, while the model is the same.
//!
//! A robot that is driven ten times a second takes 15 bytes for each action; one that its scenario commands, five in all.

use crate::files::FileError;
use rumbo_control::{ServoAngle, Wheels};
use rumbo_wire::{Command, FrameBody, FrameMessage, RobotTime, ToRobot};

/// One thing that was done to a robot.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Act {
    /// It was advanced by this many ticks.
    Advance(u32),
    /// It got a command.
    Command(Command),
    /// Its wheels were given speeds [rad/s], and its servo a direction.
    Drive(Wheels<f32>, ServoAngle),
    /// Its wheels were given shares of the full PWM, -1 to 1, and its servo a direction.
    Duty(Wheels<f32>, ServoAngle),
    /// It was commanded in the words of a scenario.
    Instruct(String),
    /// Its servo was pointed, or left to the mode.
    Aim(Option<ServoAngle>),
    /// Its recording began.
    Record,
    /// The record of its board began.
    Probe,
    /// Bytes were typed to a port of its board.
    Type(u8, Vec<u8>),
    /// A pin of its board was connected to a voltage, or no longer.
    Apply(u8, Option<f64>),
}

/// Acts in the order in which they were done, as bytes: a number for the kind, then its values, least significant byte
/// first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct History {
    bytes: Vec<u8>,
    /// Ticks since the last of them.
    ticks: u32,
}

impl History {
    /// Adds an act.
    pub(super) fn push(&mut self, act: &Act) {
        if let Act::Advance(ticks) = act
            && let Some(sum) = self.ticks.checked_add(*ticks)
        {
            self.ticks = sum;
            return;
        }
        let before = std::mem::take(&mut self.ticks);
        put_ticks(before, &mut self.bytes);
        match act {
            Act::Advance(ticks) => self.ticks = *ticks,
            Act::Command(command) => {
                let message = ToRobot::Command {
                    session: 0,
                    number: 0,
                    command: *command,
                    seen: RobotTime::default(),
                };
                self.put_text(1, message.frame(0).bytes());
            }
            Act::Drive(wheels, servo) => self.put(2, &[wheels.left, wheels.right, servo.0]),
            Act::Duty(wheels, servo) => self.put(3, &[wheels.left, wheels.right, servo.0]),
            Act::Instruct(text) => self.put_text(4, text.as_bytes()),
            Act::Aim(Some(servo)) => self.put(5, &[servo.0]),
            Act::Aim(None) => self.put(6, &[]),
            Act::Record => self.put(7, &[]),
            Act::Probe => self.put(10, &[]),
            Act::Type(port, bytes) => {
                self.put_text(11, bytes);
                self.bytes.push(*port);
            }
            Act::Apply(pin, volts) => {
                self.bytes.extend([12, *pin]);
                self.bytes.extend(volts.unwrap_or(f64::NAN).to_le_bytes());
            }
        }
    }

    fn put(&mut self, kind: u8, values: &[f32]) {
        let values = values.iter().flat_map(|value| value.to_le_bytes());
        self.bytes.push(kind);
        self.bytes.extend(values);
    }

    fn put_text(&mut self, kind: u8, text: &[u8]) {
        self.bytes.push(kind);
        self.bytes.extend((text.len() as u32).to_le_bytes());
        self.bytes.extend(text);
    }

    /// All of it.
    #[must_use]
    pub(super) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        put_ticks(self.ticks, &mut bytes);
        bytes
    }

    /// The acts that these bytes of [`History::to_bytes`] stand for.
    ///
    /// # Errors
    /// They are of something else.
    pub(super) fn acts(mut bytes: &[u8]) -> Result<Vec<Act>, FileError> {
        let mut acts = Vec::new();
        while !bytes.is_empty() {
            let act = take_act(&mut bytes).ok_or_else(|| {
                FileError::Setting(format!(
                    "what was done to a robot cannot be read after {} acts: it is damaged, make it again",
                    acts.len()
                ))
            })?;
            acts.push(act);
        }
        Ok(acts)
    }
}

/// Up to 255 in a byte after the kind, none as nothing.
fn put_ticks(ticks: u32, bytes: &mut Vec<u8>) {
    match u8::try_from(ticks) {
        Ok(0) => {}
        Ok(few) => bytes.extend([9, few]),
        Err(_) => {
            bytes.push(0);
            bytes.extend(ticks.to_le_bytes());
        }
    }
}

fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (own, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*own)
}

fn take_text<'a>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = u32::from_le_bytes(take(bytes)?) as usize;
    let (text, rest) = bytes.split_at_checked(length)?;
    *bytes = rest;
    Some(text)
}

fn take_number(bytes: &mut &[u8]) -> Option<f32> {
    take(bytes).map(f32::from_le_bytes)
}

fn take_drive(bytes: &mut &[u8]) -> Option<(Wheels<f32>, ServoAngle)> {
    let (left, right) = (take_number(bytes)?, take_number(bytes)?);
    Some((Wheels { left, right }, ServoAngle(take_number(bytes)?)))
}

fn take_act(bytes: &mut &[u8]) -> Option<Act> {
    Some(match take(bytes)? {
        [0] => Act::Advance(u32::from_le_bytes(take(bytes)?)),
        [1] => {
            let frame = take_text(bytes)?;
            let body = FrameBody::parse(frame.strip_suffix(&[0])?)?;
            match ToRobot::from_body(&body).ok()? {
                ToRobot::Command { command, .. } => Act::Command(command),
                _ => return None,
            }
        }
        [2] => {
            let (wheels, servo) = take_drive(bytes)?;
            Act::Drive(wheels, servo)
        }
        [3] => {
            let (wheels, servo) = take_drive(bytes)?;
            Act::Duty(wheels, servo)
        }
        [4] => Act::Instruct(String::from_utf8(take_text(bytes)?.to_vec()).ok()?),
        [5] => Act::Aim(Some(ServoAngle(take_number(bytes)?))),
        [6] => Act::Aim(None),
        [7] => Act::Record,
        [9] => {
            let [ticks] = take(bytes)?;
            Act::Advance(u32::from(ticks))
        }
        [10] => Act::Probe,
        [11] => {
            let text = take_text(bytes)?.to_vec();
            let [port] = take(bytes)?;
            Act::Type(port, text)
        }
        [12] => {
            let [pin] = take(bytes)?;
            let volts = f64::from_le_bytes(take(bytes)?);
            Act::Apply(pin, (!volts.is_nan()).then_some(volts))
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rumbo_control::mode::ModeId;

    #[test]
    fn acts_come_back_from_their_bytes_and_ticks_add_up() {
        let wheels = Wheels {
            left: 0.1,
            right: -7.0,
        };
        let acts = [
            Act::Command(Command::Mode(ModeId::WheelSpeed)),
            Act::Command(Command::WheelReference(wheels)),
            Act::Advance(50),
            Act::Drive(wheels, ServoAngle(0.3)),
            Act::Duty(wheels, ServoAngle(-0.3)),
            Act::Advance(70_000),
            Act::Instruct("goal_m = [1, 2]\n".to_owned()),
            Act::Aim(Some(ServoAngle(1.5))),
            Act::Aim(None),
            Act::Record,
            Act::Probe,
            Act::Type(4, b"F\n".to_vec()),
            Act::Apply(17, Some(2.5)),
            Act::Apply(2, None),
            Act::Advance(u32::MAX),
            Act::Advance(7),
        ];
        let mut history = History::default();
        for act in &acts {
            history.push(act);
        }
        let bytes = history.to_bytes();
        assert_eq!(History::acts(&bytes).unwrap(), acts);
        let mut summed = History::default();
        summed.push(&Act::Advance(10));
        summed.push(&Act::Advance(20));
        let again = History::acts(&summed.to_bytes()).unwrap();
        assert_eq!(again, [Act::Advance(30)]);
        for damaged in [&bytes[..bytes.len() - 1], &[77], &[1, 255, 0, 0, 0, 1]] {
            let said = History::acts(damaged).unwrap_err().to_string();
            assert!(said.contains("damaged"), "{said}");
        }
    }
}
