// @ts-check
/**
 * The plots: one time axis, cursors in step. The view follows the newest data, or holds still while data goes on arriving.
 */
import uPlot from '../vendor/uplot/uPlot.js';
import { create, element, setText } from './dom.js';
import { OF_MODE, PLOTS } from './plot_specs.js';
import { said, t } from './text.js';
import { STATE_COLOURS, colours, onThemeChange, stateColour } from './theme.js';
import { format } from './units.js';

/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./store.js').Stretch} Stretch */
/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./plot_specs.js').Curve} Curve */
/** @typedef {import('./plot_specs.js').PlotSpec} PlotSpec */

const GUTTER_PX = 46;
const FONT = '11px system-ui, sans-serif';
const BAND_PX = 46;
/** Height of a plot's title, as in the style sheet. */
const HEAD_PX = 20;
const SYNC = 'rumbo';
/** Shortest time that can be zoomed into [s]. */
const MIN_WINDOW_S = 0.2;

/** One plot on the page with its curves' buttons. */
class Panel {
  /** @param {HTMLElement[]} parts @param {uPlot} plot @param {() => void} fill @param {() => void} label */
  constructor(parts, plot, fill, label) {
    this.parts = parts;
    this.shown = true;
    this.plot = plot;
    this.fill = fill;
    this.label = label;
  }
}

export class Plots {
  #root;
  #store;
  /** @type {Panel[]} */
  #panels = [];
  #choices = element('plot-choice', HTMLDivElement);
  /** The mode the plots are shown for. */
  #mode = -1;
  /** The plots chosen in a mode, while the page lives. @type {Map<number, string[]>} */
  #chosen = new Map();
  #window_s = 20;
  #following = true;
  /** @type {[number, number]} */
  #range_s = [0, 20];
  /** @type {ModeEntry[]} */
  modes = [];
  #onFollow;
  #redraw;

  /**
   * @param {HTMLElement} root
   * @param {Store} store
   * @param {() => void} redraw asks for a frame
   * @param {(following: boolean) => void} onFollow
   */
  constructor(root, store, redraw, onFollow) {
    this.#root = root;
    this.#store = store;
    this.#redraw = redraw;
    this.#onFollow = onFollow;
    for (const spec of PLOTS) this.#panels.push(this.#plotPanel(spec));
    this.#panels.push(this.#bandPanel());
    this.#offerChoices();
    this.setMode(0);
    new ResizeObserver(() => this.#fit()).observe(root);
    this.#fit();
    onThemeChange(() => this.draw());
  }

  get following() {
    return this.#following;
  }

  /** @param {boolean} following */
  follow(following) {
    this.#following = following;
    this.#onFollow(following);
    this.#redraw();
  }

  /** @param {number} window_s */
  setWindow(window_s) {
    this.#window_s = window_s;
    this.follow(true);
  }

  /**
   * @param {number} from_s
   * @param {number} to_s
   */
  #zoom(from_s, to_s) {
    if (to_s - from_s < MIN_WINDOW_S) return;
    this.#range_s = [from_s, to_s];
    this.follow(false);
  }

