//! The chip with our image and nothing connected but a station at the other end of its link.

use rumbo_control::params::ParamId;
use rumbo_emulator::chip::Chip;
use rumbo_emulator::devices::ports::Pin;
use rumbo_emulator::devices::{Event, Input};
use rumbo_emulator::image::Image;
use rumbo_wire::{Command, Decoder, FrameMessage, FromRobot, Received, RobotTime, ToRobot};

/// Cycles of a millisecond.
pub(crate) const MS: u64 = 16_000;
const LINK: u8 = 2;

/// A station connected to the chip.
#[derive(Clone)]
pub(crate) struct Talk {
    pub(crate) chip: Chip,
    pub(crate) received: Vec<FromRobot>,
    decoder: Decoder<128>,
    number: u16,
    /// The newest robot time received.
    seen: Option<RobotTime>,
}

impl Talk {
    /// A chip just switched on, whose EEPROM holds this.
    pub(crate) fn new(image: &Image, eeprom: &[u8]) -> Talk {
        let mut chip = Chip::new(image);
        // The module's line idles high.
        chip.input(0, Input::Pin(Pin::new('H', 0).unwrap(), Some(true)));
        chip.devices_mut().eeprom_mut()[..eeprom.len()].copy_from_slice(eeprom);
        Talk {
            chip,
            received: Vec::new(),
            decoder: Decoder::default(),
            number: 0,
            seen: None,
        }
    }

    /// Runs it for this time.
    pub(crate) fn run_ms(&mut self, ms: u64) {
        self.chip.run_until(self.chip.cycle() + ms * MS);
        for output in self.chip.take_outputs() {
            let Event::Byte {
                usart: LINK, byte, ..
            } = output.event
            else {
                continue;
            };
            if let Some(Received::Frame(body)) = self.decoder.push(byte as u8) {
                let message = FromRobot::from_body(&body).unwrap();
                self.seen = RobotTime::after(self.seen, &message);
                self.received.push(message);
            }
        }
    }

    /// Sends bytes at the rate of the line.
    pub(crate) fn send_bytes(&mut self, bytes: &[u8]) {
        for byte in bytes {
            let (usart, byte, baud) = (LINK, *byte, 9_600);
            self.chip
                .input(self.chip.cycle(), Input::Serial { usart, byte, baud });
        }
    }

    pub(crate) fn send(&mut self, message: ToRobot) {
        self.send_bytes(message.frame(0).bytes());
    }

    /// Sends a command and returns its answer.
    pub(crate) fn command(&mut self, command: Command) -> f32 {
        self.number += 1;
        let number = self.number;
        self.send(ToRobot::Command {
            session: 7,
            number,
            command,
            seen: self.seen.unwrap_or_default(),
        });
        for _ in 0..40 {
            self.run_ms(10);
            let answer = self.received.iter().find_map(|message| match message {
                FromRobot::Ack(ack) if ack.number == number => Some(ack.result),
                _ => None,
            });
            if let Some(result) = answer {
                return result.unwrap();
            }
        }
        panic!("{command:?} is not answered");
    }

    pub(crate) fn set(&mut self, id: ParamId, value: f32) {
        assert_eq!(
            self.command(Command::SetParam {
                id: id as u8,
                value
            }),
            value
        );
    }

    pub(crate) fn get(&mut self, id: ParamId) -> f32 {
        self.command(Command::GetParam { id: id as u8 })
    }

    pub(crate) fn eeprom(&self) -> Vec<u8> {
        self.chip.devices().eeprom().to_vec()
    }
}
