// @ts-check
/** What is drawn behind the curves of a plot: kept runs in grey, from ON on, and the range of many seeds. */
import { on_s, rangeOf } from './kept.js';
import { colours } from './theme.js';

/** @typedef {import('../vendor/uplot/uPlot.js')} uPlot */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./curves.js').Curve} Curve */
/** @typedef {import('./kept.js').Range} Range */

/** More points of a curve than this are not seen. */
const MOST_POINTS = 1_500;
/** Of the range of many runs [s]. */
const STEP_S = 0.1;

export class Overlay {
  /** The runs that were kept. @type {Store[]} */
  kept = [];
  /** The same run with many seeds. @type {Store[]} */
  seeds = [];
  /** The ranges of the seeds, by signal. @type {Map<string, {range: Range, every: number, outline: Path2D}>} */
  #ranges = new Map();

  /** @param {Store[]} seeds */
  setSeeds(seeds) {
    this.seeds = seeds;
    this.#ranges.clear();
  }

  /** When the seeds were switched on, in the time of the run that is shown: as that one was, once it was [s]. @param {Store} store */
  shift_s(store) {
    return on_s(store) ?? (this.seeds[0] ? on_s(this.seeds[0]) ?? 0 : 0);
  }

  /** Outline of the range of a signal, in seconds from ON and its unit, with every so many points. @param {string} name @param {number} every */
  #range(name, every) {
    const known = this.#ranges.get(name) ?? { range: rangeOf(this.seeds.map((store) => sinceOn(store, name)), STEP_S), every: 0, outline: new Path2D() };
    this.#ranges.set(name, known);
    if (known.every === every) return known.outline;
    const { t, low, high } = known.range;
    Object.assign(known, { every, outline: new Path2D() });
    for (let index = 0; index < t.length; index += every) known.outline.lineTo(t[index] ?? 0, low[index] ?? 0);
    for (let index = t.length - 1; index >= 0; index -= every) known.outline.lineTo(t[index] ?? 0, high[index] ?? 0);
    return known.outline;
  }

  /** @param {uPlot} plot @param {Curve[]} curves @param {Store} store the run that is shown @param {[number, number]} range_s */
  draw(plot, curves, store, [from_s, to_s]) {
    if (this.kept.length + this.seeds.length === 0) return;
    const { ctx, bbox } = plot;
    const y = (/** @type {Curve} */ { right }, /** @type {number} */ value) => plot.valToPos(value, right ? 'right' : 'y', true);
    const x = (/** @type {number} */ t_s) => plot.valToPos(t_s, 'x', true);
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    const measured = curves.filter(({ kind }) => kind !== 'reference');
    // No two points in one pixel.
    const every = Math.max(1, Math.floor((to_s - from_s) / (STEP_S * bbox.width)));
    const shift_s = this.shift_s(store);
    ctx.globalAlpha = 0.18;
    for (const curve of this.seeds.length > 0 ? measured : []) {
      const [left, zero, right, one] = [x(shift_s), y(curve, 0), x(shift_s + 1), y(curve, 1)];
      ctx.save();
      ctx.transform(right - left, 0, 0, one - zero, left, zero);
      ctx.fillStyle = colours[curve.colour];
      ctx.fill(this.#range(curve.name, every));
      ctx.restore();
    }
    ctx.strokeStyle = colours.dim;
    ctx.globalAlpha = 0.75;
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([]);
    for (const run of this.kept) {
      const shift_s = (on_s(store) ?? 0) - (on_s(run) ?? 0);
      for (const curve of measured) {
        const table = run.tableOf(curve.name);
        const column = table.columns.get(curve.name);
        if (!column) continue;
        const [begin, end] = [Math.max(0, table.indexAt(from_s - shift_s) - 1), table.indexAt(to_s - shift_s) + 1];
        const every = Math.max(1, Math.floor((end - begin) / MOST_POINTS));
        ctx.beginPath();
        let gap = true;
        for (let index = begin; index < Math.min(end, table.t.length); index += every) {
          const value = column[index];
          if (value === undefined) continue;
          if (value === null) gap = true;
          else if (gap) ctx.moveTo(x((table.t[index] ?? 0) + shift_s), y(curve, value));
          else ctx.lineTo(x((table.t[index] ?? 0) + shift_s), y(curve, value));
          if (value !== null) gap = false;
        }
        ctx.stroke();
      }
    }
    ctx.restore();
  }
}

/** A signal from ON on. @param {Store} store @param {string} name */
const sinceOn = (store, name) => {
  const table = store.tableOf(name);
  const from_s = on_s(store) ?? 0;
  return { t: table.t.map((t_s) => t_s - from_s), y: table.columns.get(name) ?? [] };
};
