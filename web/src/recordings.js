// @ts-check
/** The recordings of this computer: find one, open it as a replay, compare some, delete. */
import { complaint, dialog, fileButton } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { MOST } from './kept.js';
import { ask } from './key.js';
import { language, said, t } from './text.js';
import { format } from './units.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').Recording} Recording */

export class Recordings {
  #dialog = dialog('recordings-dialog', t('Recordings'));
  #find = create('input', { type: 'search', id: 'recordings-find', placeholder: t('scenario, robot, date') });
  #rows = create('tbody');
  #none = create('p', { className: 'hint' });
  #complaint = complaint();
  /** @type {Recording[]} */
  #list = [];
  /** Names of those to compare, the one chosen last at the end. @type {string[]} */
  #chosen = [];
  /** The number of this page, which has to be in control to delete. */
  page = 0;
  /** Titles of scenarios by their names. @type {Map<string, string>} */
  titles = new Map();
  /** Shows some side by side. @type {(contents: (import('./types.js').RecordingContent & {about: import('./kept.js').About})[]) => void} */
  compare = () => {};

  /**
   * @param {(what: 'save' | 'replay') => void} ask asks the site's lab for its run
   * @param {(file: File) => void} show shows a recording on the site
   */
  constructor(ask, show) {
    element('recordings', HTMLButtonElement).addEventListener('click', () => this.open());
    if (isSite) {
      const saves = clickable({ className: 'go', textContent: t('Save this run'), title: t('Save the recording of the run so far as a file') }, () => ask('save'));
      const replays = create('button', { type: 'button', textContent: t('Replay this run'), title: t('Show the run so far as a replay; the robot waits meanwhile') });
      const close = (/** @type {() => void} */ work) => {
        this.#dialog.dialog.close();
        work();
      };
      replays.addEventListener('click', () => close(() => ask('replay')));
      const opens = fileButton(t('Open a recording…'), '.mcap', (file) => close(() => show(file)));
      opens.title = t('Show a saved recording, .mcap, as a replay; dropping it on the page does the same');
      for (const each of [replays, opens]) each.classList.add('lab-only');
      this.#dialog.body.append(create('p', { textContent: t('This page records the run until the next reset. A saved recording can be opened here again. Rumbo on a computer opens it too: rumbo replay shows it, rumbo rerun runs it again. It also keeps every session and compares two.') }), create('div', { className: 'row' }, saves, replays, opens));
      return;
    }
    const head = create('thead', {}, create('tr', {}, ...[t('compare'), t('recording'), t('actions'), t('duration'), t('size'), t('seed')].map((textContent) => create('th', { textContent, scope: 'col' }))));
    const find = create('label', {}, `${t('find')} `, this.#find);
    this.#dialog.body.append(
      create('div', { className: 'row' }, find),
      this.#complaint, create('div', { className: 'scroll recordings', tabIndex: 0 }, create('table', {}, head, this.#rows)), this.#none,
    );
    this.#find.addEventListener('input', () => this.#show());
  }

  open() {
    this.#dialog.open();
    if (isSite) return Promise.resolve();
    setText(this.#none, t('loading…'));
    return this.#try(() => this.#load());
  }

  async #load() {
    this.#list = JSON.parse(await ask('/recordings'));
    const names = this.#list.map(({ name }) => name);
    this.#chosen = this.#chosen.filter((name) => names.includes(name));
    this.#show();
  }

  /** Says what went wrong. @param {() => Promise<void>} work */
  async #try(work) {
    setText(this.#complaint, '');
    try {
      await work();
    } catch (error) {
      setText(this.#complaint, said(error instanceof Error ? error.message : String(error)));
    }
  }

  #show() {
    const wanted = this.#find.value.trim().toLowerCase();
    const found = this.#list.filter((each) => this.#words(each).toLowerCase().includes(wanted));
    this.#rows.replaceChildren(...found.map((each) => this.#row(each)));
    setText(this.#none, found.length > 0 ? t('recordings: {} of {}', found.length, this.#list.length) : t('no recordings'));
  }

  /** What a recording is found by. @param {Recording} recording */
  #words(recording) {
    return [recording.name, this.#title(recording), recording.robot ?? '', when(recording)].join(' ');
  }

  /** @param {Recording} recording */
  #title({ scenario, readable }) {
    const title = this.titles.get(scenario ?? '');
    return title ? said(title).replaceAll('->', '→') : scenario ?? (readable ? t('a real robot') : t('not readable'));
  }

