// @ts-check
/** *Share*: the link of what runs, to copy. On the site only: a station's address is for its own computer. */
import { dialog } from './dialog.js';
import { create, element, setText } from './dom.js';
import { readLink, writeLink } from './run_link.js';
import { t } from './text.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').Scene} Scene */
/** @typedef {import('./types.js').Parameter} Parameter */

export class Share {
  #dialog = dialog('share-dialog', t('Share'));
  #link = create('input', { type: 'text', id: 'share-link', readOnly: true });
  #copied = create('output', { className: 'hint' });

  /** @param {() => {scene: Scene | null, table: Parameter[], own: boolean, version: string}} now */
  constructor(now) {
    const button = element('share', HTMLButtonElement);
    button.hidden = !isSite;
    if (!isSite) return;
    const about = create('p', { className: 'hint' });
    const copy = create('button', { type: 'button', className: 'go', textContent: t('Copy') });
    copy.addEventListener('click', async () => {
      this.#link.select();
      await navigator.clipboard.writeText(this.#link.value).then(() => setText(this.#copied, t('copied')), () => setText(this.#copied, t('copy it from the field')));
    });
    this.#link.setAttribute('aria-label', t('Link'));
    this.#dialog.body.append(about, create('div', { className: 'row' }, this.#link, copy, this.#copied));
    button.addEventListener('click', () => {
      const { scene, table, own, version } = now();
      if (!scene) return;
      const changed = table.filter((each) => each.value !== null && each.value !== each.default).map(({ name, value }) => [name, value]);
      const { robot } = readLink(location.hash).start;
      this.#link.value = writeLink(location.href, scene.choice, robot, Object.fromEntries(changed), version);
      setText(about, own ? t('The link opens this scenario, world, sensor layout and seed. Your program is not in it.') : t('The link opens this scenario, world, sensor layout and seed, with these parameters.'));
      setText(this.#copied, '');
      this.#dialog.open();
      this.#link.select();
    });
    // Another link in the same tab.
    addEventListener('hashchange', () => location.reload());
  }
}
