// @ts-check
/** Runs side by side, from power-on, from ON or from a step: a signal of all, figures of their steps, metrics, and what differs. */
import uPlot from '../vendor/uplot/uPlot.js';
import { create } from './dom.js';
import { begin_s, differences, on_s, stepsOf } from './kept.js';
import { FONT, valueAxis } from './plot.js';
import { SIGNALS } from './signals.js';
import { figures } from './step.js';
import { said, t } from './text.js';
import { colours } from './theme.js';
import { formatShort } from './units.js';

/** @typedef {import('./kept.js').Run} Run */
/** @typedef {import('./store.js').Store} Store */
/** @typedef {string | number | null | undefined} Value */

const HEIGHT_PX = 260;
const BEFORE_S = 1;
/** Of the runs, in turn; from the sixth on dashed. */
const INKS = /** @type {const} */ (['left', 'right', 'front', 'goal', 'reference']);

export class Comparison {
  #signal = create('select', { id: 'compare-signal' });
  #align = create('select', { id: 'compare-align' });
  #legend = create('p', { className: 'row' });
  #plot = create('div');
  #tables = create('div', { className: 'compare-tables' });
  body = create('section', { id: 'comparison', hidden: true }, create('div', { className: 'row' }, create('label', {}, `${t('signal')} `, this.#signal), create('label', {}, `${t('time from')} `, this.#align)), this.#legend, this.#plot, this.#tables);
  /** @type {Run[]} */
  #runs = [];
  /** @type {uPlot | null} */
  #drawn = null;

  constructor() {
    for (const select of [this.#signal, this.#align]) select.addEventListener('change', () => this.#draw());
  }

  /** @param {Run[]} runs */
  show(runs) {
    this.body.hidden = runs.length === 0;
    if (runs.length === 0) return;
    this.#runs = runs;
    const chosen = this.#signal.value;
    const all = SIGNALS.filter(({ name }) => runs.every(({ store }) => has(store, name)));
    this.#signal.replaceChildren(...all.map(({ name, about, unit }) => create('option', { value: name, textContent: `${t(about)} [${t(unit)}]` })));
    const first = [chosen, 'range_front_cm', 'left_rpm'].find((wanted) => all.some(({ name }) => name === wanted));
    if (first) this.#signal.value = first;
    this.#legend.replaceChildren(...runs.map(({ name }, index) => create('span', {}, create('span', { className: `swatch ${ink(index)}${index >= INKS.length ? ' dashed' : ''}` }), ` ${index + 1}: ${name}`)));
    const steps = Math.min(...runs.map(({ store }) => stepsOf(store).length));
    const armed = runs.every(({ store }) => on_s(store) !== null);
    this.#align.replaceChildren(create('option', { value: '', textContent: t('power-on') }), ...(armed ? [create('option', { value: 'on', textContent: 'ON', selected: true })] : []),
      ...Array.from({ length: steps }, (_, index) => create('option', { value: String(index), textContent: t('step {}', index + 1) })));
    this.#tables.replaceChildren(
      table(t('what differs'), [...differences(runs.map(({ about }) => about)).map(([name, values]) => /** @type {[string, Value[]]} */ ([t(name), values])), ...differences(runs.map(({ parameters }) => parameters)).filter(([, values]) => !values.includes(undefined))], runs.length),
      table(t('step'), figuresOf(runs, steps), runs.length),
      table(t('metric'), [...new Set(runs.flatMap(({ metrics }) => Object.keys(metrics)))].sort().map((name) => [name, runs.map(({ metrics }) => metrics[name])]), runs.length),
    );
    this.#draw();
  }

  #draw() {
    this.#drawn?.destroy();
    this.#drawn = null;
    const name = this.#signal.value;
    if (name === '') return this.#plot.replaceChildren(t('the runs have no signal in common'));
    this.#plot.replaceChildren();
    const lines = this.#runs.map(({ store }) => {
      const { t: times, y } = store.series(name);
      const from_s = begin_s(store, this.#align.value);
      return { t: times.map((t_s) => t_s - from_s), y };
    });
    const { about = '', unit = 'cm' } = SIGNALS.find((each) => each.name === name) ?? {};
    const data = uPlot.join(/** @type {uPlot.AlignedData[]} */ (lines.map((each) => [each.t, each.y])));
    this.#drawn = new uPlot({
      width: Math.max(260, this.body.clientWidth),
      height: HEIGHT_PX,
      legend: { show: false },
      // What was before ON, or before the step, is not compared.
      scales: { x: { time: false, range: (_plot, low, high) => [this.#align.value === '' ? low : Math.max(low, -BEFORE_S), high] } },
      axes: [t('time [s]'), `${t(about)} [${t(unit)}]`].map((label, axis) => ({ ...valueAxis(), label, labelFont: FONT, labelSize: 16, size: [24, 46][axis], space: [50, 30][axis] })),
      series: [{}, ...this.#runs.map((_run, index) => ({ stroke: () => colours[ink(index)], width: 1.75, spanGaps: true, points: { show: false }, dash: index < INKS.length ? undefined : [6, 3] }))],
    }, data, this.#plot);
    return undefined;
  }
}

/** @param {number} index */
const ink = (index) => INKS[index % INKS.length] ?? 'left';

/** @param {Store} store @param {string} name */
const has = (store, name) => store.tableOf(name).columns.get(name)?.some((value) => typeof value === 'number') ?? false;

/** Figures of the steps that all have. @param {Run[]} runs @param {number} steps @returns {[string, Value[]][]} */
function figuresOf(runs, steps) {
  return Array.from({ length: steps }).flatMap((_, index) => {
    const all = runs.map(({ store }) => {
      const step = stepsOf(store)[index];
      return step ? figures(store, step) : null;
    });
    const unit = all[0]?.unit ?? '';
    return (/** @type {const} */ ([['rise_s', t('rise'), 's'], ['overshoot', t('overshoot'), unit], ['settling_s', t('settling'), 's'], ['steady_error', t('steady error'), unit]]))
      .map(([key, name, of]) => /** @type {[string, Value[]]} */ ([`${t('step {}', index + 1)}: ${name} [${of}]`, all.map((each) => (Number.isFinite(each?.[key]) ? each?.[key] : null))]));
  });
}

/** The value of each run; of two also the difference. @param {string} title @param {[string, Value[]][]} lines @param {number} runs */
function table(title, lines, runs) {
  const number = (/** @type {Value} */ value) => (typeof value === 'number' ? formatShort(value, Number.isInteger(value) ? 12 : 4) : typeof value === 'string' ? said(value) : value === null ? t('never') : '–');
  const rows = lines.map(([name, values]) => {
    const [a, b] = values;
    const difference = runs !== 2 ? [] : [typeof a === 'number' && typeof b === 'number' ? number(b - a) : ''];
    return create('tr', {}, ...[name, ...values.map(number), ...difference].map((textContent) => create('td', { textContent })));
  });
  const head = create('tr', {}, ...[title, ...Array.from({ length: runs }, (_, index) => String(index + 1)), ...(runs === 2 ? ['2 − 1'] : [])].map((textContent) => create('th', { textContent, scope: 'col' })));
  return lines.length === 0 ? '' : create('div', { className: 'scroll', tabIndex: 0 }, create('table', {}, create('thead', {}, head), create('tbody', {}, ...rows)));
}
