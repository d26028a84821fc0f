// @ts-check
/** The events, newest first, each with its cause. */
import { create, element } from './dom.js';
import { format } from './units.js';
import { said, t } from './text.js';

/** @typedef {import('./types.js').LoggedEvent} LoggedEvent */

/** Lines kept on the page. */
const KEPT = 300;
/** The level in a sign too: not by colour alone. */
const SIGNS = { info: '·', good: '✓', warning: '!', fault: '✕' };

export class EventList {
  #list = element('events', HTMLOListElement);
  #newest_s = 0;

  /** @param {(t_s: number) => void} chosen Called with the time of an event that is clicked. */
  constructor(chosen) {
    const choose = (/** @type {Event} */ event) => {
      const line = event.target instanceof Element ? event.target.closest('li') : null;
      if (line?.dataset['t']) chosen(Number(line.dataset['t']));
    };
    this.#list.addEventListener('click', choose);
    this.#list.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') choose(event);
    });
  }

  clear() {
    this.#list.replaceChildren();
  }

  /** @param {LoggedEvent[]} events oldest first */
  add(events) {
    const lines = events.slice(-KEPT).map(({ t_s, level, text }) => create('li', { className: level },
      create('time', { textContent: `${format(t_s, 2)} s` }), create('span', { className: 'sign', textContent: SIGNS[level], title: t(level) }), said(text)));
    const replay = document.body.classList.contains('replay');
    lines.forEach((line, index) => {
      line.dataset['t'] = String(events.slice(-KEPT)[index]?.t_s);
      // There it leads to its time, by keyboard too.
      if (replay) line.tabIndex = 0;
    });
    // Another run has begun: what was before has no time in it.
    if (!replay && events.some(({ t_s }) => t_s < this.#newest_s - 1)) for (const line of this.#list.querySelectorAll('li')) delete line.dataset['t'];
    this.#newest_s = events.at(-1)?.t_s ?? this.#newest_s;
    this.#list.prepend(...lines.reverse());
    while (this.#list.children.length > KEPT) this.#list.lastElementChild?.remove();
  }
}
