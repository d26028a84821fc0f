// @ts-check
/** Where the program on the emulated chip spends its time: its functions by their share of the cycles, and its interrupts. */
import { create, element, setText } from './dom.js';
import { t } from './text.js';
import { format } from './units.js';

/** @typedef {import('./types.js').State} State */
/** @typedef {import('./types.js').Profile} Profile */

/** @param {number} part @param {number} whole */
const percent = (part, whole) => `${format((100 * part) / Math.max(1, whole))} %`;

/** A whole number, its thousands apart. @param {number} value */
const count = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, '\u202f');

/**
 * A table whose first column is a name.
 * @param {HTMLTableElement} table
 * @param {string} caption
 * @param {[string, string][]} columns Their headings, and what they are.
 */
function prepare(table, caption, columns) {
  const headings = columns.map(([text, title]) => create('th', { textContent: text, title, scope: 'col' }));
  table.append(create('caption', { textContent: caption }), create('thead', {}, create('tr', {}, ...headings)), create('tbody', {}));
}

/** @param {HTMLTableElement} table @param {{cells: string[], share: number}[]} rows */
function fill(table, rows) {
  const made = rows.map(({ cells: [name = '', ...rest], share }) => {
    const heading = create('th', { scope: 'row', textContent: name, title: name });
    heading.style.setProperty('--share', `${format(100 * share, 1).replace(',', '.')}%`);
    return create('tr', {}, heading, ...rest.map((text) => create('td', { textContent: text })));
  });
  table.tBodies[0]?.replaceChildren(...made);
  table.hidden = rows.length === 0;
}

export class ProfilePanel {
  #tab = element('profile-tab', HTMLButtonElement);
  #run = element('profile-run', HTMLButtonElement);
  #about = element('profile-about', HTMLSpanElement);
  #functions = element('profile-functions', HTMLTableElement);
  #interrupts = element('profile-interrupts', HTMLTableElement);
  /** Another panel is shown, since this one has nothing to show any more. */
  #leave;
  #counting = false;
  /** What is shown. */
  #shown = '';

  /** @param {(order: import('./types.js').Order) => void} send @param {() => void} leave */
  constructor(send, leave) {
    this.#leave = leave;
    prepare(this.#functions, t('Functions'), [
      [t('function'), t('Its name, as far as the program has symbols; else its address')],
      [t('own'), t('Share of all cycles in the function itself')],
      [t('with calls'), t('Share of all cycles with the functions that it calls')],
      [t('calls'), t('How often it was called since the count began')],
      [t('cycles each'), t('Mean cycles of a call, with what it calls')],
    ]);
    prepare(this.#interrupts, t('Interrupts'), [
      [t('interrupt'), t('Number and name of the vector in the datasheet')],
      [t('count'), t('How often it was served')],
      [t('per s'), t('How often in a second of the program')],
      [t('share'), t('Share of all cycles')],
      [t('mean'), t('Mean cycles, from the entry to the end of RETI')],
      [t('longest'), t('Most cycles, from the entry to the end of RETI')],
      [t('latest'), t('Most cycles from the request to the first instruction')],
    ]);
    this.#run.addEventListener('click', () => send({ type: 'profile', on: !this.#counting }));
  }

  /** @param {State} state */
  show({ program, replay }) {
    const profile = program?.profile ?? null;
    const absent = !program || (Boolean(replay) && profile === null);
    if (absent && !this.#tab.hidden && this.#tab.ariaSelected === 'true') this.#leave();
    this.#tab.hidden = absent;
    this.#counting = profile !== null;
    this.#run.hidden = Boolean(replay);
    setText(this.#run, this.#counting ? t('Stop counting') : t('Count cycles'));
    setText(this.#about, profile === null ? t('Counts the cycles of the program by function and interrupt. Meanwhile the emulation is about eight times slower.')
      : t('{} s of the program, {} asleep', format(profile.cycles / profile.hertz), percent(profile.asleep, profile.cycles)));
    const all = JSON.stringify(profile);
    if (all === this.#shown) return;
    this.#shown = all;
    this.#fill(profile ?? { cycles: 0, asleep: 0, hertz: 1, functions: [], interrupts: [] });
  }

  /** @param {Profile} profile */
  #fill({ cycles, hertz, functions, interrupts }) {
    const byOwn = [...functions].sort((one, other) => other.own - one.own);
    fill(this.#functions, byOwn.map(({ name, own, total, calls }) => ({
      cells: [name, percent(own, cycles), percent(total, cycles), count(calls), calls === 0 ? '–' : count(Math.round(total / calls))],
      share: own / Math.max(1, cycles),
    })));
    fill(this.#interrupts, interrupts.map(({ vector, name, count: times, total, mean, longest, worst_latency }) => ({
      cells: [`${vector} ${name}`, count(times), format((times * hertz) / Math.max(1, cycles)), percent(total, cycles), count(mean), count(longest), count(worst_latency)],
      share: total / Math.max(1, cycles),
    })));
  }
}
