// @ts-check
/** Shows who has control where it is not obvious: to viewers, and where several pages are open. */
import { element, setText } from './dom.js';
import { t } from './text.js';

/** @typedef {{seat: import('./types.js').Seat, page: number, holder: number | null, pages: number}} Control */

export class Seat {
  #row = element('seat', HTMLDivElement);
  #words = element('seat-words', HTMLSpanElement);
  #take = element('take-control', HTMLButtonElement);
  #release = element('release-control', HTMLButtonElement);

  /** @param {(order: import('./types.js').Order) => void} send */
  constructor(send) {
    this.#take.addEventListener('click', () => send({ type: 'take_control' }));
    this.#release.addEventListener('click', () => send({ type: 'release_control' }));
  }

  /** @param {Control} control */
  show(control) {
    const { seat, pages } = control;
    this.#row.hidden = seat !== 'viewer' && pages < 2;
    this.#take.hidden = seat !== 'passenger' && seat !== 'free';
    this.#release.hidden = seat !== 'driver';
    setText(this.#words, words(control));
    this.#row.className = `row ${seat === 'driver' || seat === 'free' ? '' : 'warning'}`;
    document.body.classList.toggle('viewer', seat === 'viewer');
  }
}

/** @param {Control} control */
function words({ seat, page, holder }) {
  if (seat === 'viewer') return holder === null ? t('you watch, nobody has control; STOP works') : t('you watch, page {} has control; STOP works', holder);
  if (seat === 'driver') return t('this is page {}, it has control', page);
  return holder === null ? t('this is page {}, nobody has control', page) : t('page {} has control, this is page {}; STOP works', holder, page);
}
