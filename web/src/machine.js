// @ts-check
/**
 * The state machine of the mode: its states in a row, forward transitions above them and backward ones below; or, where they
 * are many, in several rows, with the transitions of one state only. The active state and the transition to it are
 * highlighted. Below in words: when the active state, or the one that is pointed at, is left. States and transitions come from
 * the control core.
 */
import { create, element } from './dom.js';
import { said, t } from './text.js';

/** @typedef {import('./types.js').ModeEntry} ModeEntry */
/** @typedef {import('./store.js').Store} Store */

const SVG = 'http://www.w3.org/2000/svg';
const BOX_HEIGHT_PX = 44;
const MARGIN_PX = 4;
const LINE_PX = 12;
/** About the width of a letter of a state's name [px]. */
const LETTER_PX = 6.1;
/** Narrower than this a box does not stand in one row with all others [px]. */
const NARROWEST_PX = 92;
/** Of several rows [px]. */
const ROW_PX = 62;
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

/** Height of one row with its arcs, and room for the words below [px]. */
const ONE_ROW_PX = 84;
const WORDS_PX = 40;

/** An arc above the boxes, or below them on the way back; higher the further it goes. @param {number} from @param {number} to @param {number} top @param {number} box @param {number} share */
function arc(from, to, top, box, share) {
  const on = to > from;
  const reach = (top - 6) * (0.35 + 0.65 * share);
  const beside = (on ? 1 : -1) * Math.min(box / 2 - 3, BESIDE_PX + 20 * share);
  const edge = on ? top : top + BOX_HEIGHT_PX;
  const y = on ? edge - reach : edge + reach;
  return `M${from + beside} ${edge}C${from + beside} ${y} ${to - beside} ${y} ${to - beside} ${edge + (on ? -2 : 2)}`;
}

/** A line from box to box, from edge to edge. @param {[number, number]} from Middle and top. @param {[number, number]} to @param {number} box */
function straight([x1, y1], [x2, y2], box) {
  const [dx, dy] = [x2 - x1, y2 - y1];
  // The share of the way that is inside a box.
  const inside = Math.min((box / 2 + 1) / Math.max(Math.abs(dx), 1), (BOX_HEIGHT_PX / 2 + 1) / Math.max(Math.abs(dy), 1), 0.45);
  const at = (/** @type {number} */ share) => `${(x1 + share * dx).toFixed(1)} ${(y1 + BOX_HEIGHT_PX / 2 + share * dy).toFixed(1)}`;
  return `M${at(inside)}L${at(1 - inside)}`;
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
  #list = element('ways', HTMLUListElement);
  #live = /** @type {number | null} */ (null);
  /** The state that is pointed at or has the focus. @type {number | null} */
  #pointed = null;

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
    this.#pointed = null;
    this.#layOut();
  }

  #layOut() {
    const width = this.#svg.clientWidth;
    const states = this.#mode?.states ?? [];
    if (width === 0 || states.length === 0) return;
    const rows = Math.ceil(states.length / Math.max(2, Math.floor((width - 2 * MARGIN_PX) / NARROWEST_PX)));
    const columns = Math.ceil(states.length / rows);
    const pitch = (width - 2 * MARGIN_PX) / columns;
    const box = Math.min(pitch - 10, 150);
    this.#svg.classList.toggle('rows', rows > 1);
    const height = rows > 1 ? rows * ROW_PX : Math.max(ONE_ROW_PX, element('states', HTMLDivElement).clientHeight - WORDS_PX);
    this.#svg.style.height = `${height}px`;
    this.#svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    const middle = (/** @type {number} */ state) => MARGIN_PX + pitch * (state % columns + 0.5);
    const top = (/** @type {number} */ state) => (rows > 1 ? Math.floor(state / columns) * ROW_PX + (ROW_PX - BOX_HEIGHT_PX) / 2 : (height - BOX_HEIGHT_PX) / 2);
    this.#boxes = states.map((state, index) => this.#box(said(state), index, middle(index), top(index), box));
    this.#ways = new Map((this.#mode?.ways ?? []).map(([from, to, when]) => {
      const d = rows > 1 ? straight([middle(from), top(from)], [middle(to), top(to)], box) : arc(middle(from), middle(to), top(0), box, Math.abs(to - from) / states.length);
      return [`${from},${to}`, draw('path', { class: 'way', d, 'marker-end': 'url(#way-end)' }, draw('title', {}, `${said(states[from] ?? '')} → ${said(states[to] ?? '')}: ${said(when)}`))];
    }));
    const end = draw('marker', { id: 'way-end', viewBox: '0 0 6 6', refX: 5, refY: 3, markerWidth: 6, markerHeight: 6, orient: 'auto' }, draw('path', { d: 'M0 0L6 3L0 6z', class: 'way-head' }));
    this.#svg.replaceChildren(draw('defs', {}, end), ...this.#ways.values(), ...this.#boxes);
    this.#lit = '';
    this.draw();
  }

  /** Shows the transitions of a state; null: of the active one. @param {number | null} state */
  #point(state) {
    this.#pointed = state;
    this.#showWays();
  }

  /** In words, when the state is left that is pointed at, or the active one; without one, the first. */
  #showWays() {
    const { states = [], ways = [] } = this.#mode ?? {};
    const of = this.#pointed ?? this.#live ?? 0;
    const known = this.#pointed !== null || this.#live !== null;
    for (const [key, path] of this.#ways) path.classList.toggle('near', known && key.startsWith(`${of},`));
    this.#boxes.forEach((box, state) => box.classList.toggle('next', known && this.#ways.has(`${of},${state}`)));
    this.#list.replaceChildren(...ways.filter(([from]) => from === of).map(([, to, when]) => create('li', {}, create('b', { textContent: `${said(states[of] ?? '')} → ${said(states[to] ?? '')}` }), ` ${said(when)}`)));
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
    const box = draw('g', { class: `state-box s${state % 6}`, tabindex: 0, role: 'img', 'aria-label': `${state} ${name}` },
      draw('rect', { x: x - width / 2, y: top, width, height: BOX_HEIGHT_PX, rx: 5 }),
      draw('text', { x, y: first }, ...rows.map((row, index) => draw('tspan', { x, dy: index === 0 ? 0 : LINE_PX }, row))),
      draw('title', {}, `${state} ${name}`));
    for (const type of ['pointerenter', 'focus']) box.addEventListener(type, () => this.#point(state));
    for (const type of ['pointerleave', 'blur']) box.addEventListener(type, () => this.#point(null));
    return box;
  }

  /** Highlights the state, and the transition that led there. */
  draw() {
    const { last, before } = this.#store.now;
    const own = last && last.mode === this.#mode?.id ? last : null;
    const live = own?.armed ? own.state : null;
    const way = live !== null && before?.armed && before.mode === own?.mode ? `${before.state},${live}` : '';
    const lit = `${live} ${way} ${own?.faulted}`;
    if (lit === this.#lit) return;
    this.#lit = lit;
    this.#live = live;
    this.#showWays();
    this.#boxes.forEach((box, state) => box.classList.toggle('live', state === live));
    for (const [key, path] of this.#ways) path.classList.toggle('taken', key === way);
    const name = live === null ? t(own?.faulted ? 'fault' : 'off') : said(this.#mode?.states[live] ?? '');
    this.#svg.setAttribute('aria-label', t('State machine of the mode; now: {}', name));
  }
}
