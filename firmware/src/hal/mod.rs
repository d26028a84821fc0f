//! The chip: everything that touches a register, and all the `unsafe` of the image.
//!
//! Interrupts and the main loop share nothing but atomics ([`core::sync::atomic`] bytes and words, which the compiler
//! reads and writes whole on this 8-bit machine), so a torn value cannot be written down. Timer 1 is the one clock: it
//! runs at 2 MHz and wraps after 32.768 ms; every stamp is younger than that when it is used.
//!
//! | resource | use |
//! |---|---|
//! | INT0, INT1 | encoders: a stamp into a ring ([`encoder`]) |
//! | INT2, INT3, INT5 | echoes: the stamps of rise and fall ([`sonar`]) |
//! | timer 1, 2 MHz | compare A: the tick; B: outputs, 3 ms later; C: end of the trigger pulse ([`clock`], [`outputs`]) |
//! | timer 2, 250 kHz | the servo's edges on OC2B ([`servo`]) |
//! | timers 3 and 4 | PWM of the right and the left motor ([`motors`]) |
//! | USART 2 | the link, two rings ([`link`]) |
//! | watchdog, EEPROM, sleep | [`power`], [`eeprom`] |

pub mod clock;
pub mod eeprom;
pub mod encoder;
pub mod link;
pub mod motors;
pub mod outputs;
pub mod power;
mod registers;
pub mod servo;
pub mod sonar;

/// Sets every peripheral up, outputs at rest; interrupts are still off.
pub fn start() {
    motors::start();
    sonar::start();
    servo::start();
    encoder::start();
    link::start();
    clock::start();
}

/// Interrupts on.
pub fn enable_interrupts() {
    // SAFETY: every interrupt that is enabled has its handler, and handlers share only atomics.
    unsafe { avr_device::interrupt::enable() }
}
