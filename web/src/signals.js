// @ts-check
/** The signals that can be plotted, each with its label, its unit and its colour. */

import { BadExpression, MARK, unitOfExpression } from './computed.js';
import { ROW } from './row.js';
import { sensed } from './sensed.js';
import { named, t } from './text.js';
import { CM_PER_M, DEG_PER_RAD, RPM_PER_RAD_S } from './units.js';

/** @typedef {import('./theme.js').ColourName} ColourName */
/** @typedef {'cm' | 'rpm' | 'of 255' | '°' | 'm' | '°/s' | 'm/s' | 'm/s²' | 'level' | 'edges' | 'µs' | 'lx' | 'Hz' | 'printed'} Unit */

/**
 * @typedef {object} Signal
 * @property {string} name As in the store.
 * @property {string} label Short, beside its curve.
 * @property {string} about What it is, where signals are chosen.
 * @property {Unit} unit
 * @property {ColourName} colour
 * @property {'measured' | 'reference' | 'true'} kind
 */

/** The unit's first scale reaches over ten steps; values have so many decimals. Steps of `free` units grow and shrink with the values. @type {Record<Unit, {step: number, decimals: number, free?: boolean}>} */
export const UNITS = {
  cm: { step: 10, decimals: 1 },
  rpm: { step: 20, decimals: 0 },
  'of 255': { step: 50, decimals: 0 },
  '°': { step: 30, decimals: 0 },
  m: { step: 0.5, decimals: 2 },
  '°/s': { step: 10, decimals: 1 },
  'm/s': { step: 0.05, decimals: 3 },
  'm/s²': { step: 1, decimals: 2, free: true },
  level: { step: 0.1, decimals: 2 },
  edges: { step: 10, decimals: 0, free: true },
  'µs': { step: 100, decimals: 0, free: true },
  lx: { step: 50, decimals: 0, free: true },
  Hz: { step: 100, decimals: 0, free: true },
  printed: { step: 1, decimals: 2, free: true },
};

/** What the factor from the unit of a frame is, where it is not 1. @type {Partial<Record<Unit, number>>} */
export const FACTORS = { cm: CM_PER_M, rpm: RPM_PER_RAD_S, '°': DEG_PER_RAD };

/** Those of a frame, what the page computes from them, and what an emulated robot's pins say. @type {Signal[]} */
export const SIGNALS = [
  ...ROW,
  { name: 'pinged_left_cm', label: 'left', about: 'range by the last echo, left sonar', unit: 'cm', colour: 'left', kind: 'measured' },
  { name: 'pinged_right_cm', label: 'right', about: 'range by the last echo, right sonar', unit: 'cm', colour: 'right', kind: 'measured' },
  { name: 'pinged_front_cm', label: 'front', about: 'range by the last echo, front sonar', unit: 'cm', colour: 'front', kind: 'measured' },
  { name: 'reference_cm', label: 'setpoint', about: 'distance setpoint', unit: 'cm', colour: 'reference', kind: 'reference' },
  { name: 'range_difference_cm', label: 'left − right', about: 'range, left minus right sonar', unit: 'cm', colour: 'goal', kind: 'measured' },
  { name: 'left_error_rpm', label: 'error l.', about: 'error of the speed, left wheel', unit: 'rpm', colour: 'front', kind: 'measured' },
  { name: 'right_error_rpm', label: 'error r.', about: 'error of the speed, right wheel', unit: 'rpm', colour: 'goal', kind: 'measured' },
  { name: 'true_left_pwm', label: 'true l.', about: 'PWM at the motor, left wheel', unit: 'of 255', colour: 'left', kind: 'true' },
  { name: 'true_right_pwm', label: 'true r.', about: 'PWM at the motor, right wheel', unit: 'of 255', colour: 'right', kind: 'true' },
  { name: 'heading_error_deg', label: 'error', about: 'error of the heading', unit: '°', colour: 'goal', kind: 'measured' },
  { name: 'servo_pulse_us', label: 'servo', about: 'last pulse to the servo', unit: 'µs', colour: 'right', kind: 'measured' },
  { name: 'left_edges', label: 'left', about: 'edges of the encoder so far, left wheel', unit: 'edges', colour: 'left', kind: 'measured' },
  { name: 'right_edges', label: 'right', about: 'edges of the encoder so far, right wheel', unit: 'edges', colour: 'right', kind: 'measured' },
  { name: 'goal_x_m', label: 'goal x', about: 'goal position, x', unit: 'm', colour: 'left', kind: 'reference' },
  { name: 'goal_y_m', label: 'goal y', about: 'goal position, y', unit: 'm', colour: 'right', kind: 'reference' },
];

