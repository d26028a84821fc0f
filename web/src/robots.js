// @ts-check
/**
 * The robots in one world, each with its own session: which of them this page shows. On the site also how many there
 * are, and a scenario of the reader's.
 */
import { create, element } from './dom.js';
import { EDITED } from './header.js';
import { readLink } from './run_link.js';
import { isSite } from './worker_link.js';

/** @typedef {import('./types.js').Scene['choice']} Choice */
/** @typedef {import('./worker_link.js').WorkerLink} WorkerLink */

const choice = element('robot', HTMLSelectElement);
const count = element('robots', HTMLInputElement);

/** @param {string[]} robots @param {number} own */
export function offerRobots(robots, own) {
  choice.hidden = robots.length === 0;
  choice.replaceChildren(...robots.map((name) => create('option', { textContent: name })));
  choice.selectedIndex = own;
  count.value = count.defaultValue = String(robots.length || 1);
}

/**
 * @param {WorkerLink['ask']} ask asks the lab of the site
 * @param {() => Choice | null} known what runs
 */
export function listen(ask, known) {
  choice.addEventListener('change', () => {
    if (isSite) ask({ robot: choice.selectedIndex });
    else location.hash = `robot=${choice.value}`;
  });
  element('robots-field', HTMLLabelElement).hidden = !isSite;
  count.addEventListener('change', () => {
    const runs = known();
    if (!runs || !count.reportValidity()) return;
    const robots = count.valueAsNumber;
    // Until they have loaded.
    count.value = count.defaultValue;
    ask({ open: { ...runs, world: runs.world === EDITED ? null : runs.world, robots, ...robotOf() } });
  });
}

/** Another robot than the scenario's, as the address has it. */
function robotOf() {
  const { robot } = readLink(location.hash).start;
  return robot ? { robot } : {};
}

/**
 * Begins with a scenario of the reader's, in its own world if its file is there too.
 * @param {File[]} files
 * @param {WorkerLink['ask']} ask
 * @param {(why: string) => void} complain
 */
export async function openScenario(files, ask, complain) {
  /** @type {import('./run_link.js').Start} */
  const start = {};
  for (const file of files) {
    const text = await file.text();
    // A world has no duration.
    if (!/^\s*duration_s\s*=/m.test(text)) start.edited = text;
    else Object.assign(start, { scenario: file.name.replace(/\.toml$/i, ''), file: text });
  }
  if (start.file) ask({ open: { ...start, ...robotOf() } });
  else complain(`${files.map(({ name }) => name).join(', ')}: no scenario is among these files`);
}
