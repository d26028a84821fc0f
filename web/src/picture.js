// @ts-check
/** A plot as a file: PNG as on the page, SVG redrawn for paper, and its values as CSV. */
import { t } from './text.js';
import { colours } from './theme.js';
import { format } from './units.js';

/** @typedef {import('./plot.js').PlotPanel} PlotPanel */

const WIDTH = 800;
const HEIGHT = 320;
const LEFT = 60;
const TOP = 34;
const RIGHT = 12;
const BOTTOM = 40;
/** Colours on white paper. @type {Partial<Record<import('./theme.js').ColourName, string>>} */
const INK = { left: '#0072b2', right: '#a65200', front: '#00795a', reference: '#222222', goal: '#a8327d' };
/** Dashes of each kind of curve. */
const DASH = { measured: '', reference: '7 4', true: '2 2' };

/** @param {PlotPanel} panel @returns {Promise<Blob>} */
export function toPng(panel) {
  const source = panel.plot.ctx.canvas;
  const ratio = devicePixelRatio;
  const head_px = 24 * ratio;
  const canvas = new OffscreenCanvas(source.width, source.height + head_px + 18 * ratio);
  const context = /** @type {OffscreenCanvasRenderingContext2D} */ (canvas.getContext('2d'));
  context.fillStyle = colours.panel;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(source, 0, head_px);
  context.font = `${13 * ratio}px system-ui, sans-serif`;
  context.textBaseline = 'middle';
  let x = 8 * ratio;
  const write = (/** @type {string} */ text, /** @type {string} */ colour) => {
    context.fillStyle = colour;
    context.fillText(text, x, head_px / 2);
    x += context.measureText(text).width + 12 * ratio;
  };
  write(`${t(panel.spec.title)} [${t(panel.unit)}]`, colours.text);
  for (const { label, colour, right, unit } of shown(panel)) write(right ? `${label} [${t(unit)}]` : label, colours[colour]);
  const [from_s, to_s] = limits(panel, 'x');
  context.fillStyle = colours.dim;
  context.textAlign = 'right';
  context.fillText(`${format(from_s, 2)} – ${format(to_s, 2)} s`, canvas.width - 8 * ratio, canvas.height - 9 * ratio);
  return canvas.convertToBlob({ type: 'image/png' });
}

/** The signals whose curves are seen. @param {PlotPanel} panel */
function shown(panel) {
  return panel.curves.filter((_curve, index) => panel.plot.series[index + 1]?.show && panel.plot.data[index + 1]?.some((value) => typeof value === 'number'));
}

/** @param {PlotPanel} panel @param {string} scale @returns {[number, number]} */
function limits(panel, scale) {
  const { min = 0, max = 1 } = panel.plot.scales[scale] ?? {};
  return [min ?? 0, max ?? 1];
}

