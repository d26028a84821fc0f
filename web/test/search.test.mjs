// @ts-check
/** The search of the site's pages. No browser is needed. */
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { entriesOf, find, fold } from '../pages/find.js';

/** @type {import('../pages/find.js').Page[]} */
const PAGES = [
  ['docs/a.html', 'Wheels', 'en', false, [['wheels', 'Wheels', 'What a wheel is.'], ['speed', 'Speed of a wheel', 'Its odometry, in front_kp.']]],
  ['docs/lessons/en/1.html', 'Odometry', 'en', true, [['odometry', 'Odometry', 'A lesson.']]],
  ['docs/lessons/es/1.html', 'Odometría', 'es', true, [['odometria', 'Odometría', 'Una lección con señales.']]],
  ['CHANGELOG.html', 'Changelog', 'en', false, [['changelog', 'Changelog', 'Odometry, odometry, odometry.']]],
];

/** Addresses of what is found. @param {string} query @param {string} [language] */
const found = (query, language = 'en') => find(entriesOf(PAGES, language), query).map(({ address }) => address);

test('accents and capitals make no difference, and folding moves nothing', () => {
  assert.equal(fold('Odometría: ñ, Ü, ½, 🦾, ﬁ'), 'odometria: n, u, ½, 🦾, ﬁ');
  for (const query of ['odometria', 'ODOMETRÍA', 'senal']) assert.deepEqual(found(query, 'es').slice(0, 1), ['docs/lessons/es/1.html']);
});

test('headings come before texts, and what users read before what changed', () => {
  assert.deepEqual(found('odometry'), ['docs/lessons/en/1.html', 'docs/a.html#speed', 'CHANGELOG.html']);
});

test('a page in two languages is found in the reader\'s', () => {
  assert.deepEqual(found('odometr', 'es').filter((address) => address.includes('lessons')), ['docs/lessons/es/1.html']);
  assert.deepEqual(found('odometr').filter((address) => address.includes('lessons')), ['docs/lessons/en/1.html']);
});

test('a word is found by its beginning, all words before some, and nothing for none', () => {
  assert.deepEqual(found('kp'), ['docs/a.html#speed']);
  assert.deepEqual(found('dometry'), []);
  assert.equal(found('wheel odometry')[0], 'docs/a.html#speed');
  assert.equal(found('wheel xyzzy').length, 2);
  // Other forms of a word, after the word itself.
  assert.deepEqual(found('lessons'), ['docs/lessons/en/1.html']);
  for (const query of ['leccion', 'señal']) assert.deepEqual(found(query, 'es'), ['docs/lessons/es/1.html']);
  assert.deepEqual(found('xyzzy'), []);
  assert.deepEqual(found(' - '), []);
});

test('an excerpt is where the rarest word stands, in whole words', () => {
  const long = `${'wheel '.repeat(60)}and its encoder.${' wheel'.repeat(60)}`;
  const [best] = find(entriesOf([...PAGES, ['docs/b.html', 'Long', 'en', false, [['long', 'Long', long]]]], 'en'), 'wheel encoder');
  assert.match(best?.excerpt ?? '', /^… (?:wheel )+and its encoder\.(?: wheel)+ …$/);
});
