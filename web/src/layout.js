// @ts-check
/**
 * Layouts: the plots, their signals, the limits of their axes, and the window of time. One for each mode, which starts from
 * its description and is stored by the browser when changed; and others by name. A layout is also a file.
 */
import { signal } from './signals.js';
import { keep, recall } from './stored.js';
import { t } from './text.js';

/**
 * One plot. Its signals have one unit, or two: those of the second have the axis on the right. `min` and `max` are the limits of the axis on
 * the left if it is locked, `right` those of the other; null: automatic.
 * @typedef {{title: string, signals: string[], min: number | null, max: number | null, right?: [number, number] | null, weight: number}} PlotSpec
 *
 * @typedef {{window_s: number, plots: PlotSpec[]}} Layout
 */

/** Longest and shortest window of time [s]. */
export const LONGEST_S = 600;
export const SHORTEST_S = 0.2;
const WINDOW_S = 20;
const MOST_PLOTS = 12;
const VERSION = 1;

/** @param {string} title @param {number} weight @param {string[]} signals @returns {PlotSpec} */
const plot = (title, weight, signals) => ({ title, signals, min: null, max: null, weight });

/** The default plots of modes. */
export const PLOTS = [
  plot('distance', 5, ['ghost_range_left_cm', 'ghost_range_right_cm', 'ghost_range_front_cm', 'true_range_left_cm', 'true_range_right_cm', 'true_range_front_cm', 'range_left_cm', 'range_right_cm', 'range_front_cm', 'reference_cm']),
  plot('wheels', 5, ['ghost_left_rpm', 'ghost_right_rpm', 'true_left_rpm', 'true_right_rpm', 'left_rpm', 'right_rpm', 'left_ref_rpm', 'right_ref_rpm']),
  plot('PWM', 3, ['left_pwm', 'right_pwm']),
  plot('heading', 4, ['ghost_heading_deg', 'true_heading_deg', 'heading_deg', 'heading_ref_deg']),
  plot('position', 4, ['ghost_x_m', 'ghost_y_m', 'true_x_m', 'true_y_m', 'x_m', 'y_m', 'goal_x_m', 'goal_y_m']),
];

/** The terms of control loops, where they are known. */
export const LOOP_PLOTS = [
  plot('left loop', 4, ['left_p_pwm', 'left_i_pwm', 'left_d_pwm', 'left_feedforward_pwm', 'left_pwm']),
  plot('right loop', 4, ['right_p_pwm', 'right_i_pwm', 'right_d_pwm', 'right_feedforward_pwm', 'right_pwm']),
  plot('steering', 4, ['heading_p_deg_s', 'heading_d_deg_s', 'yaw_ref_deg_s', 'distance_p_deg', 'distance_i_deg']),
];

/** In place of a mode's number: a program that does not say which mode it is in, as most people's own. */
export const OWN_PROGRAM = -2;
/** Sonars with usual names: those that a robot has not, have nothing to show. */
const SONARS = ['left', 'right', 'front', 'rear', 'back', 'front_left', 'front_right', 'rear_left', 'rear_right', 'back_left', 'back_right'];
/** What can be plotted of any program. */
export const OWN_PLOTS = [
  plot('wheels', 4, ['true_left_rpm', 'true_right_rpm']),
  plot('PWM', 3, ['true_left_pwm', 'true_right_pwm']),
  plot('sonars', 4, ['true_range', 'pinged'].flatMap((way) => SONARS.map((sonar) => `${way}_${sonar}_cm`))),
  plot('heading', 4, ['true_heading_deg']),
  plot('position', 4, ['true_x_m', 'true_y_m']),
];
/** Titles of those that it begins with. */
const OWN_TITLES = ['wheels', 'PWM', 'sonars'];

/** A mode's default layout: the plots of these titles, the first of which matters most. @param {string[]} titles @param {PlotSpec[]} plots @returns {Layout} */
function initial(titles, plots) {
  const chosen = titles.flatMap((title) => plots.filter((each) => each.title === title));
  return { window_s: WINDOW_S, plots: chosen.map((each, index) => ({ ...each, weight: index === 0 ? 2 * each.weight : each.weight })) };
}

/** The units of signals, in the order in which they come. @param {string[]} signals */
export function unitsOf(signals) {
  return [...new Set(signals.flatMap((name) => signal(name)?.unit ?? []))];
}

/** How many units a plot may have: one for each of its axes. */
export const MOST_UNITS = 2;

/** Why something is not a layout. */
export class BadLayout extends Error {}

/** @param {boolean} right @param {string} why */
function check(right, why) {
  if (!right) throw new BadLayout(why);
}

