// @ts-check
/** What can be plotted, and which plots a mode begins with. */

/** @typedef {import('./theme.js').ColourName} ColourName */

/**
 * @typedef {object} Curve
 * @property {string} name As in the store.
 * @property {string} label
 * @property {ColourName} colour
 * @property {'measured' | 'reference' | 'true'} kind
 */

/** @typedef {{title: string, unit: string, table: 'slow' | 'fast', step: number, decimals: number, weight: number, curves: Curve[] }} PlotSpec */

/** @type {PlotSpec[]} */
export const PLOTS = [
  {
    title: 'distance', unit: 'cm', table: 'slow', step: 10, decimals: 1, weight: 5,
    curves: [
      { name: 'true_range_left_cm', label: 'true l.', colour: 'left', kind: 'true' },
      { name: 'true_range_right_cm', label: 'true r.', colour: 'right', kind: 'true' },
      { name: 'true_range_front_cm', label: 'true front', colour: 'front', kind: 'true' },
      { name: 'range_left_cm', label: 'left', colour: 'left', kind: 'measured' },
      { name: 'range_right_cm', label: 'right', colour: 'right', kind: 'measured' },
      { name: 'range_front_cm', label: 'front', colour: 'front', kind: 'measured' },
      { name: 'reference_cm', label: 'reference', colour: 'reference', kind: 'reference' },
    ],
  },
  {
    title: 'wheels', unit: 'rpm', table: 'fast', step: 20, decimals: 0, weight: 5,
    curves: [
      { name: 'true_left_rpm', label: 'true l.', colour: 'left', kind: 'true' },
      { name: 'true_right_rpm', label: 'true r.', colour: 'right', kind: 'true' },
      { name: 'left_rpm', label: 'left', colour: 'left', kind: 'measured' },
      { name: 'right_rpm', label: 'right', colour: 'right', kind: 'measured' },
      { name: 'left_ref_rpm', label: 'ref. l.', colour: 'left', kind: 'reference' },
      { name: 'right_ref_rpm', label: 'ref. r.', colour: 'right', kind: 'reference' },
    ],
  },
  {
    title: 'PWM', unit: 'of 255', table: 'slow', step: 50, decimals: 0, weight: 3,
    curves: [
      { name: 'left_pwm', label: 'left', colour: 'left', kind: 'measured' },
      { name: 'right_pwm', label: 'right', colour: 'right', kind: 'measured' },
    ],
  },
  {
    title: 'heading', unit: '°', table: 'slow', step: 30, decimals: 0, weight: 4,
    curves: [
      { name: 'true_heading_deg', label: 'true', colour: 'front', kind: 'true' },
      { name: 'heading_deg', label: 'heading', colour: 'front', kind: 'measured' },
      { name: 'heading_ref_deg', label: 'reference', colour: 'reference', kind: 'reference' },
    ],
  },
  {
    title: 'place', unit: 'm', table: 'slow', step: 0.5, decimals: 2, weight: 4,
    curves: [
      { name: 'true_x_m', label: 'true x', colour: 'left', kind: 'true' },
      { name: 'true_y_m', label: 'true y', colour: 'right', kind: 'true' },
      { name: 'x_m', label: 'x', colour: 'left', kind: 'measured' },
      { name: 'y_m', label: 'y', colour: 'right', kind: 'measured' },
      { name: 'goal_x_m', label: 'goal x', colour: 'left', kind: 'reference' },
      { name: 'goal_y_m', label: 'goal y', colour: 'right', kind: 'reference' },
    ],
  },
];

/** The plots that a mode begins with, by its number. @type {string[][]} */
export const OF_MODE = [
  ['wheels', 'PWM', 'heading'],
  ['distance', 'wheels', 'PWM'],
  ['distance', 'heading', 'wheels'],
  ['distance', 'heading', 'wheels'],
  ['distance', 'heading', 'wheels'],
  ['wheels', 'PWM'],
  ['wheels', 'heading', 'place'],
  ['place', 'heading', 'wheels'],
  ['place', 'heading', 'distance', 'wheels'],
];
