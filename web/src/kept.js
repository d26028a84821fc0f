// @ts-check
/** Runs side by side: from where their time counts, what differs between them, and the range of many. No page is needed. */

/** @typedef {import('./store.js').Store} Store */
/** What tells it from others, by what it is; null: not known. @typedef {Record<string, string | number | null>} About */
/** @typedef {{name: string, store: Store, about: About, parameters: Record<string, number>, metrics: Record<string, number | null>}} Run */
/** The range of many runs at the same times. @typedef {{t: number[], low: number[], middle: number[], high: number[]}} Range */

/** So many runs can be told apart. */
export const MOST = 8;

/** When it was switched on last [s]; null: never. @param {Pick<Store, 'stretches'>} store */
export function on_s({ stretches }) {
  const last = stretches.findLastIndex(({ armed }, index) => armed && !stretches[index - 1]?.armed);
  return stretches[last]?.from_s ?? null;
}

/** The steps of the setpoint since then. @param {Pick<Store, 'stretches' | 'steps'>} store */
export const stepsOf = (store) => store.steps.filter(({ from_s }) => from_s >= (on_s(store) ?? 0));

/** Where the time of a run counts from [s]: power-on (''), ON, or a step since, by its number. @param {Pick<Store, 'stretches' | 'steps'>} store @param {string} align */
export function begin_s(store, align) {
  if (align === '') return 0;
  return (align === 'on' ? on_s(store) : stepsOf(store)[Number(align)]?.from_s) ?? 0;
}

/**
 * What is not the same in all runs: names, and the value of each.
 * @template T
 * @param {Record<string, T>[]} of
 * @returns {[string, (T | undefined)[]][]}
 */
export function differences(of) {
  const names = [...new Set(of.flatMap((each) => Object.keys(each)))];
  const lines = names.map((name) => /** @type {[string, (T | undefined)[]]} */ ([name, of.map((each) => each[name])]));
  return lines.filter(([, values]) => values.some((value) => value !== values[0]));
}

/**
 * Lowest, middle and highest value of many lines, at steps of time; only where half of them have one.
 * @param {{t: number[], y: (number | null | undefined)[]}[]} lines
 * @param {number} step_s
 * @returns {Range}
 */
export function rangeOf(lines, step_s) {
  /** @type {Range} */
  const made = { t: [], low: [], middle: [], high: [] };
  const at = lines.map(() => 0);
  const end_s = Math.max(0, ...lines.map(({ t }) => t.at(-1) ?? 0));
  for (let t_s = 0; t_s <= end_s; t_s += step_s) {
    const values = lines.flatMap(({ t, y }, line) => {
      let index = at[line] ?? 0;
      while ((t[index + 1] ?? Infinity) <= t_s) index += 1;
      at[line] = index;
      const value = y[index];
      return typeof value === 'number' && t_s <= (t.at(-1) ?? 0) ? [value] : [];
    }).sort((one, other) => one - other);
    if (2 * values.length < lines.length) continue;
    made.t.push(t_s);
    made.low.push(values[0] ?? 0);
    made.middle.push(values[values.length >> 1] ?? 0);
    made.high.push(values.at(-1) ?? 0);
  }
  return made;
}
