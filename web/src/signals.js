// @ts-check
/** The signals that can be plotted, each with its label, its unit and its colour. */

/** @typedef {import('./theme.js').ColourName} ColourName */
/** @typedef {'cm' | 'rpm' | 'of 255' | '°' | 'm'} Unit */

/**
 * @typedef {object} Signal
 * @property {string} name As in the store.
 * @property {string} label Short, beside its curve.
 * @property {string} about What it is, where signals are chosen.
 * @property {Unit} unit
 * @property {ColourName} colour
 * @property {'measured' | 'reference' | 'true'} kind
 */

/** The unit's first scale reaches over ten steps; values have so many decimals. @type {Record<Unit, {step: number, decimals: number}>} */
export const UNITS = {
  cm: { step: 10, decimals: 1 },
  rpm: { step: 20, decimals: 0 },
  'of 255': { step: 50, decimals: 0 },
  '°': { step: 30, decimals: 0 },
  m: { step: 0.5, decimals: 2 },
};

/** @type {Signal[]} */
export const SIGNALS = [
  { name: 'true_range_left_cm', label: 'true l.', about: 'true range, left sonar', unit: 'cm', colour: 'left', kind: 'true' },
  { name: 'true_range_right_cm', label: 'true r.', about: 'true range, right sonar', unit: 'cm', colour: 'right', kind: 'true' },
  { name: 'true_range_front_cm', label: 'true front', about: 'true range, front sonar', unit: 'cm', colour: 'front', kind: 'true' },
  { name: 'range_left_cm', label: 'left', about: 'range, left sonar', unit: 'cm', colour: 'left', kind: 'measured' },
  { name: 'range_right_cm', label: 'right', about: 'range, right sonar', unit: 'cm', colour: 'right', kind: 'measured' },
  { name: 'range_front_cm', label: 'front', about: 'range, front sonar', unit: 'cm', colour: 'front', kind: 'measured' },
  { name: 'reference_cm', label: 'setpoint', about: 'distance setpoint', unit: 'cm', colour: 'reference', kind: 'reference' },
  { name: 'range_difference_cm', label: 'left − right', about: 'range, left minus right sonar', unit: 'cm', colour: 'goal', kind: 'measured' },
  { name: 'true_left_rpm', label: 'true l.', about: 'true speed, left wheel', unit: 'rpm', colour: 'left', kind: 'true' },
  { name: 'true_right_rpm', label: 'true r.', about: 'true speed, right wheel', unit: 'rpm', colour: 'right', kind: 'true' },
  { name: 'left_rpm', label: 'left', about: 'speed, left wheel', unit: 'rpm', colour: 'left', kind: 'measured' },
  { name: 'right_rpm', label: 'right', about: 'speed, right wheel', unit: 'rpm', colour: 'right', kind: 'measured' },
  { name: 'left_ref_rpm', label: 'set l.', about: 'speed setpoint, left wheel', unit: 'rpm', colour: 'left', kind: 'reference' },
  { name: 'right_ref_rpm', label: 'set r.', about: 'speed setpoint, right wheel', unit: 'rpm', colour: 'right', kind: 'reference' },
  { name: 'left_error_rpm', label: 'error l.', about: 'error of the speed, left wheel', unit: 'rpm', colour: 'front', kind: 'measured' },
  { name: 'right_error_rpm', label: 'error r.', about: 'error of the speed, right wheel', unit: 'rpm', colour: 'goal', kind: 'measured' },
  { name: 'left_pwm', label: 'left', about: 'PWM, left wheel', unit: 'of 255', colour: 'left', kind: 'measured' },
  { name: 'right_pwm', label: 'right', about: 'PWM, right wheel', unit: 'of 255', colour: 'right', kind: 'measured' },
  { name: 'true_heading_deg', label: 'true', about: 'true heading', unit: '°', colour: 'front', kind: 'true' },
  { name: 'heading_deg', label: 'heading', about: 'estimated heading', unit: '°', colour: 'front', kind: 'measured' },
  { name: 'heading_ref_deg', label: 'setpoint', about: 'heading setpoint', unit: '°', colour: 'reference', kind: 'reference' },
  { name: 'heading_error_deg', label: 'error', about: 'error of the heading', unit: '°', colour: 'goal', kind: 'measured' },
  { name: 'servo_deg', label: 'servo', about: 'angle of the servo', unit: '°', colour: 'right', kind: 'measured' },
  { name: 'ghost_heading_deg', label: 'ghost', about: 'ghost heading', unit: '°', colour: 'goal', kind: 'true' },
  { name: 'ghost_x_m', label: 'ghost x', about: 'ghost position, x', unit: 'm', colour: 'goal', kind: 'true' },
  { name: 'ghost_y_m', label: 'ghost y', about: 'ghost position, y', unit: 'm', colour: 'front', kind: 'true' },
  { name: 'true_x_m', label: 'true x', about: 'true position, x', unit: 'm', colour: 'left', kind: 'true' },
  { name: 'true_y_m', label: 'true y', about: 'true position, y', unit: 'm', colour: 'right', kind: 'true' },
  { name: 'x_m', label: 'x', about: 'estimated position, x', unit: 'm', colour: 'left', kind: 'measured' },
  { name: 'y_m', label: 'y', about: 'estimated position, y', unit: 'm', colour: 'right', kind: 'measured' },
  { name: 'x_deviation_m', label: 'σ x', about: 'standard deviation of the estimated position, x', unit: 'm', colour: 'left', kind: 'measured' },
  { name: 'y_deviation_m', label: 'σ y', about: 'standard deviation of the estimated position, y', unit: 'm', colour: 'right', kind: 'measured' },
  { name: 'heading_deviation_deg', label: 'σ heading', about: 'standard deviation of the estimated heading', unit: '°', colour: 'front', kind: 'measured' },
  { name: 'goal_x_m', label: 'goal x', about: 'goal position, x', unit: 'm', colour: 'left', kind: 'reference' },
  { name: 'goal_y_m', label: 'goal y', about: 'goal position, y', unit: 'm', colour: 'right', kind: 'reference' },
];

/** The signal with this name. @param {string} name */
export function signal(name) {
  return SIGNALS.find((each) => each.name === name) ?? null;
}
