// @ts-check
/** The bar of alarms that need action at once; an alarm stays as long as its cause. */
import { create, element } from './dom.js';
import { said } from './text.js';

/** @typedef {import('./types.js').State} State */

export class Alarm {
  #bar = element('alarm', HTMLDivElement);
  #shown = '';

  /** @param {State} state */
  show({ alarms = [] }) {
    const words = alarms.map(said).join('\n');
    // Read out once, not with each state.
    if (words === this.#shown) return;
    this.#shown = words;
    this.#bar.hidden = alarms.length === 0;
    this.#bar.replaceChildren(...alarms.map((text) => create('p', { textContent: said(text) })));
  }
}
