// @ts-check
/**
 * Figures of the running step of the setpoint: rise, overshoot, settling, steady error, as the metrics of the scenarios
 * define them (docs/scenarios.md; `step.rs` of the metrics). Ground truth where it is known, else what the robot measures.
 */
import { create, element, setText } from './dom.js';
import { response, stage } from './response.js';
import { t } from './text.js';
import { format } from './units.js';

/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./store.js').Step} Step */
/** @typedef {import('./response.js').Signal} Signal */
/** @typedef {import('./response.js').Response} Response */

/** Share of a distance step that is its band. */
const DISTANCE_BAND = 0.05;
/** Band in which a wheel's speed counts as settled [rpm]. */
const SPEED_BAND_RPM = 3.2;

/** The figures of a step whose worse wheel counts. @param {Response[]} responses @returns {Response} */
function worst([first, second]) {
  const none = { rise_s: NaN, overshoot: NaN, settling_s: NaN, steady_error: NaN, moving: 0 };
  if (!first || !second) return first ?? none;
  const keys = /** @type {(keyof Response)[]} */ (Object.keys(none));
  return /** @type {Response} */ (Object.fromEntries(keys.map((key) => [key, Math.max(first[key], second[key])])));
}

/** Lines of a signal while a step lasts, gaps left out. @param {Store} store @param {string} name @param {Step} step @returns {Signal} */
function during(store, name, { from_s, until_s }) {
  const table = store.tableOf(name);
  const column = table.columns.get(name) ?? [];
  /** @type {Signal} */
  const made = { t: [], y: [] };
  for (let index = table.indexAt(from_s); index < table.t.length; index++) {
    const [t_s = 0, value] = [table.t[index], column[index]];
    if (t_s > until_s) break;
    if (typeof value === 'number') {
      made.t.push(t_s);
      made.y.push(value);
    }
  }
  return made;
}

/** The true signal, or the measured one of a real robot. @param {Store} store @param {string} name @param {Step} step */
function known(store, name, step) {
  const truth = during(store, `true_${name}`, step);
  return truth.y.length > 0 ? truth : during(store, name, step);
}

/** The distance that a step is of: by the front sonar, by a pair of the others, or by the one nearer to its wall. @param {Store} store @param {Step} step @returns {Signal} */
function distance(store, step) {
  const [left, right, front] = ['left', 'right', 'front'].map((sonar) => known(store, `range_${sonar}_cm`, step));
  const beside = [left, right].filter((each) => each && each.y.length > 0);
  const [one, other] = beside;
  if (step.ahead && front && front.y.length > 0) return front;
  if (!one || !other) return one ?? { t: [], y: [] };
  if (front && front.y.length > 0) return (one.y[0] ?? 0) < (other.y[0] ?? 0) ? one : other;
  return { t: one.t, y: one.y.map((value, index) => (value + (other.y[index] ?? value)) / 2) };
}

/** The way left to the goal [cm]. @param {Store} store @param {Step} step @returns {Signal} */
function wayLeft(store, step) {
  const [x, y] = [known(store, 'x_m', step), known(store, 'y_m', step)];
  const [goal_x, goal_y] = step.reference;
  return { t: x.t, y: x.y.map((x_m, index) => 100 * Math.hypot(goal_x - x_m, goal_y - (y.y[index] ?? 0))) };
}

/** How far from its setpoint a step has settled, as plotted. @param {Store} store @param {Step} step */
export function settlingBand(store, step) {
  if (step.kind === 'wheel_speed') return SPEED_BAND_RPM;
  const [start = step.reference[0]] = (step.kind === 'goal' ? wayLeft(store, step) : distance(store, step)).y;
  return DISTANCE_BAND * Math.abs(step.reference[0] - start);
}

/** The figures of a step so far, and their unit. @param {Store} store @param {Step} step */
export function figures(store, step) {
  const { from_s, reference: [left, right] } = step;
  const share = (/** @type {number} */ span) => DISTANCE_BAND * span;
  if (step.kind === 'wheel_speed') {
    const wheels = [['left_rpm', left], ['right_rpm', right]].map(([name, value]) => response(known(store, String(name), step), from_s, Number(value), () => SPEED_BAND_RPM));
    return { unit: 'rpm', ...worst(wheels) };
  }
  if (step.kind === 'goal') return { unit: 'cm', ...response(wayLeft(store, step), from_s, 0, share) };
  return { unit: 'cm', ...response(distance(store, step), from_s, left, share) };
}

/** Shows them. */
export class StepFigures {
  #list = element('step-figures', HTMLDListElement);
  #store;
  /** @type {Record<string, HTMLElement>} */
  #values = {};

  /** The first step of the run is over. */
  #onFirst;

  /** @param {Store} store @param {(shown: Record<string, string>) => void} onFirst the first step of the run is over, and its figures are these */
  constructor(store, onFirst) {
    this.#store = store;
    this.#onFirst = onFirst;
    const terms = { rise_s: t('rise'), overshoot: t('overshoot'), settling_s: t('settling'), steady_error: t('steady error') };
    const titles = { rise_s: t('From 10 % to 90 % of the step'), overshoot: t('Beyond the setpoint, in the direction of the step'), settling_s: t('Until it stays within 5 % of the step; for speeds, 3.2 rpm'), steady_error: t('Mean error of the last 40 % of the step') };
    for (const key of /** @type {(keyof typeof terms)[]} */ (Object.keys(terms))) {
      const value = create('dd', { textContent: '–' });
      this.#values[key] = value;
      this.#list.append(create('div', { title: titles[key] }, create('dt', { textContent: terms[key] }), value));
    }
  }

  /** @param {import('./types.js').ModeEntry | null} mode */
  show(mode) {
    // Where there are none their place stays, so that nothing moves when the mode changes.
    const none = !mode?.reference?.commanded || mode.reference.kind === 'speed' || mode.lane === true;
    this.#list.classList.toggle('none', none);
    if (none) return;
    const step = this.#store.step;
    const now = step && step.mode === mode.id ? figures(this.#store, step) : null;
    const at = now && step ? stage(now, step, Math.min(step.until_s, this.#store.newest_s)) : 'none';
    for (const [key, value] of Object.entries(this.#values)) {
      const figure = now?.[/** @type {keyof Response} */ (key)] ?? NaN;
      const is_time = key.endsWith('_s');
      const known = Number.isFinite(figure) && !(at === 'stopped' && ['settling_s', 'steady_error'].includes(key));
      const never = key === 'settling_s' && at !== 'none' ? t(at === 'stopped' ? 'stopped' : 'not settled') : '–';
      setText(value, at === 'running' ? '…' : known ? `${format(figure, is_time ? 2 : 1)} ${is_time ? 's' : now?.unit}` : never);
    }
    if (at !== 'running' && at !== 'none' && this.#store.steps.length === 1) this.#onFirst(Object.fromEntries(Object.entries(this.#values).map(([key, { textContent }]) => [key, textContent ?? ''])));
  }
}
