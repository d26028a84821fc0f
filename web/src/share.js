// @ts-check
/**
 * *Share*: the link of what runs, to copy, with what was done by hand or without. On the site only: a station's address is
 * for its own computer.
 */
import { dialog } from './dialog.js';
import { clickable, create, element, setText } from './dom.js';
import { LONGEST, pack, readLink, writeLink } from './run_link.js';
import { said, t } from './text.js';
import { format } from './units.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').Parameter} Parameter */
/** @typedef {import('./worker_link.js').Shared} Shared */

/** What the page knows of the run. @typedef {{scene: Scene | null, table: Parameter[], version: string}} Known */

export class Share {
  #dialog = dialog('share-dialog', t('Share'));
  #about = create('p', { className: 'hint' });
  #by_hand = create('input', { type: 'checkbox', id: 'share-drive', checked: true });
  #changes = create('span');
  #row = create('label', { className: 'row' }, this.#by_hand, this.#changes);
  #link = create('input', { type: 'text', id: 'share-link', readOnly: true });
  #copied = create('output', { className: 'hint' });
  #known;
  /** @type {Shared | null} */
  #shared = null;

  /**
   * @param {() => Known} known
   * @param {() => Promise<Shared>} ask asks the lab
   */
  constructor(known, ask) {
    this.#known = known;
    const button = element('share', HTMLButtonElement);
    button.hidden = !isSite;
    if (!isSite) return;
    const copy = clickable({ className: 'go', textContent: t('Copy') }, async () => {
      this.#link.select();
      await navigator.clipboard.writeText(this.#link.value).then(() => setText(this.#copied, t('copied')), () => setText(this.#copied, t('copy it from the field')));
    });
    this.#link.setAttribute('aria-label', t('Link'));
    this.#dialog.body.append(this.#about, this.#row, create('div', { className: 'row' }, this.#link, copy, this.#copied));
    this.#by_hand.addEventListener('change', () => this.#show());
    button.addEventListener('click', async () => {
      const shared = await ask();
      this.#shared = { ...shared, edited: shared.edited && await pack(shared.edited), file: shared.file && await pack(shared.file) };
      this.#show();
      this.#dialog.open();
      this.#link.select();
    });
    // Another link in the same tab.
    addEventListener('hashchange', () => location.reload());
  }

  /** A link without its files would open something else. */
  #refuse() {
    this.#row.hidden = true;
    this.#link.value = '';
    setText(this.#copied, '');
    setText(this.#about, t('The edited world, or the scenario, is too large for a link, which has at most 2 KB: pass on its file.'));
  }

  #show() {
    const { scene, table, version } = this.#known();
    const shared = this.#shared;
    if (!scene || !shared) return;
    const { robot } = readLink(location.hash).start;
    const { edited, file } = shared;
    const choice = { ...scene.choice, ...(edited ? { world: null, edited } : {}), file, robots: shared.robots > 1 ? shared.robots : null, robot };
    const changed = table.flatMap(({ name, value, default: usual }) => (value === null || value === usual ? [] : [[name, value]]));
    const setUp = writeLink(location.href, { ...choice, parameters: Object.fromEntries(changed) }, version);
    if ((edited || file) && setUp.length > LONGEST) return this.#refuse();
    const { drive, until_s, hash, parameters, changes } = shared;
    const driven = drive === null || changes === 0 ? null : writeLink(location.href, { ...choice, parameters, drive, until_s, hash }, version);
    const why = shared.why_not ?? (driven !== null && driven.length > LONGEST ? 'a link has at most 2 KB, this one would be longer' : null);
    const fits = driven !== null && why === null;
    const repeats = fits && this.#by_hand.checked;
    this.#row.hidden = !fits;
    setText(this.#changes, t('with what was done by hand until {} s (changes of commands: {})', format(until_s, 2), changes));
    this.#link.value = repeats ? driven : setUp;
    setText(this.#about, repeats
      ? t('The link opens this scenario, world, sensor layout and seed, and repeats this run from its start, to the last bit.')
      : t('The link opens this scenario, world, sensor layout and seed, with these parameters.') + (why === null ? '' : ` ${t('What was done by hand is not in it: {}.', said(why))}`));
    setText(this.#copied, setUp.length > LONGEST ? t('it has {} characters: some programs cut it', this.#link.value.length) : '');
  }
}
