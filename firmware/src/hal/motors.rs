//! The L298N: two direction pins and a PWM for each motor, phase-correct, 8 bits, 490 Hz as on Arduino.

use super::registers::{change, port_e, port_g, port_h, put, timer_3, timer_4};
use crate::pins;
use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use rumbo_control::{Duty, Wheels};

const LEFT_DIRECTIONS: u8 = pins::LEFT_FORWARD.mask() | pins::LEFT_BACKWARD.mask();

/// A motor's enable input: `embedded-hal`'s view of the PWM.
macro_rules! enable {
    ($(#[$doc:meta])* $Name:ident, $timer:ident, $compare:ident) => {
        $(#[$doc])*
        struct $Name;

        impl ErrorType for $Name {
            type Error = Infallible;
        }

        impl SetDutyCycle for $Name {
            fn max_duty_cycle(&self) -> u16 {
                255
            }

            #[inline(always)]
            fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
                put!($timer().$compare, duty);
                Ok(())
            }
        }
    };
}

enable!(
    /// The left motor's, OC4A.
    LeftEnable, timer_4, ocr4a
);
enable!(
    /// The right motor's, OC3A.
    RightEnable, timer_3, ocr3a
);

/// The next state of the pins, ready to be written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Bridge {
    /// Bits of port H: the left motor's direction.
    pub(super) left: u8,
    /// Bits of ports E (backward) and G (forward): the right motor's direction.
    pub(super) right_e: u8,
    pub(super) right_g: u8,
    /// PWM, 0 to 255.
    pub(super) left_pwm: u8,
    pub(super) right_pwm: u8,
}

impl Bridge {
    /// Both inputs low release the bridge.
    pub(super) fn of(duty: Wheels<Duty>) -> Self {
        let (left, right) = (duty.left.counts(), duty.right.counts());
        let when = |condition: bool, pin: pins::Pin| if condition { pin.mask() } else { 0 };
        Self {
            left: when(left > 0, pins::LEFT_FORWARD) | when(left < 0, pins::LEFT_BACKWARD),
            right_e: when(right < 0, pins::RIGHT_BACKWARD),
            right_g: when(right > 0, pins::RIGHT_FORWARD),
            left_pwm: (left.unsigned_abs() & 0xFF) as u8,
            right_pwm: (right.unsigned_abs() & 0xFF) as u8,
        }
    }

    /// Writes the pins; for interrupt handlers.
    #[inline(always)]
    pub(super) fn write(self) {
        change!(port_h().porth, set self.left, clear LEFT_DIRECTIONS);
        change!(port_e().porte, set self.right_e, clear pins::RIGHT_BACKWARD.mask());
        change!(port_g().portg, set self.right_g, clear pins::RIGHT_FORWARD.mask());
        let Ok(()) = LeftEnable.set_duty_cycle(u16::from(self.left_pwm));
        let Ok(()) = RightEnable.set_duty_cycle(u16::from(self.right_pwm));
    }
}

/// Released, PWM running at zero.
pub(super) fn start() {
    change!(port_h().ddrh, set LEFT_DIRECTIONS | pins::LEFT_ENABLE.mask(), clear 0);
    change!(port_e().ddre, set pins::RIGHT_BACKWARD.mask() | pins::RIGHT_ENABLE.mask(), clear 0);
    change!(port_g().ddrg, set pins::RIGHT_FORWARD.mask(), clear 0);
    // Mode 1, clear on match counting up; clock / 64: 16 MHz / (64 * 510) = 490 Hz.
    put!(timer_3().tccr3a, 0b1000_0001);
    put!(timer_3().tccr3b, 0b011);
    put!(timer_4().tccr4a, 0b1000_0001);
    put!(timer_4().tccr4b, 0b011);
}
