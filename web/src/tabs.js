// @ts-check
/** Panels of which one is visible, selected by tabs above them: click, or the arrow keys. */
import { element } from './dom.js';

export class Tabs {
  #tabs;
  #onChange;

  /**
   * @param {string} id of the list of tabs; each tab names its panel
   * @param {(panel: string) => void} onChange called when another panel is seen
   */
  constructor(id, onChange) {
    this.#onChange = onChange;
    const list = element(id, HTMLDivElement);
    this.#tabs = /** @type {HTMLButtonElement[]} */ ([...list.querySelectorAll('[role="tab"]')]);
    this.#tabs.forEach((tab, index) => {
      tab.addEventListener('click', () => this.show(tab.getAttribute('aria-controls') ?? ''));
      tab.addEventListener('keydown', (event) => {
        const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
        const next = this.#tabs.at((index + step) % this.#tabs.length);
        if (step === 0 || !next || event.defaultPrevented) return;
        next.focus();
        next.click();
      });
    });
  }

  /** @param {string} panel */
  show(panel) {
    for (const tab of this.#tabs) {
      const own = tab.getAttribute('aria-controls') ?? '';
      tab.setAttribute('aria-selected', String(own === panel));
      tab.tabIndex = own === panel ? 0 : -1;
      element(own, HTMLElement).hidden = own !== panel;
    }
    this.#onChange(panel);
  }
}
