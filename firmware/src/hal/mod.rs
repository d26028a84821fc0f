//! The chip: everything that touches a register, and all the `unsafe` of the image.
//!
//! Interrupts and the main loop share only bytes, and words that are accessed atomically ([`shared`]). Timer 1 is the
//! only clock: it runs at 2 MHz and wraps after 32.768 ms; every stamp is younger than that when it is used.
//!
//! | resource | use |
//! |---|---|
//! | INT0, INT1 | encoders: a stamp into a ring ([`encoder`]) |
//! | INT2, INT3, INT5 | echoes: the stamps of rise and fall ([`sonar`]) |
//! | timer 1, 2 MHz | compare A: the tick; B: outputs, 3 ms later; C: end of the trigger pulse ([`clock`], [`tick`], [`outputs`], [`sonar`]) |
//! | timer 2, 250 kHz | the servo's edges on OC2B ([`servo`]) |
//! | timers 3 and 4 | PWM of the right and the left motor ([`motors`]) |
//! | USART 2 | the link, two rings ([`link`]) |
//! | converter | the battery's voltage, where a divider is wired ([`adc`]) |
//! | EEPROM | saved parameters ([`eeprom`]) |
//! | flash from 160 KB on | the network of mode 9 ([`network`]) |
//! | watchdog, sleep | [`power`] |
//!
//! [`record`] exposes the loop's inputs and outputs to tests.

pub mod adc;
mod clock;
pub mod eeprom;
pub mod encoder;
pub mod link;
pub mod motors;
pub mod network;
pub mod outputs;
pub mod power;
pub mod record;
mod registers;
pub mod servo;
mod shared;
pub mod sonar;
pub mod tick;

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
    // SAFETY: every enabled interrupt has its handler, and handlers share only bytes and atomically accessed words.
    unsafe { avr_device::interrupt::enable() }
}

/// Hash of the image, written into the file by `cargo xtask firmware`; 0 where that has not been done.
// SAFETY: the name is used once.
#[used]
#[unsafe(no_mangle)]
static RUMBO_IMAGE_HASH: u32 = 0;

/// What was written there.
pub fn image_hash() -> u32 {
    // SAFETY: a valid, aligned word that is never written; volatile, since the compiler would assume 0.
    unsafe { core::ptr::read_volatile(&raw const RUMBO_IMAGE_HASH) }
}
