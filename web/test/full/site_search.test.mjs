// @ts-check
/** The search of the site's pages: what is found, with the keyboard, on a telephone, without a network, and axe. SCREENSHOT_SEARCH is a file for a picture. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { serious as violations } from '../axe.mjs';
import { FOLDER, open, skip } from '../site.mjs';

const GUIDE = 'docs/scenarios.html';
const LESSON = 'docs/lessons/es/2-front-distance.html';

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
