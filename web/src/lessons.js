// @ts-check
/**
 * The lessons, in a pane beside the lab: a link of a lesson starts its run here, and the empty cells of the row that it stands
 * in take the figures of the first step. What is written there is handed in by `hand_in.js`.
 */
import { create, element } from './dom.js';
import { HandIn } from './hand_in.js';
import { Lesson } from './markdown.js';
import { readLink } from './run_link.js';
import { language, t } from './text.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').Parameter} Parameter */

/** Figures of a step by the words that head a column. */
const COLUMNS = () => /** @type {const} */ ([['rise_s', t('rise')], ['overshoot', t('overshoot')], ['settling_s', t('settling')], ['steady_error', t('steady error')]]);

export class Lessons {
  #send;
  #pane = element('lesson', HTMLElement);
  #body = element('lesson-body', HTMLDivElement);
  #handIn = new HandIn(this.#body);
  /** What the robot is still to be told, once its run has begun. @type {{run: number, parameters: Map<string, number>} | null} */
  #due = null;
  #run = 0;
  /** The row whose run goes on. @type {HTMLTableRowElement | null} */
  #row = null;
  /** Where the reader is, kept by the browser. */
  #shown = '';

  /** @param {import('./panel.js').Send} send */
  constructor(send) {
    this.#send = send;
    // The site has them as pages.
    element('lessons', HTMLButtonElement).hidden = isSite;
    element('lessons', HTMLButtonElement).addEventListener('click', () => (this.#pane.hidden ? this.open() : this.close()));
    element('lesson-close', HTMLButtonElement).addEventListener('click', () => this.close());
    element('lesson-list', HTMLButtonElement).addEventListener('click', () => this.open('README.md'));
  }

  close() {
    this.#pane.hidden = true;
    document.body.classList.remove('lesson');
  }

  /** @param {string} [name] of a file; none: where the reader was */
  async open(name = this.#shown || 'README.md') {
    this.#pane.hidden = false;
    document.body.classList.add('lesson');
    if (name === this.#shown) return;
    const answer = await fetch(`lessons/${language}/${name}`).catch(() => null);
    if (!answer?.ok) return this.#body.replaceChildren(create('p', { className: 'complaint', textContent: t('the station does not answer') }));
    this.#shown = name;
    const lesson = new Lesson((href, title) => this.#link(href, title));
    this.#body.replaceChildren(...lesson.read(await answer.text()));
    this.#handIn.add(lesson.title, name);
    this.#body.scrollTop = 0;
  }

  /** A run, another lesson, or a document that is not here. @param {string} href @param {string} title @returns {HTMLElement} */
  #link(href, title) {
    const [, run] = /web\/index\.html#(.*)/.exec(href) ?? [];
    const [, lesson] = /^([\w-]+\.md)$/.exec(href) ?? [];
    if (run === undefined && lesson === undefined) return create('span', { title });
    const button = create('button', { type: 'button', className: 'link', title: run === undefined ? '' : t('Start this run: the robot waits for ON') });
    if (run !== undefined) button.dataset['run'] = run;
    button.addEventListener('click', () => (run === undefined ? this.open(lesson) : this.#start(run, button)));
    return button;
  }

  /** @param {string} run @param {HTMLElement} link */
  #start(run, link) {
    const { scenario = '', world = null, rig = null, seed = 1, parameters = {} } = readLink(run).start;
    this.#row = link.closest('tr');
    for (const each of this.#body.querySelectorAll('tr.now')) each.classList.remove('now');
    this.#row?.classList.add('now');
    this.#due = { run: this.#run, parameters: new Map(Object.entries(parameters)) };
    this.#send({ type: 'reset', scenario, world, rig, seed });
  }

  /** @param {number} run */
  setRun(run) {
    this.#run = run;
  }

  /** The robot's parameters are known: those of the lesson are set. @param {Parameter[]} table */
  setParameters(table) {
    if (!this.#due || this.#run === this.#due.run) return;
    for (const { id, name, value: held } of table) {
      const value = this.#due.parameters.get(name);
      if (value === undefined || held === null) continue;
      this.#due.parameters.delete(name);
      this.#send({ type: 'set_param', id, value });
    }
    if (this.#due.parameters.size === 0) this.#due = null;
  }

  /** The first step of the run is over. @param {Record<string, string>} figures as they are shown */
  fill(figures) {
    const heads = [...this.#row?.closest('table')?.querySelectorAll('th') ?? []].map(({ textContent }) => textContent ?? '');
    for (const [key, word] of COLUMNS()) {
      const cell = this.#row?.cells[heads.findIndex((head) => head.startsWith(word))];
      const input = cell?.querySelector('input');
      if (input) input.value = figures[key]?.replace(/ (s|cm|rpm)$/, '') ?? '';
    }
    if (this.#row) this.#handIn.keep();
  }
}
