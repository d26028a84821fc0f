// @ts-check
/** One plot: its curves, the numbers beside their names, its axis, and the pointer's actions. */
import uPlot from '../vendor/uplot/uPlot.js';
import { create, setText } from './dom.js';
import { drawExperiment } from './experiment.js';
import { curvesOf, linesOf } from './curves.js';
import { UNITS } from './signals.js';
import { t } from './text.js';
import { colours } from './theme.js';
import { watchFingers } from './touch.js';
import { format, formatShort } from './units.js';

/** @typedef {import('./plots.js').Plots} Plots */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./layout.js').PlotSpec} PlotSpec */
/** @typedef {import('./curves.js').Curve} Curve */

export const GUTTER_PX = 46;
export const FONT = '11px system-ui, sans-serif';
/** Right of the plot, where the time axis ends in half a label. */
const EDGE_PX = 22;
/** More changes of state than this hide the curves; the band shows them still. */
const MOST_TRANSITIONS = 60;
/** A drag that goes further than this along both axes is a box [px]. */
const BOX_PX = 25;
/** A curve without a value for so long, and with none in sight, has no name in the title [s]. */
const LATELY_S = 40;

export class PlotPanel {
  #view;
  #spec;
  #store;
  curves;
  /** Limits of the axes, left and right, while they are zoomed into. @type {[[number, number], [number, number] | null] | null} */
  #zoomed = null;
  #lock = create('button', { type: 'button', className: 'small', textContent: t('lock'), title: t('Hold the limits of the axis') });
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
    this.curves = curvesOf(spec);
    const body = create('div', { className: 'plot-body' });
    this.plot = this.#make(body);
    this.#chips = this.curves.map((each, index) => this.#chip(each, index + 1));
    this.head = this.#head();
    this.parts = [this.head, body];
  }

  get spec() {
    return this.#spec;
  }

  /** Unit of the axis on the left. */
  get unit() {
    return this.curves[0]?.unit ?? 'cm';
  }

  /** Unit of the axis on the right, if there is one. */
  get rightUnit() {
    return this.curves.at(-1)?.right ? this.curves.at(-1)?.unit ?? null : null;
  }

  #head() {
    const edit = create('button', { type: 'button', className: 'small', textContent: '…', title: t('Signals, axis and picture of this plot') });
    edit.setAttribute('aria-label', t('Change the plot {}', t(this.#spec.title)));
    edit.addEventListener('click', () => this.#view.edit(this));
    this.#lock.setAttribute('aria-pressed', String(this.#spec.min !== null));
    this.#lock.addEventListener('click', () => this.#toggleLock());
    const left = this.#chips.filter(({ right }) => !right);
    const right = this.#chips.filter((chip) => chip.right);
    const unit = this.rightUnit === null ? '' : create('i', { textContent: `${t(this.rightUnit)} ▸`, title: t('These have the axis on the right') });
    return create('div', { className: 'plot-head' }, create('b', { textContent: t(this.#spec.title) }), create('i', { textContent: t(this.unit) }),
      create('div', { className: 'plot-curves' }, ...left.map(({ chip }) => chip), unit, ...right.map(({ chip }) => chip)), this.#lock, edit);
  }

  #toggleLock() {
    const spans = ['y', 'right'].map((scale) => this.#span(scale));
    const [left, right] = this.#spec.min === null ? spans : [];
    this.#view.change(this.#spec, { ...this.#spec, min: left?.[0] ?? null, max: left?.[1] ?? null, right: right ?? null });
  }

  /** What is seen of an axis. @param {string} scale @returns {[number, number] | null} */
  #span(scale) {
    const { min, max } = this.plot.scales[scale] ?? {};
    return typeof min === 'number' && typeof max === 'number' ? [min, max] : null;
  }

  /** Resets zoomed axes. */
  resetAxis() {
    this.#zoomed = null;
  }

  /**
   * Limits of an axis, for what is in sight.
   * @param {boolean} right
   * @param {number | null} low
   * @param {number | null} high
   * @returns {[number, number]}
   */
  limits(right, low, high) {
    const { min, max, right: kept } = this.#spec;
    const zoomed = this.#zoomed?.[right ? 1 : 0];
    if (zoomed) return zoomed;
    if (right && kept) return kept;
    if (!right && min !== null && max !== null) return [min, max];
    // Whole steps, so that the axis does not jitter with the noise.
    const unit = UNITS[(right ? this.rightUnit : null) ?? this.unit];
    if (low === null || low === undefined || high === null) return [0, 10 * unit.step];
    const step = unit.free ? 10 ** Math.floor(Math.log10(Math.max(high - low, Math.abs(high) / 1_000, 1e-9))) : unit.step;
    return [Math.floor(low / step - 0.05) * step, Math.ceil(high / step + 0.05) * step];
  }

  draw() {
    const [min, max] = this.#view.range_s;
    this.plot.batch(() => {
      this.plot.setData(/** @type {uPlot.AlignedData} */ (linesOf(this.#store, this.curves, [min, max])), false);
      this.plot.setScale('x', { min, max });
    });
  }

  /** The numbers beside the names: at the pointer, else at the playhead or the newest; and how far from those at the mark. */
  label() {
    const { mark_s } = this.#view;
    const at_s = this.#view.pointed_s ?? this.#store.playhead_s;
    for (const { chip, value, name, unit } of this.#chips) {
      const { decimals } = UNITS[unit];
      const table = this.#store.tableOf(name);
      const unused = !table.knowsIn(name, (table.t.at(-1) ?? 0) - LATELY_S) && !table.knowsIn(name, ...this.#view.range_s);
      if (chip.hidden !== unused) chip.hidden = unused;
      // What is drawn may be thinned.
      const now = table.at(name, at_s);
      const then = mark_s === null ? null : table.at(name, mark_s);
      const difference = typeof now === 'number' && typeof then === 'number' ? ` Δ ${format(now - then, decimals)}` : '';
      setText(value, `${format(now, decimals)}${difference}`);
    }
  }

  /** @param {Curve} each @param {number} series */
  #chip({ name, label, about, kind, colour, unit, right }, series) {
    const value = create('output', { textContent: '–' });
    const chip = create('button', { type: 'button', className: `curve ${kind}`, title: t('{}: show or hide', about) }, create('span', { className: `swatch ${colour}` }), label, value);
    chip.setAttribute('aria-pressed', 'true');
    chip.addEventListener('click', () => {
      const show = chip.getAttribute('aria-pressed') !== 'true';
      chip.setAttribute('aria-pressed', String(show));
      this.plot.setSeries(series, { show });
    });
    return { chip, value, name, unit, right };
  }

  /** @param {HTMLElement} body */
  #make(body) {
    const right = this.rightUnit !== null;
    /** @type {uPlot.Scales} */
    const scales = { x: { time: false, auto: false }, y: { range: (_plot, low, high) => this.limits(false, low, high) } };
    if (right) scales['right'] = { range: (_plot, low, high) => this.limits(true, low, high) };
    const plot = new uPlot({
      ...commonOptions(this.#view, right),
      scales,
      axes: [timeAxis(false), valueAxis(), ...(right ? [{ ...valueAxis(), scale: 'right', side: /** @type {uPlot.Axis.Side} */ (1), grid: { show: false } }] : [])],
      series: [{}, ...this.curves.map(curveOptions)],
      hooks: {
        setSelect: [(/** @type {uPlot} */ each) => this.#zoom(each)],
        setCursor: [() => this.#view.label()],
        drawAxes: [(/** @type {uPlot} */ each) => {
          this.#view.overlay.draw(each, this.curves, this.#store, this.#view.range_s);
          if (this.#store.limits) drawExperiment(each, this.unit, this.#store, this.#view.range_s);
          drawTransitions(each, this.#store, this.#view.range_s);
        }],
        draw: [(/** @type {uPlot} */ each) => {
          drawLine(each, this.#view.mark_s, colours.goal);
          drawLine(each, this.#store.playhead_s, colours.text);
          const isPlotted = (/** @type {Curve} */ { name }, /** @type {number} */ index) => each.series[index + 1]?.show && this.#store.tableOf(name).knowsIn(name, ...this.#view.range_s);
          if (!this.curves.some(isPlotted)) drawNothing(each);
        }],
      },
    }, [[], ...this.curves.map(() => [])], body);
    makeNavigable(plot, this.#view);
    return plot;
  }

  /** Zooms to the dragged box. @param {uPlot} plot */
  #zoom(plot) {
    const { left, top, width, height } = plot.select;
    if (width < 4) return;
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    /** @param {string} scale @returns {[number, number]} */
    const span = (scale) => [plot.posToVal(top + height, scale), plot.posToVal(top, scale)];
    if (height < plot.over.clientHeight - 1) this.#zoomed = [span('y'), this.rightUnit === null ? null : span('right')];
    this.#view.zoom(plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x'));
  }
}

/**
 * Options that all plots share: one of them with an axis on the right, and all leave room there, so that times stand above each other.
 * @param {Plots} view
 * @param {boolean} right The plot has an axis on the right.
 */
export function commonOptions(view, right) {
  return {
    width: 600,
    height: 120,
    padding: /** @type {uPlot.Padding} */ ([6, () => (right ? 4 : view.rightAxis ? GUTTER_PX + 4 : EDGE_PX), 0, 0]),
    legend: { show: false },
    cursor: {
      sync: { key: 'rumbo', setSeries: false },
      drag: { x: true, y: true, uni: BOX_PX, setScale: false },
      points: { size: 5 },
      bind: { dblclick: () => () => { view.follow(true); return null; } },
    },
  };
}

/** The wheel zooms in time, as two fingers do; one finger moves in time, a click sets the mark. @param {uPlot} plot @param {Plots} view */
export function makeNavigable(plot, view) {
  plot.over.addEventListener('wheel', (event) => {
    event.preventDefault();
    view.scale(event.deltaY > 0 ? 1.25 : 0.8, plot.posToVal(event.offsetX, 'x'));
  }, { passive: false });
  watchFingers(plot.over, (dx_px) => {
    const by_s = plot.posToVal(0, 'x') - plot.posToVal(dx_px, 'x');
    view.zoom(view.range_s[0] + by_s, view.range_s[1] + by_s);
  }, (factor, { x }) => view.scale(1 / factor, plot.posToVal(x, 'x')));
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
  const changes = store.stretches.slice(1).filter((stretch) => stretch.from_s >= from_s && stretch.from_s <= to_s);
  if (changes.length > MOST_TRANSITIONS) return;
  ctx.save();
  ctx.strokeStyle = colours.dim;
  ctx.globalAlpha = 0.45;
  ctx.lineWidth = devicePixelRatio;
  ctx.setLineDash([2 * devicePixelRatio, 4 * devicePixelRatio]);
  ctx.beginPath();
  for (const { from_s: at_s } of changes) {
    const x = Math.round(plot.valToPos(at_s, 'x', true));
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
  }
  ctx.stroke();
  ctx.restore();
}

/** Shows that nothing is plotted, so that an empty plot is not mistaken for a broken one. @param {uPlot} plot */
function drawNothing({ ctx, bbox }) {
  ctx.save();
  ctx.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.fillStyle = colours.dim;
  ctx.textAlign = 'center';
  ctx.textBaseline = 'middle';
  ctx.fillText(t('nothing to plot here'), bbox.left + bbox.width / 2, bbox.top + bbox.height / 2);
  ctx.restore();
}

/** An upright line: the mark, from which differences are counted, or a replay's playhead. @param {uPlot} plot @param {number | null} at_s @param {string} colour */
export function drawLine(plot, at_s, colour) {
  const { min, max } = plot.scales['x'] ?? {};
  if (at_s === null || typeof min !== 'number' || typeof max !== 'number' || at_s < min || at_s > max) return;
  const { ctx, bbox } = plot;
  const x = Math.round(plot.valToPos(at_s, 'x', true));
  ctx.save();
  ctx.strokeStyle = colour;
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.setLineDash([]);
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.restore();
}

/** @param {Curve} each @returns {uPlot.Series} */
function curveOptions({ label, kind, colour, right }) {
  const reference = kind === 'reference';
  return {
    label,
    scale: right ? 'right' : 'y',
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
    values: labelled ? (_plot, splits) => splits.map((t_s) => `${formatShort(Number(t_s.toFixed(2)))} s`) : () => [],
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
    values: (_plot, splits) => splits.map((value) => formatShort(Number(value.toFixed(6)))),
    space: 18,
  };
}
