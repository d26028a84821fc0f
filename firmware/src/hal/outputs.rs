//! Outputs take effect exactly 3 ms after their tick: the loop stores them here, compare B writes them.

use super::motors::Bridge;
use super::registers::handler;
use super::shared::{Byte, CriticalSection, Word};
use super::{servo, sonar, tick};
use rumbo_control::Outputs;

static LEFT: Byte = Byte::new(0);
static RIGHT_E: Byte = Byte::new(0);
static RIGHT_G: Byte = Byte::new(0);
static LEFT_PWM: Byte = Byte::new(0);
static RIGHT_PWM: Byte = Byte::new(0);
static SERVO: Word = Word::new(servo::AHEAD_COUNTS);
/// The number of the last tick whose outputs were due.
static APPLIED: Byte = Byte::new(0);

/// Stores the outputs of tick number `tick` for compare B; if they are late, writes them now. Returns whether they were
/// in time.
pub fn leave(outputs: &Outputs, tick: u8) -> bool {
    let bridge = Bridge::of(outputs.drive);
    let servo = servo::counts(outputs.servo);
    avr_device::interrupt::free(|section| {
        LEFT.set(bridge.left);
        RIGHT_E.set(bridge.right_e);
        RIGHT_G.set(bridge.right_g);
        LEFT_PWM.set(bridge.left_pwm);
        RIGHT_PWM.set(bridge.right_pwm);
        SERVO.set(servo, section);
        sonar::ask(outputs.ping, section);
        let in_time = APPLIED.get() != tick && tick::ticks() == tick;
        if !in_time {
            apply(tick, section);
            sonar::trigger(section);
        }
        in_time
    })
}

/// Writes the stored outputs.
#[inline(always)]
fn apply(tick: u8, section: CriticalSection<'_>) {
    Bridge {
        left: LEFT.get(),
        right_e: RIGHT_E.get(),
        right_g: RIGHT_G.get(),
        left_pwm: LEFT_PWM.get(),
        right_pwm: RIGHT_PWM.get(),
    }
    .write();
    servo::point(SERVO.get(section), section);
    APPLIED.set(tick);
}

handler! { __vector_18, "TIMER1_COMPB", |section| {
    apply(tick::ticks(), section);
} }
