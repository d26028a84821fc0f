//! Reset cause, watchdog, sleep.

use super::registers::{cpu, get, put, watchdog};
use super::tick;
use rumbo_wire::ResetCause;

/// Change enable, reset mode, and a prescaler of 16 K cycles at 128 kHz: 125 ms.
const CHANGE: u8 = 0b0001_1000;
const ON: u8 = 0b0000_1011;

/// The reset cause; reading clears the flags.
pub fn reset_cause() -> ResetCause {
    let flags = get!(cpu().mcusr);
    put!(cpu().mcusr, 0);
    if flags & 1 << 3 != 0 {
        ResetCause::Watchdog
    } else if flags & 1 << 0 != 0 {
        // Power-on raises the brown-out flag too.
        ResetCause::PowerOn
    } else if flags & 1 << 2 != 0 {
        ResetCause::BrownOut
    } else {
        ResetCause::External
    }
}

/// Starts the watchdog: without [`feed_watchdog`] for 120 ms the chip is reset.
pub fn start_watchdog() {
    feed_watchdog();
    // The second write must follow the first within four cycles.
    put!(watchdog().wdtcsr, CHANGE);
    put!(watchdog().wdtcsr, ON);
}

/// Resets the watchdog.
#[inline(always)]
pub fn feed_watchdog() {
    avr_device::asm::wdr();
}

/// Sleeps until a tick other than the one numbered `tick`; interrupts are served meanwhile.
pub fn sleep_after(tick: u8) {
    // Idle mode, enabled.
    put!(cpu().smcr, 1);
    loop {
        avr_device::interrupt::disable();
        if tick::ticks() != tick {
            super::enable_interrupts();
            return;
        }
        // The instruction after SEI is executed before any interrupt: none can come between the check and the sleep.
        super::enable_interrupts();
        avr_device::asm::sleep();
    }
}
