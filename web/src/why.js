// @ts-check
/** *Explain this*: what explains the stretch that the plots show, by the rules of the station (`explain.rs` of the session). */
import { wordsOf } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { ask } from './key.js';
import { said, t } from './text.js';
import { format } from './units.js';
import { isSite } from './worker_link.js';

/** @typedef {{kind: string, from_s: number, to_s: number, text: string, lesson: string | null}} Cause */

/** Around a cause so much is shown [s]. */
const AROUND_S = 0.5;

export class Why {
  #list = create('ol', { className: 'causes' });
  #words = create('span', { className: 'hint' });
  #plots;
  #open;
  #ask;

  /**
   * @param {import('./plots.js').Plots} plots
   * @param {((from_s: number, to_s: number) => Promise<string>) | null} askLab asks the lab of the site
   * @param {(lesson: string) => void} openLesson
   * @param {() => void} show makes them seen
   */
  constructor(plots, askLab, openLesson, show) {
    this.#plots = plots;
    this.#open = openLesson;
    const robot = () => /^#(robot=.*)/.exec(location.hash)?.[1];
    this.#ask = askLab ?? ((from_s, to_s) => ask(`/explain?from=${from_s}&to=${to_s}${robot() ? `&${robot()}` : ''}`));
    this.clear();
    element('why', HTMLDivElement).append(create('div', { className: 'row' }, this.#words), this.#list);
    const button = element('explain', HTMLButtonElement);
    button.addEventListener('click', () => {
      show();
      this.#explain();
    });
  }

  /** What was explained is of another run. */
  clear() {
    setText(this.#words, t('What explains the time that the plots show: zoom into a piece first'));
    this.#list.replaceChildren();
  }

  async #explain() {
    // What the plots show: all of it, or what was zoomed into.
    const [from_s, to_s] = this.#plots.range_s;
    try {
      /** @type {Cause[]} */
      const causes = JSON.parse(await this.#ask(from_s, to_s));
      setText(this.#words, t(causes.length > 0 ? 'from {} to {} s, what explains most first:' : 'from {} to {} s no rule finds anything unusual', format(Math.max(0, from_s), 1), format(to_s, 1)));
      this.#list.replaceChildren(...causes.map((cause) => this.#line(cause)));
    } catch (error) {
      setText(this.#words, wordsOf(error));
      this.#list.replaceChildren();
    }
  }

  /** @param {Cause} cause */
  #line({ from_s, to_s, text, lesson }) {
    const at = clickable({ className: 'small', textContent: `${format(from_s, 2)} s`, title: t('Show it in the plots') }, () => this.#plots.zoom(from_s - AROUND_S, to_s + AROUND_S));
    const learn = clickable({ className: 'link', textContent: t('lesson {}', lesson?.split('-')[0] ?? '') }, () => this.#open(`${lesson}.md`));
    return create('li', {}, at, ` ${said(text)} `, ...(lesson === null || isSite ? [] : [learn]));
  }
}
