// @ts-check
/**
 * The signals received, in columns for uPlot: a slow table with a line for each telemetry frame, and a fast one for the
 * wheel speeds, of which a frame carries two samples.
 *
 * A replay has what is before and after its playhead: plots show all of it, the map and the numbers only what has been.
 *
 * Positions are in metres in the frame of the world, as on the map, also after the robot has moved its origin; headings
 * continue through 180 degrees up to 315.
 */
import { Computed, MARK } from './computed.js';
import { IDENTITY, compose, near, place, wrapped } from './geometry.js';
import { Readings } from './readings.js';
import { ROW } from './row.js';
import { FACTORS } from './signals.js';
import { Table } from './table.js';
import { CM_PER_M, DEG_PER_RAD, RPM_PER_RAD_S } from './units.js';

/** @typedef {import('./types.js').Cell} Cell */
/** @typedef {import('./table.js').Column} Column */

/** Time kept [s], as long as the server's. */
const KEPT_S = 600;
/** A frame's first wheel speeds are this much older [s]. */
const EARLIER_S = 0.02;

/** @param {Cell | undefined} cell */
const number = (cell) => (typeof cell === 'number' ? cell : null);

/**
 * @param {Cell | undefined} cell
 * @param {number} factor
 */
function scaled(cell, factor) {
  return typeof cell === 'number' ? cell * factor : null;
}

/** @param {number | null} a @param {number | null} b */
function less(a, b) {
  return a === null || b === null ? null : a - b;
}

/** Signals of a frame that are plotted as seen from where the run began. */
const PLACED = /^(true_|ghost_)?(x_m|y_m|heading_rad|heading_ref_rad)$/;
const SPEEDS = ROW.filter(({ unit }) => unit === 'rpm');
const OTHERS = ROW.filter(({ unit, column }) => unit !== 'rpm' && !PLACED.test(column));
const SLOW = [...ROW.filter(({ unit }) => unit !== 'rpm').map(({ name }) => name), 'reference_cm', 'range_difference_cm', 'heading_error_deg', 'goal_x_m', 'goal_y_m'];
const FAST = [...SPEEDS.map(({ name }) => name), 'left_error_rpm', 'right_error_rpm'];

/** A heading is plotted on through 180 degrees up to here [deg]. */
const FARTHEST_DEG = 315;

/**
 * A stretch of time in one state; null: the robot does not report it.
 * @typedef {{from_s: number, to_s: number, mode: number, state: number | null, armed: boolean, faulted: boolean}} Stretch
 */

/**
 * A step of the setpoint: from arming, or from its change, to the next one or the end.
 * @typedef {object} Step
 * @property {number} from_s
 * @property {number} until_s
 * @property {number} mode
 * @property {import('./types.js').Reference['kind']} kind
 * @property {[number, number]} reference As plotted: cm, rpm, or m of a goal.
 * @property {boolean} ahead The distance is to a wall ahead.
 * @property {boolean} [stopped] It ended with the mode, not with another step.
 */

/** @typedef {import('./types.js').Pose} Pose */
/** @typedef {import('./types.js').Spread} Spread */

/**
 * A sample, for the map and the numbers: the newest, or that of a replay's playhead.
 * @typedef {object} Latest
 * @property {number} t_s
 * @property {number} mode
 * @property {number | null} state Of the mode's machine; null: not reported.
 * @property {boolean} armed
 * @property {Pose} origin The robot's origin in the world, as it was when it was last moved.
 * @property {Pose | null} estimated From the origin.
 * @property {Spread | null} spread Uncertainty of `estimated`.
 * @property {Pose | null} truth In the world.
 * @property {Pose | null} ghost In the world: a simulated robot that receives the same commands.
 * @property {number | null} heading_ref_rad Heading setpoint of the mode; null where it has none.
 * @property {Cell[]} ranges_m Left, right, front, and those with names of their own.
 * @property {number | null} servo_rad
 * @property {boolean} contact
 */

