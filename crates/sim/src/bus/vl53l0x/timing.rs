//! How long a measurement takes: the sum that ST's and Pololu's libraries call the timing budget, of the steps that are on.

/// Timeout of the first three steps, less one; each period of the laser is followed by the timeout of its step.
pub(super) const EARLY_STEPS: u8 = 0x46;
pub(super) const PRE_PERIOD: u8 = 0x50;
pub(super) const FINAL_PERIOD: u8 = 0x70;
const TARGET_CHECK: u8 = 1 << 4;
const DIODE_CHOICE: u8 = 1 << 3;
const SIGNAL_CHECK: u8 = 1 << 2;
const PRE_RANGE: u8 = 1 << 6;
const FINAL_RANGE: u8 = 1 << 7;
/// Start and end, and what each step takes beside its timeout \[us\].
const ENDS_US: f64 = 1_910.0 + 960.0;
const TARGET_CHECK_US: f64 = 590.0;
const DIODE_CHOICE_US: f64 = 690.0;
const SIGNAL_CHECK_US: f64 = 660.0;
const PRE_RANGE_US: f64 = 660.0;
const FINAL_RANGE_US: f64 = 550.0;

/// Duration by the registers of page 0 \[us\].
pub(super) fn duration_us(registers: &[u8; 256]) -> f64 {
    let at = |register: u8| registers[usize::from(register)];
    let has = |step: u8| at(super::SEQUENCE) & step != 0;
    // 2304 periods of so many clocks, of 1.655 ns.
    let unit_us = |period: u8| 2_304.0 * 2.0 * (f64::from(at(period)) + 1.0) * 1.655e-3;
    let timeout = |period: u8| {
        let (high, low) = (at(period + 1), at(period + 2));
        (u32::from(low) << (high & 15)) + 1
    };
    let early_us = (f64::from(at(EARLY_STEPS)) + 1.0) * unit_us(PRE_PERIOD);
    let pre = timeout(PRE_PERIOD);
    let mut sum_us = ENDS_US;
    if has(TARGET_CHECK) {
        sum_us += early_us + TARGET_CHECK_US;
    }
    if has(DIODE_CHOICE) {
        sum_us += 2.0 * (early_us + DIODE_CHOICE_US);
    } else if has(SIGNAL_CHECK) {
        sum_us += early_us + SIGNAL_CHECK_US;
    }
    if has(PRE_RANGE) {
        sum_us += f64::from(pre) * unit_us(PRE_PERIOD) + PRE_RANGE_US;
    }
    if has(FINAL_RANGE) {
        // That of the last step counts from the begin of the one before.
        let before = if has(PRE_RANGE) { pre } else { 0 };
        let own = timeout(FINAL_PERIOD).saturating_sub(before);
        sum_us += f64::from(own) * unit_us(FINAL_PERIOD) + FINAL_RANGE_US;
    }
    sum_us
}
