// @ts-check
/** The dialog of one plot: its title, its signals, the limits of its axis, and its export as a picture. */
import { BadExpression, MARK } from './computed.js';
import { check, decimal, number, read, write } from './decimal.js';
import { complaint, dialog, saveFile } from './dialog.js';
import { clickable, create } from './dom.js';
import { MOST_UNITS, unitsOf } from './layout.js';
import { printPdf, toCsv, toPng, toSvg } from './picture.js';
import { SIGNALS, UNITS, computed, signal } from './signals.js';
import { numberAs, t } from './text.js';

/** @typedef {import('./plot.js').PlotPanel} PlotPanel */
/** @typedef {import('./plots.js').Plots} Plots */

/** What the signals of a unit are. @returns {Record<keyof typeof UNITS, string>} */
const GROUPS = () => ({
  cm: t('distances, cm'), rpm: t('wheel speeds, rpm'), 'of 255': t('PWM, of 255'), '°': t('angles, °'), m: t('positions, m'),
  '°/s': t('yaw rates, °/s'), 'm/s': t('speeds, m/s'), 'm/s²': t('accelerations, m/s²'), level: t('levels of pins, 0 to 1'), edges: t('encoders, edges'), 'µs': t('pulses, µs'), lx: t('light, lx'), Hz: t('tones, Hz'), printed: t('printed by the program'),
});

export class PlotDialog {
  #plots;
  #dialog;
  /** The plot that is changed; null: a new one. @type {PlotPanel | null} */
  #panel = null;
  #title = create('input', { type: 'text', id: 'plot-title', maxLength: 60, required: true });
  #min = decimal('plot-min');
  #max = decimal('plot-max');
  #rightMin = decimal('plot-right-min');
  #rightMax = decimal('plot-right-max');
  #right = create('div', { className: 'row' }, create('label', {}, `${t('right axis: y min')} `, this.#rightMin), create('label', {}, `${t('y max')} `, this.#rightMax));
  /** @type {{box: HTMLInputElement, label: HTMLLabelElement}[]} */
  #boxes = [];
  #choice = create('div', { className: 'signal-choice' });
  #expression = create('input', { type: 'text', id: 'plot-expression', maxLength: 120, size: 32, placeholder: 'left_rpm - right_rpm', autocomplete: 'off', spellcheck: false });
  #complaint = complaint();
  #remove = create('button', { type: 'button', textContent: t('Remove plot') });
  #from = decimal('figure-from');
  #to = decimal('figure-to');
  #width = number('figure-width', 160, 40, 400);
  #height = number('figure-height', 70, 30, 400);
  #pictures = create('fieldset', { className: 'row' });

