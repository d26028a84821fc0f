// @ts-check
/** The pages of the site beside the lab: their links to runs, the lab beside a lesson, telephones, no network, and axe. */
import assert from 'node:assert/strict';
import { readFileSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { serious as violations } from '../axe.mjs';
import { eventually } from '../dashboard.mjs';
import { FOLDER, open, skip } from '../site.mjs';

/** All pages but the lab and what rustdoc made. */
const PAGES = skip ? [] : readdirSync(FOLDER, { recursive: true, encoding: 'utf8' })
  .map((path) => path.replaceAll('\\', '/')).filter((path) => path.endsWith('.html') && path !== 'index.html' && !path.startsWith('api/'));
const LESSON = 'docs/lessons/es/2-front-distance.html';
/** Of the lesson: braking late. */
const LATE = 'front_brake_m_s2=0.8';

/** The runs that a page links to. @param {string} path */
function runsOf(path) {
  const found = readFileSync(join(FOLDER, path), 'utf8').matchAll(/<a class="run" href="[^"#]*#([^"]*)"/g);
  return [...found].map(([, run]) => String(run).replaceAll('&amp;', '&'));
}

test('every run that a page links to opens without a warning', { skip }, async () => {
  const runs = [...new Set(PAGES.flatMap(runsOf))];
  assert.ok(runs.length > 40, `${runs.length} runs`);
  const { page, close } = await open();
  /** What the lab says to each. @param {string[]} runs */
  const warnings = (runs) => page.evaluate(async (runs) => {
    const from = (/** @type {string} */ path) => import(new URL(path, location.href).href);
    const { default: init, Lab } = await from('lab/rumbo.js');
    const { readLink } = await from('src/run_link.js');
    await init();
    return runs.flatMap((run) => {
      try {
        const lab = new Lab(JSON.stringify(readLink(run).start));
        lab.advance();
        const said = lab.news().map((/** @type {string} */ text) => JSON.parse(text)).filter((/** @type {any} */ message) => message.type === 'events');
        lab.free();
        const events = said.flatMap((/** @type {any} */ message) => message.events);
        return events.filter((/** @type {any} */ event) => event.level === 'warning').map((/** @type {any} */ event) => `${run}: ${event.text}`);
      } catch (error) {
        return [`${run}: ${error}`];
      }
    });
  }, runs);
  const wrong = ['scenario=mode99', 'scenario=mode1&front_kq=1', 'scenario=mode1&drive=0.5+fly'];
  assert.equal((await warnings(wrong)).length, wrong.length);
  assert.deepEqual(await warnings(runs), []);
  await close();
});

test('a lesson opens the lab beside its text, in its language, and the figure is that of the lesson', { skip }, async () => {
  const { page, complaints, abroad, close } = await open({ viewport: { width: 1440, height: 900 } }, '', LESSON);
  assert.equal(await page.locator('iframe').count(), 0);
  const late = page.locator(`a.run[href$="${LATE}"]`).first();
  await late.click();
  const lab = page.frameLocator('#lab iframe');
  await lab.locator('#connection.good').waitFor();
  await lab.locator('#stop', { hasText: 'PARAR' }).waitFor();
  assert.equal(await lab.locator('#pages').count(), 0);
  await lab.locator('#speed').selectOption('4');
  await lab.locator('#on').click();
  await lab.locator('#events li', { hasText: 'referencia alcanzada' }).first().waitFor();
  const stated = await page.locator('details tr', { has: page.locator(`a[href$="${LATE}"]`) }).locator('td').nth(1).textContent();
  const number = (/** @type {string | null} */ text) => Number(text?.replace(',', '.').replace(' cm', ''));
  assert.ok(number(stated) > 5, String(stated));
  // ON was pressed at another instant than in the lesson's run.
  await eventually(async () => {
    const read = await lab.locator('#step-figures dd').nth(1).textContent();
    assert.ok(Math.abs(number(read) - number(stated)) < 1, `${read}, ${stated}`);
  });
  // Another run is another lab; closed, the text has the page again.
  await page.locator('a.run').first().click();
  await lab.locator('#armed', { hasText: 'apagado' }).waitFor();
  assert.equal(await page.locator('a.run[aria-current]').count(), 1);
  assert.equal(await page.locator('iframe').count(), 1);
  await page.locator('#lab button').click();
  assert.equal(await page.locator('iframe').count(), 0);
  assert.deepEqual([...complaints, ...abroad], []);
  await close();
});

test('on a telephone no page is wider than the screen, and a run takes the place of the lesson', { skip }, async () => {
  const { page, url, complaints, abroad, close } = await open({ viewport: { width: 390, height: 844 } }, '', LESSON);
  await page.locator('a.run').first().click();
  await page.waitForSelector('#connection.good');
  assert.match(page.url(), /#scenario=mode1&seed=1/);
  await page.goBack();
  await page.locator('a.run').first().waitFor();
  assert.ok(PAGES.length > 60, `${PAGES.length} pages`);
  const wide = [];
  for (const path of PAGES) {
    await page.goto(url + path);
    if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)) wide.push(path);
  }
  assert.deepEqual(wide, []);
  assert.deepEqual([...complaints, ...abroad], []);
  await close();
});

test('without a network a lesson opens with its lab, and so does a page that was read', { skip }, async () => {
  const { page, url, complaints, abroad, unplug, close } = await open();
  await page.waitForSelector('#connection.good');
  await page.evaluate(() => navigator.serviceWorker.ready);
  const answers = await page.locator('#pages a').evaluateAll((links) => Promise.all(links.map(async (link) => (await fetch(/** @type {HTMLAnchorElement} */ (link).href)).ok)));
  assert.deepEqual(answers, [true, true, true]);
  await page.goto(`${url}docs/scenarios.html`);
  // What is kept is written after it is shown.
  await eventually(async () => assert.ok(await page.evaluate(() => caches.match(location.href))));
  unplug();
  await page.goto(`${url}docs/scenarios.html`);
  await page.locator('nav a', { hasText: 'Lessons' }).click();
  await page.locator('main a', { hasText: '2. ' }).click();
  await page.locator('a.run').first().click();
  await page.frameLocator('#lab iframe').locator('#connection.good').waitFor();
  assert.deepEqual([...complaints, ...abroad], []);
  await close();
});

for (const colorScheme of /** @type {const} */ (['dark', 'light'])) {
  test(`axe finds nothing serious, ${colorScheme}`, { skip }, async () => {
    const { page, url, close } = await open({ colorScheme }, '', LESSON);
    for (const path of ['docs/lessons/en/', 'docs/lessons/es/1-wheel-speed.html', 'docs/theory/wheel_speed.html', 'docs/scenarios.html', 'docs/api.html', 'README.html', LESSON]) {
      await page.goto(url + path);
      for (const summary of await page.locator('summary').all()) await summary.click();
      assert.deepEqual(await violations(page), [], path);
    }
    await page.locator('a.run').first().click();
    await page.frameLocator('#lab iframe').locator('#connection.good').waitFor();
    assert.deepEqual(await violations(page), [], 'with the lab');
    await close();
  });
}
