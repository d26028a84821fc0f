// @ts-check
/** The bar over the page that reports a lost station, the consequences, and its return. */
import { element, setText } from './dom.js';
import { said, t } from './text.js';

/** @typedef {import('./link.js').Connection} Connection */

/** How long the good news is shown [ms]. */
const GOOD_NEWS_MS = 5_000;

export class Notice {
  #bar = element('notice', HTMLDivElement);
  /** When it was lost, as a clock shows it; null: it is not. @type {string | null} */
  #since = null;
  #known = false;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  #timer;

  /** @param {Connection} now @param {string | null} why the station closed the connection, if it said so */
  show(now, why) {
    clearTimeout(this.#timer);
    if (now === 'open') return this.#back();
    this.#since ??= new Date().toTimeString().slice(0, 8);
    return this.#say('bad', this.#words(now, why));
  }

  /** @param {Connection} now @param {string | null} why */
  #words(now, why) {
    // A log has no robot to stop.
    const old = this.#known && !document.body.classList.contains('replay') ? ` ${t('What is shown is of {}, and STOP does not reach the robot.', this.#since ?? '')}` : '';
    const robot = document.body.classList.contains('at-port') ? ` ${t('With Rumbo\'s program the robot stops by itself, for lack of a heartbeat.')}` : '';
    if (now === 'ended') return t('The lab of this page has ended: {}. Load the page again.', said(why ?? '')) + robot;
    if (now === 'used') return t('This address opens once, and was opened before. Go on in the browser in which it was opened, or press Enter where rumbo runs: it prints another address.');
    if (now === 'locked' && !this.#known) return t('This browser has no key to the station: open the address that rumbo printed when it started.');
    if (now === 'locked') return `${t('The station was started again, with a new key: open the address that it printed.')}${old}`;
    return `${why ? t('No connection to the station: {}. Trying again…', said(why)) : t('No connection to the station. Trying again…')}${old}`;
  }

  #back() {
    if (this.#since !== null && this.#known) {
      this.#say('good', t('The station is back; it was gone since {}.', this.#since));
      this.#timer = setTimeout(() => { this.#bar.hidden = true; }, GOOD_NEWS_MS);
    } else {
      this.#bar.hidden = true;
    }
    this.#since = null;
    this.#known = true;
  }

  /** @param {string} level @param {string} text */
  #say(level, text) {
    this.#bar.className = level;
    this.#bar.hidden = false;
    setText(this.#bar, text);
  }
}