/** What control loops add up: known of our own program where it is simulated, offered where it is known. @type {Signal[]} */
const LOOPS = [
  { name: 'left_p_pwm', label: 'P l.', about: 'speed loop, P, left wheel', unit: 'of 255', colour: 'reference', kind: 'measured' },
  { name: 'left_i_pwm', label: 'I l.', about: 'speed loop, I, left wheel', unit: 'of 255', colour: 'right', kind: 'measured' },
  { name: 'left_d_pwm', label: 'D l.', about: 'speed loop, D, left wheel', unit: 'of 255', colour: 'goal', kind: 'measured' },
  { name: 'left_feedforward_pwm', label: 'feedforward l.', about: 'speed loop, feedforward, left wheel', unit: 'of 255', colour: 'front', kind: 'measured' },
  { name: 'right_p_pwm', label: 'P r.', about: 'speed loop, P, right wheel', unit: 'of 255', colour: 'reference', kind: 'measured' },
  { name: 'right_i_pwm', label: 'I r.', about: 'speed loop, I, right wheel', unit: 'of 255', colour: 'left', kind: 'measured' },
  { name: 'right_d_pwm', label: 'D r.', about: 'speed loop, D, right wheel', unit: 'of 255', colour: 'goal', kind: 'measured' },
  { name: 'right_feedforward_pwm', label: 'feedforward r.', about: 'speed loop, feedforward, right wheel', unit: 'of 255', colour: 'front', kind: 'measured' },
  { name: 'left_ramp_rpm', label: 'ramp l.', about: 'speed loop, ramp, left wheel', unit: 'rpm', colour: 'left', kind: 'reference' },
  { name: 'right_ramp_rpm', label: 'ramp r.', about: 'speed loop, ramp, right wheel', unit: 'rpm', colour: 'right', kind: 'reference' },
  { name: 'forward_ref_m_s', label: 'set forward', about: 'setpoint of the forward speed', unit: 'm/s', colour: 'reference', kind: 'reference' },
  { name: 'yaw_ref_deg_s', label: 'set yaw', about: 'setpoint of the yaw rate', unit: '°/s', colour: 'reference', kind: 'reference' },
  { name: 'heading_p_deg_s', label: 'P', about: 'heading loop, P', unit: '°/s', colour: 'left', kind: 'measured' },
  { name: 'heading_d_deg_s', label: 'D', about: 'heading loop, D', unit: '°/s', colour: 'goal', kind: 'measured' },
  { name: 'distance_p_deg', label: 'P', about: 'distance loop, P', unit: '°', colour: 'left', kind: 'measured' },
  { name: 'distance_i_deg', label: 'I', about: 'distance loop, I', unit: '°', colour: 'right', kind: 'measured' },
  { name: 'network_left', label: 'network l.', about: 'output of the network, left wheel', unit: 'level', colour: 'left', kind: 'measured' },
  { name: 'network_right', label: 'network r.', about: 'output of the network, right wheel', unit: 'level', colour: 'right', kind: 'measured' },
  { name: 'network_servo', label: 'network servo', about: 'output of the network, servo', unit: 'level', colour: 'front', kind: 'measured' },
];

/** Colours of signals that a wiring or a program names, in turn. @type {ColourName[]} */
const COLOURS = ['left', 'right', 'front', 'goal', 'reference'];
/** Signals by their names, in the reader's language. @type {Map<string, Signal>} */
const met = new Map([...SIGNALS, ...LOOPS].map((each) => [each.name, { ...each, label: t(each.label), about: t(each.about) }]));

/** The signal of an expression. @param {string} name with its mark @returns {Signal} */
export function computed(name) {
  const unit = unitOfExpression(name, (each) => signal(each)?.unit ?? null);
  const label = name.slice(MARK.length).trim();
  return { name, label, about: label, unit, colour: COLOURS[met.size % COLOURS.length] ?? 'left', kind: 'measured' };
}

/** The same; null if it is none. @param {string} name */
function ifComputed(name) {
  try {
    const made = met.get(name) ?? computed(name);
    met.set(name, made);
    return made;
  } catch (error) {
    if (error instanceof BadExpression) return null;
    throw error;
  }
}

/** The signal with this name: one of those above, a pin's, a sensor's, a printed one, or an expression's. @param {string} name @returns {Signal | null} */
export function signal(name) {
  if (name.startsWith(MARK)) return ifComputed(name);
  const known = met.get(name);
  if (known) return known;
  const [, pin = null, port = null, printed = null, way = null, sonar = null] = name.match(/^(?:pin_(\w+)|serial(\d+):(.+)|(true_range|pinged)_(\w+)_cm)$/) ?? [];
  if (sonar !== null) return ranged(name, sonar.replaceAll('_', ' '), way === 'pinged');
  const sensor = sensed(name);
  const [label, about, unit] = pin !== null ? [named(pin), t('level of the pin {}', named(pin)), /** @type {Unit} */ ('level')]
    : sensor !== null ? [sensor[0], t(sensor[1], sensor[0]), sensor[2]]
      : [printed, `${portName(Number(port))}: ${printed}`, /** @type {Unit} */ ('printed')];
  if (label === null) return null;
  const colour = COLOURS[(met.size - SIGNALS.length - LOOPS.length) % COLOURS.length] ?? 'left';
  /** @type {Signal} */
  const made = { name, label, about, unit, colour, kind: 'measured' };
  met.set(name, made);
  return made;
}

/** The range of a sonar with a name of its own. @param {string} name @param {string} sonar @param {boolean} pinged @returns {Signal} */
function ranged(name, sonar, pinged) {
  const about = pinged ? t('range by the last echo, sonar {}', sonar) : t('true range, sonar {}', sonar);
  const colour = COLOURS[[...sonar].reduce((sum, each) => sum + each.charCodeAt(0), 0) % COLOURS.length] ?? 'goal';
  /** @type {Signal} */
  const made = { name, label: pinged ? sonar : t('true {}', sonar), about, unit: 'cm', colour, kind: pinged ? 'measured' : 'true' };
  met.set(name, made);
  return made;
}

/** A port as the student's program calls it. @param {number} usart */
export const portName = (usart) => (usart === LINK ? 'link' : usart === 0 ? 'Serial (USB)' : usart === ON_PINS ? 'Bluetooth' : `Serial${usart}`);

/** In place of a USART: the Bluetooth module on other pins. */
const ON_PINS = 4;

/** In place of a USART: the link to a robot with the text protocol. */
export const LINK = 255;
