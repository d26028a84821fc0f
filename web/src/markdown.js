// @ts-check
/** Lessons as elements: the part of Markdown that they are written in. What is in a text is never taken for HTML. */
import { create } from './dom.js';

/** @typedef {(href: string, title: string) => HTMLElement} MakeLink */

const INLINE = /`([^`]+)`|\*\*([^*]+)\*\*|\*([^*]+)\*|\[([^\]]+)\](?:\(([^\s)]+)(?: "([^"]*)")?\)|\[([^\]]+)\])/g;

export class Lesson {
  #link;
  /** @type {Map<string, [string, string]>} */
  #references = new Map();
  title = '';

  /** @param {MakeLink} link */
  constructor(link) {
    this.#link = link;
  }

  /** @param {string} text */
  read(text) {
    const lines = text.split('\n').filter((line) => {
      const reference = /^\[([^\]]+)\]: (\S+)(?: "([^"]*)")?$/.exec(line);
      if (reference) this.#references.set(reference[1] ?? '', [reference[2] ?? '', reference[3] ?? '']);
      return !reference;
    });
    this.title = lines.find((line) => line.startsWith('# '))?.slice(2) ?? '';
    return this.#blocks(lines);
  }

  /** @param {string[]} lines @returns {HTMLElement[]} */
  #blocks(lines) {
    /** @type {HTMLElement[]} */
    const made = [];
    for (let at = 0; at < lines.length;) {
      const line = lines[at] ?? '';
      /** The lines from here on that are so. @param {(line: string) => boolean} is */
      const take = (is) => {
        const from = at;
        while (at < lines.length && is(lines[at] ?? '')) at += 1;
        return lines.slice(from, at);
      };
      const heading = /^(#+) (.*)/.exec(line);
      if (line.trim() === '') {
        at += 1;
      } else if (heading) {
        made.push(create(heading[1]?.length === 1 ? 'h2' : 'h3', {}, ...this.#words(heading[2] ?? '')));
        at += 1;
      } else if (line.startsWith('<details>')) {
        const inside = take((each) => !each.startsWith('</details>'));
        at += 1;
        const end = inside.findIndex((each) => each.includes('</summary>'));
        const summary = inside.slice(0, end + 1).join(' ').replace(/<\/?(details|summary)>/g, '');
        made.push(create('details', {}, create('summary', {}, ...this.#words(summary)), ...this.#blocks(inside.slice(end + 1))));
      } else if (line.startsWith('|')) {
        made.push(this.#table(take((each) => each.startsWith('|'))));
      } else if (/^ {4}/.test(line)) {
        made.push(create('pre', { tabIndex: 0 }, create('code', { textContent: take((each) => /^ {4}/.test(each)).map((each) => each.slice(4)).join('\n') })));
      } else if (/^(- |\d+\. )/.test(line)) {
        const items = take((each) => /^(- |\d+\. | {2,}\S)/.test(each)).join('\n').split(/\n(?=- |\d+\. )/);
        made.push(create(/^\d/.test(line) ? 'ol' : 'ul', {}, ...items.map((item) => create('li', {}, ...this.#words(item.replace(/^(- |\d+\. )/, '').replace(/\n\s*/g, ' '))))));
      } else {
        made.push(create('p', {}, ...this.#words(take((each) => each.trim() !== '' && !/^(#|\||<|- |\d+\. )/.test(each)).join(' '))));
      }
    }
    return made;
  }

  /** @param {string[]} lines */
  #table([head = '', , ...rows]) {
    const cells = (/** @type {string} */ line) => line.split('|').slice(1, -1).map((cell) => cell.trim());
    const line = (/** @type {'th' | 'td'} */ tag, /** @type {string} */ row) => create('tr', {}, ...cells(row).map((cell) => create(tag, { className: cell === '' ? 'own' : '' }, ...this.#words(cell))));
    return create('div', { className: 'scroll', tabIndex: 0 }, create('table', {}, create('thead', {}, line('th', head)), create('tbody', {}, ...rows.map((row) => line('td', row)))));
  }

  /** @param {string} text @returns {(string | HTMLElement)[]} */
  #words(text) {
    /** @type {(string | HTMLElement)[]} */
    const made = [];
    let end = 0;
    for (const found of text.matchAll(INLINE)) {
      const [all, code, strong, em, name = '', href, title = '', reference] = found;
      made.push(text.slice(end, found.index));
      end = found.index + all.length;
      if (code !== undefined) made.push(create('code', { textContent: code }));
      else if (strong !== undefined) made.push(create('b', {}, ...this.#words(strong)));
      else if (em !== undefined) made.push(create('em', {}, ...this.#words(em)));
      else {
        const [to, note] = href === undefined ? this.#references.get(reference ?? '') ?? ['', ''] : [href, title];
        const link = this.#link(to, note);
        link.append(...this.#words(name));
        made.push(link);
      }
    }
    return [...made, text.slice(end)].filter((part) => part !== '');
  }
}
