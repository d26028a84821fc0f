// @ts-check
/**
 * The control law of the mode, with the numbers of the instant that is shown: of several terms the one that decides is lit, and a
 * click on a gain gives a slider. The equations come from the control core; names and units are those of its parameters and signals.
 */
import { Diagram } from './diagram.js';
import { clickable, create, element, setText } from './dom.js';
import { wrapped } from './geometry.js';
import { parse, work } from './law.js';
import { unitWords } from './parameters.js';
import { said, t } from './text.js';
import { CM_PER_M, DEG_PER_RAD, RPM_PER_RAD_S, formatShort } from './units.js';

/** @typedef {import('./law.js').Part} Part */
/** @typedef {import('./types.js').Parameter} Parameter */
/** @typedef {{part: Part, gives: string, shown: Map<Part, {box: HTMLElement, value: HTMLElement | null}>, result: HTMLElement, other: HTMLElement, body: HTMLElement, states: number[]}} Line */

/** By the unit at the end of a name: that in which the store has it, and the factor. @type {[string, string, number][]} */
const UNITS = [['_rad_s', '_rpm', RPM_PER_RAD_S], ['_rad_s', '_deg_s', DEG_PER_RAD], ['_rad', '_deg', DEG_PER_RAD], ['_m', '_cm', CM_PER_M]];
/** What the robot gives may be so much else than the sum: telemetry and loops are not of the same instant. */
const [NEAR, NEAR_SHARE] = [0.02, 0.25];
/** And of yaw rates so much: what the heading changes by between two frames. */
const NEAR_RAD_S = 0.06;
/** A slider goes this far from the value, both ways. */
const REACH = 4;
/** Minimum time between two values of a slider that moves [ms]. */
const SLIDE_MS = 120;
const SIGNS = { '*': '·', '/': '/', '+': '+', '-': '−' };

export class LawPanel {
  #body = element('law', HTMLDivElement);
  #lines = create('div', { className: 'laws' });
  #slider = create('div', { className: 'row', id: 'gain', hidden: true });
  #send;
  #store;
  #diagram;
  #mode = -1;
  /** @type {Line[]} */
  #laws = [];
  /** @type {Map<string, Parameter>} */
  #parameters = new Map();
  /** The parameter that has a slider. */
  #chosen = '';
  /** Where its value is written. @type {(() => void)} */
  #showChosen = () => {};
  /** @type {import('./types.js').ModeEntry[]} */
  modes = [];
  /** The estimated heading when the robot was armed [rad]. */
  on_rad = NaN;

  /** @param {import('./panel.js').Send} send @param {import('./store.js').Store} store */
  constructor(send, store) {
    this.#send = send;
    this.#store = store;
    this.#diagram = new Diagram(store);
    this.#body.append(this.#slider, this.#diagram.body, this.#lines);
  }

  /** @param {Parameter[]} parameters */
  setParameters(parameters) {
    const first = this.#parameters.size === 0;
    this.#parameters = new Map(parameters.map((each) => [each.name, each]));
    if (first) this.#layOut();
    this.#showChosen();
    this.draw();
  }

