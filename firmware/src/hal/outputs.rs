//! Outputs take effect exactly 3 ms after their tick: the loop leaves them here, compare B writes them.

use core::sync::atomic::{AtomicU8, AtomicU16, Ordering::Relaxed};

use super::motors::Bridge;
use super::{servo, sonar};
use rumbo_control::{Outputs, SonarId};

/// No ping.
const NONE: u8 = 0xFF;

static LEFT: AtomicU8 = AtomicU8::new(0);
static RIGHT_E: AtomicU8 = AtomicU8::new(0);
static RIGHT_G: AtomicU8 = AtomicU8::new(0);
static LEFT_PWM: AtomicU8 = AtomicU8::new(0);
static RIGHT_PWM: AtomicU8 = AtomicU8::new(0);
static SERVO: AtomicU16 = AtomicU16::new(servo::AHEAD_COUNTS);
static PING: AtomicU8 = AtomicU8::new(NONE);
/// The outputs of the last tick have had their time.
static DUE: AtomicU8 = AtomicU8::new(0);

/// Leaves outputs for compare B; if they are late, writes them now. Says whether they were in time.
pub fn leave(outputs: &Outputs) -> bool {
    let bridge = Bridge::of(outputs.drive);
    let servo = servo::counts(outputs.servo);
    let ping = outputs.ping.map_or(NONE, |sonar| sonar as u8);
    avr_device::interrupt::free(|_| {
        LEFT.store(bridge.left, Relaxed);
        RIGHT_E.store(bridge.right_e, Relaxed);
        RIGHT_G.store(bridge.right_g, Relaxed);
        LEFT_PWM.store(bridge.left_pwm, Relaxed);
        RIGHT_PWM.store(bridge.right_pwm, Relaxed);
        SERVO.store(servo, Relaxed);
        PING.store(ping, Relaxed);
        let in_time = DUE.load(Relaxed) == 0;
        if !in_time {
            apply();
        }
        in_time
    })
}

/// At the tick.
#[inline(always)]
pub(super) fn tick() {
    DUE.store(0, Relaxed);
}

/// Writes what was left.
pub(super) fn apply() {
    Bridge {
        left: LEFT.load(Relaxed),
        right_e: RIGHT_E.load(Relaxed),
        right_g: RIGHT_G.load(Relaxed),
        left_pwm: LEFT_PWM.load(Relaxed),
        right_pwm: RIGHT_PWM.load(Relaxed),
    }
    .write();
    servo::point(SERVO.load(Relaxed));
    match PING.load(Relaxed) {
        0 => sonar::trigger(SonarId::Left),
        1 => sonar::trigger(SonarId::Right),
        2 => sonar::trigger(SonarId::Front),
        _ => {}
    }
    PING.store(NONE, Relaxed);
    DUE.store(1, Relaxed);
}
