// @ts-check
/**
 * Signals computed from others by an expression, in the units that people read: `=left_rpm - right_rpm`. It has the operators
 * and functions of control laws (`law.js`), and two that remember: `derivative(x)`, per second, and `filter(x, T)`, a low-pass of
 * the first order with a time constant in s.
 */
import { namesIn, parse, work } from './law.js';
import { Table } from './table.js';

/** @typedef {import('./law.js').Part} Part */
/** @typedef {import('./signals.js').Unit} Unit */

/** What marks an expression among the names of signals. */
export const MARK = '=';

/** Of the derivative. @type {Partial<Record<Unit, Unit>>} */
const PER_SECOND = { m: 'm/s', 'm/s': 'm/s²', '°': '°/s' };
/** A number that is in none of the units. */
const NUMBER = 'printed';

/** Why something is no expression: a text with values. */
export class BadExpression extends Error {
  /** @param {string} text @param {string[]} values */
  constructor(text, ...values) {
    super(text);
    this.values = values;
  }
}

/**
 * The unit of an expression.
 * @param {string} name with its mark
 * @param {(name: string) => Unit | null} unitOf of a signal; null: there is none
 * @returns {Unit}
 */
export function unitOfExpression(name, unitOf) {
  let whole;
  try {
    whole = parse(name.slice(MARK.length));
  } catch {
    throw new BadExpression('not understood: {}', name.slice(MARK.length));
  }
  if (namesIn(whole).length === 0) throw new BadExpression('the expression {} has no signal', name.slice(MARK.length));
  return of(whole) ?? NUMBER;

  /** Null: a plain number. @param {Part} part @returns {Unit | null} */
  function of(part) {
    if (part.parts.length === 0) {
      if (/^[\d.]+$/.test(part.of)) return null;
      const unit = unitOf(part.of);
      if (unit === null) throw new BadExpression('there is no signal {}', part.of);
      return unit;
    }
    const units = part.parts.map(of);
    const [a = null, b = null] = units;
    if (part.of === '*') return a === null || b === null ? a ?? b : NUMBER;
    if (part.of === '/') return b === null ? a : NUMBER;
    if (part.of === 'filter') return a;
    if (part.of === 'derivative') return (a && PER_SECOND[a]) ?? NUMBER;
    if (part.of === 'sqrt' || part.of === 'sign') return NUMBER;
    const known = units.filter((unit) => unit !== null);
    const other = known.find((unit) => unit !== known[0]);
    if (other) throw new BadExpression('{} and {} do not add up', known[0] ?? '', other);
    return known[0] ?? null;
  }
}

/** The tables of expressions, each filled as far as its signals go. */
export class Computed {
  #tableOf;
  #kept_s;
  /** @type {Map<string, {table: Table, part: Part, source: Table, memory: Map<Part, {t_s: number, value: number, result: number}>}>} */
  #all = new Map();

  /** @param {(name: string) => Table} tableOf of a signal @param {number} kept_s how long lines are kept [s] */
  constructor(tableOf, kept_s) {
    this.#tableOf = tableOf;
    this.#kept_s = kept_s;
  }

  clear() {
    this.#all.clear();
  }

  /** @param {string} name of an expression */
  tableOf(name) {
    const part = this.#all.get(name)?.part ?? parse(name.slice(MARK.length));
    const source = this.#tableOf(namesIn(part)[0] ?? '');
    let own = this.#all.get(name);
    if (!own || own.source !== source) {
      own = { table: new Table([name], this.#kept_s), part, source, memory: new Map() };
      this.#all.set(name, own);
    }
    const { table, memory } = own;
    const last_s = table.t.at(-1) ?? -Infinity;
    for (let line = source.indexAt(last_s); line < source.t.length; line++) {
      const t_s = source.t[line] ?? 0;
      if (t_s <= last_s) continue;
      const value = work(part, (signal) => this.#tableOf(signal).at(signal, t_s) ?? NaN, new Map(), (call, values) => remember(call, values, t_s, memory));
      table.push(t_s, { [name]: Number.isFinite(value) ? value : null });
    }
    return table;
  }
}

/** @param {Part} call @param {number[]} values @param {number} t_s @param {Map<Part, {t_s: number, value: number, result: number}>} memory */
function remember(call, [value = NaN, constant_s = 0], t_s, memory) {
  const before = memory.get(call);
  if (!Number.isFinite(value)) return NaN;
  const dt_s = before ? t_s - before.t_s : 0;
  const result = call.of === 'derivative'
    ? (before && dt_s > 0 ? (value - before.value) / dt_s : NaN)
    : before ? before.result + (dt_s / (constant_s + dt_s)) * (value - before.result) : value;
  memory.set(call, { t_s, value, result });
  return result;
}