  /** @param {number} mode */
  setMode(mode) {
    if (mode === this.#mode) return;
    this.#mode = mode;
    this.#layOut();
  }

  #layOut() {
    const entry = this.modes.find(({ id }) => id === this.#mode);
    const laws = entry?.laws ?? [];
    this.#diagram.body.hidden = laws.length === 0;
    this.#diagram.setMode(entry?.name ?? '');
    this.#slider.hidden = true;
    this.#chosen = '';
    this.#laws = laws.map(([gives, is, , states]) => ({ part: parse(is), gives, states, body: create('p', { className: 'law' }), shown: new Map(), result: create('output'), other: create('span', { className: 'chip warning', hidden: true }) }));
    this.#lines.replaceChildren(...this.#laws.map((law, index) => {
      const ids = laws[index]?.[2] ?? [];
      const within = [...this.#parameters.values()].filter(({ id }) => ids.includes(id));
      law.body.append(create('b', { textContent: law.gives }), ' ', law.result, ' = ', this.#write(law.part, law), ' ', law.other,
        ...(within.length > 0 ? [create('span', { className: 'hint' }, ` ${t('with|gains')} `, ...within.flatMap(({ name }) => [this.#gain(name), ' '])) ] : []));
      return law.body;
    }));
    if (laws.length === 0) setText(this.#lines, t('The program of this robot has no law that is known.'));
    this.draw();
  }

  /** @param {string} name */
  #gain(name) {
    return clickable({ className: 'small', textContent: name, title: said(this.#parameters.get(name)?.description ?? '') }, () => this.#choose(name));
  }

  /** A part of an equation, to be filled with numbers. @param {Part} part @param {Line} law @returns {HTMLElement} */
  #write(part, law) {
    const { of, parts } = part;
    const inner = parts.map((each) => this.#write(each, law));
    const box = create('span', { className: 'term' });
    let value = null;
    if (of in SIGNS) box.append(inner[0] ?? '', ` ${SIGNS[/** @type {keyof typeof SIGNS} */ (of)]} `, inner[1] ?? '');
    else if (of === 'negative') box.append('−', inner[0] ?? '');
    else if (parts.length > 0) box.append(of === 'sqrt' ? '√(' : of === '(' ? '(' : `${of}(`, ...inner.flatMap((each, index) => (index === 0 ? [each] : [', ', each])), ')');
    else if (/^[\d.]+$/.test(of)) box.append(formatShort(Number(of)));
    else {
      value = create('output');
      box.append(this.#parameters.has(of) ? this.#gain(of) : create('code', { textContent: of }), ' ', value);
    }
    law.shown.set(part, { box, value });
    return box;
  }

  /** What a name is now, in SI units. @param {string} name */
  #valueOf(name) {
    const parameter = this.#parameters.get(name);
    if (parameter) return parameter.value ?? NaN;
    const store = this.#store;
    // Plots have it in the frame of the world.
    if (name === 'heading_ref_rad') return store.latest?.heading_ref_rad ?? NaN;
    if (name === 'heading_since_on_rad') return wrapped((store.latest?.estimated?.heading_rad ?? NaN) - this.on_rad);
    const at_s = Math.min(store.playhead_s, store.slow.t.at(-1) ?? 0);
    for (const [suffix, shown, factor] of [['', '', 1], ...UNITS]) {
      const own = name.endsWith(String(suffix)) ? name.slice(0, name.length - String(suffix).length) + shown : '';
      const table = own && store.tableOf(own);
      if (table && table.columns.has(own)) return Number(table.at(own, at_s) ?? NaN) / Number(factor);
    }
    return NaN;
  }

  /** The numbers of the instant that is shown. */
  draw() {
    if (this.#body.hidden || this.#body.clientWidth === 0) return;
    this.#diagram.draw();
    const armed = this.#store.latest?.armed === true;
    const laws = this.#laws.filter(({ states, body }) => {
      body.hidden = armed && states.length > 0 && !states.includes(this.#store.latest?.state ?? -1);
      return !body.hidden;
    });
    /** What one equation gives to the others. @type {Map<string, number>} */
    const given_by = new Map();
    for (const { part, gives, shown, result, other } of laws) {
      /** @type {Map<Part, import('./law.js').Worked>} */
      const all = new Map();
      // At rest only gains have a value.
      const sum = work(part, (name) => given_by.get(name) ?? (armed || this.#parameters.has(name) ? this.#valueOf(name) : NaN), all);
      const given = armed ? this.#valueOf(gives) : NaN;
      if (Number.isNaN(given)) given_by.set(gives, sum);
      for (const [each, { value }] of shown) {
        const { decides = -1, value: now = NaN } = all.get(each) ?? {};
        if (value) setText(value, digits(now));
        each.parts.forEach((child, index) => shown.get(child)?.box.classList.toggle('lit', decides === index && !['min', 'max'].includes(child.of) && (each.of !== 'clamp' || index > 0)));
      }
      setText(result, digits(sum));
      // A limit that the equation does not spell out, or a program at rest.
      const off = Number.isFinite(given) && Math.abs(given - sum) > Math.max((gives === 'yaw_ref_rad_s' ? NEAR_RAD_S : NEAR) * (Math.abs(given) > 5 ? 50 : 1), NEAR_SHARE * Math.abs(given));
      other.hidden = !off;
      if (off) setText(other, t('the robot gives {}', digits(given)));
    }
  }

  /** A slider for a parameter. @param {string} name */
  #choose(name) {
    const parameter = this.#parameters.get(name);
    if (!parameter || parameter.value === null) return;
    const { id, unit, value, min, max } = parameter;
    this.#chosen = name;
    const [low, high] = value === 0 ? [min, max] : [Math.max(min, Math.min(value / REACH, value * REACH)), Math.min(max, Math.max(value / REACH, value * REACH))];
    const range = create('input', { type: 'range', min: String(low), max: String(high), step: 'any', value: String(value) });
    range.setAttribute('aria-label', name);
    const words = create('output');
    let sent_ms = 0;
    const send = () => {
      sent_ms = performance.now();
      this.#send({ type: 'set_param', id, value: Number(range.valueAsNumber.toPrecision(3)) });
    };
    range.addEventListener('input', () => {
      if (performance.now() - sent_ms > SLIDE_MS) send();
    });
    range.addEventListener('change', send);
    this.#showChosen = () => {
      const now = this.#parameters.get(this.#chosen);
      setText(words, `${digits(now?.value ?? NaN)} ${unitWords(unit)}${now?.pending ? ` ${t('waiting…')}` : now?.refused ? ` ${t('refused: {}', said(now.refused))}` : ''}`);
    };
    this.#slider.replaceChildren(create('b', { textContent: name }), formatShort(low, 3), range, formatShort(high, 3), words);
    this.#slider.hidden = false;
    this.#showChosen();
    range.focus();
  }
}

/** Three digits are what an equation needs. @param {number} value */
const digits = (value) => (Number.isFinite(value) ? formatShort(Number((Math.abs(value) < 5e-4 ? 0 : value).toPrecision(3)), 4) : '–');