/** Steps kept: more than a person gives in ten minutes. */
const STEPS_KEPT = 500;
/** Two frames of telemetry [s]. */
const SHORTEST_STEP_S = 0.1;
/** Samples kept for the map: more than ten minutes, and of a replay what a page gets around the playhead. */
const MOMENTS_KEPT = 16_000;
/** Points kept of each trail, in the world, one every 2 cm at least. */
const TRAIL_POINTS = 2_000;
const TRAIL_STEP_M = 0.02;

export class Store {
  slow = new Table(SLOW, KEPT_S);
  fast = new Table(FAST, KEPT_S);
  readings = new Readings(KEPT_S);
  #computed = new Computed((name) => this.tableOf(name), KEPT_S);
  /** Where the robot began, in the world. @type {Pose} */
  start = IDENTITY;
  /** @type {Stretch[]} */
  stretches = [];
  /** The steps of the setpoint. @type {Step[]} */
  steps = [];
  /** The limits of the experiment whose steps these are; null: they are given by hand. @type {import('./types.js').Limit[] | null} */
  limits = null;
  /** Where it ends [s]. */
  experiment_end_s = Infinity;
  /** Some sample has a ghost. */
  haunted = false;
  /** @type {Latest | null} */
  latest = null;
  /** @type {{estimated: [number, number][], truth: [number, number][], ghost: [number, number][]}} */
  trails = { estimated: [], truth: [], ghost: [] };
  /** By number. @type {Map<number, import('./types.js').ModeEntry>} */
  #modes = new Map();
  #run = 0;
  /** The heading plotted last [deg]. */
  #heading_deg = 0;
  /** Where a replay is [s]; live there is nothing after it, unless an earlier instant is looked at. */
  #playhead_s = Infinity;
  /** The samples, and how many of them the map shows. @type {Latest[]} */
  #moments = [];
  #shown = 0;
  /** @type {Map<string, number>} */
  #index = new Map();

  /**
   * A new connection: everything is sent again.
   * @param {string[]} columns
   * @param {import('./types.js').ModeEntry[]} modes
   */
  begin(columns, modes) {
    this.#modes = new Map(modes.map((mode) => [mode.id, mode]));
    this.#index = new Map(columns.map((name, index) => [name, index]));
    this.clear();
  }

  clear() {
    this.slow.clear();
    this.fast.clear();
    this.readings.clear();
    this.#computed.clear();
    this.stretches = [];
    this.steps = [];
    this.haunted = false;
    this.#moments = [];
    this.#rewind();
  }

  /** Where a replay is [s]. */
  get playhead_s() {
    return this.#playhead_s;
  }

  set playhead_s(t_s) {
    if (t_s < this.#playhead_s) this.#rewind();
    this.#playhead_s = t_s;
    this.#advance();
  }

  /** Time of the oldest sample kept [s]. */
  get oldest_s() {
    return this.#moments[0]?.t_s ?? 0;
  }

  /** Where the robot was at an instant, in the world. @param {number} t_s @returns {Pose | null} */
  poseAt(t_s) {
    let [low, high] = [0, this.#moments.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((this.#moments[middle]?.t_s ?? Infinity) <= t_s) low = middle + 1;
      else high = middle;
    }
    const at = this.#moments[low - 1];
    return at ? at.truth ?? (at.estimated && compose(at.origin, at.estimated)) : null;
  }

  /** What there is of this run so far: for a comparison. */
  frozen() {
    const steps = this.steps.map((step) => ({ ...step, until_s: Math.min(step.until_s, this.newest_s) }));
    return Store.of({ ...this.content(), steps });
  }

  /** What a comparison needs, for what stores it: without its methods. */
  content() {
    return { slow: this.slow, fast: this.fast, steps: this.steps, stretches: this.stretches };
  }

  /** A run of that. @param {ReturnType<Store['content']>} content */
  static of({ slow, fast, steps, stretches }) {
    return Object.assign(new Store(), { slow: Table.of(slow, KEPT_S), fast: Table.of(fast, KEPT_S), steps, stretches: structuredClone(stretches) });
  }

  #rewind() {
    this.latest = null;
    this.trails = { estimated: [], truth: [], ghost: [] };
    this.#shown = 0;
  }

