// @ts-check
/** Shows who has control where it is not obvious: to viewers, and where several pages are open. */
import { create, element, setText } from './dom.js';
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
    document.body.classList.toggle('passenger', seat === 'passenger');
  }
}

/** What a page may send without control. */
const FREE = ['stop', 'take_control', 'release_control', 'sketch'];
/** How long the refusal is shown [ms]. */
const SHOWN_MS = 2_500;

/** Whether an order is for the page that drives, which this one is not: that is said where it was pressed. @param {import('./types.js').Order} order */
export function isOthers({ type }) {
  if (!document.body.classList.contains('passenger') || FREE.includes(type)) return false;
  document.getElementById('nope')?.remove();
  const pressed = document.activeElement instanceof HTMLElement && document.activeElement !== document.body ? document.activeElement : element('seat', HTMLDivElement);
  const { left, bottom } = pressed.getBoundingClientRect();
  const bubble = create('output', { id: 'nope', textContent: t('refused: another page has control; take it first') });
  bubble.setAttribute('role', 'alert');
  document.body.append(bubble);
  bubble.style.left = `${Math.max(4, Math.min(left, innerWidth - bubble.offsetWidth - 8))}px`;
  bubble.style.top = `${Math.min(bottom + 4, innerHeight - bubble.offsetHeight - 8)}px`;
  setTimeout(() => bubble.remove(), SHOWN_MS);
  return true;
}

/** @param {Control} control */
function words({ seat, page, holder }) {
  if (seat === 'viewer') return holder === null ? t('you watch, nobody has control; STOP works') : t('you watch, page {} has control; STOP works', holder);
  if (seat === 'driver') return t('this is page {}, it has control', page);
  return holder === null ? t('this is page {}, nobody has control', page) : t('page {} has control, this is page {}; STOP works', holder, page);
}