/** @param {unknown} value @returns {value is number} */
const isNumber = (value) => typeof value === 'number' && Number.isFinite(value);

/** @param {unknown} low @param {unknown} high */
const isSpan = (low, high) => isNumber(low) && isNumber(high) && low < high;

/**
 * A layout from the content of a file or the browser's storage.
 * @param {any} from
 * @returns {Layout}
 */
export function checked(from) {
  check(from !== null && typeof from === 'object' && Array.isArray(from.plots), t('it is no layout of Rumbo'));
  check(from.version === undefined || from.version === VERSION, t('its version is {}, this page knows {}', String(from.version), VERSION));
  check(isNumber(from.window_s) && from.window_s >= SHORTEST_S && from.window_s <= LONGEST_S, t('window_s must be {} to {} s', SHORTEST_S, LONGEST_S));
  check(from.plots.length <= MOST_PLOTS, t('there are {} plots, {} at most', from.plots.length, MOST_PLOTS));
  return { window_s: from.window_s, plots: from.plots.map(checkedPlot) };
}

/** @param {any} from @param {number} index @returns {PlotSpec} */
function checkedPlot(from, index) {
  const here = t('plot {}', index + 1);
  check(from !== null && typeof from === 'object' && typeof from.title === 'string' && from.title.length <= 60, t('{} has no title', here));
  check(Array.isArray(from.signals) && from.signals.length > 0, t('{} has no signals', here));
  for (const name of from.signals) check(typeof name === 'string' && signal(name) !== null, t('{} has a signal that is none: {}', here, String(name)));
  const units = unitsOf(from.signals);
  check(units.length <= MOST_UNITS, t('the signals of {} have more than two units: {}', here, units.join(', ')));
  const { min = null, max = null, right = null, weight = 4 } = from;
  check((min === null && max === null) || isSpan(min, max), t('the limits of {} are not two numbers, min below max', here));
  check(right === null || (Array.isArray(right) && right.length === 2 && isSpan(right[0], right[1])), t('the limits of {} are not two numbers, min below max', here));
  check(isNumber(weight) && weight >= 1 && weight <= 20, t('the weight of {} must be {} to {}', here, 1, 20));
  return { title: from.title, signals: [...new Set(/** @type {string[]} */ (from.signals))], min, max, ...(right ? { right } : {}), weight };
}

/** A file's text. @param {Layout} layout */
export function toText(layout) {
  return `${JSON.stringify({ rumbo: 'layout', version: VERSION, ...layout }, null, 2)}\n`;
}

/** @param {string} text @returns {Layout} */
export function fromText(text) {
  let from;
  try {
    from = JSON.parse(text);
  } catch {
    throw new BadLayout(t('it is no JSON'));
  }
  check(from?.rumbo === 'layout', t('it is no layout of Rumbo'));
  return checked(from);
}

/** The stored layouts: the latest one of each mode, and the named ones. */
export class Shelf {
  /** @type {Record<string, Layout>} */
  #modes = {};
  /** @type {Record<string, Layout>} */
  #named = {};
  /** The modes with their defaults. @type {import('./types.js').ModeEntry[]} */
  modes = [];

  constructor() {
    try {
      const kept = JSON.parse(recall('layouts') ?? '{}');
      this.#modes = sound(kept.modes);
      this.#named = sound(kept.named);
    } catch {
      // Nothing is stored, or nothing readable: the defaults apply.
    }
  }

  get names() {
    return Object.keys(this.#named).sort((a, b) => a.localeCompare(b));
  }

  /** @param {number} mode */
  ofMode(mode) {
    const own = mode === OWN_PROGRAM ? initial(OWN_TITLES, OWN_PLOTS) : initial(this.modes.find(({ id }) => id === mode)?.plots ?? [], PLOTS);
    return this.#modes[mode] ?? own;
  }

  /** @param {string} name */
  named(name) {
    return this.#named[name] ?? null;
  }

  /** @param {number} mode @param {Layout | null} layout Null: the default. */
  keep(mode, layout) {
    if (layout) this.#modes[mode] = layout;
    else delete this.#modes[mode];
    this.#store();
  }

  /** @param {string} name @param {Layout | null} layout Null: no longer. */
  name(name, layout) {
    if (layout) this.#named[name] = layout;
    else delete this.#named[name];
    this.#store();
  }

  #store() {
    keep('layouts', JSON.stringify({ version: VERSION, modes: this.#modes, named: this.#named }));
  }
}

/** Those that are layouts. @param {any} kept @returns {Record<string, Layout>} */
function sound(kept) {
  return Object.fromEntries(Object.entries(kept ?? {}).flatMap(([name, layout]) => {
    try {
      return [[name, checked(layout)]];
    } catch {
      return [];
    }
  }));
}
