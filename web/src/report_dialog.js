// @ts-check
/**
 * *Report*: the experiments of the course, run and written up as one page. On the site a worker makes it, `lab/report.js`,
 * which is loaded when the dialog is opened first; at a station it is a command that makes it, and the dialog says which.
 */
import { complaint, copyButton, dialog, saveFile } from './dialog.js';
import { clickable, create, element, setText, withCode } from './dom.js';
import { language, said, t } from './text.js';
import { Search } from './tune_search.js';
import { format } from './units.js';
import { isSite } from './worker_link.js';

/** @typedef {import('../lab/report.js').News} News */
/** @typedef {import('../lab/report.js').Wanted} Wanted */

const COMMAND = `rumbo experiments --language ${language}`;
/** As `rumbo experiments` calls it. */
const FILE = 'report.html';
const MOST_SEED = 2 ** 32 - 1;

export class ReportDialog {
  #dialog = dialog('report-dialog', t('Report'));
  #experiments = create('fieldset', {}, create('legend', { textContent: t('Experiments') }));
  #all = create('input', { type: 'checkbox', id: 'report-all', checked: true });
  /** By the names of their experiments. @type {Map<string, HTMLInputElement>} */
  #boxes = new Map();
  #seed = create('input', { type: 'number', id: 'report-seed', min: '0', max: String(MOST_SEED), step: '1', value: '1', required: true });
  #make = create('button', { type: 'submit', id: 'report-make', className: 'go', textContent: t('Make the report'), disabled: true });
  #cancel = create('button', { type: 'button', id: 'report-cancel', textContent: t('Cancel'), hidden: true });
  #part = create('progress', { id: 'report-part', max: 1, hidden: true });
  #result = create('div', { className: 'row', id: 'report-result', hidden: true });
  #note = create('output', { className: 'hint' });
  #complaint = complaint();
  /** @type {Worker | null} */
  #worker = null;
  /** What it is to make as soon as it is there. @type {Wanted | null} */
  #wanted = null;
  /** The number of this page, which has to be in control. */
  page = 0;
  /** The page that was made last. */
  #url = '';

  constructor() {
    element('report', HTMLButtonElement).addEventListener('click', () => this.#open());
    this.#part.setAttribute('aria-label', t('Make the report'));
    if (!isSite) {
      this.#make.disabled = false;
      this.#make.addEventListener('click', () => this.#askStation());
      this.#dialog.body.append(
        create('p', { textContent: t('Rumbo writes the report on this computer: every experiment of the course, run faster than real time, with its figures, as one page.') }),
        create('div', { className: 'row' }, this.#make, this.#part, this.#result), this.#complaint,
        create('p', { className: 'hint', textContent: t('The same on the command line:') }), create('div', { className: 'row' }, create('code', { textContent: COMMAND }), copyButton(COMMAND)),
        create('p', { className: 'hint' }, ...withCode(t('`--only mode1 mode5` writes chosen chapters, `--real FOLDER` puts recorded runs of a robot beside ours.'))));
      return;
    }
    this.#experiments.append(create('label', {}, this.#all, ` ${t('all')}`));
    this.#all.addEventListener('change', () => this.#boxes.forEach((box) => { box.checked = this.#all.checked; }));
    this.#cancel.addEventListener('click', () => this.#end());
    const form = create('form', { className: 'stack' }, this.#experiments,
      create('div', { className: 'row' }, create('label', {}, `${t('seed')} `, this.#seed), this.#make, this.#cancel, this.#part));
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#begin();
    });
    this.#dialog.body.append(
      create('p', { textContent: t('Runs the experiments of the course, faster than real time, and writes them up with their figures as one page, in the language of this one. On a computer `rumbo experiments` writes the same page, byte for byte.') }),
      form, this.#result, this.#complaint);
  }

  #open() {
    this.#dialog.open();
    if (isSite) this.#start();
  }

  /** The station makes it, in threads beside its session. */
  #askStation() {
    setText(this.#complaint, '');
    this.#result.hidden = true;
    this.#show(true);
    this.#cancel.hidden = true;
    const search = new Search(this.page, { report: language }, {
      share: (share) => { this.#part.value = share; },
      found: ({ page }) => {
        search.end();
        this.#offer(new TextEncoder().encode(page));
      },
      failed: (why) => {
        search.end();
        this.#show(false);
        setText(this.#complaint, said(why));
      },
    });
  }

  /** Loads what makes reports, unless it is there. */
  #start() {
    if (this.#worker) return;
    setText(this.#complaint, '');
    const worker = new Worker(new URL('../lab/report.js', import.meta.url), { type: 'module', name: language });
    worker.addEventListener('message', ({ data }) => this.#take(data));
    worker.addEventListener('error', (event) => this.#fail(event.message || 'its program could not be loaded'));
    this.#worker = worker;
  }

  #begin() {
    const chosen = [...this.#boxes].flatMap(([name, box]) => (box.checked ? [name] : []));
    if (chosen.length === 0) return setText(this.#complaint, t('choose an experiment'));
    this.#wanted = { only: chosen.length === this.#boxes.size ? [] : chosen, seed: Number(this.#seed.value) };
    setText(this.#complaint, '');
    this.#result.hidden = true;
    this.#show(true);
    if (this.#worker) this.#order();
    else this.#start();
    return undefined;
  }

  #order() {
    if (this.#wanted) this.#worker?.postMessage(this.#wanted);
    this.#wanted = null;
  }

  /** Ends the worker, and what it makes. */
  #end() {
    this.#worker?.terminate();
    this.#worker = this.#wanted = null;
    this.#show(false);
  }

  /** @param {string} why */
  #fail(why) {
    this.#end();
    const loaded = this.#boxes.size > 0;
    setText(this.#complaint, loaded ? said(why) : t('The report is not here: {}. Without a network it can be made where it has been made before.', said(why)));
  }

  /** @param {boolean} works */
  #show(works) {
    this.#make.disabled = works;
    this.#cancel.hidden = this.#part.hidden = !works;
    this.#part.value = 0;
  }

  /** @param {News} news */
  #take(news) {
    if (typeof news === 'number') this.#part.value = news;
    else if ('error' in news) this.#fail(news.error);
    else if ('page' in news) this.#offer(news.page);
    else {
      if (this.#boxes.size === 0) for (const { name, title } of news.experiments) this.#add(name, title);
      if (this.#wanted) this.#order();
      else this.#make.disabled = false;
    }
  }

  /** @param {string} name @param {string} title */
  #add(name, title) {
    const box = create('input', { type: 'checkbox', checked: this.#all.checked });
    box.addEventListener('change', () => { this.#all.checked = [...this.#boxes.values()].every(({ checked }) => checked); });
    this.#boxes.set(name, box);
    this.#experiments.append(create('label', {}, box, ` ${title}`));
  }

  /** @param {Uint8Array<ArrayBuffer>} page */
  #offer(page) {
    this.#show(false);
    const file = new Blob([page], { type: 'text/html' });
    URL.revokeObjectURL(this.#url);
    this.#url = URL.createObjectURL(file);
    const save = clickable({ textContent: t('Save') }, () => saveFile(FILE, file));
    const open = create('a', { href: this.#url, target: '_blank', textContent: t('Open the report') });
    setText(this.#note, `${FILE}, ${format(page.length / 1e3, 0)} kB`);
    // The station allows its own pages no styles within: the saved file shows them.
    this.#result.replaceChildren(...(isSite ? [open] : []), save, this.#note);
    this.#result.hidden = false;
    (isSite ? open : save).focus();
  }
}
