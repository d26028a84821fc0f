// @ts-check
/** One plot: its curves, the numbers beside their names, its axis, and what the pointer does in it. */
import uPlot from '../vendor/uplot/uPlot.js';
import { create, setText } from './dom.js';
import { unitOf } from './layout.js';
import { UNITS, signal } from './signals.js';
import { t } from './text.js';
import { colours } from './theme.js';
import { format } from './units.js';

/** @typedef {import('./plots.js').Plots} Plots */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./layout.js').PlotSpec} PlotSpec */
/** @typedef {import('./signals.js').Signal} Signal */

export const GUTTER_PX = 46;
export const FONT = '11px system-ui, sans-serif';
/** Height of a plot's title, as in the style sheet. */
export const HEAD_PX = 20;
/** From so many lines in sight on the coarse copy is drawn: more than a plot is wide. */
const MANY_LINES = 4_000;
/** A drag that goes further than this along both axes is a box [px]. */
const BOX_PX = 25;

export class PlotPanel {
  #view;
  #spec;
  #store;
  #table;
  /** @type {Signal[]} */
  #signals;
  /** Limits of the axis while it is zoomed into. @type {[number, number] | null} */
  #zoomed = null;
  #lock = create('button', { type: 'button', className: 'small', textContent: t('lock'), title: t('Keep the limits of the axis as they are') });
  #chips;
  /** @type {HTMLElement[]} */
  parts;
  plot;

  /**
   * @param {PlotSpec} spec
   * @param {Store} store
   * @param {Plots} view
   */
  constructor(spec, store, view) {
    this.#spec = spec;
    this.#store = store;
    this.#view = view;
    this.#signals = spec.signals.flatMap((name) => signal(name) ?? []);
    this.#table = store.tableOf(spec.signals[0] ?? '');
    const body = create('div', { className: 'plot-body' });
    this.plot = this.#make(body);
    this.#chips = this.#signals.map((each, index) => this.#chip(each, index + 1));
    const head = this.#head();
    this.parts = [head, body];
  }

  get spec() {
    return this.#spec;
  }

  get signals() {
    return this.#signals;
  }

