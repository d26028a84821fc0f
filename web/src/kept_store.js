// @ts-check
/**
 * The kept runs of a tab, which outlive a reload of its page: in IndexedDB, since ten minutes of a run are some megabytes
 * (`web/test/kept.test.mjs`) and the storage of a session takes five. Those of a tab that is closed go after a day.
 */
import { Store } from './store.js';
import { keep, recall } from './stored.js';

/** @typedef {import('./kept.js').Run} Run */
/** They are recordings, and so is none of this page's runs. @typedef {{runs: Run[], recorded: boolean}} Kept */

const DAY_MS = 86_400_000;
/** When the tab began, and a number of its own. */
const TAB = recall('tab', 'sessionStorage') ?? `${Date.now()} ${Math.random()}`;
keep('tab', TAB, 'sessionStorage');
/** @type {Promise<IDBDatabase> | null} */
let opened = null;

/** @template T @param {IDBRequest<T>} request @returns {Promise<T>} */
const done = (request) => new Promise((resolve, reject) => {
  request.onsuccess = () => resolve(request.result);
  request.onerror = () => reject(request.error);
});

async function records() {
  if (!opened) {
    const opening = indexedDB.open('rumbo', 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore('runs');
    opened = done(opening);
  }
  return (await opened).transaction('runs', 'readwrite').objectStore('runs');
}

/** Fails where the browser stores nothing, or no more. @param {Kept} kept */
export async function storeKept({ runs, recorded }) {
  const plain = runs.map((run) => ({ ...run, store: run.store.content() }));
  await done((await records()).put({ runs: plain, recorded }, TAB));
}

/** What the tab kept before the page was loaded. @returns {Promise<Kept>} */
export async function recallKept() {
  const all = await records();
  for (const tab of await done(all.getAllKeys())) {
    if (tab !== TAB && Number(String(tab).split(' ')[0]) < Date.now() - DAY_MS) all.delete(tab);
  }
  const { runs, recorded } = (await done(all.get(TAB))) ?? { runs: [], recorded: false };
  return { runs: runs.map((/** @type {any} */ run) => ({ ...run, store: Store.of(run.store) })), recorded };
}