  /** Shows the samples up to the playhead. */
  #advance() {
    for (let next = this.#moments[this.#shown]; next && next.t_s <= this.#playhead_s; next = this.#moments[++this.#shown]) {
      lengthen(this.trails.estimated, next.estimated && compose(next.origin, next.estimated));
      lengthen(this.trails.truth, next.truth);
      lengthen(this.trails.ghost, next.ghost);
      this.latest = next;
    }
    // In large blocks, so that moving the rest is rare.
    if (this.#moments.length > 1.2 * MOMENTS_KEPT) this.#shown = Math.max(0, this.#shown - this.#moments.splice(0, this.#moments.length - MOMENTS_KEPT).length);
  }

  /**
   * What is plotted belongs to this run of the simulation only.
   * @param {number} run
   */
  setRun(run) {
    if (run !== this.#run) this.clear();
    this.#run = run;
  }

  /** @param {Cell[]} row */
  push(row) {
    /** @param {string} name */
    const cell = (name) => row[this.#index.get(name) ?? -1];
    /** @param {string} name */
    const rpm = (name) => scaled(cell(name), RPM_PER_RAD_S);
    /** @param {string} name */
    const cm = (name) => scaled(cell(name), CM_PER_M);
    const t_s = number(cell('t_s'));
    if (t_s === null) return;
    const mode = number(cell('mode')) ?? 0;
    const armed = cell('armed') === 1;
    const estimated = pose(cell('x_m'), cell('y_m'), cell('heading_rad'));
    const ghost = pose(cell('ghost_x_m'), cell('ghost_y_m'), cell('ghost_heading_rad'));
    const truth = pose(cell('true_x_m'), cell('true_y_m'), cell('true_heading_rad'));
    const origin = pose(cell('origin_x_m'), cell('origin_y_m'), cell('origin_heading_rad')) ?? IDENTITY;
    const { heading = false, idle = null, reference = null } = this.#modes.get(mode) ?? {};
    const follows = armed && (idle === null || cell('state') !== idle);
    const heading_ref_rad = follows && heading ? number(cell('heading_ref_rad')) : null;
    const toPlace = follows && reference?.kind === 'goal';
    // The robot's origin may move with a goal: what is plotted does not jump.
    const [left, right] = [number(cell('reference_left')), number(cell('reference_right'))];
    const goal = toPlace && left !== null && right !== null ? place(origin, [left, right]) : null;

    /** Signals as plotted, from these columns. @param {typeof ROW} signals @param {(column: string) => string} [of] */
    const plotted = (signals, of = (column) => column) => Object.fromEntries(signals.map(({ name, column, unit }) => [name, scaled(cell(of(column)), FACTORS[unit] ?? 1)]));
    /** @param {string} column */
    const before = (column) => column.replace('_rad_s', '_before_rad_s');

    this.slow.push(t_s, {
      ...plotted(OTHERS),
      reference_cm: reference?.kind === 'distance' && cell('reference_left') !== 0 ? cm('reference_left') : null,
      range_difference_cm: less(cm('range_left_m'), cm('range_right_m')),
      ...this.#placeAndHeading(estimated && compose(origin, estimated), truth, ghost, heading_ref_rad === null ? null : origin.heading_rad + heading_ref_rad),
      goal_x_m: goal?.[0] ?? null,
      goal_y_m: goal?.[1] ?? null,
    });
    this.fast.push(t_s - EARLIER_S, plotted(SPEEDS.filter(({ column }) => this.#index.has(before(column))), before));
    this.fast.push(t_s, {
      ...plotted(SPEEDS),
      left_error_rpm: less(rpm('left_ref_rad_s'), rpm('left_rad_s')),
      right_error_rpm: less(rpm('right_ref_rad_s'), rpm('right_rad_s')),
    });
    // The speeds wanted come with every frame, other setpoints with the status.
    const wanted = reference?.kind === 'wheel_speed' ? [number(cell('left_ref_rad_s')), number(cell('right_ref_rad_s'))] : reference?.kind === 'goal' ? goal : [left, right];
    this.#pushStep(t_s, mode, armed ? wanted : null);
    this.#pushStretch(t_s, mode, number(cell('state')), armed, cell('faulted') === 1);

    this.haunted ||= ghost !== null;
    this.#moments.push({
      t_s,
      mode,
      state: number(cell('state')),
      armed,
      origin,
      estimated,
      spread: spread(cell('x_deviation_m'), cell('y_deviation_m'), cell('xy_correlation'), cell('heading_deviation_rad')),
      truth,
      ghost,
      heading_ref_rad,
      ranges_m: [cell('range_left_m') ?? null, cell('range_right_m') ?? null, cell('range_front_m') ?? null],
      servo_rad: number(cell('true_servo_rad')) ?? number(cell('servo_rad')),
      contact: cell('contact') === 1,
    });
    this.#advance();
  }

  /**
   * All in the frame of the world.
   * @param {Pose | null} estimated
   * @param {Pose | null} truth
   * @param {Pose | null} ghost
   * @param {number | null} heading_ref_rad
   */
  #placeAndHeading(estimated, truth, ghost, heading_ref_rad) {
    if (!estimated) return {};
    const wrapped_deg = estimated.heading_rad * DEG_PER_RAD;
    const before_deg = this.#heading_deg;
    const on_deg = near(wrapped_deg, before_deg);
    const heading_deg = Math.abs(on_deg) > FARTHEST_DEG ? wrapped_deg : on_deg;
    this.#heading_deg = heading_deg;
    /** A gap where the curve starts over. @param {number | null} angle_deg */
    const curve = (angle_deg) => (angle_deg === null || Math.abs(heading_deg - before_deg) > 180 ? null : near(angle_deg, heading_deg));
    return {
      x_m: estimated.x_m,
      y_m: estimated.y_m,
      true_x_m: truth?.x_m ?? null,
      true_y_m: truth?.y_m ?? null,
      ghost_x_m: ghost?.x_m ?? null,
      ghost_y_m: ghost?.y_m ?? null,
      ghost_heading_deg: curve(ghost ? ghost.heading_rad * DEG_PER_RAD : null),
      heading_deg: curve(heading_deg),
      heading_ref_deg: curve(heading_ref_rad === null ? null : heading_ref_rad * DEG_PER_RAD),
      heading_error_deg: heading_ref_rad === null ? null : wrapped(heading_ref_rad - estimated.heading_rad) * DEG_PER_RAD,
      true_heading_deg: curve(truth ? truth.heading_rad * DEG_PER_RAD : null),
    };
  }

  /**
   * @param {number} t_s
   * @param {number} mode
   * @param {number | null} state
   * @param {boolean} armed
   * @param {boolean} faulted
   */
  #pushStretch(t_s, mode, state, armed, faulted) {
    const last = this.stretches.at(-1);
    if (last) last.to_s = t_s;
    if (!last || last.mode !== mode || last.state !== state || last.armed !== armed || last.faulted !== faulted) {
      this.stretches.push({ from_s: t_s, to_s: t_s, mode, state, armed, faulted });
    }
    const first = this.stretches[0];
    if (first && first.to_s < t_s - 1.2 * KEPT_S) this.stretches.shift();
  }

  /** @param {number} t_s @param {number} mode @param {(number | null)[] | null} reference Null: none is in force. */
  #pushStep(t_s, mode, reference) {
    const entry = this.#modes.get(mode);
    const kind = entry?.reference?.kind;
    const [left, right] = reference ?? [];
    const last = this.steps.at(-1);
    const runs = last && last.until_s === Infinity ? last : null;
    const in_force = entry && kind && typeof left === 'number' && typeof right === 'number' && (kind !== 'distance' || left !== 0);
    const factor = kind === 'distance' ? CM_PER_M : kind === 'goal' ? 1 : RPM_PER_RAD_S;
    /** @type {[number, number]} */
    const now = [(left ?? 0) * factor, (right ?? 0) * factor];
    if (runs && (!in_force || runs.mode !== mode || runs.reference.some((value, index) => value !== now[index]))) Object.assign(runs, { until_s: t_s, stopped: !in_force || runs.mode !== mode });
    // A frame between two values of a setpoint is no step.
    if (runs && runs.until_s - runs.from_s < SHORTEST_STEP_S) this.steps.pop();
    if (in_force && (!runs || runs.until_s !== Infinity)) {
      this.steps.push({ from_s: t_s, until_s: Infinity, mode, kind, reference: now, ahead: entry.rigs.some((rig) => rig.startsWith('front_')) });
    }
    if (this.steps.length > STEPS_KEPT) this.steps.shift();
  }