  draw() {
    const newest_s = this.#store.slow.t.at(-1);
    if (this.#following) {
      const to_s = Math.max(newest_s ?? 0, this.#window_s);
      this.#range_s = [to_s - this.#window_s, to_s];
    }
    const [min, max] = this.#range_s;
    for (const panel of this.#panels) {
      if (!panel.shown) continue;
      panel.plot.batch(() => {
        panel.fill();
        panel.plot.setScale('x', { min, max });
      });
      panel.label();
    }
  }

  /** Shows the plots that the mode begins with, or those that were chosen in it. @param {number} mode */
  setMode(mode) {
    if (mode === this.#mode) return;
    this.#mode = mode;
    this.#show(this.#chosen.get(mode) ?? OF_MODE[mode] ?? OF_MODE[0] ?? []);
  }

  /** @param {string[]} titles */
  #show(titles) {
    PLOTS.forEach((spec, index) => {
      const panel = this.#panels[index];
      if (!panel) return;
      panel.shown = titles.includes(spec.title);
      for (const part of panel.parts) part.hidden = !panel.shown;
    });
    for (const choice of this.#choices.querySelectorAll('button')) choice.setAttribute('aria-pressed', String(titles.includes(choice.value)));
    this.#fit();
    this.#redraw();
  }

  /** One button for each plot: shown or not. */
  #offerChoices() {
    this.#choices.replaceChildren(...PLOTS.map(({ title }, index) => {
      const button = create('button', { type: 'button', value: title, textContent: t(title), title: t('Plot {}, or not', t(title)) });
      button.addEventListener('click', () => {
        const titles = PLOTS.filter((_spec, each) => (each === index) !== this.#panels[each]?.shown).map((spec) => spec.title);
        this.#chosen.set(this.#mode, titles);
        this.#show(titles);
      });
      return button;
    }));
  }

  #fit() {
    const width = this.#root.clientWidth;
    const shown = PLOTS.filter((_spec, index) => this.#panels[index]?.shown);
    const weights = shown.reduce((sum, spec) => sum + spec.weight, 0);
    const free_px = this.#root.clientHeight - BAND_PX - shown.length * HEAD_PX;
    this.#panels.forEach((panel, index) => {
      const weight = PLOTS[index]?.weight;
      if (!panel.shown) return;
      const height = weight === undefined ? BAND_PX : Math.max(50, Math.floor((free_px * weight) / weights));
      panel.plot.setSize({ width, height });
    });
  }

  /** @param {PlotSpec} spec */
  #plotPanel(spec) {
    const table = this.#store[spec.table];
    const data = /** @type {uPlot.AlignedData} */ ([table.t, ...spec.curves.map((curve) => table.columns.get(curve.name) ?? [])]);
    const head = create('div', { className: 'plot-head' }, create('b', { textContent: t(spec.title) }), create('i', { textContent: t(spec.unit) }));
    const body = create('div', { className: 'plot-body' });
    this.#root.append(head, body);

    const step = spec.step;
    const plot = new uPlot({
      ...this.#common(),
      scales: {
        x: { time: false, auto: false },
        // Whole steps, so that the axis does not tremble with the noise.
        y: { range: (_plot, low, high) => (low === null || low === undefined ? [0, 10 * step] : [Math.floor(low / step - 0.05) * step, Math.ceil(high / step + 0.05) * step]) },
      },
      axes: [timeAxis(false), valueAxis()],
      series: [{}, ...spec.curves.map(curveOptions)],
    }, data, body);
    this.#makeNavigable(plot);

    const chips = spec.curves.map((curve, index) => {
      const value = create('output', { textContent: '–' });
      const chip = create('button', { type: 'button', className: `curve ${curve.kind}`, title: t('{}: show or hide', t(curve.label)) }, create('span', { className: `swatch ${curve.colour}` }), t(curve.label), value);
      chip.setAttribute('aria-pressed', 'true');
      chip.addEventListener('click', () => {
        const show = chip.getAttribute('aria-pressed') !== 'true';
        chip.setAttribute('aria-pressed', String(show));
        plot.setSeries(index + 1, { show });
      });
      head.append(chip);
      return { chip, value, column: /** @type {(number | null | undefined)[]} */ (data[index + 1]) };
    });
    const label = () => {
      const at = plot.cursor.idx ?? table.t.length - 1;
      for (const { chip, value, column } of chips) {
        const unused = !plottedIn(column);
        if (chip.hidden !== unused) chip.hidden = unused;
        setText(value, format(column[at] ?? column[at - 1], spec.decimals));
      }
    };
    return new Panel([head, body], plot, () => plot.setData(data, false), label);
  }

  /** The states of the mode's machine, along the time axis. */
  #bandPanel() {
    const body = create('div', { className: 'plot-body' });
    this.#root.append(body);
    const table = this.#store.slow;
    const data = /** @type {uPlot.AlignedData} */ ([table.t, table.columns.get('left_pwm') ?? []]);
    const options = this.#common();
    const plot = new uPlot({
      ...options,
      scales: { x: { time: false, auto: false }, y: { range: [0, 1] } },
      axes: [timeAxis(true), { ...valueAxis(), values: () => [], grid: { show: false }, label: t('state'), labelSize: 14, labelFont: FONT, size: GUTTER_PX - 14 }],
      series: [{}, { show: false }],
      hooks: { ...options.hooks, drawAxes: [(/** @type {uPlot} */ each) => this.#drawBand(each)] },
    }, data, body);
    this.#makeNavigable(plot);
    return new Panel([body], plot, () => plot.setData(data, false), () => {});
  }

  /** @param {uPlot} plot */
  #drawBand(plot) {
    const { ctx, bbox } = plot;
    const [from_s, to_s] = this.#range_s;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textBaseline = 'middle';
    ctx.textAlign = 'left';
    for (const stretch of this.#store.stretches) {
      if (stretch.to_s < from_s || stretch.from_s > to_s) continue;
      const left = plot.valToPos(Math.max(stretch.from_s, from_s), 'x', true);
      const right = plot.valToPos(Math.min(stretch.to_s, to_s), 'x', true);
      // More states than colours: the later ones are paler, and each begins with a line.
      ctx.globalAlpha = stretch.faulted ? 0.55 : stretch.armed ? (stretch.state < STATE_COLOURS ? 0.55 : 0.3) : 0.25;
      ctx.fillStyle = stretch.faulted ? colours.bad : stretch.armed ? stateColour(stretch.state) : colours.dim;
      ctx.fillRect(left, bbox.top, right - left, bbox.height);
      ctx.globalAlpha = 1;
      ctx.fillStyle = colours.panel;
      ctx.fillRect(left, bbox.top, devicePixelRatio, bbox.height);
      const name = this.#stretchName(stretch);
      if (ctx.measureText(name).width + 8 < right - left) {
        ctx.fillStyle = colours.text;
        ctx.fillText(name, left + 4, bbox.top + bbox.height / 2);
      }
    }
    ctx.restore();
  }

  /** @param {Stretch} stretch */
  #stretchName(stretch) {
    const mode = this.modes.find((each) => each.id === stretch.mode);
    const state = stretch.faulted ? t('fault') : stretch.armed ? said(mode?.states[stretch.state] ?? `state ${stretch.state}`) : t('off');
    return `${stretch.mode}: ${state}`;
  }

  /** Options that all plots share. */
  #common() {
    return {
      width: 600,
      height: 120,
      padding: /** @type {uPlot.Padding} */ ([6, 8, 0, 0]),
      legend: { show: false },
      cursor: {
        sync: { key: SYNC, setSeries: false },
        drag: { x: true, y: false, setScale: false },
        points: { size: 5 },
        bind: { dblclick: () => () => { this.follow(true); return null; } },
      },
      hooks: {
        setSelect: [(/** @type {uPlot} */ plot) => {
          const { left, width } = plot.select;
          if (width < 4) return;
          this.#zoom(plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x'));
          plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        }],
        setCursor: [() => this.#redrawLabels()],
      },
    };
  }

  /** A moved cursor changes the numbers shown, not the curves. */
  #redrawLabels() {
    for (const panel of this.#panels) if (panel.shown) panel.label();
  }

  /** @param {uPlot} plot */
  #makeNavigable(plot) {
    plot.over.addEventListener('wheel', (event) => {
      event.preventDefault();
      const [from_s, to_s] = this.#range_s;
      const factor = event.deltaY > 0 ? 1.25 : 0.8;
      const at_s = this.#following ? to_s : plot.posToVal(event.offsetX, 'x');
      if (this.#following) {
        this.#window_s = Math.min(300, Math.max(MIN_WINDOW_S, this.#window_s * factor));
        this.#redraw();
      } else {
        this.#zoom(at_s - (at_s - from_s) * factor, at_s + (to_s - at_s) * factor);
      }
    }, { passive: false });
  }
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

/** @param {Curve} curve @returns {uPlot.Series} */
function curveOptions(curve) {
  const reference = curve.kind === 'reference';
  return {
    label: curve.label,
    stroke: () => colours[curve.colour],
    width: reference ? 1.5 : curve.kind === 'true' ? 1 : 1.75,
    dash: reference ? [7, 4] : curve.kind === 'true' ? [2, 2] : undefined,
    alpha: curve.kind === 'true' ? 0.75 : 1,
    points: { show: false },
    paths: reference ? uPlot.paths.stepped?.({ align: 1 }) : uPlot.paths.linear?.(),
  };
}

/** @param {boolean} labelled @returns {uPlot.Axis} */
function timeAxis(labelled) {
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
function valueAxis() {
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