  /** @param {Plots} plots */
  constructor(plots) {
    this.#plots = plots;
    this.#dialog = dialog('plot-dialog', t('Plot'));
    const form = create('form', { className: 'stack' },
      create('div', { className: 'row' }, create('label', {}, `${t('title')} `, this.#title),
        create('label', {}, `${t('y min')} `, this.#min), create('label', {}, `${t('y max')} `, this.#max), create('span', { className: 'hint', textContent: t('empty = auto') })),
      this.#right,
      this.#choice,
      create('div', { className: 'row' }, create('label', {}, `${t('computed')} `, this.#expression),
        create('span', { className: 'hint', textContent: t('of names of signals, which the pointer shows above: + - * / min max abs sqrt clamp, derivative(x), filter(x, seconds)') })),
      this.#complaint,
      create('div', { className: 'row' }, create('button', { type: 'submit', className: 'go', textContent: t('Apply') }), this.#remove), this.#pictures);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#apply();
    });
    form.addEventListener('change', () => this.#limitUnits());
    this.#remove.addEventListener('click', () => {
      if (this.#panel) plots.change(this.#panel.spec, null);
      this.#dialog.dialog.close();
    });
    const field = (/** @type {string} */ text, /** @type {HTMLInputElement} */ input, /** @type {string} */ unit) => create('label', {}, `${text} `, input, ` ${unit}`);
    this.#pictures.replaceChildren(create('legend', { textContent: t('figure') }),
      field(t('from'), this.#from, 's'), field(t('to'), this.#to, 's'), field(t('width'), this.#width, 'mm'), field(t('height'), this.#height, 'mm'), create('span', { className: 'spacer' }),
      this.#pictureButton('SVG', 'svg', (panel, frame) => toSvg(panel, plots, frame)), this.#pictureButton('PNG', 'png', (panel, frame) => toPng(panel, plots, frame)),
      this.#pictureButton('PDF', null, (panel, frame) => printPdf(panel, plots, frame)), this.#pictureButton('CSV', 'csv', (panel, frame) => toCsv(panel, plots, frame)));
    this.#dialog.body.append(form);
  }

  /** @param {string} text @param {string | null} ending Null: the browser's print dialog saves it. @param {(panel: PlotPanel, frame: import('./picture.js').Frame) => Blob | Promise<Blob | void>} make */
  #pictureButton(text, ending, make) {
    const title = ending === null ? t('Print this plot, or save it as PDF') : t('Save this plot as {}', text);
    const button = clickable({ textContent: text, title }, async () => {
      const panel = this.#panel;
      const [from_s = 0, to_s = 0, width_mm = 0, height_mm = 0] = [this.#from, this.#to, this.#width, this.#height].map(read);
      const fits = from_s < to_s && width_mm >= 40 && width_mm <= 400 && height_mm >= 30 && height_mm <= 400;
      this.#complain(fits ? '' : t('a figure goes from a time to a later one, and is 40 to 400 mm wide and 30 to 400 mm high'));
      if (!panel || !fits) return;
      const made = await make(panel, { from_s, to_s, width_mm, height_mm });
      if (made) saveFile(`${panel.spec.title.replace(/[^\p{Letter}\d]+/gu, '_')}.${ending}`, made);
    });
    return button;
  }

  /** Offers the signals that there are now. */
  #offer() {
    const names = new Set([...SIGNALS.map(({ name }) => name), ...this.#plots.store.readings.names(), ...this.#panel?.spec.signals ?? []]);
    const signals = [...names].flatMap((name) => signal(name) ?? []);
    const units = /** @type {(keyof typeof UNITS)[]} */ (Object.keys(UNITS));
    this.#boxes = [];
    const groups = units.map((unit) => signals.filter((each) => each.unit === unit).map(({ name, about }) => {
      const box = create('input', { type: 'checkbox', value: name });
      const { store } = this.#plots;
      const known = store.tableOf(name).columns.get(name)?.some((value) => typeof value === 'number') ?? false;
      const label = create('label', { className: known ? '' : 'absent', title: known ? name : `${name}: ${t('nothing to plot here')}` }, box, ` ${about}`);
      this.#boxes.push({ box, label });
      return label;
    }));
    const boxes = groups.flatMap((labels, index) => (labels.length === 0 ? [] : [create('fieldset', {}, create('legend', { textContent: GROUPS()[units[index] ?? 'cm'] }), ...labels)]));
    const absent = t('Terms of the loops are known only of Rumbo’s own program on a simulated robot: the link has no room for them.');
    const known = this.#plots.store.readings.loops.t.length > 0;
    this.#choice.replaceChildren(...boxes, ...(known ? [] : [create('p', { className: 'hint', textContent: absent })]));
  }

  /** @param {PlotPanel | null} panel Null: a new plot. */
  open(panel) {
    this.#panel = panel;
    this.#offer();
    const spec = panel?.spec ?? null;
    this.#dialog.heading.textContent = spec ? t('Change the plot {}', t(spec.title)) : t('New plot');
    this.#title.value = spec ? t(spec.title) : '';
    this.#min.value = limit(spec?.min);
    this.#max.value = limit(spec?.max);
    const [rightMin, rightMax] = spec?.right ?? [];
    this.#rightMin.value = limit(rightMin);
    this.#rightMax.value = limit(rightMax);
    for (const input of [this.#min, this.#max, this.#rightMin, this.#rightMax]) check(input);
    for (const { box } of this.#boxes) box.checked = spec?.signals.includes(box.value) ?? false;
    this.#remove.hidden = this.#pictures.hidden = panel === null;
    const [from_s, to_s] = this.#plots.range_s;
    write(this.#from, Math.round(from_s * 100) / 100);
    write(this.#to, Math.round(to_s * 100) / 100);
    this.#complaint.textContent = this.#expression.value = '';
    this.#limitUnits();
    this.#dialog.open();
  }

  /** One plot has two units at most: signals of others can be taken when those of one of them are not. */
  #limitUnits() {
    const units = unitsOf(this.#chosen());
    this.#right.hidden = units.length < MOST_UNITS;
    for (const { box } of this.#boxes) box.disabled = units.length === MOST_UNITS && unitsOf([box.value]).every((unit) => !units.includes(unit));
  }

  /** The signals chosen: as the plot had them, so that its axes stay where they are, then the others. */
  #chosen() {
    const checked = this.#boxes.filter(({ box }) => box.checked).map(({ box }) => box.value);
    const before = this.#panel?.spec.signals.filter((name) => checked.includes(name)) ?? [];
    return [...before, ...checked.filter((name) => !before.includes(name))];
  }

  #apply() {
    const signals = this.#chosen();
    const text = this.#expression.value.trim();
    if (text !== '') {
      try {
        signals.push(computed(MARK + text).name);
      } catch (error) {
        if (error instanceof BadExpression) return this.#complain(t(error.message, ...error.values));
        throw error;
      }
    }
    if (unitsOf(signals).length > MOST_UNITS) return this.#complain(t('one plot has two units at most'));
    const left = limits(this.#min, this.#max);
    const right = this.#right.hidden ? null : limits(this.#rightMin, this.#rightMax);
    if (signals.length === 0) return this.#complain(t('choose a signal at least'));
    if (left === undefined || right === undefined) return this.#complain(t('give y min and y max, min below max, or leave both empty'));
    const old = this.#panel?.spec ?? null;
    // A title in two languages is kept as it is.
    const title = old && this.#title.value === t(old.title) ? old.title : this.#title.value;
    this.#plots.change(old, { title, signals, min: left?.[0] ?? null, max: left?.[1] ?? null, ...(right ? { right } : {}), weight: old?.weight ?? 4 });
    return this.#dialog.dialog.close();
  }

  /** @param {string} text */
  #complain(text) {
    this.#complaint.textContent = text;
  }
}

/** A limit as it is written. @param {number | null | undefined} value */
const limit = (value) => (value === null || value === undefined ? '' : numberAs(String(Number(value.toPrecision(4)))));

/** The limits written: null for none, undefined if they are no span. @param {HTMLInputElement} from @param {HTMLInputElement} to @returns {[number, number] | null | undefined} */
function limits(from, to) {
  const [min, max] = [read(from), read(to)];
  if (from.value.trim() === '' && to.value.trim() === '') return null;
  return min < max ? [min, max] : undefined;
}
