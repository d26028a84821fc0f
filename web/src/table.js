// @ts-check
/**
 * Signals in columns, lines of increasing time, in uPlot's form. Beside the lines a table keeps a coarse copy for long
 * windows: min and max of each signal over sixteen lines, which is all that a narrow plot can show of them.
 *
 * In a column null is a gap, and undefined means that this line has no such value and the curve continues.
 */

/** @typedef {(number | null | undefined)[]} Column */

/** How far back a value may be [lines]. */
const LINES_BACK = 60;
/** Lines that become two in the coarse copy. */
const BUCKET = 16;

/** A signal in a bucket so far: min and max, and which came first. */
class Extent {
  /** @type {number | null | undefined} */
  low = undefined;
  /** @type {number | null | undefined} */
  high = undefined;
  rising = true;

  /** @param {number | null | undefined} value */
  add(value) {
    if (typeof value !== 'number') {
      if (value === null && this.low === undefined) this.low = this.high = null;
      return;
    }
    if (typeof this.low !== 'number' || typeof this.high !== 'number') {
      this.low = this.high = value;
    } else if (value < this.low) {
      this.low = value;
      this.rising = false;
    } else if (value > this.high) {
      this.high = value;
      this.rising = true;
    }
  }

  clear() {
    this.low = this.high = undefined;
    this.rising = true;
  }
}

/** Time and columns. */
export class Lines {
  /** @type {number[]} */
  t = [];
  /** @type {Map<string, Column>} */
  columns;

  /** @param {string[]} names */
  constructor(names) {
    this.columns = new Map(names.map((name) => [name, []]));
  }

  /** Drops the first lines. @param {number} count */
  drop(count) {
    this.t.splice(0, count);
    for (const column of this.columns.values()) column.splice(0, count);
  }

  /** Number of the first line at or after a time. @param {number} t_s */
  indexAt(t_s) {
    let [low, high] = [0, this.t.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (/** @type {number} */ (this.t[middle]) < t_s) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Drops older lines. @param {number} t_s */
  dropBefore(t_s) {
    this.drop(this.t.findIndex((each) => each >= t_s));
  }
}

export class Table extends Lines {
  coarse;
  #kept_s;
  /** @type {Map<string, Extent>} */
  #bucket;
  #inBucket = 0;
  #bucketFrom_s = 0;
  /** When each column had its last number [s]: that is asked in each frame, and not searched. @type {Map<string, number>} */
  #known = new Map();

  /** @param {string[]} names @param {number} kept_s how long lines are kept [s] */
  constructor(names, kept_s) {
    super(names);
    this.coarse = new Lines(names);
    this.#kept_s = kept_s;
    this.#bucket = new Map(names.map((name) => [name, new Extent()]));
  }

  /** Adds the columns that there are not yet. @param {string[]} names */
  offer(names) {
    for (const name of names) {
      if (this.columns.has(name)) continue;
      for (const lines of [this, this.coarse]) lines.columns.set(name, Array(lines.t.length).fill(undefined));
      this.#bucket.set(name, new Extent());
    }
  }

  /**
   * Appends a line; one that is not later than the last is dropped.
   * @param {number} t_s
   * @param {Record<string, number | null | undefined>} values
   */
  push(t_s, values) {
    const last = this.t.at(-1);
    if (last !== undefined && t_s <= last) return;
    this.t.push(t_s);
    if (this.#inBucket === 0) this.#bucketFrom_s = t_s;
    for (const [name, column] of this.columns) {
      column.push(values[name]);
      this.#bucket.get(name)?.add(values[name]);
      if (typeof values[name] === 'number') this.#known.set(name, t_s);
    }
    this.#inBucket += 1;
    if (this.#inBucket === BUCKET) this.#close(t_s);
    // In large blocks, so that moving the rest is rare.
    if (t_s - (this.t[0] ?? t_s) <= 1.2 * this.#kept_s) return;
    this.dropBefore(t_s - this.#kept_s);
    this.coarse.dropBefore(t_s - this.#kept_s);
  }

  /** The bucket is full. @param {number} t_s */
  #close(t_s) {
    this.coarse.t.push(this.#bucketFrom_s, (this.#bucketFrom_s + t_s) / 2);
    for (const [name, column] of this.coarse.columns) {
      const extent = this.#bucket.get(name);
      if (extent) column.push(...(extent.rising ? [extent.low, extent.high] : [extent.high, extent.low]));
      extent?.clear();
    }
    this.#inBucket = 0;
  }

  /** The same lines, which stay as they are. */
  copy() {
    return Table.of(this, this.#kept_s);
  }

  /** A table of these lines. @param {Lines & {coarse: Lines}} lines @param {number} kept_s */
  static of(lines, kept_s) {
    const made = new Table([], kept_s);
    for (const [from, into] of /** @type {const} */ ([[lines, made], [lines.coarse, made.coarse]])) {
      into.t = [...from.t];
      into.columns = new Map([...from.columns].map(([name, column]) => [name, [...column]]));
    }
    for (const [name, column] of made.columns) {
      const last_s = made.t[column.findLastIndex((value) => typeof value === 'number')];
      if (last_s !== undefined) made.#known.set(name, last_s);
    }
    return made;
  }

  clear() {
    this.drop(this.t.length);
    this.coarse.drop(this.coarse.t.length);
    for (const extent of this.#bucket.values()) extent.clear();
    this.#known.clear();
    this.#inBucket = 0;
  }

  /** Whether a signal has had a value since then, or between two times. @param {string} name @param {number} from_s @param {number} [to_s] */
  knowsIn(name, from_s, to_s = Infinity) {
    const last_s = this.#known.get(name);
    if (last_s === undefined || last_s < from_s) return false;
    if (last_s <= to_s) return true;
    const column = this.columns.get(name) ?? [];
    let line = this.indexAt(to_s);
    if (this.t[line] !== to_s) line -= 1;
    while (line >= 0 && typeof column[line] !== 'number') line -= 1;
    return (this.t[line] ?? -Infinity) >= from_s;
  }

  /** A signal's value at a time, or the last before it; lines without it and two gaps are passed over. @param {string} name @param {number} t_s */
  at(name, t_s) {
    const column = this.columns.get(name) ?? [];
    let line = this.indexAt(t_s);
    if (this.t[line] !== t_s) line -= 1;
    for (const end = line - LINES_BACK; line > 0 && line > end && column[line] === undefined; line--);
    return column[line] ?? column[line - 1] ?? column[line - 2];
  }
}
