// @ts-check
/**
 * The state machine of the mode: its states in a row, forward transitions above them and backward ones below, with the
 * active state and the transition to it highlighted. States and transitions come from the control core.
 */
import { element } from './dom.js';
import { said, t } from './text.js';

/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./store.js').Store} Store */

const SVG = 'http://www.w3.org/2000/svg';
const BOX_HEIGHT_PX = 44;
const MARGIN_PX = 4;
const LINE_PX = 10;
/** About the width of a letter of a state's name [px]. */
const LETTER_PX = 4.7;
/** The arrows of a state begin and end this far beside its middle, and further for further states [px]. */
const BESIDE_PX = 4;

/**
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 * @param {(Node | string)[]} children
 */
function draw(tag, attributes, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
  made.append(...children);
  return made;
}

/** Where a word is broken: before the last syllable that fits, as far as letters tell. @param {string} word @param {number} most */
function breakOf(word, most) {
  for (let at = Math.min(most - 1, word.length - 3); at > 2; at--) {
    if (/^(?:ch|ll|rr|[bcdfgpt][lr]|[bcdfghjklmnpqrstvwxyzñ])[aeiouyáéíóú]/.test(word.slice(at)) && !/^(?:[csl]h|[bcdfgpt][lr]|ll|rr)/.test(word.slice(at - 1))) return at;
  }
  return most - 1;
}

/** A name in lines that fit a box; a word that does not is broken. @param {string} name @param {number} width_px */
function lines(name, width_px) {
  const most = Math.max(4, Math.floor(width_px / LETTER_PX));
  /** @type {string[]} */
  const made = [];
  for (const whole of name.split(' ')) {
    const last = made.at(-1);
    let word = whole;
    if (last !== undefined && last.length + 1 + word.length <= most) {
      made[made.length - 1] = `${last} ${word}`;
      continue;
    }
    for (let at; word.length > most; word = word.slice(at)) made.push(`${word.slice(0, at = breakOf(word, most))}-`);
    made.push(word);
  }
  return made.slice(0, 4);
}

export class Machine {
  #svg = element('machine', SVGSVGElement);
  #store;
  /** @type {ModeEntry[]} */
  modes = [];
  /** @type {ModeEntry | null} */
  #mode = null;
  /** @type {Element[]} */
  #boxes = [];
  /** The transitions, by from and to. @type {Map<string, Element>} */
  #ways = new Map();
  #lit = '';

  /** @param {Store} store */
  constructor(store) {
    this.#store = store;
    new ResizeObserver(() => this.#layOut()).observe(this.#svg);
  }

  /** @param {number} mode */
  setMode(mode) {
    const entry = this.modes.find(({ id }) => id === mode) ?? null;
    if (entry === this.#mode) return;
    this.#mode = entry;
    this.#layOut();
  }

  #layOut() {
    const { clientWidth: width, clientHeight: height } = this.#svg;
    const states = this.#mode?.states ?? [];
    if (width === 0 || states.length === 0) return;
    const pitch = (width - 2 * MARGIN_PX) / states.length;
    const box = Math.min(pitch * 0.84, 150);
    const top = (height - BOX_HEIGHT_PX) / 2;
    const middle = (/** @type {number} */ state) => MARGIN_PX + pitch * (state + 0.5);
    this.#svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#boxes = states.map((state, index) => this.#box(said(state), index, middle(index), top, box));
    this.#ways = new Map((this.#mode?.ways ?? []).map(([from, to, when]) => {
      const on = to > from;
      const span = Math.abs(to - from);
      const reach = (top - 6) * (0.35 + 0.65 * (span - 1) / Math.max(1, states.length - 2));
      const beside = (on ? 1 : -1) * Math.min(box / 2 - 3, BESIDE_PX + 2 * span);
      const edge = on ? top : top + BOX_HEIGHT_PX;
      const [x1, x2] = [middle(from) + beside, middle(to) - beside];
      const y = on ? edge - reach : edge + reach;
      const path = draw('path', { class: 'way', d: `M${x1} ${edge}C${x1} ${y} ${x2} ${y} ${x2} ${edge + (on ? -2 : 2)}`, 'marker-end': 'url(#way-end)' }, draw('title', {}, `${said(states[from] ?? '')} → ${said(states[to] ?? '')}: ${said(when)}`));
      return [`${from},${to}`, path];
    }));
    const end = draw('marker', { id: 'way-end', viewBox: '0 0 6 6', refX: 5, refY: 3, markerWidth: 6, markerHeight: 6, orient: 'auto' }, draw('path', { d: 'M0 0L6 3L0 6z', class: 'way-head' }));
    this.#svg.replaceChildren(draw('defs', {}, end), ...this.#ways.values(), ...this.#boxes);
    this.#lit = '';
    this.draw();
  }

  /**
   * @param {string} name
   * @param {number} state
   * @param {number} x
   * @param {number} top
   * @param {number} width
   */
  #box(name, state, x, top, width) {
    const rows = lines(name, width - 2);
    const first = top + (BOX_HEIGHT_PX - rows.length * LINE_PX) / 2 + LINE_PX - 2;
    return draw('g', { class: `state-box s${state % 6}` },
      draw('rect', { x: x - width / 2, y: top, width, height: BOX_HEIGHT_PX, rx: 5 }),
      draw('text', { x, y: first }, ...rows.map((row, index) => draw('tspan', { x, dy: index === 0 ? 0 : LINE_PX }, row))),
      draw('title', {}, `${state} ${name}`));
  }

  /** Highlights the state, and the transition that led there. */
  draw() {
    const { stretches } = this.#store;
    const last = stretches.at(-1);
    const before = stretches.at(-2);
    const own = last && last.mode === this.#mode?.id ? last : null;
    const live = own?.armed ? own.state : null;
    const way = live !== null && before?.armed && before.mode === own?.mode ? `${before.state},${live}` : '';
    const lit = `${live} ${way} ${own?.faulted}`;
    if (lit === this.#lit) return;
    this.#lit = lit;
    this.#boxes.forEach((box, state) => box.classList.toggle('live', state === live));
    for (const [key, path] of this.#ways) path.classList.toggle('taken', key === way);
    const name = live === null ? t(own?.faulted ? 'fault' : 'off') : said(this.#mode?.states[live] ?? '');
    this.#svg.setAttribute('aria-label', t('State machine of the mode; now: {}', name));
  }
}
