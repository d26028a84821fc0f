// @ts-check
/** The dialog of the layouts: those that the browser keeps by name, and files. */
import { complaint, dialog, fileButton, saveFile } from './dialog.js';
import { clickable, create } from './dom.js';
import { BadLayout, fromText, toText } from './layout.js';
import { t } from './text.js';

/** @typedef {import('./plots.js').Plots} Plots */

export class LayoutDialog {
  #plots;
  #dialog = dialog('layout-dialog', t('Layouts'));
  #list = create('div', { className: 'stack', id: 'layout-names' });
  #name = create('input', { type: 'text', id: 'layout-name', maxLength: 60, required: true });
  #complaint = complaint();

  /** @param {Plots} plots */
  constructor(plots) {
    this.#plots = plots;
    const keep = create('form', { className: 'row' }, create('label', {}, `${t('name')} `, this.#name),
      create('button', { type: 'submit', className: 'go', textContent: t('Save'), title: t('Save the plots as they are in this browser, under this name') }));
    keep.addEventListener('submit', (event) => {
      event.preventDefault();
      plots.shelf.name(this.#name.value, plots.layout);
      this.#show();
    });
    const save = clickable({ textContent: t('Save file'), id: 'layout-save' }, () => saveFile(`${this.#name.value || 'rumbo'}.layout.json`, new Blob([toText(plots.layout)], { type: 'application/json' })));
    const initial = clickable({ textContent: t('Restore default'), id: 'layout-initial' }, () => {
      plots.use(null);
      this.#dialog.dialog.close();
    });
    this.#dialog.body.append(
      create('p', { className: 'hint', textContent: t('A layout is a set of plots with their signals and axes, and the window of time. Each mode has its own.') }),
      this.#list, keep, create('div', { className: 'row' }, save, fileButton(t('Load file'), '.json,application/json', async (file) => this.#take(file.name, await file.text())), initial), this.#complaint);
  }

  open() {
    this.#complaint.textContent = '';
    this.#show();
    this.#dialog.open();
  }

  #show() {
    this.#list.replaceChildren(...this.#plots.shelf.names.map((name) => {
      const load = clickable({ textContent: name, title: t('Show this layout') }, () => {
        this.#plots.use(this.#plots.shelf.named(name));
        this.#name.value = name;
        this.#dialog.dialog.close();
      });
      const forget = create('button', { type: 'button', className: 'small', textContent: t('Delete') });
      forget.setAttribute('aria-label', t('Delete the layout {}', name));
      forget.addEventListener('click', () => {
        this.#plots.shelf.name(name, null);
        this.#show();
      });
      return create('div', { className: 'row' }, load, forget);
    }));
  }

  /** A file that is no layout changes nothing. @param {string} name @param {string} text */
  #take(name, text) {
    try {
      this.#plots.use(fromText(text));
      this.#dialog.dialog.close();
    } catch (error) {
      if (!(error instanceof BadLayout)) throw error;
      this.#complaint.textContent = t('{} is not taken: {}. The plots are as they were.', name, error.message);
    }
  }
}
