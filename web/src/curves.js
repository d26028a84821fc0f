// @ts-check
/** What a plot draws: its signals, each with its axis and its colour, and their lines, which may come from two tables. */
import { unitsOf } from './layout.js';
import { signal } from './signals.js';

/** @typedef {import('./layout.js').PlotSpec} PlotSpec */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./table.js').Column} Column */
/** @typedef {import('./table.js').Lines} Lines */
/** @typedef {import('./signals.js').Signal & {right: boolean}} Curve A signal in a plot; `right`: its axis is the one on the right. */

/** Above this number of visible lines the coarse copy is drawn: more than a plot's width. */
const MANY_LINES = 4_000;
/** For curves of the right axis whose colour the left one has: the first that is free. @type {import('./theme.js').ColourName[]} */
const OTHERS = ['goal', 'front', 'reference', 'right', 'left'];

/** The curves of a plot, those of the left axis first. @param {PlotSpec} spec @returns {Curve[]} */
export function curvesOf({ signals }) {
  const [unit] = unitsOf(signals);
  const known = signals.flatMap((name) => signal(name) ?? []);
  // Where nothing else is drawn, what is true needs no other line.
  const only = known.every(({ kind }) => kind === 'true');
  const all = known.map((each) => ({ ...each, kind: only ? /** @type {const} */ ('measured') : each.kind, right: each.unit !== unit }));
  const left = all.filter(({ right }) => !right);
  const taken = new Set(left.map(look));
  return [...left, ...all.filter(({ right }) => right).map((each) => {
    const colour = [each.colour, ...OTHERS].find((other) => !taken.has(look({ ...each, colour: other }))) ?? each.colour;
    taken.add(look({ ...each, colour }));
    return { ...each, colour };
  })];
}

/** What distinguishes a curve. @param {{colour: string, kind: string}} curve */
const look = ({ colour, kind }) => `${colour} ${kind}`;

/**
 * The visible lines of the curves: times, then a column for each curve. Those of one table unchanged; those of two merged
 * by time, and where only one has a line the curves of the other continue.
 * @param {Store} store
 * @param {Curve[]} curves
 * @param {[number, number]} range_s
 * @returns {[number[], ...Column[]]}
 */
export function linesOf(store, curves, [from_s, to_s]) {
  const tables = [...new Set(curves.map(({ name }) => store.tableOf(name)))];
  const many = tables.some((table) => table.indexAt(to_s) - table.indexAt(from_s) > MANY_LINES);
  const sources = tables.map((table) => (many ? table.coarse : table));
  const [only] = sources;
  if (only && sources.length === 1) return [only.t, ...curves.map(({ name }) => only.columns.get(name) ?? [])];
  // Two tables may have signals of one name: each is taken from its own.
  const parts = tables.map((table, index) => ({ source: sources[index] ?? table, names: curves.map(({ name }) => name).filter((name) => store.tableOf(name) === table) }));
  const joined = join(parts, [from_s, to_s]);
  return [joined.t, ...curves.map(({ name }) => joined.columns.get(name) ?? [])];
}

/** @param {{source: Lines, names: string[]}[]} from @param {[number, number]} range_s */
function join(from, [from_s, to_s]) {
  /** @type {number[]} */
  const t = [];
  // From the line before to the line after, so that the curves go through to the edges. `lines`: its line at each time, or -1.
  const parts = from.map(({ source, names }) => ({
    t: source.t, names, columns: source.columns, lines: /** @type {number[]} */ ([]),
    at: Math.max(0, source.indexAt(from_s) - 1), end: Math.min(source.t.length, source.indexAt(to_s) + 1),
  }));
  for (;;) {
    let next_s = Infinity;
    for (const part of parts) if (part.at < part.end) next_s = Math.min(next_s, part.t[part.at] ?? Infinity);
    if (next_s === Infinity) break;
    t.push(next_s);
    for (const part of parts) part.lines.push(part.at < part.end && part.t[part.at] === next_s ? part.at++ : -1);
  }
  // Column by column: times and lines are found once for all of them, for each frame.
  const columns = new Map(parts.flatMap(({ names, columns: of, lines }) => names.map((name) => {
    const column = of.get(name) ?? [];
    return /** @type {[string, Column]} */ ([name, lines.map((line) => (line < 0 ? undefined : column[line]))]);
  })));
  return { t, columns };
}
