// @ts-check
/** The time line below the plots of a live robot: dragged back, the map, the numbers and the state are those of then. */
import { element, setText } from './dom.js';
import { t } from './text.js';
import { format } from './units.js';

export class Timeline {
  #range = element('timeline', HTMLInputElement);
  #words = element('timeline-words', HTMLOutputElement);
  #store;
  #redraw;
  /** What is looked at [s]; infinite: the newest. */
  at_s = Infinity;

  /** @param {import('./store.js').Store} store @param {() => void} redraw */
  constructor(store, redraw) {
    this.#store = store;
    this.#redraw = redraw;
    this.#range.addEventListener('input', () => this.lookAt(this.#range.value === this.#range.max ? Infinity : this.#range.valueAsNumber));
  }

  /** Back to the newest. */
  follow() {
    this.lookAt(Infinity);
  }

  /** Shows the map, the numbers and the state of then; infinite: the newest. @param {number} at_s */
  lookAt(at_s) {
    this.at_s = this.#store.playhead_s = at_s;
    document.body.classList.toggle('looking-back', at_s !== Infinity);
    this.#redraw();
  }

  draw() {
    const { oldest_s, newest_s } = this.#store;
    // Another run has begun.
    if (this.at_s !== Infinity && newest_s < this.at_s) this.follow();
    Object.assign(this.#range, { min: String(oldest_s), max: String(newest_s) });
    this.#range.value = String(Math.min(this.at_s, newest_s));
    setText(this.#words, this.at_s === Infinity ? t('present') : `${format(this.at_s, 2)} s, ${t('{} s ago', format(newest_s - this.at_s, 1))}`);
  }
}
