// @ts-check
/** The report of `rumbo experiments` as a browser shows it: whole, without a word of complaint, on a screen, a phone and paper. */
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { folder, launch, open, program } from '../dashboard.mjs';

/** @param {string} language */
function report(language) {
  const out = folder();
  execFileSync(program(), ['experiments', '--language', language, '--out', out], { stdio: 'ignore' });
  return pathToFileURL(join(out, 'report.html')).href;
}

for (const language of ['en', 'es']) {
  test(`the report in ${language} asks for nothing and fits every page`, async (context) => {
    const browser = await launch();
    const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
    context.after(() => page.close());
    /** @type {string[]} */
    const complaints = [];
    page.on('pageerror', (error) => complaints.push(String(error)));
    page.on('console', (message) => complaints.push(message.text()));
    page.on('request', (request) => {
      if (!/^(file|data):/.test(request.url())) complaints.push(request.url());
    });
    await page.goto(report(language));
    assert.equal(await page.locator('html').getAttribute('lang'), language);
    assert.ok((await page.locator('figure').count()) > 60);

    // Every entry of the contents leads to its chapter.
    for (const link of await page.locator('nav a').all()) {
      const target = await link.getAttribute('href');
      assert.equal(await page.locator(`h2${target}`).count(), 1, `${target}`);
    }
    // No text of a drawing leaves it, and every curve is seen.
    const outside = await page.evaluate(() => {
      const found = [];
      for (const text of document.querySelectorAll('svg.plot text')) {
        const picture = text.closest('svg.plot')?.getBoundingClientRect();
        const place = text.getBoundingClientRect();
        if (picture && (place.left < picture.left - 1 || place.right > picture.right + 1 || place.top < picture.top - 1 || place.bottom > picture.bottom + 1))
          found.push(`${text.closest('figure')?.id}: ${text.textContent}`);
      }
      return found;
    });
    assert.deepEqual(outside, []);

    // A phone scrolls pictures, not the page; the dark page is dark.
    await page.setViewportSize({ width: 390, height: 800 });
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
    const paper = () => page.evaluate(() => getComputedStyle(document.documentElement).backgroundColor);
    const light = await paper();
    await page.emulateMedia({ colorScheme: 'dark' });
    assert.notEqual(await paper(), light);
    await page.emulateMedia({ media: 'print', colorScheme: 'dark' });
    assert.equal(await paper(), light, 'paper is white');
    assert.deepEqual(complaints, []);
  });
}

test('the lab at a station makes the report, and says which command does', async (context) => {
  const { page, complaints, close } = await open(['lab', '--out', folder()], { locale: 'es-ES' });
  context.after(() => close());
  await page.waitForSelector('#connection.good');
  await page.getByRole('button', { name: 'Memoria' }).click();
  assert.equal(await page.locator('#report-dialog code').first().textContent(), 'rumbo experiments --language es');
  assert.equal(await page.locator('#report-dialog form').count(), 0);
  await page.locator('#report-make').click();
  const [saved] = await Promise.all([page.waitForEvent('download'), page.locator('#report-result button').click()]);
  const made = readFileSync(await saved.path(), 'utf8');
  assert.ok(saved.suggestedFilename() === 'report.html' && made.startsWith('<!doctype html>') && made.includes('lang="es"'), made.slice(0, 100));
  assert.deepEqual(await page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
  assert.deepEqual(complaints, []);
});