  /** @param {Recording} recording */
  #row(recording) {
    const { name, seed, duration_s, bytes, open, readable } = recording;
    const box = create('input', { type: 'checkbox', checked: this.#chosen.includes(name), disabled: !readable || open });
    box.setAttribute('aria-label', t('Compare {}', name));
    box.title = t('Choose up to eight recordings, then Compare in any line');
    box.addEventListener('change', () => {
      this.#chosen = [...this.#chosen.filter((each) => each !== name), ...(box.checked ? [name] : [])].slice(-MOST);
      this.#show();
    });
    const show = clickable({ textContent: t('Open|replay'), disabled: !readable, title: t('Show it as a replay, in a page of its own') }, () => this.#replay(name));
    const others = this.#chosen.filter((each) => each !== name);
    const compare = clickable({ textContent: t('Compare'), disabled: box.disabled, title: t(others.length > 0 ? 'Compare it with those that are chosen' : 'Compare it with the run of this page') }, () => this.#try(() => this.#open([...others, name].slice(-MOST))));
    return create('tr', { title: name },
      create('td', {}, box, compare), create('td', { className: 'wrap' }, this.#title(recording), create('span', { className: 'hint', textContent: when(recording) })),
      create('td', {}, show, ...(open ? [create('span', { className: 'chip', textContent: t('being recorded') })] : readable ? [this.#deleteButton(name)] : [])),
      create('td', { textContent: readable ? `${format(duration_s)} s` : '' }), create('td', { textContent: `${format(bytes / 1e6)} MB` }), create('td', { textContent: seed === null ? '' : String(seed) }));
  }

  /** Asks before it deletes. @param {string} name */
  #deleteButton(name) {
    const first = create('button', { type: 'button', textContent: t('Delete'), title: t('Delete this recording') });
    const sure = create('button', { type: 'button', className: 'bad', textContent: t('Delete for good') });
    const keep = create('button', { type: 'button', textContent: t('Keep') });
    const asked = create('span', { className: 'row', hidden: true }, sure, keep);
    const offer = (/** @type {boolean} */ question) => {
      first.hidden = question;
      asked.hidden = !question;
      (question ? keep : first).focus();
    };
    first.addEventListener('click', () => offer(true));
    keep.addEventListener('click', () => offer(false));
    sure.addEventListener('click', () => this.#try(async () => {
      await ask(`/recordings/${encodeURIComponent(name)}?page=${this.page}`, 'DELETE');
      await this.#load();
    }));
    return create('span', {}, first, asked);
  }

  /** @param {string} name */
  #replay(name) {
    // At once: what opens later, browsers take for an advertisement.
    const tab = window.open('about:blank', '_blank');
    return this.#try(async () => {
      try {
        const url = await ask(`/recordings/${encodeURIComponent(name)}/replay`, 'POST');
        if (tab) tab.location.href = url;
        else location.href = url;
      } catch (error) {
        tab?.close();
        throw error;
      }
    });
  }

  /** Shows these side by side. @param {string[]} names */
  async #open(names) {
    const contents = await Promise.all(names.map(async (name) => {
      const content = JSON.parse(await ask(`/recordings/${encodeURIComponent(name)}`));
      const recording = this.#list.find((each) => each.name === name);
      if (!recording) return { ...content, about: {} };
      const { scenario, robot, seed } = recording;
      return { ...content, about: { scenario, robot, seed }, name: [this.#title(recording), ...(seed === null ? [] : [t('seed {}', seed)]), when(recording)].join(', ') };
    }));
    this.#dialog.dialog.close();
    this.compare(contents);
  }
}

/** When it was made, as people of the page's language write it. @param {Recording} recording */
function when({ started, written_s }) {
  const at = started ? new Date(started) : new Date(written_s * 1_000);
  return at.toLocaleString(language === 'en' ? 'en-GB' : language, { dateStyle: 'medium', timeStyle: 'short' });
}
