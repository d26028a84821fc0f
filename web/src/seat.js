// @ts-check
/** Who has control: told where it is not this page, with what can be done about it. */
import { element, setText } from './dom.js';
import { t } from './text.js';

/** @typedef {import('./types.js').Seat} SeatName */

export class Seat {
  #row = element('seat', HTMLSpanElement);
  #words = element('seat-words', HTMLSpanElement);
  #take = element('take-control', HTMLButtonElement);

  /** @param {(order: import('./types.js').Order) => void} send */
  constructor(send) {
    this.#take.addEventListener('click', () => send({ type: 'take_control' }));
  }

  /** @param {SeatName} seat */
  show(seat) {
    this.#row.hidden = seat === 'driver' || seat === 'free';
    this.#take.hidden = seat !== 'passenger';
    setText(this.#words, seat === 'viewer' ? t('you watch; STOP works') : t('another page has control; STOP works'));
  }
}
