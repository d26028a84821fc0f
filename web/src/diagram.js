// @ts-check
/** The control loop as blocks, with the values of the instant that is shown on the lines between them. */
import { create, setText } from './dom.js';
import { named, t } from './text.js';
import { format, pair } from './units.js';

/** @typedef {import('./store.js').Store} Store */

/** Values of the left and the right wheel. @param {string} left @param {string} right @param {string} unit */
const both = (left, right, unit) => (/** @type {(name: string) => number | null} */ at) => {
  const values = [at(left), at(right)].map((value) => (value === null ? '–' : format(value, 0)));
  return `${values.join(' | ')} ${unit}`;
};

/** @param {(name: string) => number | null} at */
function setpoint(at) {
  const [distance, x_m, y_m] = ['reference_cm', 'goal_x_m', 'goal_y_m'].map(at);
  if (typeof distance === 'number') return `${format(distance)} cm`;
  return typeof x_m === 'number' && typeof y_m === 'number' ? `${pair(format(x_m, 2), format(y_m, 2))} m` : '';
}

export class Diagram {
  body = create('div', { className: 'diagram row' });
  #store;
  #mode = create('span', { className: 'block' });
  /** What the lines carry. @type {{line: HTMLElement, words: (at: (name: string) => number | null) => string}[]} */
  #lines = [];

  /** @param {Store} store */
  constructor(store) {
    this.#store = store;
    const block = (/** @type {string} */ name) => create('span', { className: 'block', textContent: name });
    const line = (/** @type {string} */ title, /** @type {(at: (name: string) => number | null) => string} */ words) => {
      const made = create('span', { className: 'line', title });
      this.#lines.push({ line: made, words });
      return made;
    };
    this.body.append(
      line(t('setpoint'), setpoint), this.#mode, line(t('setpoints'), both('left_ref_rpm', 'right_ref_rpm', 'rpm')), block(t('speed loops')), line('PWM', both('left_pwm', 'right_pwm', 'PWM')),
      block(t('wheels')), line(t('ground truth, in the simulation'), both('true_left_rpm', 'true_right_rpm', 'rpm')), block(t('encoders')), line(t('left wheel, right wheel'), both('left_rpm', 'right_rpm', 'rpm')));
  }

  /** @param {string} name of the mode, as the core has it */
  setMode(name) {
    setText(this.#mode, named(name));
  }

  draw() {
    const store = this.#store;
    const at_s = Math.min(store.playhead_s, store.slow.t.at(-1) ?? 0);
    const at = (/** @type {string} */ name) => store.tableOf(name).at(name, at_s) ?? null;
    for (const { line, words } of this.#lines) setText(line, `${words(at)} →`);
  }
}
