// @ts-check
/** The search of the site's pages: what is found, with the keyboard, on a telephone, without a network, and axe. SCREENSHOT_SEARCH is a file for a picture. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { entriesOf, find, fold } from '../pages/find.js';
import { violations } from './axe.mjs';
import { FOLDER, open, skip } from './site.mjs';

const GUIDE = 'docs/scenarios.html';
const LESSON = 'docs/lessons/es/2-front-distance.html';

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

test('every result of the site leads to a place that is there', { skip }, () => {
  const pages = JSON.parse(readFileSync(join(FOLDER, 'pages/search.json'), 'utf8'));
  assert.ok(pages.length > 200, `${pages.length} pages`);
  const lost = [];
  for (const [address, , , , sections] of pages) {
    const html = readFileSync(join(FOLDER, address, address.endsWith('/') || address === '' ? 'index.html' : ''), 'utf8');
    for (const [anchor] of sections) if (anchor && !html.includes(` id="${anchor}"`)) lost.push(`${address}#${anchor}`);
  }
  assert.deepEqual(lost, []);
});

test('a slash, a word, an arrow and Enter lead to a heading; Escape closes', { skip }, async () => {
  const { page, url, complaints, abroad, close } = await open({}, '', GUIDE);
  /** @type {string[]} */
  const loaded = [];
  page.on('request', (request) => loaded.push(request.url().slice(url.length)));
  await page.locator('#find').waitFor();
  assert.ok(!loaded.includes('pages/search.json'), 'loaded before it is used');
  await page.keyboard.press('/');
  await page.keyboard.type('calibrate the robot');
  const options = page.getByRole('option');
  await options.first().waitFor();
  assert.ok(loaded.includes('pages/search.json'));
  assert.equal(await page.getByRole('option', { selected: true }).count(), 1);
  await page.keyboard.press('ArrowDown');
  const second = await options.nth(1).getAttribute('href');
  assert.equal(await options.nth(1).getAttribute('aria-selected'), 'true');
  assert.equal(await page.locator('#find').getAttribute('aria-activedescendant'), await options.nth(1).getAttribute('id'));
  await page.keyboard.press('ArrowUp');
  await page.keyboard.press('ArrowUp');
  assert.equal(await options.last().getAttribute('aria-selected'), 'true');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#find-popup').isVisible(), false);
  await page.keyboard.press('End');
  await page.keyboard.type(' ');
  await options.first().waitFor();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('Enter');
  await page.waitForURL(String(second));
  // A slash in the box is a slash; a word that is nowhere says so.
  await page.locator('#find').fill('');
  await page.locator('#find').pressSequentially('xyzzy/');
  await page.locator('#find-note', { hasText: 'Nothing found' }).waitFor();
  assert.equal(await page.locator('#find').inputValue(), 'xyzzy/');
  assert.deepEqual([...complaints, ...abroad], []);
  await close();
});

test('in Spanish, without accents, on a telephone: the lesson is first, by a finger', { skip }, async () => {
  const { page, complaints, abroad, close } = await open({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true }, '', LESSON);
  await page.locator('#find').fill('odometria');
  const first = page.getByRole('option').first();
  await first.waitFor();
  assert.match(await first.textContent() ?? '', /odometría/);
  const { x, width } = await page.locator('#find-popup').boundingBox() ?? { x: NaN, width: NaN };
  assert.ok(x >= 0 && x + width <= 390, `${x}, ${width}`);
  assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  if (process.env['SCREENSHOT_SEARCH']) await page.screenshot({ path: process.env['SCREENSHOT_SEARCH'] });
  await first.tap();
  await page.waitForURL(/docs\/lessons\/es\/4-odometry/);
  assert.deepEqual([...complaints, ...abroad], []);
  await close();
});

test('without a network it finds what it has found before, or says why not', { skip }, async () => {
  for (const before of [true, false]) {
    const { page, url, unplug, close } = await open();
    await page.waitForSelector('#connection.good');
    await page.evaluate(() => navigator.serviceWorker.ready);
    await page.goto(url + LESSON);
    if (before) {
      await page.locator('#find').fill('sonar');
      await page.getByRole('option').first().waitFor();
      await page.waitForFunction(() => caches.match(new URL('../../../pages/search.json', location.href)));
    }
    unplug();
    await page.goto(url + LESSON);
    await page.locator('#find').fill('rueda');
    if (before) await page.getByRole('option').first().waitFor();
    else await page.locator('#find-note', { hasText: 'Sin red' }).waitFor();
    await close();
  }
});

for (const colorScheme of /** @type {const} */ (['dark', 'light'])) {
  test(`axe finds nothing serious in the results, ${colorScheme}`, { skip }, async () => {
    const { page, close } = await open({ colorScheme }, '', GUIDE);
    await page.locator('#find').fill('sonar noise');
    await page.getByRole('option').nth(3).waitFor();
    assert.deepEqual(await violations(page), []);
    await close();
  });
}
