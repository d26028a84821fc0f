// @ts-check
/**
 * Signals beside the robot's telemetry, in columns for uPlot: ground truth and pins of an emulated robot, what the control
 * loops of our simulated one add up, and the numbers that a program prints, a table for each port. Which signals there are
 * is known when they arrive.
 *
 * A printed signal is named `serial0:speed`, so that two ports may print the same name.
 */
import { near } from './geometry.js';
import { Table } from './table.js';
import { CM_PER_M, DEG_PER_RAD, RPM_PER_RAD_S } from './units.js';

/** @typedef {import('./types.js').Cell} Cell */
/** @typedef {import('./types.js').Pose} Pose */
/** @typedef {import('./types.js').ReadingGroup} ReadingGroup */

/** What people see: by the unit at the end of a name. @type {[string, string, number][]} */
const SEEN = [['_rad_s', '_rpm', RPM_PER_RAD_S], ['_rad', '_deg', DEG_PER_RAD], ['_m', '_cm', CM_PER_M]];
/** Of what turns, but is no wheel. @type {[string, string, number]} */
const YAW = ['_rad_s', '_deg_s', DEG_PER_RAD];

/** A signal with the unit that people see. @param {string} name @returns {[string, number]} */
function seen(name) {
  const unit = /(^|_)(yaw|heading)(_.*)?_rad_s$/.test(name) ? YAW : SEEN.find(([suffix]) => name.endsWith(suffix));
  return unit && !/^true_[xy]_m$/.test(name) ? [name.slice(0, -unit[0].length) + unit[1], unit[2]] : [name, 1];
}

/** Time between two readings, at most [s]. */
const READ_S = 0.04;

/**
 * What is true now, for the map and the numbers.
 * @typedef {object} Truth
 * @property {number} t_s
 * @property {Pose} pose In the world.
 * @property {Cell[]} pinged_m What the sonars measured: left, right, front, and those with names of their own.
 * @property {number | null} servo_rad
 * @property {boolean} contact
 */

export class Readings {
  truth;
  /** What control loops add up. */
  loops;
  /** Where other robots are; not plotted. */
  others;
  /** By port. @type {Map<number, Table>} */
  #printed = new Map();
  #kept_s;
  /** The heading plotted last [deg]. */
  #heading_deg = 0;

  /** @param {number} kept_s how long lines are kept [s] */
  constructor(kept_s) {
    this.#kept_s = kept_s;
    this.truth = new Table([], kept_s);
    this.loops = new Table([], kept_s);
    this.others = new Table([], kept_s);
  }

  clear() {
    this.truth = new Table([], this.#kept_s);
    this.loops = new Table([], this.#kept_s);
    this.others = new Table([], this.#kept_s);
    this.#printed.clear();
    this.#heading_deg = 0;
  }

  get #tables() {
    return [this.truth, this.loops, ...this.#printed.values()];
  }

  /** Where another robot was at an instant, as far as it is known. @param {string} robot @param {number} t_s @returns {Pose | null} */
  placeOf(robot, t_s) {
    const { t, columns } = this.others;
    if (t_s < (t[0] ?? Infinity) - READ_S) return null;
    const at = Math.min(this.others.indexAt(t_s), t.length - 1);
    const [x_m, y_m, heading_deg] = ['x_m', 'y_m', 'heading_deg'].map((part) => columns.get(`${robot}_${part}`)?.[at]);
    return typeof x_m === 'number' && typeof y_m === 'number' && typeof heading_deg === 'number' ? { x_m, y_m, heading_rad: heading_deg / DEG_PER_RAD } : null;
  }

  /** The table that a signal is in. @param {string} name */
  tableOf(name) {
    return this.#tables.find((table) => table.columns.has(name));
  }

  /** The names of all signals. */
  names() {
    return this.#tables.flatMap((table) => [...table.columns.keys()]);
  }

  /** The signals that a port has printed. @param {number} usart */
  printedBy(usart) {
    return [...this.#printed.get(usart)?.columns.keys() ?? []];
  }

  /** Time of the newest line [s]. */
  get newest_s() {
    return Math.max(0, ...this.#tables.map(({ t }) => t.at(-1) ?? 0));
  }

  /**
   * Takes readings; returns what is true at the end of them, if they tell.
   * @param {ReadingGroup} group
   * @returns {Truth[]} One for each reading of ground truth.
   */
  push({ source, names, rows }) {
    if (typeof source === 'object') {
      const { usart } = source;
      const table = this.#printed.get(usart) ?? new Table([], this.#kept_s);
      this.#printed.set(usart, table);
      const signals = names.map((name) => `serial${usart}:${name}`);
      table.offer(signals);
      for (const [t_s, cells] of rows) table.push(t_s, Object.fromEntries(signals.map((name, index) => [name, number(cells[index])])));
      return [];
    }
    if (source === 'others') {
      this.others.offer(names);
      for (const [t_s, cells] of rows) this.others.push(t_s, Object.fromEntries(names.map((name, index) => [name, number(cells[index])])));
      return [];
    }
    const signals = names.map(seen);
    const others = names.filter((name) => /^pinged_(?!(left|right|front)_m$)\w+_m$/.test(name));
    this[source].offer(signals.map(([name]) => name));
    if (source === 'loops') {
      // A loop that is not at work is left out of a log: its curve ends.
      const idle = Object.fromEntries([...this.loops.columns.keys()].map((name) => [name, null]));
      for (const [t_s, cells] of rows) {
        const at_work = signals.map(([name, factor], index) => [name, times(number(cells[index]), factor)]);
        this.loops.push(t_s, { ...idle, ...Object.fromEntries(at_work) });
      }
      return [];
    }
    return rows.flatMap(([t_s, cells]) => {
      const cell = (/** @type {string} */ name) => cells[names.indexOf(name)] ?? null;
      const values = Object.fromEntries(signals.map(([name, factor], index) => [name, times(number(cells[index]), factor)]));
      const [x_m, y_m, heading_rad] = ['true_x_m', 'true_y_m', 'true_heading_rad'].map((name) => number(cell(name)));
      if (typeof x_m !== 'number' || typeof y_m !== 'number' || typeof heading_rad !== 'number') return [];
      const pose = { x_m, y_m, heading_rad };
      this.#heading_deg = near(heading_rad * DEG_PER_RAD, this.#heading_deg);
      this.truth.push(t_s, { ...values, true_heading_deg: this.#heading_deg });
      return [{ t_s, pose, pinged_m: ['pinged_left_m', 'pinged_right_m', 'pinged_front_m', ...others].map(cell), servo_rad: number(cell('true_servo_rad')), contact: cell('contact') === 1 }];
    });
  }
}

/** @param {Cell | undefined} cell */
const number = (cell) => (typeof cell === 'number' ? cell : null);

/** @param {number | null} value @param {number} factor */
const times = (value, factor) => (value === null ? null : value * factor);
