// @ts-check
/** What sensors and a buzzer of a robot file give, by their names there. */

/** @type {[RegExp, string, import('./signals.js').Unit][]} */
const SENSED = [
  [/^line_(\w+)$/, 'how dark it is below the line sensor {}', 'level'],
  [/^obstacle_(\w+)_cm$/, 'distance before the infrared sensor {}', 'cm'],
  [/^maxsonar_(\w+)_cm$/, 'range by the MaxSonar {}', 'cm'],
  [/^(\w+)_range_cm$/, 'range by light, {}', 'cm'],
  [/^light_(\w+)_lux$/, 'light on the sensor {}', 'lx'],
  [/^(\w+)_azimuth_deg$/, 'where the compass {} points, clockwise from north', '°'],
  [/^(\w+)_m_s2$/, 'by the inertial sensor: {}', 'm/s²'],
  [/^(\w+_yaw)_deg_s$/, 'by the inertial sensor: {}', '°/s'],
  [/^(\w+)_hz$/, 'tone of the buzzer {}', 'Hz'],
];

/**
 * The name of its own that a signal of one has, a sentence for it, and its unit; null if it is of none.
 * @param {string} signal
 * @returns {[string, string, import('./signals.js').Unit] | null}
 */
export function sensed(signal) {
  for (const [pattern, about, unit] of SENSED) {
    const name = signal.match(pattern)?.[1];
    if (name) return [name.replaceAll('_', ' '), about, unit];
  }
  return null;
}
