// @ts-check
/** What a light, a buzzer or an inertial sensor at the robot's pins shows. */

/** The words for what a part shows. @param {import('./types.js').Part} part @param {(signal: string) => number | null} now @returns {[string, number]} */
export function shownOf({ name, kind }, now) {
  if (kind === 'mpu6050') return [inertial(name, now), 0];
  const level = now(`pin_${name}_${kind}`) ?? 0;
  if (kind !== 'buzzer') return [`${Math.round(100 * level)} %`, level];
  const hz = now(`${name}_hz`) ?? 0;
  return hz > 0 ? [`${Math.round(hz)} Hz`, 1] : [`${Math.round(100 * level)} %`, level];
}

/** What an inertial sensor measures. @param {string} name @param {(signal: string) => number | null} now */
function inertial(name, now) {
  const shown = (/** @type {string} */ signal, /** @type {number} */ digits) => {
    const value = now(`${name}_${signal}`);
    return value === null || Number.isNaN(value) ? '–' : value.toFixed(digits);
  };
  const [forward, left, up] = ['forward_m_s2', 'left_m_s2', 'up_m_s2'].map((signal) => shown(signal, 2));
  return `${forward} ${left} ${up} m/s², ${shown('yaw_deg_s', 1)} °/s`;
}
