// @ts-check
/**
 * What a student does with a lesson: writes figures into its empty cells and answers below, compares the figures with those
 * that the lesson gives for the same run, and saves all as a Markdown file to hand in. The tab keeps what is written: another
 * lesson may be looked at, and the page loaded again.
 */
import { saveFile } from './dialog.js';
import { clickable, create } from './dom.js';
import { keep, recall } from './stored.js';
import { t } from './text.js';
import { formatFloat, parse } from './units.js';

/** Figures are equal when they differ by no more than this share, or by this. */
const [SHARE, LEAST] = [0.05, 0.1];

/** The run that a row opens. @param {HTMLTableRowElement} row */
const runOf = (row) => row.querySelector('button')?.dataset['run'] ?? null;
/** @param {Element | undefined} cell */
const textOf = (cell) => (cell?.querySelector('input')?.value ?? cell?.textContent ?? '').trim();
/** The words that head the columns. @param {HTMLTableElement} table */
const headsOf = (table) => [...table.querySelectorAll('th')].map((head) => textOf(head));

export class HandIn {
  #body;
  #title = '';
  #key = '';
  #summary = create('output', { className: 'hint' });
  #name = create('input', { type: 'text', id: 'hand-in-name', maxLength: 80 });
  #answers = create('textarea', { id: 'hand-in-answers', rows: 5, maxLength: 8_000 });

  /** @param {HTMLElement} body of the lesson */
  constructor(body) {
    this.#body = body;
    body.addEventListener('input', () => this.keep());
  }

  /** What is written: cell by cell, the name, the answers. */
  get #fields() {
    return [.../** @type {NodeListOf<HTMLInputElement>} */ (this.#body.querySelectorAll('td.own input')), this.#name, this.#answers];
  }

  keep() {
    keep(this.#key, JSON.stringify(this.#fields.map(({ value }) => value)), 'sessionStorage');
  }

  /** Prepares a lesson that is shown: its empty cells take figures. @param {string} title @param {string} file */
  add(title, file) {
    this.#title = title;
    this.#key = `lesson.${file}`;
    const cells = [...this.#body.querySelectorAll('td.own')];
    for (const cell of cells) {
      const row = cell.closest('tr');
      const head = headsOf(/** @type {HTMLTableElement} */ (cell.closest('table')))[/** @type {HTMLTableCellElement} */ (cell).cellIndex] ?? '';
      const input = create('input', { type: 'text', inputMode: 'decimal', maxLength: 12 });
      input.setAttribute('aria-label', `${textOf(row?.cells[0])}: ${head}`);
      cell.replaceChildren(input);
    }
    if (cells.length === 0) return;
    this.#summary.textContent = this.#answers.value = '';
    /** @type {string[]} */
    const written = JSON.parse(recall(this.#key, 'sessionStorage') ?? '[]');
    this.#fields.forEach((field, index) => { field.value = written[index] || field.value; });
    this.#body.append(create('section', { className: 'stack', id: 'hand-in' }, create('h3', { textContent: t('Hand in') }),
      create('label', {}, `${t('name')} `, this.#name), create('label', { className: 'stack' }, t('hypotheses and answers'), this.#answers),
      create('div', { className: 'row' },
        clickable({
          id: 'hand-in-check', className: 'small', textContent: t('Check the figures'),
          title: t('Compare the figures in the tables with those that the lesson gives for the same runs'),
        }, () => this.#check()),
        clickable({
          id: 'hand-in-save', className: 'small', textContent: t('Save to hand in'),
          title: t('Save name, tables with their runs, and answers as a Markdown file'),
        }, () => this.#save()), this.#summary)));
  }

  get #tables() {
    return [...this.#body.querySelectorAll('table')].map((table) => ({ heads: headsOf(table), own: table.querySelector('td.own') !== null, rows: [...table.tBodies[0]?.rows ?? []] }));
  }

  /** The figure that the lesson gives. @param {string | null} run @param {string} head */
  #given(run, head) {
    for (const { heads, own, rows } of this.#tables) {
      const column = heads.indexOf(head);
      const row = own || column < 0 ? undefined : rows.find((each) => runOf(each) === run);
      if (row) return parse(textOf(row.cells[column]));
    }
    return NaN;
  }

  #check() {
    let [right, wrong, empty] = [0, 0, 0];
    for (const { heads, rows } of this.#tables) {
      for (const cell of rows.flatMap((row) => [...row.querySelectorAll('td')]).filter((each) => each.classList.contains('own'))) {
        const row = /** @type {HTMLTableRowElement} */ (cell.closest('tr'));
        const [own, given] = [parse(textOf(cell)), this.#given(runOf(row), heads[cell.cellIndex] ?? '')];
        cell.classList.remove('right', 'wrong');
        if (Number.isNaN(own)) empty += 1;
        if (Number.isNaN(own) || Number.isNaN(given)) continue;
        const agrees = Math.abs(own - given) <= Math.max(LEAST, SHARE * Math.abs(given));
        cell.classList.add(agrees ? 'right' : 'wrong');
        cell.title = agrees ? '' : t('the lesson gives {}', formatFloat(given));
        if (agrees) right += 1;
        else wrong += 1;
      }
    }
    this.#summary.textContent = t('{} agree, {} do not, {} are empty', right, wrong, empty);
  }

  #save() {
    const tables = this.#tables.filter(({ own }) => own).map(({ heads, rows }) => {
      const line = (/** @type {string[]} */ cells) => `| ${cells.map((cell) => cell.replaceAll('|', '\\|')).join(' | ')} |`;
      const body = rows.map((row) => line([...[...row.cells].map((cell) => textOf(cell)), runOf(row) === null ? '' : `\`${runOf(row)}\``]));
      return [line([...heads, t('run')]), line([...heads, ''].map(() => '---')), ...body].join('\n');
    });
    const text = [`# ${this.#title}`, this.#name.value, ...tables, this.#answers.value].map((part) => part.trim()).filter(Boolean).join('\n\n');
    const file = `${this.#title} ${this.#name.value}`.replace(/[^\p{Letter}\d]+/gu, '-').replace(/^-|-$/g, '');
    saveFile(`${file}.md`, new Blob([`${text}\n`], { type: 'text/markdown' }));
  }
}
