// @ts-check
/**
 * The report that the site's lab makes: the bytes of `rumbo experiments`, in both languages; its page as a browser shows it
 * by the site's content policy; progress, cancel, what is loaded when. RUMBO_BIN is the native program.
 */
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { serious as violations } from '../axe.mjs';
import { eventually, folder, program } from '../dashboard.mjs';
import { open, skip } from '../site.mjs';

/** @typedef {Awaited<ReturnType<typeof open>>} Site */

/** @param {string} path */
const hash = (path) => createHash('sha256').update(readFileSync(path)).digest('hex');

/** The hash of the page that the native program writes. @param {string[]} options */
function native(options) {
  const out = folder();
  execFileSync(program(), ['experiments', '--out', out, ...options], { stdio: 'ignore' });
  return hash(join(out, 'report.html'));
}

/** Opens the dialog. @param {Site} site */
async function ask({ page }) {
  await page.waitForSelector('#connection.good');
  await page.locator('#report').click();
  await page.locator('#report-make:enabled').waitFor();
}

/** Makes the report and saves it; gives its hash. @param {Site} site */
async function save({ page }) {
  await page.locator('#report-make').click();
  const saving = page.waitForEvent('download');
  await page.locator('#report-result button').click();
  const download = await saving;
  assert.equal(download.suggestedFilename(), 'report.html');
  const path = join(folder(), 'report.html');
  await download.saveAs(path);
  return hash(path);
}

/** Chooses these of the experiments, by the their titles. @param {Site} site @param {RegExp[]} titles */
async function choose({ page }, titles) {
  await page.locator('#report-all').uncheck();
  for (const title of titles) await page.locator('#report-dialog').getByLabel(title).check();
}

test('a report has the bytes of rumbo experiments, all chapters in English and two of them in Spanish', { skip }, async () => {
  const site = await open();
  /** @type {string[]} */
  const loaded = [];
  site.context.on('request', (request) => loaded.push(request.url().slice(site.url.length)));
  await site.page.waitForSelector('#connection.good');
  assert.ok(!loaded.some((path) => path.includes('rumbo_report')), 'loaded before it is asked for');
  await ask(site);
  assert.ok(loaded.includes('lab/rumbo_report_bg.wasm'));
  assert.equal(await save(site), native(['--language', 'en']));
  assert.deepEqual([...site.complaints, ...site.abroad], []);
  await site.close();

  const spanish = await open({ locale: 'es-ES' });
  await ask(spanish);
  await choose(spanish, [/Modo 1/, /Modo 5/]);
  await spanish.page.locator('#report-seed').fill('7');
  assert.equal(await save(spanish), native(['--language', 'es', '--seed', '7', '--only', 'mode1', 'mode5']));
  assert.deepEqual(await spanish.page.evaluate(() => /** @type {any} */ (window).rumbo.untranslated()), []);
  assert.deepEqual([...spanish.complaints, ...spanish.abroad], []);
  await spanish.close();
});

test('it is opened in a tab with its style, without a word of complaint, and the lab drives on', { skip }, async () => {
  const site = await open();
  const { page, context } = site;
  await ask(site);
  await choose(site, [/Mode 1/]);
  if (process.env['SCREENSHOT_REPORT']) await page.screenshot({ path: process.env['SCREENSHOT_REPORT'] });
  await page.locator('#report-make').click();
  const opening = context.waitForEvent('page');
  await page.getByRole('link', { name: 'Open the report' }).click();
  const report = await opening;
  report.on('console', (message) => site.complaints.push(message.text()));
  await report.locator('figure').first().waitFor();
  assert.equal(await report.locator('h2#mode1').count(), 1);
  // A figure is drawn by its style.
  const line = await report.locator('.plot .i1').first().evaluate((curve) => getComputedStyle(curve).fill);
  assert.equal(line, 'none');
  await report.reload();
  await report.locator('figure').first().waitFor();
  assert.deepEqual(await violations(page, '#report-dialog'), []);
  const before = await page.evaluate(() => /** @type {any} */ (window).rumbo.state().t_s);
  await page.waitForFunction((before) => /** @type {any} */ (window).rumbo.state().t_s > before + 0.5, before);
  assert.deepEqual([...site.complaints, ...site.abroad], []);
  await site.close();
});

test('it shows how far it is, and is cancelled', { skip }, async () => {
  const site = await open();
  const { page } = site;
  await ask(site);
  await page.evaluate(() => {
    const bar = document.querySelector('#report-part');
    const parts = /** @type {any} */ (window).parts = /** @type {number[]} */ ([]);
    new MutationObserver(() => parts.push(/** @type {HTMLProgressElement} */ (bar).value)).observe(/** @type {Element} */ (bar), { attributes: true });
  });
  await page.locator('#report-make').click();
  await page.locator('#report-result').waitFor();
  const parts = await page.evaluate(() => /** @type {any} */ (window).parts);
  const between = parts.filter((/** @type {number} */ part) => part > 0 && part < 1);
  assert.ok(between.length > 5, parts.join(' '));
  assert.deepEqual(between, between.toSorted((/** @type {number} */ one, /** @type {number} */ other) => one - other));

  // At once, before it is done: the worker is gone, and with it what it makes.
  const workers = () => page.workers().filter((worker) => worker.url().includes('lab/report.js')).length;
  assert.equal(workers(), 1);
  await page.evaluate(() => {
    document.getElementById('report-make')?.click();
    document.getElementById('report-cancel')?.click();
  });
  await eventually(async () => assert.equal(workers(), 0));
  assert.equal(await page.locator('#report-cancel').isVisible(), false);
  assert.equal(await page.locator('#report-make').isEnabled(), true);
  assert.equal(await page.locator('#report-result').isVisible(), false);
  // And made after all.
  await page.locator('#report-make').click();
  await page.locator('#report-result').waitFor();
  assert.deepEqual([...site.complaints, ...site.abroad], []);
  await site.close();
});

test('no experiment is no report, and without a network the dialog says what is missing', { skip }, async () => {
  const site = await open();
  const { page } = site;
  await page.waitForSelector('#connection.good');
  await page.evaluate(() => navigator.serviceWorker.ready);
  await ask(site);
  await choose(site, []);
  await page.locator('#report-make').click();
  await page.locator('#report-dialog .complaint', { hasText: 'choose an experiment' }).waitFor();
  await site.close();

  const cut = await open();
  await cut.page.waitForSelector('#connection.good');
  await cut.page.evaluate(() => navigator.serviceWorker.ready);
  cut.unplug();
  await cut.page.reload();
  await cut.page.waitForSelector('#connection.good');
  await cut.page.locator('#report').click();
  await cut.page.locator('#report-dialog .complaint', { hasText: 'Without a network' }).waitFor();
  await cut.close();
});