  get unit() {
    return unitOf(this.#spec);
  }

  #head() {
    const edit = create('button', { type: 'button', className: 'small', textContent: '…', title: t('Signals, axis and picture of this plot') });
    edit.setAttribute('aria-label', t('Change the plot {}', t(this.#spec.title)));
    edit.addEventListener('click', () => this.#view.edit(this));
    this.#lock.setAttribute('aria-pressed', String(this.#spec.min !== null));
    this.#lock.addEventListener('click', () => this.#toggleLock());
    return create('div', { className: 'plot-head' }, create('b', { textContent: t(this.#spec.title) }), create('i', { textContent: t(this.unit) }),
      create('div', { className: 'plot-curves' }, ...this.#chips.map(({ chip }) => chip)), this.#lock, edit);
  }

  #toggleLock() {
    const { min, max } = this.plot.scales['y'] ?? {};
    const locked = this.#spec.min === null && min !== undefined && max !== undefined && min !== null && max !== null;
    this.#view.change(this.#spec, { ...this.#spec, min: locked ? min : null, max: locked ? max : null });
  }

  /** The axis is as it was before it was zoomed into. */
  resetAxis() {
    this.#zoomed = null;
  }

  /** Limits of the axis, for what is in sight. @param {number | null} low @param {number | null} high @returns {[number, number]} */
  #limits(low, high) {
    if (this.#zoomed) return this.#zoomed;
    if (this.#spec.min !== null && this.#spec.max !== null) return [this.#spec.min, this.#spec.max];
    // Whole steps, so that the axis does not tremble with the noise.
    const { step } = UNITS[this.unit];
    if (low === null || low === undefined || high === null) return [0, 10 * step];
    return [Math.floor(low / step - 0.05) * step, Math.ceil(high / step + 0.05) * step];
  }

  /** The lines that are drawn: all, or where there are more than can be seen the coarse ones. */
  data() {
    const [from_s, to_s] = this.#view.range_s;
    const many = this.#table.indexAt(to_s) - this.#table.indexAt(from_s) > MANY_LINES;
    const lines = many ? this.#table.coarse : this.#table;
    return /** @type {uPlot.AlignedData} */ ([lines.t, ...this.#signals.map(({ name }) => lines.columns.get(name) ?? [])]);
  }

  draw() {
    const [min, max] = this.#view.range_s;
    this.plot.batch(() => {
      this.plot.setData(this.data(), false);
      this.plot.setScale('x', { min, max });
    });
    this.label();
  }

  /** The numbers beside the names: at the cursor, or the newest; and how far from those at the mark. */
  label() {
    const cursor = this.plot.cursor.idx;
    const data = this.plot.data;
    const at = cursor ?? (data[0]?.length ?? 0) - 1;
    const { mark_s } = this.#view;
    const { decimals } = UNITS[this.unit];
    this.#chips.forEach(({ chip, value, name }, index) => {
      const column = /** @type {(number | null | undefined)[]} */ (data[index + 1] ?? []);
      const unused = !plottedIn(column);
      if (chip.hidden !== unused) chip.hidden = unused;
      const now = column[at] ?? column[at - 1];
      const then = mark_s === null ? null : this.#table.at(name, mark_s);
      const difference = typeof now === 'number' && typeof then === 'number' ? ` Δ ${format(now - then, decimals)}` : '';
      setText(value, `${format(now, decimals)}${difference}`);
    });
  }

  /** @param {Signal} each @param {number} series */
  #chip({ name, label, about, kind, colour }, series) {
    const value = create('output', { textContent: '–' });
    const chip = create('button', { type: 'button', className: `curve ${kind}`, title: t('{}: show or hide', t(about)) }, create('span', { className: `swatch ${colour}` }), t(label), value);
    chip.setAttribute('aria-pressed', 'true');
    chip.addEventListener('click', () => {
      const show = chip.getAttribute('aria-pressed') !== 'true';
      chip.setAttribute('aria-pressed', String(show));
      this.plot.setSeries(series, { show });
    });
    return { chip, value, name };
  }

  /** @param {HTMLElement} body */
  #make(body) {
    const plot = new uPlot({
      ...commonOptions(this.#view),
      scales: { x: { time: false, auto: false }, y: { range: (_plot, low, high) => this.#limits(low, high) } },
      axes: [timeAxis(false), valueAxis()],
      series: [{}, ...this.#signals.map(curveOptions)],
      hooks: {
        setSelect: [(/** @type {uPlot} */ each) => this.#zoom(each)],
        setCursor: [() => this.#view.label()],
        drawAxes: [(/** @type {uPlot} */ each) => drawTransitions(each, this.#store, this.#view.range_s)],
        draw: [(/** @type {uPlot} */ each) => drawMark(each, this.#view.mark_s)],
      },
    }, [[], ...this.#signals.map(() => [])], body);
    makeNavigable(plot, this.#view);
    return plot;
  }

  /** What was dragged over becomes all that is seen. @param {uPlot} plot */
  #zoom(plot) {
    const { left, top, width, height } = plot.select;
    if (width < 4) return;
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    if (height < plot.over.clientHeight - 1) this.#zoomed = [plot.posToVal(top + height, 'y'), plot.posToVal(top, 'y')];
    this.#view.zoom(plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x'));
  }
}

/** Options that all plots share. @param {Plots} view */
export function commonOptions(view) {
  return {
    width: 600,
    height: 120,
    padding: /** @type {uPlot.Padding} */ ([6, 8, 0, 0]),
    legend: { show: false },
    cursor: {
      sync: { key: 'rumbo', setSeries: false },
      drag: { x: true, y: true, uni: BOX_PX, setScale: false },
      points: { size: 5 },
      bind: { dblclick: () => () => { view.follow(true); return null; } },
    },
  };
}

/** The wheel zooms in time, a click sets the mark. @param {uPlot} plot @param {Plots} view */
export function makeNavigable(plot, view) {
  plot.over.addEventListener('wheel', (event) => {
    event.preventDefault();
    view.scale(event.deltaY > 0 ? 1.25 : 0.8, plot.posToVal(event.offsetX, 'x'));
  }, { passive: false });
  /** @type {[number, number] | null} */
  let pressed = null;
  plot.over.addEventListener('pointerdown', (event) => { pressed = event.button === 0 ? [event.clientX, event.clientY] : null; });
  plot.over.addEventListener('click', (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 3 || event.detail > 1) return;
    view.mark(plot.posToVal(event.clientX - plot.over.getBoundingClientRect().left, 'x'));
  });
}

/** A faint line where the state changes. @param {uPlot} plot @param {Store} store @param {[number, number]} range_s */
function drawTransitions(plot, store, [from_s, to_s]) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.strokeStyle = colours.dim;
  ctx.globalAlpha = 0.45;
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([2 * devicePixelRatio, 4 * devicePixelRatio]);
  ctx.beginPath();
  for (const { from_s: at_s } of store.stretches.slice(1)) {
    if (at_s < from_s || at_s > to_s) continue;
    const x = Math.round(plot.valToPos(at_s, 'x', true));
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
  }
  ctx.stroke();
  ctx.restore();
}

/** The line that differences are counted from. @param {uPlot} plot @param {number | null} mark_s */
export function drawMark(plot, mark_s) {
  const { min, max } = plot.scales['x'] ?? {};
  if (mark_s === null || typeof min !== 'number' || typeof max !== 'number' || mark_s < min || mark_s > max) return;
  const { ctx, bbox } = plot;
  const x = Math.round(plot.valToPos(mark_s, 'x', true));
  ctx.save();
  ctx.strokeStyle = colours.goal;
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.setLineDash([]);
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

/**
 * Whether a curve has anything to show lately; the last lines may lack it.
 * @param {(number | null | undefined)[]} column
 */
function plottedIn(column) {
  for (let index = column.length - 1; index >= Math.max(0, column.length - 1_000); index--) {
    if (column[index] !== null && column[index] !== undefined) return true;
  }
  return false;
}

/** @param {Signal} each @returns {uPlot.Series} */
function curveOptions({ label, kind, colour }) {
  const reference = kind === 'reference';
  return {
    label,
    stroke: () => colours[colour],
    width: reference ? 1.5 : kind === 'true' ? 1 : 1.75,
    dash: reference ? [7, 4] : kind === 'true' ? [2, 2] : undefined,
    alpha: kind === 'true' ? 0.75 : 1,
    points: { show: false },
    paths: reference ? uPlot.paths.stepped?.({ align: 1 }) : uPlot.paths.linear?.(),
  };
}

/** @param {boolean} labelled @returns {uPlot.Axis} */
export function timeAxis(labelled) {
  return {
    stroke: () => colours.dim,
    grid: { stroke: () => colours.grid, width: 1 },
    ticks: { show: labelled, stroke: () => colours.grid, size: 4 },
    font: FONT,
    gap: 2,
    size: labelled ? 20 : 3,
    values: labelled ? (_plot, splits) => splits.map((t_s) => `${Number(t_s.toFixed(2))} s`) : () => [],
  };
}

/** @returns {uPlot.Axis} */
export function valueAxis() {
  return {
    stroke: () => colours.dim,
    grid: { stroke: () => colours.grid, width: 1 },
    ticks: { show: false },
    font: FONT,
    gap: 4,
    size: GUTTER_PX,
    space: 18,
  };
}
