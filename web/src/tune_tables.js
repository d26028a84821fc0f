// @ts-check
/** The tables of a tuning, as `rumbo tune` prints them: parameters, and metrics on robots that the search has not seen. */
import { create } from './dom.js';
import { t } from './text.js';
import { format, formatShort } from './units.js';

/** @typedef {import('./tune_search.js').Found} Found */
/** @typedef {import('./tune_search.js').Difference} Difference */

/** A value with four digits, or a dash where there is none. @param {number | null} value */
const figure = (value) => (value === null ? '–' : formatShort(value, 4));

/** Of a metric a tenth of a millimetre is the last digit that tells. @param {number} value */
const rounded = (value) => Number(value.toFixed(4)) + 0;

/** @param {number} value */
const short = (value) => formatShort(Number(rounded(value).toPrecision(3)));

/** A difference with its sign. @param {number | null} value */
const signed = (value) => (value === null ? '–' : value > 0 && short(value) !== '0' ? `+${short(value)}` : short(value));

/** The parameters before and after, and every metric that differs in some run. @param {Found} found @param {(name: string) => string} unitOf */
export function resultTables({ parameters, differences }, unitOf) {
  const nowhere = differences.every(({ never: [one, other] }) => one + other === 0);
  const differs = differences.filter(({ better, worse, never: [one, other] }) => better > 0 || worse > 0 || one !== other);
  return [
    table([t('parameter'), t('unit'), t('before'), t('after')], parameters.map(({ name, now, tuned }) => [name, unitOf(name), figure(now), figure(tuned)])),
    differs.length === 0 ? create('p', { textContent: t('no run differs') })
      : create('div', { className: 'scroll', tabIndex: 0 }, table([t('metric'), t('before'), t('after'), t('mean difference'), t('95 % interval'), t('effect'), t('better in'), ...(nowhere ? [] : [t('never, before and after')])], differs.map((each) => line(each).slice(0, nowhere ? 7 : 8)))),
  ];
}

/** The metrics that chance does not explain, and that are worse in most runs. @param {Found} found */
export const certainlyWorse = ({ differences }) => differences.filter(({ interval: [low, high], better, worse }) => low !== null && high !== null && low * high > 0 && worse > better).map(({ metric }) => metric);

/** @param {Difference} difference */
function line({ metric, medians, mean, interval: [low, high], effect, better, never: [one, other] }) {
  const range = low === null || high === null ? '–' : t('{} to {}|interval', signed(low), signed(high));
  const [before, after] = medians.map((value) => figure(value === null ? null : rounded(value)));
  return [metric, before ?? '', after ?? '', signed(mean), range, signed(effect), `${format(100 * better, 0)} %`, `${one}, ${other}`];
}

/** @param {string[]} head @param {string[][]} lines */
function table(head, lines) {
  return create('table', {}, create('thead', {}, create('tr', {}, ...head.map((textContent) => create('th', { textContent, scope: 'col' })))),
    create('tbody', {}, ...lines.map(([name = '', ...cells]) => create('tr', {}, create('td', { textContent: name }), ...cells.map((textContent) => create('td', { className: 'number', textContent }))))));
}
