// @ts-check
/** Output of the USARTs of an emulated chip, or of a robot with the text protocol, and an input line. */
import { create, element } from './dom.js';
import { portName } from './signals.js';
import { t } from './text.js';

/** @typedef {import('./types.js').ConsoleText} ConsoleText */

/** Characters kept of each USART. */
const KEPT = 40_000;

export class Consoles {
  #section = element('console-section', HTMLElement);
  #choice = element('console-choice', HTMLDivElement);
  #text = element('console', HTMLPreElement);
  #line = element('console-text', HTMLInputElement);
  #ending = element('console-ending', HTMLSelectElement);
  /** @type {Map<number, string>} */
  #said = new Map();
  /** @type {number | null} */
  #shown = null;
  #plot = element('console-plot', HTMLButtonElement);
  /** The USART with the Bluetooth module. @type {number | null} */
  #link = null;
  /** Whether a port prints numbers. @type {(usart: number) => boolean} */
  #hasNumbers;

  /**
   * @param {(order: import('./types.js').Order) => void} send
   * @param {(usart: number) => boolean} hasNumbers whether a port prints numbers
   * @param {(usart: number) => void} plot shows them
   */
  constructor(send, hasNumbers, plot) {
    this.#hasNumbers = hasNumbers;
    this.#plot.addEventListener('click', () => {
      if (this.#shown !== null) plot(this.#shown);
    });
    element('console-line', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      if (this.#shown === null) return;
      send({ type: 'type', usart: this.#shown, text: this.#line.value, ending: this.#ending.value });
      this.#line.select();
    });
  }

  /** Discards the previous output. */
  clear() {
    this.#said.clear();
    this.#shown = null;
    this.#section.hidden = true;
    this.#choice.replaceChildren();
    this.#text.textContent = '';
  }

  /** The ports of the student's program: shown before they have sent anything. @param {number | null} link The one with the Bluetooth module. */
  offerPorts(link) {
    this.#link = link;
    for (const usart of link === null ? [0] : [0, link]) this.#offer(usart);
  }

  /** @param {number} usart */
  #name(usart) {
    const own = portName(usart);
    return usart === this.#link && own.startsWith('Serial') && usart > 0 ? t('{} (Bluetooth)', own) : own;
  }

  /** @param {ConsoleText[]} said */
  add(said) {
    for (const { usart, text } of said) {
      this.#offer(usart);
      this.#said.set(usart, ((this.#said.get(usart) ?? '') + text).slice(-KEPT));
    }
    if (said.some(({ usart }) => usart === this.#shown)) this.#show();
  }

  /** Offers a USART, unless it is there. @param {number} usart */
  #offer(usart) {
    if (this.#said.has(usart)) return;
    this.#said.set(usart, '');
    const button = create('button', { type: 'button', value: String(usart) }, this.#name(usart));
    button.addEventListener('click', () => {
      this.#shown = usart;
      this.#show();
    });
    const next = [...this.#choice.querySelectorAll('button')].find((other) => Number(other.value) > usart);
    this.#choice.insertBefore(button, next ?? null);
    this.#section.hidden = false;
    this.#shown ??= usart;
    this.#show();
  }

  #show() {
    const atEnd = this.#text.scrollHeight - this.#text.scrollTop - this.#text.clientHeight < 30;
    this.#text.textContent = this.#said.get(this.#shown ?? -1) ?? '';
    this.#plot.hidden = this.#shown === null || !this.#hasNumbers(this.#shown);
    if (atEnd) this.#text.scrollTop = this.#text.scrollHeight;
    for (const button of this.#choice.querySelectorAll('button')) button.setAttribute('aria-pressed', String(Number(button.value) === this.#shown));
  }
}