/** @param {PlotPanel} panel @param {{store: import('./store.js').Store}} view @returns {Blob} */
export function toSvg(panel, { store }) {
  const [from_s, to_s] = limits(panel, 'x');
  const [low, high] = limits(panel, 'y');
  const other = panel.rightUnit === null ? null : limits(panel, 'right');
  const right_px = other ? LEFT : RIGHT;
  const x = (/** @type {number} */ t_s) => LEFT + ((t_s - from_s) / (to_s - from_s)) * (WIDTH - LEFT - right_px);
  const height = ([from, to] = [low, high]) => (/** @type {number} */ value) => HEIGHT - BOTTOM - ((value - from) / (to - from)) * (HEIGHT - TOP - BOTTOM);
  const y = height();
  const yRight = height(other ?? undefined);
  const parts = [
    ...ticks(low, high, 6).map((value) => `<path class="grid" d="M${LEFT} ${y(value).toFixed(1)}H${WIDTH - right_px}"/><text x="${LEFT - 6}" y="${(y(value) + 4).toFixed(1)}" text-anchor="end">${format(value, places(high - low))}</text>`),
    ...(other ? ticks(...other, 6) : []).map((value) => `<text x="${WIDTH - right_px + 6}" y="${(yRight(value) + 4).toFixed(1)}">${format(value, places((other?.[1] ?? 0) - (other?.[0] ?? 0)))}</text>`),
    ...ticks(from_s, to_s, 8).map((t_s) => `<path class="grid" d="M${x(t_s).toFixed(1)} ${TOP}V${HEIGHT - BOTTOM}"/><text x="${x(t_s).toFixed(1)}" y="${HEIGHT - BOTTOM + 16}" text-anchor="middle">${format(t_s, places(to_s - from_s))}</text>`),
    ...store.stretches.slice(1).filter((stretch) => stretch.from_s > from_s && stretch.from_s < to_s)
      .map((stretch) => `<path class="state" d="M${x(stretch.from_s).toFixed(1)} ${TOP}V${HEIGHT - BOTTOM}"/>`),
  ];
  let next = LEFT;
  const curves = shown(panel).map(({ name, label, kind, colour, right, unit }) => {
    const ink = INK[colour] ?? '#222222';
    const words = right ? `${label} [${t(unit)}]` : label;
    const place = next;
    next += 34 + 7 * words.length;
    return `<path d="${path(store.tableOf(name), name, [from_s, to_s], x, right ? yRight : y, kind === 'reference')}" fill="none" stroke="${ink}" stroke-width="1.4" stroke-dasharray="${DASH[kind]}" clip-path="url(#in)"/>
<path d="M${place} ${TOP - 10}h18" stroke="${ink}" stroke-width="2" stroke-dasharray="${DASH[kind]}"/><text x="${place + 22}" y="${TOP - 6}">${escaped(words)}</text>`;
  });
  const text = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${HEIGHT}" width="${WIDTH}" height="${HEIGHT}" font-family="sans-serif" font-size="12">
<style>.grid{stroke:#ddd}.state{stroke:#888;stroke-dasharray:2 4}</style>
<rect width="100%" height="100%" fill="#fff"/><clipPath id="in"><rect x="${LEFT}" y="${TOP}" width="${WIDTH - LEFT - right_px}" height="${HEIGHT - TOP - BOTTOM}"/></clipPath>
${[...parts, ...curves].join('\n')}
<rect x="${LEFT}" y="${TOP}" width="${WIDTH - LEFT - right_px}" height="${HEIGHT - TOP - BOTTOM}" fill="none" stroke="#555"/>
<text x="${WIDTH - RIGHT}" y="${TOP - 6}" text-anchor="end" font-weight="bold">${escaped(`${t(panel.spec.title)} [${t(panel.unit)}]`)}</text>
<text x="${(LEFT + WIDTH - right_px) / 2}" y="${HEIGHT - 6}" text-anchor="middle">${escaped(t('time [s]'))}</text>
</svg>
`;
  return new Blob([text], { type: 'image/svg+xml' });
}

/**
 * The values in sight of the signals shown, a column each with its name and its unit; the names are those of the store, in any language.
 * @param {PlotPanel} panel @param {{store: import('./store.js').Store}} view @returns {Blob}
 */
export function toCsv(panel, { store }) {
  const [from_s, to_s] = limits(panel, 'x');
  const curves = shown(panel);
  const tables = [...new Set(curves.map(({ name }) => store.tableOf(name)))];
  const times = [...new Set(tables.flatMap((table) => table.t.slice(table.indexAt(from_s), table.indexAt(to_s))))].sort((a, b) => a - b);
  const head = ['t [s]', ...curves.map(({ name, unit }) => `${name} [${unit}]`)];
  const lines = times.map((t_s) => [t_s.toFixed(3), ...curves.map(({ name }) => {
    const table = store.tableOf(name);
    const at = table.indexAt(t_s);
    const value = table.t[at] === t_s ? table.columns.get(name)?.[at] : null;
    return typeof value === 'number' ? String(Number(value.toFixed(4))) : '';
  })].join(','));
  return new Blob([`${head.join(',')}\n${lines.join('\n')}\n`], { type: 'text/csv' });
}

/**
 * @param {import('./table.js').Table} table
 * @param {string} name
 * @param {[number, number]} range_s
 * @param {(t_s: number) => number} x
 * @param {(value: number) => number} y
 * @param {boolean} stepped
 */
function path(table, name, [from_s, to_s], x, y, stepped) {
  const column = table.columns.get(name) ?? [];
  let drawn = '';
  let pen = false;
  // One line before and one after, so that the curve goes through to the edges.
  for (let index = Math.max(0, table.indexAt(from_s) - 2); index < Math.min(table.t.length, table.indexAt(to_s) + 2); index++) {
    const value = column[index];
    if (value === undefined) continue;
    if (value !== null) {
      const [at_x, at_y] = [x(table.t[index] ?? 0).toFixed(1), y(value).toFixed(1)];
      drawn += !pen ? `M${at_x} ${at_y}` : stepped ? `H${at_x}V${at_y}` : `L${at_x} ${at_y}`;
    }
    pen = value !== null;
  }
  return drawn;
}

/** Round values between two, about so many. @param {number} low @param {number} high @param {number} count */
function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((each) => each * power >= rough) ?? 10);
  const made = [];
  for (let value = Math.ceil(low / step) * step; value <= high + step / 1e6; value += step) made.push(value);
  return made;
}

/** Decimals for values that spread so far. @param {number} spread */
const places = (spread) => (spread > 20 ? 0 : spread > 2 ? 1 : 2);

/** @param {string} text */
const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;');
