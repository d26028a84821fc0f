// @ts-check
/** Output of the USARTs of an emulated chip, or of a robot with the text protocol, and an input line. */
import { create, element } from './dom.js';

/** @typedef {import('./types.js').ConsoleText} ConsoleText */

/** Characters kept of each USART. */
const KEPT = 40_000;

/** In place of a USART: the link to a robot with the text protocol. */
const LINK = 255;

/** A port as the student's program calls it. @param {number} usart */
const name = (usart) => (usart === LINK ? 'link' : usart === 0 ? 'Serial (USB)' : `Serial${usart}`);

export class Consoles {
  #section = element('console-section', HTMLElement);
  #choice = element('console-choice', HTMLDivElement);
  #text = element('console', HTMLPreElement);
  #line = element('console-text', HTMLInputElement);
  /** @type {Map<number, string>} */
  #said = new Map();
  /** @type {number | null} */
  #shown = null;

  /** @param {(order: import('./types.js').Order) => void} send */
  constructor(send) {
    element('console-line', HTMLFormElement).addEventListener('submit', (event) => {
      event.preventDefault();
      if (this.#shown === null) return;
      send({ type: 'type', usart: this.#shown, text: this.#line.value });
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

  /** @param {ConsoleText[]} said */
  add(said) {
    for (const { usart, text } of said) {
      if (!this.#said.has(usart)) this.#offer(usart);
      this.#said.set(usart, ((this.#said.get(usart) ?? '') + text).slice(-KEPT));
    }
    if (said.some(({ usart }) => usart === this.#shown)) this.#show();
  }

  /** The USART has sent something for the first time. @param {number} usart */
  #offer(usart) {
    const button = create('button', { type: 'button', value: String(usart) }, name(usart));
    button.addEventListener('click', () => {
      this.#shown = usart;
      this.#show();
    });
    const next = [...this.#choice.querySelectorAll('button')].find((other) => Number(other.value) > usart);
    this.#choice.insertBefore(button, next ?? null);
    this.#section.hidden = false;
    this.#shown ??= usart;
  }

  #show() {
    const atEnd = this.#text.scrollHeight - this.#text.scrollTop - this.#text.clientHeight < 30;
    this.#text.textContent = this.#said.get(this.#shown ?? -1) ?? '';
    if (atEnd) this.#text.scrollTop = this.#text.scrollHeight;
    for (const button of this.#choice.querySelectorAll('button')) button.setAttribute('aria-pressed', String(Number(button.value) === this.#shown));
  }
}
