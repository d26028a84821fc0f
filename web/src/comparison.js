// @ts-check
/** Two recordings side by side: a signal of both over one time axis, their metrics, and the parameters that differ. */
import uPlot from '../vendor/uplot/uPlot.js';
import { create, element } from './dom.js';
import { FONT } from './plot.js';
import { SIGNALS } from './signals.js';
import { Store } from './store.js';
import { t } from './text.js';
import { colours } from './theme.js';
import { format } from './units.js';

/** @typedef {import('./types.js').RecordingContent} Content */
/** @typedef {import('./table.js').Column} Column */

const HEIGHT_PX = 260;

export class Comparison {
  #signal = create('select', { id: 'compare-signal' });
  #legend = create('p', { className: 'row' });
  #plot = create('div');
  #tables = create('div', { className: 'compare-tables' });
  body = create('section', { id: 'comparison', hidden: true }, create('div', { className: 'row' }, create('label', {}, `${t('signal')} `, this.#signal), this.#legend), this.#plot, this.#tables);
  /** @type {Store[]} */
  #stores = [];
  /** @type {uPlot | null} */
  #drawn = null;

  constructor() {
    this.#signal.addEventListener('change', () => this.#draw());
  }

  clear() {
    this.body.hidden = true;
    this.#drawn?.destroy();
    this.#drawn = null;
  }

  /** @param {Content[]} contents @param {import('./types.js').ModeEntry[]} modes */
  show(contents, modes) {
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
    this.#legend.replaceChildren(...contents.flatMap(({ name }, index) => [create('span', { className: `swatch ${index === 0 ? 'left' : 'right'}` }), name]));
    const [one, other] = contents;
    if (!one || !other) return;
    const metrics = Object.keys({ ...one.metrics, ...other.metrics }).sort();
    const parameters = Object.keys(one.parameters).filter((name) => name in other.parameters && one.parameters[name] !== other.parameters[name]);
    this.#tables.replaceChildren(
      table(t('metric'), metrics, one.metrics, other.metrics),
      table(t('parameter that differs'), parameters, one.parameters, other.parameters),
    );
    this.#draw();
    this.body.scrollIntoView({ block: 'nearest' });
  }

  #draw() {
    this.#drawn?.destroy();
    this.#drawn = null;
    const name = this.#signal.value;
    if (name === '') return this.#plot.replaceChildren(t('the two have no signal in common'));
    this.#plot.replaceChildren();
    const lines = this.#stores.map((store) => store.series(name));
    const data = uPlot.join(/** @type {uPlot.AlignedData[]} */ (lines.map((each) => [each.t, each.y])));
    const stroke = /** @type {const} */ (['left', 'right']);
    this.#drawn = new uPlot({
      width: Math.max(260, element('recordings-dialog', HTMLDialogElement).clientWidth - 40),
      height: HEIGHT_PX,
      legend: { show: false },
      scales: { x: { time: false } },
      axes: [0, 1].map(() => ({ stroke: () => colours.dim, font: FONT, grid: { stroke: () => colours.grid, width: 1 } })),
      series: [{}, ...stroke.map((colour) => ({ stroke: () => colours[colour], width: 1.75, spanGaps: true, points: { show: false } }))],
    }, data, this.#plot);
    return undefined;
  }
}

/** @param {Store} store @param {string} name */
const has = (store, name) => store.tableOf(name).columns.get(name)?.some((value) => typeof value === 'number') ?? false;

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