  /** The step that runs, or the last one, as far as it is shown. @returns {(Step & {runs: boolean}) | null} */
  get step() {
    const last = this.steps.findLast(({ from_s }) => from_s <= this.#playhead_s);
    return last && last.until_s > this.#playhead_s ? { ...last, until_s: this.#playhead_s, stopped: false, runs: true } : last ? { ...last, runs: last.until_s === Infinity } : null;
  }

  /** The stretch shown now, and the one before. */
  get now() {
    const index = this.stretches.findLastIndex(({ from_s }) => from_s <= this.#playhead_s);
    return { last: this.stretches[index], before: this.stretches[index - 1] };
  }

  /** @param {import('./types.js').ReadingGroup} group */
  pushReadings(group) {
    const before = this.#moments.at(-1) ?? null;
    // Of a program that sends no telemetry nothing else is known.
    const silent = this.silent;
    const origin = silent || before === null ? this.start : before.origin;
    for (const { t_s, pose, pinged_m, servo_rad, contact } of this.readings.push(group)) {
      // Telemetry has the truth too.
      if (silent) this.#moments.push({ t_s, mode: -1, state: null, armed: false, origin, estimated: null, spread: null, truth: pose, ghost: null, heading_ref_rad: null, ranges_m: pinged_m, servo_rad, contact });
    }
    this.#advance();
  }

  /** The robot has sent no telemetry. */
  get silent() {
    return this.slow.t.length === 0;
  }

  /** Time of the newest line [s]. */
  get newest_s() {
    return Math.max(this.slow.t.at(-1) ?? 0, this.readings.newest_s);
  }

  /** The table that a signal is in. @param {string} name @returns {Table} */
  tableOf(name) {
    if (name.startsWith(MARK)) return this.#computed.tableOf(name);
    return this.readings.tableOf(name) ?? (this.fast.columns.has(name) ? this.fast : this.slow);
  }

  /**
   * A signal as plotted, in the units plotted.
   * @param {string} name
   * @returns {{t: number[], y: Column}}
   */
  series(name) {
    const table = this.tableOf(name);
    const y = table.columns.get(name);
    if (y) return { t: [...table.t], y: [...y] };
    throw new Error(`no signal ${name}; there are ${[...SLOW, ...FAST, ...this.readings.names()].join(', ')}`);
  }
}

/**
 * @param {Cell | undefined} x_m
 * @param {Cell | undefined} y_m
 * @param {Cell | undefined} heading_rad
 * @returns {Pose | null}
 */
function pose(x_m, y_m, heading_rad) {
  if (typeof x_m !== 'number' || typeof y_m !== 'number' || typeof heading_rad !== 'number') return null;
  return { x_m, y_m, heading_rad };
}

/**
 * @param {Cell | undefined} x_m
 * @param {Cell | undefined} y_m
 * @param {Cell | undefined} correlation
 * @param {Cell | undefined} heading_rad
 * @returns {Spread | null}
 */
function spread(x_m, y_m, correlation, heading_rad) {
  if (typeof x_m !== 'number' || typeof y_m !== 'number' || typeof correlation !== 'number' || typeof heading_rad !== 'number') return null;
  return { x_m, y_m, correlation, heading_rad };
}

/**
 * @param {[number, number][]} trail
 * @param {Pose | null} at
 */
function lengthen(trail, at) {
  if (!at) return;
  const last = trail.at(-1);
  if (last && Math.hypot(at.x_m - last[0], at.y_m - last[1]) < TRAIL_STEP_M) return;
  trail.push([at.x_m, at.y_m]);
  if (trail.length > TRAIL_POINTS) trail.splice(0, TRAIL_POINTS / 10);
}
