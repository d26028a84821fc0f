// @ts-check
/** The band below the plots: the states of the mode's machine along the time axis. */
import uPlot from '../vendor/uplot/uPlot.js';
import { create } from './dom.js';
import { commonOptions, drawLine, makeNavigable, timeAxis, valueAxis } from './plot.js';
import { stateWords } from './stateline.js';
import { t } from './text.js';
import { STATE_COLOURS, colours, stateColour } from './theme.js';

/** @typedef {import('./store.js').Stretch} Stretch */

export const BAND_PX = 46;

export class StateBand {
  #store;
  #view;
  plot;
  body = create('div', { className: 'plot-body', id: 'band' });

  /** @param {import('./store.js').Store} store @param {import('./plots.js').Plots} view */
  constructor(store, view) {
    this.#store = store;
    this.#view = view;
    this.plot = new uPlot({
      ...commonOptions(view, false),
      scales: { x: { time: false, auto: false }, y: { range: [0, 1] } },
      axes: [timeAxis(true), { ...valueAxis(), values: () => [], grid: { show: false } }],
      series: [{}, { show: false }],
      hooks: {
        setSelect: [(/** @type {uPlot} */ plot) => {
          const { left, width } = plot.select;
          plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          if (width >= 4) view.zoom(plot.posToVal(left, 'x'), plot.posToVal(left + width, 'x'));
        }],
        setCursor: [() => view.label()],
        drawAxes: [(/** @type {uPlot} */ plot) => this.#draw(plot)],
        draw: [(/** @type {uPlot} */ plot) => {
          drawLine(plot, view.mark_s, colours.goal);
          drawLine(plot, store.playhead_s, colours.text);
        }],
      },
    }, [[], []], this.body);
    makeNavigable(this.plot, view);
  }

  draw() {
    const [min, max] = this.#view.range_s;
    const table = this.#store.slow;
    this.plot.batch(() => {
      this.plot.setData([table.t, table.columns.get('left_pwm') ?? []], false);
      this.plot.setScale('x', { min, max });
    });
  }

  /** @param {uPlot} plot */
  #draw(plot) {
    const { ctx, bbox } = plot;
    const [from_s, to_s] = this.#view.range_s;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textBaseline = 'middle';
    ctx.textAlign = 'right';
    ctx.fillStyle = colours.dim;
    if (this.#store.stretches.length > 0) ctx.fillText(t('state'), bbox.left - 4 * devicePixelRatio, bbox.top + bbox.height / 2);
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    ctx.textAlign = 'left';
    const letter = ctx.measureText('n').width;
    for (const stretch of this.#store.stretches) {
      if (stretch.to_s < from_s || stretch.from_s > to_s) continue;
      const left = plot.valToPos(Math.max(stretch.from_s, from_s), 'x', true);
      const right = plot.valToPos(Math.min(stretch.to_s, to_s), 'x', true);
      // More states than colours: the later ones are paler, and each begins with a line.
      ctx.globalAlpha = stretch.faulted ? 0.55 : stretch.armed ? ((stretch.state ?? 0) < STATE_COLOURS ? 0.55 : 0.3) : 0.25;
      ctx.fillStyle = stretch.faulted ? colours.bad : stretch.armed ? stateColour(stretch.state ?? 0) : colours.dim;
      ctx.fillRect(left, bbox.top, right - left, bbox.height);
      ctx.globalAlpha = 1;
      // Where states are short there is no room for a line between them.
      ctx.fillStyle = colours.panel;
      if (right - left > 4 * devicePixelRatio) ctx.fillRect(left, bbox.top, devicePixelRatio, bbox.height);
      const name = shortened(this.#name(stretch), Math.floor((right - left - 8) / letter));
      ctx.fillStyle = colours.text;
      if (name !== '') ctx.fillText(name, left + 4, bbox.top + bbox.height / 2, right - left - 6);
    }
    ctx.restore();
  }

  /** The state at a time, as text. @param {number} t_s */
  nameAt(t_s) {
    const stretch = this.#store.stretches.find(({ to_s }) => t_s <= to_s);
    return stretch && t_s >= stretch.from_s - 0.1 ? this.#name(stretch) : '';
  }

  /** @param {Stretch} stretch */
  #name(stretch) {
    const mode = this.#view.modes.find((each) => each.id === stretch.mode);
    const state = stretch.faulted ? t('fault') : stretch.armed ? stateWords(mode, stretch.state) : t('off');
    return `${stretch.mode}: ${state}`;
  }
}

/** The name of a state in so many letters: without its mode, then its beginning; below four letters nothing. @param {string} name @param {number} most */
function shortened(name, most) {
  const own = name.replace(/^\d+: /, '');
  return name.length <= most ? name : own.length <= most ? own : most < 4 ? '' : `${own.slice(0, most - 1).trimEnd()}…`;
}
