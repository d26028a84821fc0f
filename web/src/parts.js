// @ts-check
/** What else is at the robot's pins: buttons, switches and potentiometers to work, LEDs and buzzers to look at. */
import { create, element } from './dom.js';
import { shownOf } from './light.js';
import { t } from './text.js';

/** @typedef {import('./types.js').Part} Part */

/** The console that works parts, by lines `name=value`. */
const PARTS = 5;

export class PartsPanel {
  #panel = element('parts', HTMLDivElement);
  #made = '';
  /** @type {[Part, HTMLOutputElement][]} */
  #lights = [];
  #send;

  /** @param {(order: import('./types.js').Order) => void} send */
  constructor(send) {
    this.#send = send;
  }

  /** @param {string} name @param {number} value */
  #put(name, value) {
    this.#send({ type: 'type', usart: PARTS, text: `${name}=${value}`, ending: 'none' });
  }

  /** @param {Part[]} parts @param {(signal: string) => number | null} now the last value of a signal */
  show(parts, now) {
    const kinds = JSON.stringify(parts.map(({ name, kind }) => [name, kind]));
    if (kinds !== this.#made) {
      this.#made = kinds;
      this.#lights = [];
      this.#panel.hidden = parts.length === 0;
      this.#panel.replaceChildren(...parts.map((part) => this.#make(part)));
    }
    for (const [part, light] of this.#lights) {
      const [words, level] = shownOf(part, now);
      light.textContent = words;
      light.style.setProperty('--level', String(level));
    }
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
    const light = create('output', { className: `light ${kind}` });
    this.#lights.push([part, light]);
    return create('span', { className: 'part' }, `${name} `, light);
  }
}
