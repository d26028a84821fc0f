// @ts-check
/** Two recordings side by side, from power-on, from ON or from a step: a signal of both, figures of their steps, metrics, and the parameters that differ. */
import uPlot from '../vendor/uplot/uPlot.js';
import { create, element } from './dom.js';
import { FONT } from './plot.js';
import { SIGNALS } from './signals.js';
import { figures } from './step.js';
import { Store } from './store.js';
import { t } from './text.js';
import { colours } from './theme.js';
import { format } from './units.js';

/** @typedef {import('./types.js').RecordingContent} Content */
/** @typedef {import('./table.js').Column} Column */

const HEIGHT_PX = 260;

export class Comparison {
  #signal = create('select', { id: 'compare-signal' });
  #align = create('select', { id: 'compare-align' });
  #legend = create('p', { className: 'row' });
  #plot = create('div');
  #tables = create('div', { className: 'compare-tables' });
  body = create('section', { id: 'comparison', hidden: true }, create('div', { className: 'row' }, create('label', {}, `${t('signal')} `, this.#signal), create('label', {}, `${t('time from')} `, this.#align), this.#legend), this.#plot, this.#tables);
  /** @type {Store[]} */
  #stores = [];
  /** @type {uPlot | null} */
  #drawn = null;

  constructor() {
    for (const select of [this.#signal, this.#align]) select.addEventListener('change', () => this.#draw());
  }

  clear() {
    this.body.hidden = true;
    this.#drawn?.destroy();
    this.#drawn = null;
  }

  /** @param {Content[]} contents @param {import('./types.js').ModeEntry[]} modes @param {string[]} names what people call them */
  show(contents, modes, names) {
    this.clear();
    this.body.hidden = false;
    this.#stores = contents.map(({ columns, rows }) => {
      const store = new Store();
      store.begin(columns, modes);
      for (const row of rows) store.push(row);
      return store;
    });
    const both = SIGNALS.filter(({ name }) => this.#stores.every((store) => has(store, name)));
    this.#signal.replaceChildren(...both.map(({ name, about, unit }) => create('option', { value: name, textContent: `${t(about)} [${t(unit)}]` })));
    const first = both.find(({ name }) => name === 'range_front_cm') ?? both.find(({ name }) => name === 'left_rpm');
    if (first) this.#signal.value = first.name;
    this.#legend.replaceChildren(...names.flatMap((name, index) => [create('span', { className: `swatch ${index === 0 ? 'left' : 'right'}` }), `${index + 1}: ${name}`]));
    const [one, other] = contents;
    if (!one || !other) return;
    const steps = Math.min(...this.#stores.map((store) => store.steps.length));
    const armed = this.#stores.every((store) => store.stretches.some((stretch) => stretch.armed));
    this.#align.replaceChildren(create('option', { value: '', textContent: t('power-on') }), ...(armed ? [create('option', { value: 'on', textContent: 'ON', selected: true })] : []),
      ...Array.from({ length: steps }, (_, index) => create('option', { value: String(index), textContent: t('step {}', index + 1) })));
    const metrics = Object.keys({ ...one.metrics, ...other.metrics }).sort();
    const parameters = Object.keys(one.parameters).filter((name) => name in other.parameters && one.parameters[name] !== other.parameters[name]);
    this.#tables.replaceChildren(
      stepTable(this.#stores, steps),
      table(t('metric'), metrics, one.metrics, other.metrics),
      table(t('parameter that differs'), parameters, one.parameters, other.parameters),
    );
    this.#draw();
    this.body.scrollIntoView({ block: 'nearest' });
  }

  /** Where its time counts from [s]. @param {Store} store */
  #begin(store) {
    if (this.#align.value === '') return 0;
    if (this.#align.value === 'on') return store.stretches.find(({ armed }) => armed)?.from_s ?? 0;
    return store.steps[Number(this.#align.value)]?.from_s ?? 0;
  }

  #draw() {
    this.#drawn?.destroy();
    this.#drawn = null;
    const name = this.#signal.value;
    if (name === '') return this.#plot.replaceChildren(t('the two have no signal in common'));
    this.#plot.replaceChildren();
    const lines = this.#stores.map((store) => {
      const { t: times, y } = store.series(name);
      const from_s = this.#begin(store);
      return { t: times.map((t_s) => t_s - from_s), y };
    });
    const { about = '', unit = 'cm' } = SIGNALS.find((each) => each.name === name) ?? {};
    const data = uPlot.join(/** @type {uPlot.AlignedData[]} */ (lines.map((each) => [each.t, each.y])));
    const stroke = /** @type {const} */ (['left', 'right']);
    this.#drawn = new uPlot({
      width: Math.max(260, element('recordings-dialog', HTMLDialogElement).clientWidth - 40),
      height: HEIGHT_PX,
      legend: { show: false },
      scales: { x: { time: false } },
      axes: [t('time [s]'), `${t(about)} [${t(unit)}]`].map((label) => ({ label, labelFont: FONT, labelSize: 16, stroke: () => colours.dim, font: FONT, grid: { stroke: () => colours.grid, width: 1 } })),
      series: [{}, ...stroke.map((colour) => ({ stroke: () => colours[colour], width: 1.75, spanGaps: true, points: { show: false } }))],
    }, data, this.#plot);
    return undefined;
  }
}

/** @param {Store} store @param {string} name */
const has = (store, name) => store.tableOf(name).columns.get(name)?.some((value) => typeof value === 'number') ?? false;

/** Figures of the steps of both. @param {Store[]} stores @param {number} steps */
function stepTable(stores, steps) {
  /** @type {Record<string, number | null>[]} */
  const [one = {}, other = {}] = stores.map((store) => Object.fromEntries(store.steps.slice(0, steps).flatMap((step, index) => {
    const { unit, rise_s, overshoot, settling_s, steady_error } = figures(store, step);
    const rows = [[t('rise'), 's', rise_s], [t('overshoot'), unit, overshoot], [t('settling'), 's', settling_s], [t('steady error'), unit, steady_error]];
    return rows.map(([name, of, value]) => [`${t('step {}', index + 1)}: ${name} [${of}]`, Number.isFinite(value) ? Number(value) : null]);
  })));
  return table(t('step'), Object.keys(one), one, other);
}

/**
 * Values of both, and the difference.
 * @param {string} title @param {string[]} names @param {Record<string, number | null>} one @param {Record<string, number | null>} other
 */
function table(title, names, one, other) {
  const number = (/** @type {number | null | undefined} */ value) => (typeof value === 'number' ? format(value, Math.abs(value) < 1 ? 4 : 2) : t('never'));
  const rows = names.map((name) => {
    const [a, b] = [one[name], other[name]];
    const difference = typeof a === 'number' && typeof b === 'number' ? number(b - a) : '';
    return create('tr', {}, create('td', { textContent: name }), create('td', { textContent: number(a) }), create('td', { textContent: number(b) }), create('td', { textContent: difference }));
  });
  const head = create('tr', {}, ...[title, '1', '2', '2 − 1'].map((textContent) => create('th', { textContent, scope: 'col' })));
  return names.length === 0 ? '' : create('table', {}, create('thead', {}, head), create('tbody', {}, ...rows));
}
