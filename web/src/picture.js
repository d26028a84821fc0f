// @ts-check
/** A plot as a figure for paper, SVG, PNG or PDF of a chosen time and size, and its values as CSV. */
import { t } from './text.js';
import { format } from './units.js';

/** @typedef {import('./plot.js').PlotPanel} PlotPanel */

const LEFT = 60;
const TOP = 34;
const RIGHT = 12;
const BOTTOM = 40;
/** Colours on white paper. @type {Partial<Record<import('./theme.js').ColourName, string>>} */
const INK = { left: '#0072b2', right: '#a65200', front: '#00795a', reference: '#222222', goal: '#a8327d' };
/** Dashes of each kind of curve. */
const DASH = { measured: '', reference: '7 4', true: '2 2' };

/** A figure on paper: its time [s] and its size [mm]. @typedef {{from_s: number, to_s: number, width_mm: number, height_mm: number}} Frame */

/** Pixels of a length on paper, as CSS counts them. @param {number} mm */
const px = (mm) => Math.round((mm / 25.4) * 96);

/** The figure as pixels, 300 to an inch. @param {PlotPanel} panel @param {{store: import('./store.js').Store}} view @param {Frame} frame @returns {Promise<Blob>} */
export async function toPng(panel, view, frame) {
  const url = URL.createObjectURL(toSvg(panel, view, frame));
  try {
    const image = new Image();
    image.src = url;
    await image.decode();
    const scale = 300 / 96;
    const canvas = new OffscreenCanvas(image.width * scale, image.height * scale);
    canvas.getContext('2d')?.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await canvas.convertToBlob({ type: 'image/png' });
  } finally {
    URL.revokeObjectURL(url);
  }
}

/**
 * The figure as PDF: the browser prints a page of its size with nothing else on it.
 * @param {PlotPanel} panel @param {{store: import('./store.js').Store}} view @param {Frame} frame
 */
export async function printPdf(panel, view, frame) {
  const drawn = new DOMParser().parseFromString(await toSvg(panel, view, frame).text(), 'image/svg+xml').documentElement;
  drawn.id = 'printed';
  const sheet = new CSSStyleSheet();
  // The page is a hair larger, so that rounding makes no second one.
  sheet.replaceSync(`@page { size: ${frame.width_mm + 1}mm ${frame.height_mm + 1}mm; margin: 0 } @media print { body > :not(#printed) { display: none !important } html, body { display: block; height: auto; background: #fff } #printed { display: block } } @media screen { #printed { display: none } }`);
  document.adoptedStyleSheets.push(sheet);
  document.body.append(drawn);
  addEventListener('afterprint', () => {
    drawn.remove();
    document.adoptedStyleSheets = document.adoptedStyleSheets.filter((each) => each !== sheet);
  }, { once: true });
  print();
}

/** The signals whose curves are seen. @param {PlotPanel} panel */
function shown(panel) {
  return panel.curves.filter((_curve, index) => panel.plot.series[index + 1]?.show && panel.plot.data[index + 1]?.some((value) => typeof value === 'number'));
}

/** Limits of an axis for its curves in this time. @param {PlotPanel} panel @param {import('./store.js').Store} store @param {boolean} right @param {[number, number]} range_s @returns {[number, number]} */
function span(panel, store, right, [from_s, to_s]) {
  const values = shown(panel).filter((curve) => curve.right === right).flatMap(({ name }) => {
    const table = store.tableOf(name);
    return (table.columns.get(name) ?? []).slice(table.indexAt(from_s), table.indexAt(to_s)).filter((value) => typeof value === 'number');
  });
  const [low, high] = values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
  return low > high ? panel.limits(right, null, null) : panel.limits(right, low, high);
}

