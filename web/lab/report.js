// @ts-check
/**
 * Makes the report of `rumbo experiments`, in its own worker, so that the lab goes on; terminating the worker cancels it.
 * Its name is the language. To the page go first the `{ experiments }`, each with its name and title; for
 * `{ only, seed }` numbers follow, the part that is done, and the `{ page }`, a file. `{ error }` is why it has ended.
 */
import init, { experiments, report } from './rumbo_report.js';
import { wordsOf } from './serial_link.js';

/** @typedef {{name: string, title: string}} Experiment */
/** No names: all experiments. @typedef {{only: string[], seed: number}} Wanted */
/** @typedef {number | {experiments: Experiment[]} | {page: Uint8Array<ArrayBuffer>} | {error: string}} News */

// Not in the address: the service worker's answer has one without a query.
const language = /** @type {any} */ (self).name;

/** @param {News} news @param {Transferable[]} [transfer] */
const post = (news, transfer = []) => self.postMessage(news, { transfer });

/** @param {() => void} work */
function orEnd(work) {
  try {
    work();
  } catch (error) {
    post({ error: wordsOf(error) });
    self.close();
  }
}

self.addEventListener('message', (/** @type {MessageEvent<Wanted>} */ { data }) => orEnd(() => {
  const page = report(data.only, data.seed, language);
  post({ page }, [page.buffer]);
}));

try {
  await init();
  orEnd(() => post({ experiments: JSON.parse(experiments(language)) }));
} catch (error) {
  post({ error: wordsOf(error) });
}
