// @ts-check
/**
 * The search box of the pages: a combobox with its list (WAI-ARIA). A slash focuses it, arrows choose, Enter opens, Escape
 * closes. The index, `search.json`, is loaded when the box is used first.
 */
import { create } from '../src/dom.js';
import { entriesOf, find, fold, placesOf, termsOf } from './find.js';

/** @typedef {import('./find.js').Found} Found */

const spanish = document.documentElement.lang === 'es';
const words = spanish
  ? { search: 'Buscar', placeholder: 'Buscar (/)', nothing: 'No se ha encontrado nada', results: 'Resultados', failed: 'Sin red solo se puede buscar donde ya se haya buscado antes' }
  : { search: 'Search', placeholder: 'Search (/)', nothing: 'Nothing found', results: 'Results', failed: 'Without a network you can search where you have searched before' };
const root = new URL('../', import.meta.url);

/** The text with the words in it marked. @param {string} text @param {import('./find.js').Term[]} wanted */
function marked(text, wanted) {
  /** @type {(Node | string)[]} */
  const pieces = [];
  let done = 0;
  for (const { at, length } of placesOf(fold(text), wanted)) {
    if (at < done) continue;
    pieces.push(text.slice(done, at), create('mark', { textContent: text.slice(at, at + length) }));
    done = at + length;
  }
  return [...pieces, text.slice(done)];
}

const input = create('input', { type: 'search', id: 'find', placeholder: words.placeholder, autocomplete: 'off', spellcheck: false, ariaLabel: words.search, ariaExpanded: 'false', ariaAutoComplete: 'list' });
const list = create('div', { id: 'found', ariaLabel: words.results });
const note = create('p', { id: 'find-note' });
const popup = create('div', { id: 'find-popup', hidden: true }, note, list);
input.setAttribute('role', 'combobox');
input.setAttribute('aria-controls', list.id);
list.setAttribute('role', 'listbox');
note.setAttribute('role', 'status');

/** @type {Promise<import('./find.js').Entry[]> | null} */
let index = null;
/** The chosen result. */
let chosen = 0;

/** Loads the index, unless it is there; again, when that has failed. */
function load() {
  const loaded = index ?? fetch(new URL('search.json', import.meta.url)).then(async (answer) => {
    if (!answer.ok) throw new Error(answer.statusText);
    return entriesOf(await answer.json(), document.documentElement.lang);
  });
  index = loaded;
  loaded.catch(() => { index = null; });
  return loaded;
}

/** @param {boolean} open */
function show(open) {
  popup.hidden = !open;
  input.ariaExpanded = String(open);
  if (!open) input.removeAttribute('aria-activedescendant');
}

/** @param {number} place */
function choose(place) {
  const options = [...list.children];
  chosen = options.length === 0 ? 0 : (place + options.length) % options.length;
  options.forEach((option, at) => { option.ariaSelected = String(at === chosen); });
  const option = options[chosen];
  if (!option) return input.removeAttribute('aria-activedescendant');
  input.setAttribute('aria-activedescendant', option.id);
  return option.scrollIntoView({ block: 'nearest' });
}

/** @param {Found} found @param {number} place @param {import('./find.js').Term[]} wanted */
function option({ address, title, heading, excerpt, language }, place, wanted) {
  const made = create('a', { id: `found-${place}`, href: new URL(address, root).href, tabIndex: -1, lang: language },
    create('b', {}, ...marked(heading, wanted)), ...(heading === title ? [] : [create('i', { textContent: title })]), create('span', {}, ...marked(excerpt, wanted)));
  made.setAttribute('role', 'option');
  return made;
}

async function search() {
  const query = input.value;
  const wanted = termsOf(query);
  if (wanted.length === 0) return show(false);
  try {
    const found = find(await load(), query);
    if (input.value !== query) return undefined;
    list.replaceChildren(...found.map((each, place) => option(each, place, wanted)));
    note.textContent = found.length === 0 ? words.nothing : `${words.results}: ${found.length}`;
  } catch {
    list.replaceChildren();
    note.textContent = words.failed;
  }
  show(true);
  return choose(0);
}

input.addEventListener('focus', () => {
  // Ready when the first word is typed; what fails is said then.
  load().catch(() => {});
  if (input.value) search();
});
input.addEventListener('input', search);
input.addEventListener('keydown', (event) => {
  const { key } = event;
  if (key === 'Escape') {
    if (popup.hidden) input.blur();
    else show(false);
  } else if (!popup.hidden && key === 'Enter') {
    const option = list.children[chosen];
    if (option instanceof HTMLElement) option.click();
  } else if (!popup.hidden && (key === 'ArrowDown' || key === 'ArrowUp')) choose(chosen + (key === 'ArrowDown' ? 1 : -1));
  else return;
  event.preventDefault();
});
// A click in the list keeps the focus in the box; one that opens a result closes the list.
popup.addEventListener('mousedown', (event) => event.preventDefault());
list.addEventListener('click', () => {
  show(false);
  input.blur();
});
input.addEventListener('blur', () => show(false));

addEventListener('keydown', (event) => {
  const typing = event.target instanceof HTMLElement && event.target.closest('input, select, textarea');
  if (event.key !== '/' || typing || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  input.focus();
  input.select();
});

document.getElementById('search')?.append(input, popup);