/** @param {PlotPanel} panel @param {{store: import('./store.js').Store}} view @param {Frame} frame @returns {Blob} */
export function toSvg(panel, { store }, { from_s, to_s, width_mm, height_mm }) {
  const [width, tall] = [px(width_mm), px(height_mm)];
  const [low, high] = span(panel, store, false, [from_s, to_s]);
  const other = panel.rightUnit === null ? null : span(panel, store, true, [from_s, to_s]);
  const right_px = other ? LEFT : RIGHT;
  const x = (/** @type {number} */ t_s) => LEFT + ((t_s - from_s) / (to_s - from_s)) * (width - LEFT - right_px);
  const height = ([from, to] = [low, high]) => (/** @type {number} */ value) => tall - BOTTOM - ((value - from) / (to - from)) * (tall - TOP - BOTTOM);
  const y = height();
  const yRight = height(other ?? undefined);
  const parts = [
    ...ticks(low, high, 6).map((value) => `<path stroke="#ddd" d="M${LEFT} ${y(value).toFixed(1)}H${width - right_px}"/><text x="${LEFT - 6}" y="${(y(value) + 4).toFixed(1)}" text-anchor="end">${format(value, places(high - low))}</text>`),
    ...(other ? ticks(...other, 6) : []).map((value) => `<text x="${width - right_px + 6}" y="${(yRight(value) + 4).toFixed(1)}">${format(value, places((other?.[1] ?? 0) - (other?.[0] ?? 0)))}</text>`),
    ...ticks(from_s, to_s, 8).map((t_s) => `<path stroke="#ddd" d="M${x(t_s).toFixed(1)} ${TOP}V${tall - BOTTOM}"/><text x="${x(t_s).toFixed(1)}" y="${tall - BOTTOM + 16}" text-anchor="middle">${format(t_s, places(to_s - from_s))}</text>`),
    ...store.stretches.slice(1).filter((stretch) => stretch.from_s > from_s && stretch.from_s < to_s)
      .map((stretch) => `<path stroke="#888" stroke-dasharray="2 4" d="M${x(stretch.from_s).toFixed(1)} ${TOP}V${tall - BOTTOM}"/>`),
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
  const text = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${tall}" width="${width}" height="${tall}" font-family="sans-serif" font-size="12">
<rect width="100%" height="100%" fill="#fff"/><clipPath id="in"><rect x="${LEFT}" y="${TOP}" width="${width - LEFT - right_px}" height="${tall - TOP - BOTTOM}"/></clipPath>
${[...parts, ...curves].join('\n')}
<rect x="${LEFT}" y="${TOP}" width="${width - LEFT - right_px}" height="${tall - TOP - BOTTOM}" fill="none" stroke="#555"/>
<text x="${width - RIGHT}" y="${TOP - 6}" text-anchor="end" font-weight="bold">${escaped(`${t(panel.spec.title)} [${t(panel.unit)}]`)}</text>
<text x="${(LEFT + width - right_px) / 2}" y="${tall - 6}" text-anchor="middle">${escaped(t('time [s]'))}</text>
</svg>
`;
  return new Blob([text], { type: 'image/svg+xml' });
}

/**
 * The values of the signals shown, a column each with its name and its unit; the names are those of the store, in any language.
 * @param {PlotPanel} panel @param {{store: import('./store.js').Store}} view @param {Pick<Frame, 'from_s' | 'to_s'>} frame @returns {Blob}
 */
export function toCsv(panel, { store }, { from_s, to_s }) {
  const curves = shown(panel);
  const tables = [...new Set(curves.map(({ name }) => store.tableOf(name)))];
  const times = [...new Set(tables.flatMap((table) => table.t.slice(table.indexAt(from_s), table.indexAt(to_s))))].sort((a, b) => a - b);
  const head = ['t [s]', ...curves.map(({ name, unit }) => cell(`${name.replace(/^=/, '')} [${unit}]`))];
  const lines = times.map((t_s) => [t_s.toFixed(3), ...curves.map(({ name }) => {
    const table = store.tableOf(name);
    const at = table.indexAt(t_s);
    const value = table.t[at] === t_s ? table.columns.get(name)?.[at] : null;
    return typeof value === 'number' ? String(Number(value.toFixed(4))) : '';
  })].join(','));
  return new Blob([`${head.join(',')}\n${lines.join('\n')}\n`], { type: 'text/csv' });
}

/** A cell of a CSV: the commas of an expression part no columns. @param {string} text */
const cell = (text) => (text.includes(',') ? `"${text}"` : text);

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
