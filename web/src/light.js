// @ts-check
/** What a light, a buzzer or a sensor at the robot's pins shows. */

/** What is a sensor: what it measures, in words. @type {Partial<Record<import('./types.js').Part['kind'], (shown: (signal: string, digits: number) => string) => string>>} */
const SENSORS = { mpu6050: inertial, vl53l0x: (shown) => `${shown('range_cm', 1)} cm`, qmc5883l: bearing, hmc5883l: bearing };

/** Whether a kind of part is a sensor. @param {import('./types.js').Part['kind']} kind */
export const isSensor = (kind) => kind in SENSORS;

/** The words for what a part shows. @param {import('./types.js').Part} part @param {(signal: string) => number | null} now @returns {[string, number]} */
export function shownOf({ name, kind }, now) {
  const sensor = SENSORS[kind];
  if (sensor) return [sensor((signal, digits) => number(now(`${name}_${signal}`), digits)), 0];
  const level = now(`pin_${name}_${kind}`) ?? 0;
  if (kind !== 'buzzer') return [`${Math.round(100 * level)} %`, level];
  const hz = now(`${name}_hz`) ?? 0;
  return hz > 0 ? [`${Math.round(hz)} Hz`, 1] : [`${Math.round(100 * level)} %`, level];
}

/** @param {number | null} value @param {number} digits */
const number = (value, digits) => (value === null || !Number.isFinite(value) ? '–' : value.toFixed(digits));

/** What an inertial sensor measures. @param {(signal: string, digits: number) => string} shown */
function inertial(shown) {
  const [forward, left, up] = ['forward_m_s2', 'left_m_s2', 'up_m_s2'].map((signal) => shown(signal, 2));
  return `${forward} ${left} ${up} m/s², ${shown('yaw_deg_s', 1)} °/s`;
}

/** Where a compass points. @param {(signal: string, digits: number) => string} shown */
function bearing(shown) {
  return `${shown('azimuth_deg', 0)}°`;
}
