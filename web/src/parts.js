// @ts-check
/** What else is at the robot's pins: buttons, switches and potentiometers to work, LEDs, buzzers, displays and sensors to look at. */
import { contentsOf, drawDots, drawLetters } from './displays.js';
import { create, element } from './dom.js';
import { isSensor, shownOf } from './light.js';
import { t } from './text.js';

/** @typedef {import('./types.js').Part} Part */

/** The console that works parts and tells what displays show, by lines `name=value`. */
export const PARTS = 5;

/** Keys of a remote control that have arrows. */
const ARROWS = new Map([['up', '▲'], ['left', '◀'], ['right', '▶'], ['down', '▼']]);
/** A key that is held is pressed again before the receiver takes it for released. */
const AGAIN_MS = 100;

/** What is on the two-wire bus, and where. @param {Part} part */
const onBus = ({ kind, address }) => (address === undefined ? kind.toUpperCase() : t('{} at address {}', kind.toUpperCase(), `0x${address.toString(16)}`));

export class PartsPanel {
  #panel = element('parts', HTMLDivElement);
  #made = '';
  /** @type {[Part, HTMLOutputElement][]} */
  #lights = [];
  /** What draws each display, and what it shows. @type {Map<string, (content: any) => void>} */
  #draws = new Map();
  /** @type {ReturnType<typeof contentsOf>} */
  #contents = new Map();
  #send;

  /** @param {(order: import('./types.js').Order) => void} send */
  constructor(send) {
    this.#send = send;
  }

  /** @param {string} name @param {number | string} value */
  #put(name, value) {
    this.#send({ type: 'type', usart: PARTS, text: `${name}=${value}`, ending: 'none' });
  }

  /** Another run begins. */
  clear() {
    this.#contents.clear();
    this.#made = '';
  }

  /** Takes what displays show. @param {string} text */
  tell(text) {
    for (const [name, content] of contentsOf(text)) {
      this.#contents.set(name, content);
      this.#draws.get(name)?.(content);
    }
  }

  /** @param {Part[]} parts @param {(signal: string) => number | null} now the last value of a signal */
  show(parts, now) {
    const kinds = JSON.stringify(parts.map(({ name, kind, keys }) => [name, kind, keys]));
    if (kinds !== this.#made) {
      this.#made = kinds;
      this.#lights = [];
      this.#draws.clear();
      this.#panel.hidden = parts.length === 0;
      this.#panel.replaceChildren(...parts.map((part) => this.#make(part)));
      for (const [name, content] of this.#contents) this.#draws.get(name)?.(content);
    }
    for (const [part, light] of this.#lights) {
      const [words, level] = shownOf(part, now);
      light.textContent = words;
      light.style.setProperty('--level', String(level));
    }
  }

  /** A remote control: a key that is held says so again and again. @param {Part} part */
  #remote({ name, keys = [] }) {
    const panel = create('div', { className: 'remote' });
    panel.setAttribute('role', 'group');
    panel.setAttribute('aria-label', name);
    panel.append(...keys.map((key) => {
      const shown = ARROWS.get(key) ?? key;
      const button = create('button', { type: 'button', className: `small key-${key}`, title: t('Held down, the key repeats') }, shown);
      if (shown !== key) button.setAttribute('aria-label', key);
      const press = () => this.#put(name, key);
      let again = 0;
      const release = () => clearInterval(again);
      button.addEventListener('pointerdown', () => {
        release();
        press();
        again = window.setInterval(press, AGAIN_MS);
      });
      for (const end of /** @type {const} */ (['pointerup', 'pointerleave', 'pointercancel', 'blur'])) button.addEventListener(end, release);
      button.addEventListener('keydown', (event) => {
        if (event.key === ' ' || event.key === 'Enter') press();
      });
      return button;
    }));
    return create('span', { className: 'part' }, `${name} `, panel);
  }

  /** @param {Part} part */
  #make(part) {
    const { name, kind, percent } = part;
    if (kind === 'button') {
      const button = create('button', { type: 'button', className: 'small', title: t('Held down, the button is pressed') }, name);
      const put = (/** @type {number} */ value) => () => this.#put(name, value);
      button.addEventListener('pointerdown', put(1));
      for (const end of /** @type {const} */ (['pointerup', 'pointerleave', 'pointercancel', 'blur'])) {
        button.addEventListener(end, () => {
          if (button.dataset.held) this.#put(name, 0);
          delete button.dataset.held;
        });
      }
      button.addEventListener('pointerdown', () => { button.dataset.held = '1'; });
      button.addEventListener('keydown', (event) => {
        if ((event.key !== ' ' && event.key !== 'Enter') || button.dataset.held) return;
        button.dataset.held = '1';
        this.#put(name, 1);
      });
      button.addEventListener('keyup', () => {
        if (button.dataset.held) this.#put(name, 0);
        delete button.dataset.held;
      });
      return button;
    }
    if (kind === 'switch') {
      const box = create('input', { type: 'checkbox', checked: percent > 50 });
      box.addEventListener('change', () => this.#put(name, box.checked ? 1 : 0));
      return create('label', {}, box, ` ${name}`);
    }
    if (kind === 'potentiometer') {
      const range = create('input', { type: 'range', min: '0', max: '100', value: String(percent) });
      range.addEventListener('input', () => this.#put(name, Number(range.value) / 100));
      return create('label', {}, `${name} `, range);
    }
    if (kind === 'infrared') return this.#remote(part);
    if (kind === 'ssd1306') {
      const screen = create('canvas', { className: 'screen', width: 128, height: 64 });
      screen.setAttribute('role', 'img');
      screen.setAttribute('aria-label', name);
      this.#draws.set(name, (content) => drawDots(screen, content));
      return create('span', { className: 'part', title: onBus(part) }, `${name} `, screen);
    }
    if (kind === 'hd44780') {
      const letters = create('div', { className: 'letters' });
      letters.setAttribute('role', 'img');
      letters.setAttribute('aria-label', name);
      this.#draws.set(name, (content) => drawLetters(letters, content));
      return create('span', { className: 'part', title: onBus(part) }, `${name} `, letters);
    }
    const light = create('output', { className: isSensor(kind) ? '' : `light ${kind}` });
    this.#lights.push([part, light]);
    if (isSensor(kind)) {
      const origin = create('small', {}, ` ${t('by its data sheet, not identified')}`);
      return create('span', { className: 'part', title: onBus(part) }, `${name} `, light, origin);
    }
    return create('span', { className: 'part' }, `${name} `, light);
  }
}
