// @ts-check
/**
 * The first minute in four steps, shown once in each browser: beside what is explained, never over it, and skipped at any
 * time. What a step asks for takes it to the next one; so does its button.
 */
import { create, setText } from './dom.js';
import { keep, recall } from './stored.js';
import { t } from './text.js';

/** @typedef {import('./types.js').State} State */
/** A step: what it points at, what it says, and what fulfils it, compared with its beginning. @typedef {{at: string, text: string, done?: (now: State, before: State) => boolean}} Step */

/** @returns {Step[]} */
const STEPS = () => [
  { at: '#map-section', text: t('This is the robot from above, in a simulation: nothing can break. The cones are what its sonars see.') },
  { at: '#on', text: t('Press ON: the robot starts the chosen mode. STOP, or the space bar, releases the wheels at any time.'), done: (now) => now.robot.armed },
  {
    at: '#reference', text: t('Enter another setpoint and press Set. In the plot the thick curve follows the dashed line.'),
    done: (now, before) => now.robot.reference.some((value, index) => value !== before.robot.reference[index]),
  },
  { at: '#scenario', text: t('This menu has other experiments, each with its own world. ⤢ enlarges a panel, ? explains keys and colours.') },
];

export class Tour {
  #text = create('p');
  #count = create('span', { className: 'hint' });
  #next = create('button', { type: 'button', className: 'go', textContent: t('Next') });
  #card = create('aside', { id: 'tour', hidden: true });
  #steps = STEPS();
  #step = 0;
  /** When this step began. @type {State | null} */
  #before = null;
  #offered = false;

  constructor() {
    const skip = create('button', { type: 'button', textContent: t('Skip') });
    this.#card.setAttribute('aria-label', t('First steps'));
    this.#card.append(this.#text, create('div', { className: 'row' }, this.#count, create('span', { className: 'spacer' }), skip, this.#next));
    skip.addEventListener('click', () => this.end());
    this.#next.addEventListener('click', () => this.#go(this.#step + 1));
    document.body.append(this.#card);
  }

  /** Begins by itself where nobody has seen it. */
  offer() {
    if (this.#offered || recall('tour') !== null) return;
    this.#offered = true;
    this.begin();
  }

  begin() {
    this.#card.hidden = false;
    this.#go(0);
  }

  /** @param {State} state */
  show(state) {
    if (this.#card.hidden) return;
    this.#before ??= state;
    if (this.#steps[this.#step]?.done?.(state, this.#before)) this.#go(this.#step + 1);
  }

  /** @param {number} step */
  #go(step) {
    const { at, text } = this.#steps[step] ?? {};
    if (!at || !text) return this.end();
    this.#step = step;
    this.#before = null;
    this.#point(at);
    setText(this.#text, text);
    setText(this.#count, t('step {} of {}', step + 1, this.#steps.length));
    setText(this.#next, step + 1 === this.#steps.length ? t('Done') : t('Next'));
    return undefined;
  }

  /** Frames what a step is about. @param {string | null} at */
  #point(at) {
    for (const each of document.querySelectorAll('.pointed')) each.classList.remove('pointed');
    const target = at === null ? null : document.querySelector(at);
    target?.classList.add('pointed');
    target?.scrollIntoView({ block: 'center' });
  }

  /** Over, and seen; so it is where a program of the reader's drives, of whose buttons it knows nothing. */
  end() {
    if (this.#card.hidden) return;
    this.#card.hidden = true;
    this.#point(null);
    keep('tour', 'seen');
  }
}
