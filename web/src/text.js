// @ts-check
/**
 * The page's texts in the reader's language. The key of a text is its English; `spanish/` has the translations, of the
 * page's own texts and of the messages of station and robot, which are sent and recorded in English.
 *
 * `{}` in a text stands for a value. The part after a bar, as in `off|motor`, separates meanings of one English word.
 */
import { CODE } from './spanish/code.js';
import { FILES } from './spanish/files.js';
import { GUIDE } from './spanish/guide.js';
import { PAGE } from './spanish/page.js';
import { PARAMETERS } from './spanish/parameters.js';
import { PROGRAM } from './spanish/program.js';
import { ROBOT, UNDERSCORED } from './spanish/robot.js';
import { SCENARIOS } from './spanish/scenarios.js';
import { WIRING } from './spanish/wiring.js';
import { keep, recall } from './stored.js';

/** Every text with its Spanish. @type {Record<string, string>} */
export const SPANISH = { ...PAGE, ...ROBOT, ...PARAMETERS, ...PROGRAM, ...SCENARIOS, ...GUIDE, ...FILES, ...CODE, ...WIRING };

/** The languages, by the code that browsers have for them. */
export const LANGUAGES = /** @type {const} */ ({ en: 'English', es: 'Español' });

/** @typedef {keyof typeof LANGUAGES} Language */

/** The chosen language, or else the browser's first that there is. @returns {Language} */
function choose() {
  const known = Object.keys(LANGUAGES);
  const wanted = [recall('language'), ...navigator.languages.map((each) => each.slice(0, 2))];
  return /** @type {Language} */ (wanted.find((each) => each && known.includes(each)) ?? 'en');
}

export const language = choose();

/** Reloads the page in this language, and stores the choice. @param {string} wanted */
export function speak(wanted) {
  if (keep('language', wanted)) location.reload();
}

/** Texts that were shown without a translation; for tests. @type {Set<string>} */
export const untranslated = new Set();

/**
 * A text in the page's language, its values in their places.
 * @param {string} english
 * @param {(string | number)[]} values
 */
export function t(english, ...values) {
  return fill(inLanguage(english), values);
}

/** @param {string} english */
function inLanguage(english) {
  if (language === 'en') return english.replace(/\|.*/, '');
  const spanish = SPANISH[english];
  if (spanish === undefined) untranslated.add(english);
  return spanish ?? english.replace(/\|.*/, '');
}

/**
 * `{}` is the next value, `{0}` the first, `{1}` the second.
 * @param {string} text
 * @param {(string | number)[]} values
 */
function fill(text, values) {
  let next = 0;
  return text.replace(/\{(\d?)\}/g, (_whole, index) => {
    const value = values[index === '' ? next++ : Number(index)] ?? '';
    return typeof value === 'number' ? numberAs(String(value)) : value;
  });
}

/** A number's text as the page's language writes it. @param {string} text */
export function numberAs(text) {
  return language === 'es' ? text.replace('.', ',') : text;
}

/** The numbers within a text as the page's language writes them; versions and addresses, which have more points, stay. @param {string} text */
function numbersAs(text) {
  return language === 'es' ? withMinus(text).replace(/(?<![\w./:-])([-−]?\d+)\.(\d+)(?![\d.:\w/])/g, '$1,$2') : text;
}

/** A minus before a number is none of the hyphens. @param {string} text */
const withMinus = (text) => text.replace(/(?<=^|[\s(])-(?=\d)/g, '−');

/** The sentences with placeholders, the most specific first. */
const PATTERNS = Object.keys(SPANISH).filter((english) => english.includes('{}')).map((english) => ({
  english,
  letters: english.replaceAll('{}', '').length,
  form: new RegExp(`^${english.replace(/[.*+?^$()|[\]\\]/g, '\\$&').replaceAll('{}', '(.+?)')}$`, 's'),
})).sort((a, b) => b.letters - a.letters);

/**
 * A sentence of the station or of the robot in the page's language; sentences within it are translated too, if known.
 * @param {string} english
 * @returns {string}
 */
export function said(english) {
  if (language === 'en' || english === '') return withMinus(english).replace(/\b[a-z]+(?:_[a-z]+)+\b/g, (name) => (UNDERSCORED.includes(name) ? name.replaceAll('_', ' ') : name));
  if (english.includes('\n')) return english.split('\n').map(said).join('\n');
  const found = translate(english);
  if (found === null) untranslated.add(english);
  return found ?? english;
}

/** @param {string} english @returns {string | null} */
function translate(english) {
  const known = SPANISH[english];
  if (known !== undefined) return known;
  for (const { english: pattern, form } of PATTERNS) {
    const values = form.exec(english)?.slice(1);
    // Of a file: one word is a key or a name of it, and its numbers have points.
    const inFile = FILES[pattern] !== undefined;
    const inside = (/** @type {string} */ value) => (inFile && !/ /.test(value) ? value : translate(value) ?? (inFile ? value : numbersAs(value)));
    if (values) return fill(SPANISH[pattern] ?? pattern, values.map(inside));
  }
  return null;
}

/** A name of the robot's, such as a mode's, as people read it; that of a pin is the same in any language. @param {string} name */
export function named(name) {
  return /^[A-Z]\d+$/.test(name) ? name : t(name.replaceAll('_', ' '));
}

const ATTRIBUTES = ['title', 'aria-label', 'placeholder', 'alt'];

/** Translates the static texts of the page. */
export function translatePage() {
  document.documentElement.lang = language;
  if (language === 'en') return;
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const node = /** @type {Text} */ (texts.currentNode);
    const words = node.data.trim();
    if (/\p{Letter}/u.test(words)) node.data = node.data.replace(words, t(words));
  }
  for (const attribute of ATTRIBUTES) {
    for (const each of document.body.querySelectorAll(`[${attribute}]`)) {
      const words = each.getAttribute(attribute) ?? '';
      if (/\p{Letter}/u.test(words)) each.setAttribute(attribute, t(words));
    }
  }
}
